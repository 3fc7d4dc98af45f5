#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <glm/geometric.hpp>
#include <memory>
#include <string>
#include <vector>

#include "apps/bench/registry.h"
#include "skeleton/filters/holt_filter.h"
#include "skeleton/filters/kalman_filter.h"
#include "skeleton/filters/lag.h"
#include "skeleton/filters/one_euro_filter.h"
#include "tests/skeleton/gestures/logs.h"

namespace kino {
namespace {

using Track = std::vector<glm::dvec3>;
using MakeFilter = std::function<std::unique_ptr<BodyFilter>()>;

constexpr double kStepS = 1.0 / 30;

struct Knob {
    std::string name;  ///< of the filter
    std::function<MakeFilter(double factor)> at;
};

Track joint_track(const std::vector<BodyFrame>& frames, Joint joint) {
    Track out;
    for (const BodyFrame& frame : frames) out.emplace_back(frame.bodies[0][joint].position_m);
    return out;
}

/// The log without what is faster than people move: a binomial kernel of 9 frames, which has no
/// lag (-3 dB at 4 Hz). It stands for the truth, which nobody knows.
Track smoothed(const Track& track) {
    constexpr std::array<double, 9> kKernel = {1, 8, 28, 56, 70, 56, 28, 8, 1};
    Track out(track.size());
    for (std::size_t i = 0; i < track.size(); ++i) {
        glm::dvec3 sum(0);
        double weight = 0;
        for (std::size_t k = 0; k < kKernel.size(); ++k) {
            const auto at = static_cast<std::ptrdiff_t>(i + k) - 4;
            if (at < 0 || at >= static_cast<std::ptrdiff_t>(track.size())) continue;
            sum += kKernel[k] * track[static_cast<std::size_t>(at)];
            weight += kKernel[k];
        }
        out[i] = sum / weight;
    }
    return out;
}

std::vector<BodyFrame> filtered(const std::vector<BodyFrame>& frames, const MakeFilter& make) {
    const auto filter = make();
    std::vector<BodyFrame> out = frames;
    for (BodyFrame& frame : out) frame.bodies[0] = filter->update(frame.bodies[0], frame.time);
    return out;
}

struct Still {
    std::size_t first = 0;
    double mm = 1e9;
};

constexpr std::size_t kStillFrames = 20;

/// Jitter: RMS over the joints of second differences over the square root of 6, mm. Of white noise
/// that is its deviation; slow sway and drift are not in it.
double jitter_mm(const std::vector<BodyFrame>& frames, std::size_t first) {
    double sum = 0;
    for (std::size_t j = 0; j < kJointCount; ++j) {
        const Track track = joint_track(frames, static_cast<Joint>(j));
        for (std::size_t i = first + 1; i + 1 < first + kStillFrames; ++i) {
            const glm::dvec3 bend = track[i + 1] - 2.0 * track[i] + track[i - 1];
            sum += glm::dot(bend, bend) / 6;
        }
    }
    return 1000 * std::sqrt(sum / (kJointCount * (kStillFrames - 2)));
}

/// The two thirds of a second in which the person keeps most still; not at the very begin, where
/// filters have just started.
Still stillest(const std::vector<BodyFrame>& frames) {
    Still best;
    for (std::size_t i = 15; i + kStillFrames <= frames.size(); ++i) {
        if (const double mm = jitter_mm(frames, i); mm < best.mm) best = {i, mm};
    }
    return best;
}

std::vector<Knob> knobs() {
    return {{"holt, smoothing",
             [](double factor) {
                 HoltParameters p;
                 p.smoothing = std::min(0.95, p.smoothing * factor);
                 return MakeFilter([p] { return std::make_unique<HoltFilter>(p); });
             }},
            {"one-euro, least cutoff",
             [](double factor) {
                 OneEuroParameters p;
                 p.min_cutoff_hz /= factor;
                 return MakeFilter([p] { return std::make_unique<OneEuroFilter>(p); });
             }},
            {"one-euro, cutoff and beta",
             [](double factor) {
                 OneEuroParameters p;
                 p.min_cutoff_hz /= factor;
                 p.beta_hz_per_mps /= factor;
                 return MakeFilter([p] { return std::make_unique<OneEuroFilter>(p); });
             }},
            {"kalman, noise", [](double factor) {
                 KalmanParameters p;
                 p.noise_m *= factor;
                 return MakeFilter([p] { return std::make_unique<KalmanFilter>(p); });
             }}};
}

struct Measured {
    double lag_ms = 0, residual_mm = 0, still_mm = 0;
};

/// Lag and residual of the waving and drawing hand, jitter of the stillest moments of two logs.
struct Logs {
    std::vector<std::vector<BodyFrame>> moving, calm;
    std::vector<Still> still;

