#include "tests/sensor/device/scenarios/report.h"

#include <fmt/format.h>
#include <sys/mman.h>
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
constexpr std::chrono::seconds kHeldUp{1};

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

namespace {

struct Attempt {
    std::string output;
    bool held_up = false;
};

/// Waits for the child and watches how far apart its own steps get.
bool wait_for_child(pid_t child, int& status) {
    using std::chrono::steady_clock;
    bool held_up = false;
    auto last = steady_clock::now();
    while (waitpid(child, &status, WNOHANG) == 0) {
        std::this_thread::sleep_for(std::chrono::milliseconds(10));
        const auto now = steady_clock::now();
        held_up = held_up || now - last > kHeldUp;
        last = now;
    }
    return held_up;
}

Attempt try_scenario(const Scenario& scenario) {
    Attempt attempt;
    const int output = memfd_create("output", MFD_CLOEXEC);
    const auto began = std::chrono::steady_clock::now();
    const pid_t child = output < 0 ? -1 : fork();
    if (child == 0) {
        alarm(kSecondsAtMost);
        dup2(output, STDOUT_FILENO);
        scenario.run(Report(scenario.name));
        std::fflush(stdout);
        _exit(0);
    }
    std::string verdict;
    int status = 0;
    if (child < 0) {
        verdict = "was not started";
    } else {
        attempt.held_up = wait_for_child(child, status);
        if (WIFSIGNALED(status)) {
            verdict = fmt::format("ended by signal {}", strsignal(WTERMSIG(status)));
        } else if (WEXITSTATUS(status) != 0) {
            verdict = fmt::format("ended with status {}", WEXITSTATUS(status));
        }
    }
    if (output >= 0) {
        lseek(output, 0, SEEK_SET);
        char part[4096];
        for (ssize_t got = 0; (got = read(output, part, sizeof part)) > 0;) {
            attempt.output.append(part, static_cast<std::size_t>(got));
        }
        close(output);
    }
    if (!verdict.empty()) attempt.output += fmt::format("! {} {}\n", scenario.name, verdict);
    if (!wait_for_empty_bus()) {
        attempt.output += fmt::format("! {} leaves a device on the bus\n", scenario.name);
    }
    const std::chrono::duration<double> took = std::chrono::steady_clock::now() - began;
    attempt.output += fmt::format("= {} seconds {:.1f}\n", scenario.name, took.count());
    return attempt;
}

}  // namespace

void run_scenarios(const std::vector<Scenario>& scenarios) {
    for (const Scenario& scenario : scenarios) {
        Attempt attempt = try_scenario(scenario);
        int held_up = 0;
        while (attempt.held_up && held_up < 2) {
            ++held_up;
            attempt = try_scenario(scenario);
        }
        say(attempt.output);
        Report(scenario.name).value("held_up", held_up);
    }
}

}  // namespace kino::guest
