#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "apps/bench/depth_score.h"
#include "apps/bench/registry.h"
#include "calibration/rig.h"
#include "sensor/filters/depth_filter_chain.h"
#include "sensor/source.h"
#include "skeleton/synthetic/synthetic_source.h"
#include "tests/reference/depth_filters.h"
#include "tests/support/random.h"

namespace kino {
namespace {

constexpr int kWarmUp = 8;  // frames that temporal filters see before anything is judged
/// Turns a share of the pixels beside true steps into mixtures of both sides, as time-of-flight
/// sensors and resampled pictures have them.
void mix_edges(Shot& shot, double share, std::uint64_t seed) {
    test::Random random(seed);
    for (int y = 0; y < shot.truth_m.height(); ++y) {
        for (int x = 1; x < shot.truth_m.width(); ++x) {
            const float a = shot.truth_m.at(x - 1, y);
            const float b = shot.truth_m.at(x, y);
            if (!is_step(a, b) || !random.chance(share)) continue;
            const double part = random.real(0.15, 0.85);
            shot.depth_m.at(x, y) = static_cast<float>(1 / (part / a + (1 - part) / b));
        }
    }
}

Result<std::vector<Shot>> synthetic_shots(Motion motion, int count) {
    KINO_ASSIGN(const auto source, SyntheticSource::create(make_scene(motion)));
    KINO_TRY(source->subscribe({0, StreamKind::depth}));
    RigParameters parameters = source->scene().rig;
    parameters.color.reset();
    KINO_ASSIGN(Rig rig, Rig::create(parameters));
    std::vector<Shot> shots;
    for (int i = 0; i < count; ++i) {
        KINO_ASSIGN(const auto set, source->next(kNsPerSecond));
        if (!set || !set->depth) return fail("the synthetic source ended early");
        RegisteredDepth registered;
        KINO_TRY(rig.register_depth(*set->depth, registered));
        SyntheticTruth truth = source->truth(set->index);
        Shot shot{std::move(registered.depth_m), std::move(truth.depth_m), std::move(truth.lit)};
        for (std::size_t p = 0; p < shot.expected.size(); ++p) {
            const float z = shot.truth_m.pixels()[p];
            const bool in_range = z >= parameters.min_depth_m && z <= parameters.max_depth_m;
            if (!in_range) shot.expected.pixels()[p] = 0;
        }
        shots.push_back(std::move(shot));
    }
    return shots;
}

/// One way of filtering: a chain of ours, or librealsense's.
struct Way {
    std::string level;
    std::function<void(const Image<float>&)> run;
    std::function<void(const Goal&, const Image<float>&, Score&)> judge;
    std::function<void()> reset;
    int factor = 1;
};

Way our_way(const std::string& level, const std::string& specification) {
    struct State {
        DepthFilterChain chain;
        Image<float> out;
    };
    const auto state = std::make_shared<State>();
    auto parsed = DepthFilterChain::parse(specification);
    KINO_CHECK(parsed.has_value());
    state->chain = std::move(*parsed);
    return {level, [state](const Image<float>& in) { state->chain.apply(in, state->out); },
            [state](const Goal& goal, const Image<float>& in, Score& score) {
                ::kino::judge(state->out, goal, in, score);
            },
            [state] { state->chain.reset(); }, state->chain.reduction()};
}

struct LibrealsenseStages {
    bool disparity = true, spatial = true, temporal = false, holes = false;
};

/// In pixels of disparity of a Kinect, else in millimetres.
Way librealsense_way(const std::string& level, const LibrealsenseStages& stages) {
    struct State {
        reference::librealsense::Temporal temporal;
        Image<double> values;
    };
    const auto state = std::make_shared<State>();
    constexpr double kBaselineTimesFocal = 0.075 * 571.0;
    const auto run = [state, stages](const Image<float>& in) {
        Image<double>& v = state->values;
        v.resize(in.width(), in.height());
        const auto convert = [&](double z) {
            if (!(z > 0)) return 0.0;
            return stages.disparity ? kBaselineTimesFocal / z : 1000 * z;
        };
        std::transform(in.pixels().begin(), in.pixels().end(), v.pixels().begin(), convert);
        if (stages.spatial) reference::librealsense::spatial(v);
        if (stages.temporal) state->temporal.next(v);
        for (double& value : v.pixels()) {
            if (value > 0) value = stages.disparity ? kBaselineTimesFocal / value : value / 1000;
        }
        if (stages.holes) reference::librealsense::fill_holes(v);
    };
    return {level, run,
            [state](const Goal& goal, const Image<float>& in, Score& score) {
                ::kino::judge(state->values, goal, in, score);
            },
            [state] { state->temporal = reference::librealsense::Temporal(); }};
}

Score score_of(const Way& way, const std::vector<Shot>& shots) {
    Score score;
    way.reset();
    for (std::size_t i = 0; i < shots.size(); ++i) {
        way.run(shots[i].depth_m);
        if (i >= kWarmUp) way.judge(goal_of(shots[i], way.factor), shots[i].depth_m, score);
    }
    return score;
}

struct Measure {
    std::string metric;
    std::function<double(const Score&)> value;
};

Measure overall() {
    return {fmt::format("mm RMS, all (lost = {})", kWorstMm),
            [](const Score& s) { return s.all.rms(); }};
}
Measure surfaces() {
    return {"mm RMS, surfaces", [](const Score& s) { return s.surface.rms(); }};
}
Measure edges() {
    return {fmt::format("mm RMS, edges (lost = {})", kWorstMm),
            [](const Score& s) { return s.edge.rms(); }};
}
Measure flying() {
    return {"flying pixels a frame", [](const Score& s) { return s.flying / s.frames; }};
}
Measure filled() {
    return {"mm RMS, filled pixels", [](const Score& s) { return s.filled.rms(); }};
}
Measure lost() {
    return {"lost pixels a frame", [](const Score& s) { return s.lost / s.frames; }};
}

std::vector<Score> sweep(BenchContext& context, const std::string& case_name,
                         const std::string& knob, const std::string& prefix,
                         const std::vector<Shot>& shots, const std::vector<Way>& ways,
                         const std::vector<Measure>& measures) {
    std::vector<bench::Candidate> candidates;
    std::vector<Score> scores;
    for (const Way& way : ways) {
        scores.push_back(score_of(way, shots));
        way.reset();
        candidates.push_back({way.level, [&way, &shots, next = std::size_t{0}]() mutable {
                                  way.run(shots[next++ % shots.size()].depth_m);
                              }});
    }
    const bench::Comparison times = context.compare(knob, candidates, {.max_seconds = 10});
    for (const Measure& measure : measures) {
        for (std::size_t i = 0; i < ways.size(); ++i) {
            context.add({.case_name = case_name,
                         .knob = knob,
                         .level = ways[i].level,
                         .error = measure.value(scores[i]),
                         .metric = prefix + measure.metric},
                        times);
        }
    }
    return scores;
}

std::vector<Way> levels(const std::string& filter, const std::string& key,
                        const std::vector<std::string>& values) {
    std::vector<Way> ways;
    for (const std::string& value : values) {
        ways.push_back(our_way(value, fmt::format("{}:{}={}", filter, key, value)));
    }
    return ways;
}

void bench_synthetic(BenchContext& context) {
    const int count = kWarmUp + (context.quick() ? 2 : 8);
    const auto shots = synthetic_shots(Motion::dance, count);
    if (!shots) return context.fail(shots.error());
    struct Sweep {
        const char *filter, *key, *unit;
        std::vector<std::string> levels;
        std::vector<Measure> metrics;
    };
    const auto run = [&](const std::string& case_name, const std::vector<Shot>& on,
                         const std::vector<Sweep>& sweeps) {
        for (const Sweep& s : sweeps) {
            const std::string what = fmt::format("{} {}", s.filter, s.key);
            sweep(context, case_name, what + s.unit, what + ": ", on,
                  levels(s.filter, s.key, s.levels), s.metrics);
        }
    };
    const std::vector<Measure> both = {surfaces(), edges()}, outlines = {edges(), flying()};
    run("synthetic dance 640x480", *shots,
        {{"spatial", "radius", ", px", {"1", "2", "3", "4"}, both},
         {"spatial", "sigmas", "", {"2", "3", "4", "5", "6", "7", "10", "20"}, both},
         {"spatial", "noise", "", {"0.0005", "0.001", "0.0017", "0.003", "0.006"}, both},
         {"temporal", "alpha", "", {"1", "0.5", "0.3", "0.15", "0.1", "0.05"}, both},
         {"temporal", "sigmas", "", {"3", "4.5", "7", "15", "50"}, both},
         {"temporal", "noise", "", {"0.0005", "0.001", "0.0017", "0.003", "0.006"}, both},
         {"temporal", "running", "", {"0", "1"}, both},
         {"temporal", "soft", "", {"0", "1"}, both},
         {"temporal", "persistence", "", {"0", "1", "2", "4", "8"}, outlines},
         {"holes", "gap", ", px", {"1", "2", "4", "8", "16", "32"}, {overall(), filled()}},
         {"holes", "angle", ", degrees", {"0", "20", "40", "60", "75"}, outlines},
         {"holes", "edge", ", px", {"0", "1", "2", "3", "4", "6", "8"}, outlines},
         {"holes", "steps", "", {"0", "1", "3", "6", "12"}, outlines},
         {"holes", "background", "", {"0", "1"}, {overall(), flying()}},
         {"decimate", "factor", "", {"1", "2", "3", "4", "8"}, {surfaces(), flying()}},
         {"decimate", "readings", "", {"1", "2", "3", "4"}, {surfaces(), lost()}}});

    // Another motion than the one our defaults were chosen on.
    auto mixed = synthetic_shots(Motion::walk, count);
    if (!mixed) return context.fail(mixed.error());
    for (std::size_t i = 0; i < mixed->size(); ++i) mix_edges((*mixed)[i], 0.3, 100 + i);
    const std::string mixed_name = "synthetic walk 640x480, 30 % of edge pixels mixed";
    run(mixed_name, *mixed,
        {{"flying", "steps", "", {"0.5", "1", "2", "3", "6", "12"}, {flying(), lost()}},
         {"flying", "angle", ", degrees", {"40", "60", "70", "80", "85"}, {flying(), lost()}},
         {"flying", "support", "", {"0", "1", "2", "3", "4", "6"}, {flying(), lost()}},
         {"decimate", "steps", "", {"0.5", "1", "3", "6", "20"}, {surfaces(), flying()}}});

    std::vector<Way> ways;
    const auto ours = [&](const std::string& specification) {
        ways.push_back(our_way(specification, specification));
    };
    ways.push_back(our_way("none", ""));
    for (const char* one : {"flying", "spatial", "temporal", "holes", "flying,spatial,temporal",
                            "flying,spatial,temporal,holes"}) {
        ours(one);
    }
    ways.push_back(our_way("temporal:preset=librealsense", "temporal:preset=librealsense"));
    ways.push_back(librealsense_way("librealsense spatial, mm", {.disparity = false}));
    ways.push_back(librealsense_way("librealsense spatial, disparity", {}));
    ways.push_back(librealsense_way("librealsense all, mm",
                                    {.disparity = false, .temporal = true, .holes = true}));
    ways.push_back(
        librealsense_way("librealsense all, disparity", {.temporal = true, .holes = true}));
    const auto scores = sweep(context, mixed_name, "chain", "", *mixed, ways,
                              {overall(), surfaces(), edges(), flying(), lost()});
    const auto at = [&](const std::string& level) -> const Score& {
        const auto found = std::find_if(ways.begin(), ways.end(),
                                        [&](const Way& way) { return way.level == level; });
        return scores[static_cast<std::size_t>(found - ways.begin())];
    };
    const Score& none = at("none");
    const Score& whole = at("flying,spatial,temporal,holes");
    context.claim(
        "flying, spatial, temporal and holes together at least halve the noise on surfaces",
        whole.surface.rms() <= 0.5 * none.surface.rms());
    context.claim("the same leaves fewer lost pixels and a smaller error at edges",
                  whole.lost < none.lost && whole.edge.rms() < none.edge.rms());
    context.claim("flying removes at least 95 % of the flying pixels and leaves surfaces alone",
                  at("flying").flying <= 0.05 * none.flying &&
                      at("flying").surface.rms() <= none.surface.rms());
    for (const char* theirs : {"librealsense all, mm", "librealsense all, disparity"}) {
        context.claim(fmt::format("smaller error than \"{}\" over all pixels, at edges and in "
                                  "flying pixels",
                                  theirs),
                      whole.all.rms() < at(theirs).all.rms() &&
                          whole.edge.rms() < at(theirs).edge.rms() &&
                          whole.flying < at(theirs).flying);
    }
}

Result<std::vector<Shot>> recorded_shots(const std::string& path, int count) {
    KINO_ASSIGN(const auto source, open_source(path));
    KINO_TRY(source->subscribe({0, StreamKind::depth}));
    KINO_ASSIGN(RigParameters parameters, source->calibration());
    parameters.color.reset();
    KINO_ASSIGN(Rig rig, Rig::create(parameters));
    std::vector<Shot> shots;
    while (static_cast<int>(shots.size()) < count) {
        KINO_ASSIGN(const auto set, source->next(kNsPerSecond));
        if (!set || !set->depth) break;
        RegisteredDepth registered;
        KINO_TRY(rig.register_depth(*set->depth, registered));
        shots.push_back({std::move(registered.depth_m), {}, {}});
    }
    if (shots.empty()) return fail("the recording holds no depth", path);
    return shots;
}

/// Pixels that are there in every frame and never move by more than five sigmas of the sensor, so
/// that what is left of change is noise. Picked on the unfiltered frames.
Image<std::uint8_t> still_pixels(const std::vector<Shot>& shots) {
    const Image<float>& first = shots.front().depth_m;
    Image<std::uint8_t> still(first.width(), first.height(), 1);
    for (std::size_t p = 0; p < still.size(); ++p) {
        double low = 1e9;
        double high = 0;
        for (const Shot& shot : shots) {
            const double z = shot.depth_m.pixels()[p];
            low = std::min(low, z > 0 ? 1 / z : 0.0);
            high = std::max(high, z > 0 ? 1 / z : 0.0);
        }
        if (!(low > 0) || high - low > 2 * 5 * 0.0017) still.pixels()[p] = 0;
    }
    return still;
}

/// RMS over the still pixels of the deviation from each pixel's own mean over time, mm.
double temporal_noise_mm(const std::string& specification, const std::vector<Shot>& shots,
                         const Image<std::uint8_t>& still, std::size_t warm_up) {
    auto chain = DepthFilterChain::parse(specification);
    KINO_CHECK(chain.has_value());
    std::vector<Image<float>> frames;
    for (const Shot& shot : shots) {
        Image<float> out;
        chain->apply(shot.depth_m, out);
        // Two frames are too few for anything to settle: there each is judged by itself.
        if (warm_up == 0) chain->reset();
        frames.push_back(std::move(out));
    }
    frames.erase(frames.begin(), frames.begin() + static_cast<std::ptrdiff_t>(warm_up));
    const auto n = static_cast<double>(frames.size());
    Sum sum;
    for (std::size_t p = 0; p < still.size(); ++p) {
        if (still.pixels()[p] == 0) continue;
        double mean = 0;
        for (const auto& frame : frames) mean += frame.pixels()[p] / n;
        for (const auto& frame : frames) {
            sum.squares += std::pow(1000 * (frame.pixels()[p] - mean), 2);
        }
        sum.count += n - 1;
    }
    return sum.rms();
}

void bench_recorded(BenchContext& context) {
    struct Recording {
        std::string path;
        int frames;
        std::size_t warm_up;
        std::vector<std::string> specifications;
    };
    const std::vector<Recording> recordings = {
        {"recordings/laptop", 2, 0, {"", "spatial:radius=1", "spatial", "spatial:radius=4"}},
        {"recordings/person",
         24,
         12,
         {"", "spatial", "temporal:alpha=0.4", "temporal", "temporal:alpha=0.05",
          "temporal:preset=librealsense", "flying,spatial,temporal,holes"}}};
    for (const Recording& recording : recordings) {
        const auto shots = recorded_shots(recording.path, recording.frames);
        if (!shots) return context.fail(shots.error());
        const Image<std::uint8_t> still = still_pixels(*shots);
        std::vector<Way> ways;
        std::vector<bench::Candidate> candidates;
        for (const std::string& text : recording.specifications) {
            ways.push_back(our_way(text.empty() ? "none" : text, text));
            candidates.push_back({ways.back().level,
                                  [run = ways.back().run, &shots, next = std::size_t{0}]() mutable {
                                      run((*shots)[next++ % shots->size()].depth_m);
                                  }});
        }
        const auto times = context.compare(recording.path, candidates, {.max_seconds = 10});
        for (std::size_t i = 0; i < ways.size(); ++i) {
            context.add({.case_name = recording.path,
                         .knob = "chain",
                         .level = ways[i].level,
                         .error = temporal_noise_mm(recording.specifications[i], *shots, still,
                                                    recording.warm_up),
                         .metric = recording.path + ": mm RMS, noise over time"},
                        times);
        }
    }
}

/// Each filter's fast code against its portable twin, on a real frame.
void bench_twins(BenchContext& context) {
    const auto shots = recorded_shots("recordings/office", 1);
    if (!shots) return context.fail(shots.error());
    const Image<float>& in = shots->front().depth_m;
    for (const char* filter : {"flying", "decimate", "spatial", "temporal", "holes"}) {
        auto fast = DepthFilterChain::parse(filter);
        auto portable = DepthFilterChain::parse(filter, {.simd = false});
        KINO_CHECK(fast && portable);
        Image<float> out;
        const std::string portable_name = fmt::format("{} portable", filter);
        const std::vector<bench::Candidate> candidates = {
            {filter, [&] { fast->apply(in, out); }},
            {portable_name, [&] { portable->apply(in, out); }}};
        const auto times = context.compare(fmt::format("office, {}", filter), candidates);
        context.add({.case_name = "recordings/office 640x480",
                     .knob = "code",
                     .level = filter,
                     .baseline = portable_name},
                    times);
        context.add(
            {.case_name = "recordings/office 640x480", .knob = "code", .level = portable_name},
            times);
    }
}

}  // namespace

void bench_filters(BenchContext& context) {
    bench_synthetic(context);
    bench_recorded(context);
    bench_twins(context);
    context.note(fmt::format(
        "Synthetic: the Kinect v1 of skeleton/synthetic (noise of 0.46 steps, rounding, lost edge "
        "pixels, projector shadow) before a person who dances (our defaults were chosen on these "
        "pictures) or walks (whole chains and flying pixels; the same room); truth is per pixel. "
        "\"all\": every "
        "pixel in range that the projector reaches; a lost one counts as {0} mm off, and nothing "
        "counts as more. \"surfaces\": readings more than {1} px from a true step. \"edges\": "
        "pixels within {1} px of one, lost ones as above. \"flying\": readings farther than "
        "3 * 0.00307 z^2 + tan(80 degrees) z / f from every true depth of the 3x3 pixels around. "
        "\"filled\": pixels without a reading before and with one after, shadow included, at most "
        "{0} mm. The first {2} frames only warm up.",
        kWorstMm, kEdgePx, kWarmUp));
    context.note(
        "Mixed edges: the noise model has no flying pixels, so 30 % of the pixels beside a true "
        "step along a row become mixtures of both sides.");
    context.note(
        "Decimated pictures are judged against the true surface of each block, edges within 3 px "
        "of the small picture.");
    context.note(
        "librealsense: its filters with its published defaults (spatial: alpha 0.5, delta 20, "
        "magnitude 2; temporal: alpha 0.4, delta 20, persistence \"2 of the last 4\"; holes: "
        "farthest from around), written in double for tests/reference, once in millimetres and "
        "once in pixels of disparity (75 mm, 571 px). Their times are those of this slow reference "
        "and say nothing about librealsense's speed. They were tuned for another sensor.");
    context.note(
        "recordings/laptop: two frames of a still scene, each filtered by itself; "
        "recordings/person: 24 frames, the still background behind him, the first 12 to warm up; "
        "its noise is that of video coding. Judged where no unfiltered reading moves by more than "
        "10 sigmas. office holds one frame and desk a moving camera: neither shows noise over "
        "time.");
}

}  // namespace kino
