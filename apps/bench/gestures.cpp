#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "apps/bench/registry.h"
#include "skeleton/gestures/gesture_recognizer.h"
#include "tests/skeleton/gestures/logs.h"
#include "tests/skeleton/gestures/scripts.h"

namespace kino {
namespace {

using test::Script;
using Kinds = std::vector<GestureKind>;

struct Score {
    int expected = 0, found = 0, seen = 0;
    [[nodiscard]] double missed() const {
        return expected == 0 ? 0 : 1 - static_cast<double>(found) / expected;
    }
    [[nodiscard]] double wrong() const {
        return seen == 0 ? 0 : 1 - static_cast<double>(found) / seen;
    }
};

Kinds recognized(const std::vector<BodyFrame>& frames, const GestureDefinitions& definitions) {
    GestureRecognizer recognizer(definitions);
    return test::kinds(test::recognize(frames, recognizer));
}

void count(Kinds want, const Kinds& got, std::map<GestureKind, Score>& by_kind) {
    for (const GestureKind kind : want) ++by_kind[kind].expected;
    for (const GestureKind kind : got) {
        ++by_kind[kind].seen;
        const auto hit = std::find(want.begin(), want.end(), kind);
        if (hit == want.end()) continue;
        ++by_kind[kind].found;
        want.erase(hit);
    }
}

Score total(const std::map<GestureKind, Score>& by_kind) {
    Score out;
    for (const auto& [kind, score] : by_kind) {
        out.expected += score.expected;
        out.found += score.found;
        out.seen += score.seen;
    }
    return out;
}

/// Every script with each of `seeds` noises.
std::map<GestureKind, Score> score_scripts(double noise_m, int seeds,
                                           const GestureDefinitions& definitions) {
    std::map<GestureKind, Score> by_kind;
    for (int seed = 1; seed <= seeds; ++seed) {
        for (const Script& script : test::scripts()) {
            const auto frames =
                test::record(script.pose, {.seconds = script.seconds,
                                           .noise_m = noise_m,
                                           .seed = static_cast<std::uint64_t>(seed)});
            count(script.expected, recognized(frames, definitions), by_kind);
        }
    }
    return by_kind;
}

struct Log {
    const char* name;
    Kinds expected;
};

/// What was seen in the logs when they were looked at frame by frame.
const std::vector<Log>& logs() {
    using K = GestureKind;
    static const std::vector<Log> kLogs = {
        {"laban-wave", {K::wave}},
        {"laban-draw", {K::swipe_right, K::swipe_left, K::swipe_right, K::swipe_left}},
        {"laban-point", {}},
        {"laban-arms", {}},
        {"keraal-ctk", {}},
        {"multitrack-4-2", {}},
        {"multitrack-4-3", {}},
        {"multitrack-24-0", {}},
        {"multitrack-24-1", {}}};
    return kLogs;
}

/// All distances and travels a hand has to go, by one factor: the knob of how much is a gesture.
GestureDefinitions scaled(double factor) {
    GestureDefinitions d;
    d.wave.min_swing *= factor;
    d.wave.large_swing *= factor;
    d.swipe.min_travel *= factor;
    d.push.min_travel *= factor;
    d.two_hand.min_stretch *= factor;
    d.two_hand.min_turn_deg *= factor;
    d.raise.hold_s *= factor;
    d.t_pose.hold_s *= factor;
    d.dwell.hold_s *= factor;
    return d;
}

std::vector<BodyFrame> everyday(std::uint64_t seed, double seconds) {
    return test::record(test::everyday(seed, seconds),
                        {.seconds = seconds, .noise_m = 0.008, .seed = seed});
}

void by_noise(BenchContext& bench) {
    bool good = true;
    for (const double mm : {0.0, 5.0, 10.0, 15.0, 20.0, 30.0}) {
        const auto by_kind = score_scripts(mm / 1000, bench.quick() ? 2 : 5, {});
        const Score all = total(by_kind);
        if (mm <= 15) good = good && all.missed() <= 0.05 && all.wrong() <= 0.05;
        const std::string level = fmt::format("{:g}", mm);
        bench.add({.case_name = "scripts",
                   .knob = "noise, mm",
                   .level = level,
                   .error = 100 * all.missed(),
                   .metric = "gestures missed, %"});
        bench.add({.case_name = "scripts",
                   .knob = "noise, mm",
                   .level = level,
                   .error = 100 * all.wrong(),
                   .metric = "events wrong, %"});
        if (mm == 15) {
            for (const auto& [kind, score] : by_kind) {
                bench.note(fmt::format("{} at 15 mm: {} expected, {} found, {} events",
                                       gesture_name(kind), score.expected, score.found,
                                       score.seen));
            }
        }
    }
    bench.claim(
        "recall and precision are at least 95 % on the scripts up to 15 mm of noise on "
        "every axis of every joint",
        good);
}

void by_threshold(BenchContext& bench) {
    const double seconds = bench.quick() ? 120 : 300;
    std::vector<std::vector<BodyFrame>> days;
    for (std::uint64_t seed = 1; seed <= 4; ++seed) days.push_back(everyday(seed, seconds));
    for (const double factor : {0.4, 0.55, 0.7, 0.85, 1.0, 1.2, 1.4, 1.7, 2.0}) {
        const GestureDefinitions definitions = scaled(factor);
        const Score all = total(score_scripts(0.01, bench.quick() ? 1 : 3, definitions));
        std::size_t false_events = 0;
        for (const auto& day : days) false_events += recognized(day, definitions).size();
        const std::string level = fmt::format("{:g}", factor);
        const double per_five_minutes =
            static_cast<double>(false_events) * 300 / (seconds * static_cast<double>(days.size()));
        const auto add = [&](double error, const char* metric) {
            bench.add({.case_name = "all sizes and times",
                       .knob = "thresholds, times the default",
                       .level = level,
                       .error = error,
                       .metric = metric});
        };
        add(100 * all.missed(), "gestures missed, % (thresholds)");
        add(100 * all.wrong(), "events wrong, % (thresholds)");
        add(per_five_minutes, "false events in 5 min of everyday arms");
        if (factor == 1.0) {
            bench.claim(fmt::format("at most one false event in 5 minutes of computed everyday "
                                    "arms ({} in {:.0f} minutes)",
                                    false_events, seconds * 4 / 60),
                        per_five_minutes <= 1);
        }
    }
}

void by_log(BenchContext& bench) {
    double seconds = 0;
    std::size_t wrong = 0;
    Score all;
    for (const Log& log : logs()) {
        const auto frames = test::motion_log(log.name);
        if (frames.empty()) {
            return bench.fail({.what = "the log is not there",
                               .where = fmt::format("tests/data/motion/{}.csv", log.name),
                               .hint = "run it in the source tree"});
        }
        seconds += to_seconds(frames.back().time - frames.front().time);
        std::map<GestureKind, Score> by_kind;
        const Kinds got = recognized(frames, {});
        count(log.expected, got, by_kind);
        const Score score = total(by_kind);
        all.expected += score.expected;
        all.found += score.found;
        all.seen += score.seen;
        wrong += static_cast<std::size_t>(score.seen - score.found);
        bench.note(fmt::format("log {}: {} gestures in it, {} found, {} events", log.name,
                               score.expected, score.found, score.seen));
    }
    bench.claim(fmt::format("the logs of real people ({:.0f} s) give their {} gestures and at "
                            "most one false event ({} found, {} false)",
                            seconds, all.expected, all.found, wrong),
                all.found == all.expected && wrong <= 1);
}

void cost(BenchContext& context) {
    for (const int people : {1, 6}) {
        auto frames = everyday(1, 30);
        for (BodyFrame& frame : frames) {
            for (int i = 1; i < people; ++i) {
                Body other = frame.bodies[0];
                other.id = static_cast<std::uint32_t>(i + 1);
                frame.bodies.push_back(other);
            }
        }
        // Everybody stands and moves; who walks makes no gestures and costs less.
        std::erase_if(frames, [](const BodyFrame& f) { return to_seconds(f.time) >= 113; });
        const std::string name = people == 1 ? "one person" : "six people";
        const std::vector<bench::Candidate> candidates = {
            {name, [&] { (void)recognized(frames, {}); }}};
        const auto times = context.compare("cost", candidates, {.repeats = 15});
        const double us = 1000 * times[name].median_ms() / static_cast<double>(frames.size());
        context.note(fmt::format("cost: {:.1f} us a frame for {}", us,
                                 people == 1 ? "one person" : "six people"));
    }
}

}  // namespace

void bench_gestures(BenchContext& bench) {
    bench.note(
        "Scripts are computed motion: true joints at 30 Hz with white noise. Logs are those "
        "of Kinect v2 trackers in tests/data/motion, looked at frame by frame; the "
        "thresholds of the wave and of raised hands were set with them in view.");
    by_noise(bench);
    by_log(bench);
    by_threshold(bench);
    cost(bench);
}

}  // namespace kino