    [[nodiscard]] Measured measure(const MakeFilter& make) const {
        Measured out;
        for (const auto& frames : moving) {
            const auto lag =
                measure_lag(smoothed(joint_track(frames, Joint::hand_right)),
                            joint_track(filtered(frames, make), Joint::hand_right), kStepS, 0.4);
            out.lag_ms += 1000 * lag.lag_s / static_cast<double>(moving.size());
            out.residual_mm += 1000 * lag.residual_rms_m / static_cast<double>(moving.size());
        }
        for (std::size_t i = 0; i < calm.size(); ++i) {
            out.still_mm += jitter_mm(filtered(calm[i], make), still[i].first) /
                            static_cast<double>(calm.size());
        }
        return out;
    }
};

}  // namespace

void bench_joint_filters(BenchContext& bench) {
    Logs logs;
    for (const char* name : {"laban-wave", "laban-draw"}) {
        logs.moving.push_back(test::motion_log(name));
    }
    for (const char* name : {"laban-wave", "laban-draw", "keraal-ctk"}) {
        logs.calm.push_back(test::motion_log(name));
    }
    for (const auto& frames : logs.calm) {
        if (frames.size() < 100) {
            return bench.fail({.what = "the logs are not there",
                               .where = "tests/data/motion",
                               .hint = "run it in the source tree"});
        }
        logs.still.push_back(stillest(frames));
    }
    double raw_mm = 0;
    for (const Still& still : logs.still) raw_mm += still.mm / static_cast<double>(3);
    bench.note(fmt::format(
        "Logs of Kinect v2 trackers at 30 Hz (tests/data/motion), already smoothed by those. Lag "
        "and rest: right hand of laban-wave and laban-draw against the log smoothed without lag, "
        "which stands for the truth. Jitter: RMS of second differences over the square root of 6, "
        "of all "
        "joints over the stillest two thirds of a second of three logs, {:.2f} mm unfiltered. The "
        "optical record of the Keraal exercise could not serve: its targets are not joints, and "
        "nothing says which is where.",
        raw_mm));
    const auto add = [&](const std::string& name, const std::string& knob, const std::string& level,
                         const Measured& m) {
        const auto row = [&](double value, const char* metric) {
            bench.add({.case_name = name,
                       .knob = knob,
                       .level = level,
                       .error = value,
                       .metric = metric});
        };
        row(m.lag_ms, "lag, ms");
        row(m.residual_mm, "left over after the lag, mm");
        row(m.still_mm, "jitter when still, mm");
    };
    double default_lag_ms = 0;
    for (const char* preset :
         {"holt:default", "holt:somewhat-latent", "holt:very-smooth", "one-euro:calm",
          "one-euro:default", "one-euro:quick", "kalman:calm", "kalman:default", "kalman:quick"}) {
        const Measured m = logs.measure([preset] { return *make_body_filter(preset); });
        if (std::string_view(preset) == "one-euro:default") default_lag_ms = m.lag_ms;
        add(preset, "preset", preset, m);
    }
    for (const Knob& knob : knobs()) {
        for (const double factor : {0.25, 0.5, 0.75, 1.0, 1.5, 2.0, 3.0, 4.0}) {
            add(knob.name, "times the default", fmt::format("{:g}", factor),
                logs.measure(knob.at(factor)));
        }
    }
    bench.claim(fmt::format("one-euro:default lags at most 50 ms on the hands of the logs "
                            "({:.0f} ms)",
                            default_lag_ms),
                default_lag_ms <= 50);
}

}  // namespace kino
