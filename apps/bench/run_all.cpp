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
#include <sstream>
#include <thread>

#include "apps/bench/table.h"

extern char** environ;

namespace kino::bench {
namespace {

using Clock = std::chrono::steady_clock;

struct TypicalTime {
    std::string_view name;
    double full_s = 60, quick_s = 10;
};
constexpr std::array kTypical = {
    TypicalTime{"bodies", 230, 25},
    TypicalTime{"calibration", 25, 7},
    TypicalTime{"codecs", 90, 8},
    TypicalTime{"filters", 60, 5},
    TypicalTime{"forest", 120, 5},
    TypicalTime{"forward-plus", 75, 8},
    TypicalTime{"framebuffer-lod", 165, 14},
    TypicalTime{"gestures", 2, 1},
    TypicalTime{"governor", 116, 20},
    TypicalTime{"joint-filters", 1, 1},
    TypicalTime{"lbvh", 140, 13},
    TypicalTime{"lod-knobs", 40, 4},
    TypicalTime{"multiresolution", 60, 15},
    TypicalTime{"one-bounce", 14, 3},
    TypicalTime{"raster", 33, 5},
    TypicalTime{"registration", 34, 3},
    TypicalTime{"skinning", 1, 1},
    TypicalTime{"supersampling", 40, 10},
    TypicalTime{"vertex-pulling", 40, 7},
    TypicalTime{"zoom", 28, 6},
};
/// An entry that takes this many times what it should is stuck: the others want their turn.
constexpr double kStuckBeyond = 5;
constexpr double kLeastLimitS = 60, kLeastQuickLimitS = 30;

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

void read_claims(const std::string& text, EntryOutcome& outcome) {
    constexpr std::string_view kHolds = "holds: ", kMissed = "missed: ";
    std::istringstream lines(text);
    for (std::string line; std::getline(lines, line);) {
        if (line.starts_with(kHolds)) ++outcome.claims_hold;
        if (line.starts_with(kMissed)) outcome.claims_missed.push_back(line.substr(kMissed.size()));
    }
}

}  // namespace

double typical_seconds(std::string_view name, bool quick) {
    const auto known = std::find_if(kTypical.begin(), kTypical.end(),
                                    [&](const TypicalTime& time) { return time.name == name; });
    const TypicalTime time = known == kTypical.end() ? TypicalTime{} : *known;
    return quick ? time.quick_s : time.full_s;
}

std::size_t AllReport::failures() const {
    return static_cast<std::size_t>(
        std::count_if(outcomes.begin(), outcomes.end(),
                      [](const EntryOutcome& outcome) { return !outcome.failure.empty(); }));
}

std::size_t AllReport::claims_missed() const {
    std::size_t count = 0;
    for (const EntryOutcome& outcome : outcomes) count += outcome.claims_missed.size();
    return count;
}

AllReport run_all(std::span<const std::string_view> names, const AllOptions& options) {
    AllReport report{.csv = std::string(csv_header()), .most_minutes = options.most_minutes};
    const auto began = Clock::now();
    const std::filesystem::path beside =
        std::filesystem::temp_directory_path() / fmt::format("kinoscope-bench-{}", getpid());
    const auto csv = std::filesystem::path(beside).concat(".csv");
    const auto claims = std::filesystem::path(beside).concat(".claims");
    double expected_s = 0, done_s = 0;
    for (const std::string_view name : names) expected_s += typical_seconds(name, options.quick);
    for (std::size_t i = 0; i < names.size(); ++i) {
        EntryOutcome outcome{.name = std::string(names[i])};
        const double typical_s = typical_seconds(names[i], options.quick);
        const double gone_s = seconds_since(began);
        const double left_s = 60 * options.most_minutes - gone_s;
        // A machine that was twice as slow so far stays so.
        const double pace = done_s > 0 ? gone_s / done_s : 1;
        fmt::print(stderr, "{} of {}: {} ({:.1f} min gone, about {:.1f} left)\n", i + 1,
                   names.size(), outcome.name, gone_s / 60, pace * (expected_s - done_s) / 60);
        done_s += typical_s;
        if (left_s > 0) {
            std::vector<std::string> words = {options.program, outcome.name, "--csv",
                                              csv.string(),    "--claims",   claims.string()};
            words.insert(words.end(), options.arguments.begin(), options.arguments.end());
            const double stuck_s = std::max(kStuckBeyond * std::max(pace, 1.0) * typical_s,
                                            options.quick ? kLeastQuickLimitS : kLeastLimitS);
            outcome.failure = run_program(words, std::min(left_s, stuck_s));
        } else {
            outcome.failure =
                fmt::format("not begun, the {:.0f} minutes are over", options.most_minutes);
        }
        outcome.seconds = seconds_since(began) - gone_s;
        if (outcome.failure.empty()) {
            const std::string rows = text_of(csv);
            if (rows.starts_with(csv_header())) {
                report.csv += rows.substr(csv_header().size());
                outcome.rows =
                    static_cast<std::size_t>(std::count(rows.begin(), rows.end(), '\n')) - 1;
            }
            read_claims(text_of(claims), outcome);
        } else {
            fmt::print(stderr, "kinoscope-bench: {}: {}\n", outcome.name, outcome.failure);
        }
        std::error_code error;
        std::filesystem::remove(csv, error);
        std::filesystem::remove(claims, error);
        report.outcomes.push_back(std::move(outcome));
    }
    report.seconds = seconds_since(began);
    return report;
}

std::string summary_table(const AllReport& report) {
    std::string text =
        fmt::format("{:<18} {:>8} {:>6}  {}\n", "entry", "seconds", "rows", "claims");
    for (const EntryOutcome& outcome : report.outcomes) {
        const std::size_t missed = outcome.claims_missed.size();
        const std::size_t claims = missed + static_cast<std::size_t>(outcome.claims_hold);
        std::string what = fmt::format("{} of {} hold", outcome.claims_hold, claims);
        if (claims == 0) what = "none";
        if (!outcome.failure.empty()) what = "FAILED";
        text += fmt::format("{:<18} {:>8.1f} {:>6}  {}\n", outcome.name, outcome.seconds,
                            outcome.rows, what);
    }
    text += fmt::format("{:<18} {:>8.1f}         of {:.0f} at most\n", "all", report.seconds,
                        60 * report.most_minutes);
    if (report.failures() > 0) text += fmt::format("\n{} failed:\n", report.failures());
    for (const EntryOutcome& outcome : report.outcomes) {
        if (outcome.failure.empty()) continue;
        text += fmt::format("  {}: {}\n", outcome.name, outcome.failure);
    }
    if (report.claims_missed() > 0) {
        text += fmt::format("\n{} claims do not hold on this machine (no failure):\n",
                            report.claims_missed());
    }
    for (const EntryOutcome& outcome : report.outcomes) {
        for (const std::string& claim : outcome.claims_missed) {
            text += fmt::format("  {}: {}\n", outcome.name, claim);
        }
    }
    return text;
}

}  // namespace kino::bench
