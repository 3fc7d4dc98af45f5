#include "apps/bench/run_all.h"

#include <fmt/format.h>
#include <signal.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <optional>
#include <thread>

#include "apps/bench/table.h"

extern char** environ;

namespace kino::bench {
namespace {

using Clock = std::chrono::steady_clock;

struct TypicalTime {
    std::string_view name;
    double full_s = 60, quick_s = 12;
};
constexpr std::array kTypical = {
    TypicalTime{"bodies", 420, 25},
    TypicalTime{"forest", 120, 12},
    TypicalTime{"governor", 200, 40},
};
constexpr double kMostQuickSeconds = 60;

double seconds_since(Clock::time_point start) {
    return std::chrono::duration<double>(Clock::now() - start).count();
}

/// Runs to its end or `most_seconds`. Empty: it went well; else what went wrong.
std::string run_program(const std::vector<std::string>& words, double most_seconds) {
    std::vector<char*> argv;
    for (const std::string& word : words) argv.push_back(const_cast<char*>(word.c_str()));
    argv.push_back(nullptr);
    pid_t child = 0;
    if (posix_spawn(&child, argv.front(), nullptr, nullptr, argv.data(), environ) != 0) {
        return "could not be started";
    }
    const auto began = Clock::now();
    int status = 0;
    bool over = false;
    while (waitpid(child, &status, WNOHANG) == 0) {
        if (!over && seconds_since(began) > most_seconds) {
            over = true;
            kill(child, SIGKILL);
        }
        std::this_thread::sleep_for(std::chrono::milliseconds(50));
    }
    if (over) return fmt::format("was not done after {:.0f} s", most_seconds);
    if (WIFSIGNALED(status)) return fmt::format("ended by signal {}", WTERMSIG(status));
    if (WEXITSTATUS(status) != 0) return fmt::format("ended with status {}", WEXITSTATUS(status));
    return {};
}

std::string text_of(const std::filesystem::path& path) {
    std::ifstream file(path, std::ios::binary);
    return std::string((std::istreambuf_iterator<char>(file)), {});
}

}  // namespace

double typical_seconds(std::string_view name, bool quick) {
    const auto known = std::find_if(kTypical.begin(), kTypical.end(),
                                    [&](const TypicalTime& time) { return time.name == name; });
    const TypicalTime time = known == kTypical.end() ? TypicalTime{} : *known;
    return quick ? time.quick_s : time.full_s;
}

AllReport run_all(std::span<const std::string_view> names, const AllOptions& options) {
    AllReport report{.csv = std::string(csv_header()), .failed = {}};
    const auto began = Clock::now();
    const std::filesystem::path csv =
        std::filesystem::temp_directory_path() / fmt::format("kinoscope-bench-{}.csv", getpid());
    double expected_s = 0, done_s = 0;
    for (const std::string_view name : names) expected_s += typical_seconds(name, options.quick);
    for (std::size_t i = 0; i < names.size(); ++i) {
        const std::string name(names[i]);
        const double gone_s = seconds_since(began);
        const double left_s = 60 * options.most_minutes - gone_s;
        // A machine that was twice as slow so far stays so.
        const double pace = done_s > 0 ? gone_s / done_s : 1;
        fmt::print(stderr, "{} of {}: {} ({:.1f} min gone, about {:.1f} left)\n", i + 1,
                   names.size(), name, gone_s / 60, pace * (expected_s - done_s) / 60);
        done_s += typical_seconds(name, options.quick);
        if (left_s <= 0) {
            report.failed.push_back(fmt::format("{}: not begun, the {:.0f} minutes are over", name,
                                                options.most_minutes));
            continue;
        }
        std::vector<std::string> words = {options.program, name, "--csv", csv.string()};
        words.insert(words.end(), options.arguments.begin(), options.arguments.end());
        const double most_s = options.quick ? std::min(left_s, kMostQuickSeconds) : left_s;
        const std::string wrong = run_program(words, most_s);
        if (wrong.empty()) {
            const std::string rows = text_of(csv);
            if (rows.starts_with(csv_header())) report.csv += rows.substr(csv_header().size());
        } else {
            report.failed.push_back(name + ": " + wrong);
            fmt::print(stderr, "kinoscope-bench: {}\n", report.failed.back());
        }
        std::error_code error;
        std::filesystem::remove(csv, error);
    }
    return report;
}

}  // namespace kino::bench
