#include "tests/sensor/device/scenarios/report.h"

#include <fmt/format.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <cstdio>
#include <cstring>
#include <thread>

#include "tests/sensor/device/fake_kinect/fake_kinect.h"

namespace kino::guest {
namespace {

constexpr unsigned kSecondsAtMost = 120;

void say(const std::string& line) {
    std::fputs(line.c_str(), stdout);
    std::fflush(stdout);
}

bool wait_for_empty_bus() {
    for (int tries = 0; tries < 250; ++tries) {
        if (fake::devices_on_bus(0x02ae) == 0 && fake::devices_on_bus(0x02b0) == 0) return true;
        std::this_thread::sleep_for(std::chrono::milliseconds(20));
    }
    return false;
}

}  // namespace

void Report::value(const std::string& key, double number) const {
    say(fmt::format("= {} {} {}\n", scenario_, key, number));
}

void Report::failure(const std::string& text) const {
    say(fmt::format("! {} {}\n", scenario_, text));
}

void run_scenarios(const std::vector<Scenario>& scenarios) {
    for (const Scenario& scenario : scenarios) {
        const Report report(scenario.name);
        const auto began = std::chrono::steady_clock::now();
        const pid_t child = fork();
        if (child == 0) {
            alarm(kSecondsAtMost);
            scenario.run(report);
            std::fflush(stdout);
            _exit(0);
        }
        int status = 0;
        if (child < 0 || waitpid(child, &status, 0) != child) {
            report.failure("was not started");
        } else if (WIFSIGNALED(status)) {
            report.failure(fmt::format("ended by signal {}", strsignal(WTERMSIG(status))));
        } else if (WEXITSTATUS(status) != 0) {
            report.failure(fmt::format("ended with status {}", WEXITSTATUS(status)));
        }
        if (!wait_for_empty_bus()) report.failure("leaves a device on the bus");
        const std::chrono::duration<double> took = std::chrono::steady_clock::now() - began;
        report.value("seconds", took.count());
    }
}

}  // namespace kino::guest
