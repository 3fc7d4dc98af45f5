#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <functional>
#include <map>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "apps/bench/body_score.h"
#include "apps/bench/logged_motions.h"
#include "apps/bench/marked_frames.h"
#include "apps/bench/registry.h"
#include "calibration/rig.h"
#include "skeleton/actors/actor_sequence.h"
#include "skeleton/filters/body_filter.h"
#include "skeleton/filters/lag.h"
#include "skeleton/forest/default_forest.h"
#include "skeleton/forest/tree_pruning.h"
#include "skeleton/tracking/body_tracker.h"

namespace kino {
namespace {

using SharedForest = std::shared_ptr<const Forest>;

constexpr int kWidth = 640, kHeight = 480;
constexpr int kInView = 5;  // joints of a person that is more than a few pixels beside a cupboard
constexpr double kLeadInS = 2;  // of the empty room

/// One setting of the tracker, carried through all takes.
struct Variant {
    std::string knob, level;
    BodyTrackerOptions options;
    SharedForest forest;
    BodyScore score;
    std::vector<double> ms;
    std::array<std::vector<double>, 5> stage_ms;  // of frames with one person
};

constexpr std::array<const char*, 5> kStages = {"people", "parts", "proposals", "fit", "filter"};

void note_times(const TrackingTimes& times, Variant& variant) {
    const std::array<TimeNs, 5> stages = {times.people, times.parts, times.proposals, times.fit,
                                          times.filter};
    for (std::size_t s = 0; s < stages.size(); ++s)
        variant.stage_ms[s].push_back(1e-6 * static_cast<double>(stages[s]));
    variant.ms.push_back(1e-6 * static_cast<double>(times.total()));
}

ActorTake take_of(const std::string& motion, std::uint64_t seed) {
    ActorTake take;
    take.seed = seed;
    take.motion = motion;
    take.width = kWidth;
    take.height = kHeight;
    take.lead_in_s = kLeadInS;
    return take;
}

Result<void> play(const ActorTake& take, int frames, std::vector<Variant*> variants) {
    KINO_ASSIGN(const auto sequence, ActorSequence::create(take));
    KINO_ASSIGN(const Rig rig, Rig::create(sequence->rig()));
    std::vector<BodyTracker> trackers;
    for (const Variant* v : variants) {
        KINO_ASSIGN(BodyTracker tracker,
                    BodyTracker::create(rig.depth_rays(), v->forest, v->options));
        trackers.push_back(std::move(tracker));
    }
    ActorFrame frame;
    BodyFrame found;
    const int lead_in = static_cast<int>(std::lround(take.lead_in_s * sequence->rate_hz()));
    const int last = std::min(sequence->frames(), lead_in + frames);
    for (int i = 0; i < last; ++i) {
        sequence->render(i, frame);
        for (std::size_t v = 0; v < variants.size(); ++v) {
            trackers[v].track(frame.depth_m, frame.time + 1, std::nullopt, found);
            variants[v]->score.add(frame.truth, found);
            if (found.bodies.size() == 1) note_times(trackers[v].times(), *variants[v]);
        }
    }
    return {};
}

BenchRow row_of(const std::string& case_name, const std::string& knob, const std::string& level) {
    BenchRow row;
    row.case_name = case_name;
    row.knob = knob;
    row.level = level;
    return row;
}

void add_figures(BenchContext& context, const std::string& level, const ErrorFigures& f) {
    if (f.n == 0) return;
    BenchRow row = row_of(fmt::format("recorded motion, {} joints", f.n), "joints", level);
    row.error = f.mean_mm;
    row.metric = "mm mean";
    context.add(row);
    row.error = 1 - f.within_100;
    row.metric = "share beyond 100 mm";
    context.add(row);
    row.error = 1 - f.within_150;
    row.metric = "share beyond 150 mm";
    context.add(row);
    row.error = f.lost;
    row.metric = "share lost";
    context.add(row);
}

std::vector<Variant> all_variants(const SharedForest& forest) {
    std::vector<Variant> variants;
    const auto add = [&](const char* knob, const std::string& level) -> Variant& {
        variants.push_back({knob, level, {}, forest, {}, {}, {}});
        return variants.back();
    };
    add("tracker", "as shipped");
    for (int trees = 1; trees < static_cast<int>(forest->trees.size()); ++trees)
        add("trees", std::to_string(trees)).options.trees = trees;
    for (const int depth : {6, 10, 14})
        add("depth", std::to_string(depth)).forest =
            std::make_shared<const Forest>(shallower(*forest, depth));
    for (const int step : {1, 2, 4, 8})
        add("step, px", std::to_string(step)).options.step_px = step;
    for (const int cell : {2, 4, 8, 16})
        add("cell, px", std::to_string(cell)).options.people.cell_px = cell;
    for (const int rounds : {1, 2, 4})
        add("fit rounds", std::to_string(rounds)).options.fit_rounds = rounds;
    return variants;
}

void add_variants(BenchContext& context, const std::vector<Variant>& variants,
                  const SharedForest& forest) {
    for (const Variant& v : variants) {
        BenchRow row = row_of("recorded motion", v.knob, v.level);
        row.ms_median = bench::quantile(v.ms, 0.5);
        row.ms_p95 = bench::quantile(v.ms, 0.95);
        row.error = v.score.figures().mean_mm;
        row.metric = "mm mean";
        context.add(row);
    }
    // The shipped setting ends every curve of trees and depth.
    int deepest = 0;
    for (const ForestTree& tree : forest->trees) deepest = std::max(deepest, tree_depth(tree));
    for (const auto& [knob, level] :
         {std::pair<std::string, std::size_t>{"trees", forest->trees.size()},
          std::pair<std::string, std::size_t>{"depth", static_cast<std::size_t>(deepest)}}) {
        BenchRow row = row_of("recorded motion", knob, std::to_string(level));
        row.ms_median = bench::quantile(variants[0].ms, 0.5);
        row.ms_p95 = bench::quantile(variants[0].ms, 0.95);
        row.error = variants[0].score.figures().mean_mm;
        row.metric = "mm mean";
        context.add(row);
    }
}

Result<void> accuracy(BenchContext& context, const SharedForest& forest) {
    KINO_ASSIGN(std::vector<std::string> motions, logged_motions());
    if (context.quick()) {
        // Every other one: all kinds are among them.
        for (std::size_t i = 1; i < motions.size(); ++i) {
            motions.erase(motions.begin() + static_cast<std::ptrdiff_t>(i));
        }
    }
    std::vector<Variant> variants = all_variants(forest);
    std::vector<Variant*> all;
    for (Variant& v : variants) all.push_back(&v);
    // The knobs see the beginning of each motion with one body, so that all have the same frames.
    for (std::size_t i = 0; i < motions.size(); i += context.quick() ? 2 : 1) {
        const std::string& motion = motions[i];
        context.progress(motion + ", all settings");
        KINO_TRY(play(take_of(motion, 501), context.quick() ? 15 : 60, all));
    }
    add_variants(context, variants, forest);
    variants[0] = all_variants(forest)[0];
    const int frames = context.quick() ? 60 : 100000;
    for (std::uint64_t seed = 501; seed < (context.quick() ? 502u : 507u); ++seed)
        for (const std::string& motion : motions) {
            Variant one = all_variants(forest)[0];
            KINO_TRY(play(take_of(motion, seed), frames, {&one}));
            const ErrorFigures f = one.score.figures();
            context.progress(fmt::format("{}, body {}: {:.0f} mm, {:.1f} % lost", motion, seed,
                                         f.mean_mm, 100 * f.lost));
            BenchRow row =
                row_of("recorded motion", "take",
                       fmt::format("{}, body {}",
                                   std::filesystem::path(motion.substr(4)).stem().string(), seed));
            row.error = f.mean_mm;
            row.metric = fmt::format("mm mean, {:.1f} % lost", 100 * f.lost);
            context.add(row);
            variants[0].score.add(one.score);
            variants[0].ms.insert(variants[0].ms.end(), one.ms.begin(), one.ms.end());
            for (std::size_t s = 0; s < kStages.size(); ++s)
                variants[0].stage_ms[s].insert(variants[0].stage_ms[s].end(),
                                               one.stage_ms[s].begin(), one.stage_ms[s].end());
        }
    const BodyScore& score = variants[0].score;
    const ErrorFigures figures = score.figures();
    add_figures(context, "all", figures);
    const ErrorFigures in_view =
        score.figures([](const JointError& e) { return e.seen >= kInView; });
    add_figures(context, fmt::format("all of people with at least {} joints seen", kInView),
                in_view);
    add_figures(context, "visible", score.figures([](const JointError& e) { return e.visible; }));
    add_figures(context, "occluded", score.figures([](const JointError& e) { return !e.visible; }));
    for (int metre = 0; metre < 6; ++metre)
        add_figures(context, fmt::format("{} to {} m", metre, metre + 1),
                    score.figures(
                        [&](const JointError& e) { return static_cast<int>(e.range_m) == metre; }));
    for (std::size_t j = 0; j < kJointCount; ++j)
        add_figures(context, joint_name(static_cast<Joint>(j)),
                    score.figures([&](const JointError& e) { return e.joint == j; }));
    context.claim(fmt::format("mean error of all joints {:.0f} mm (at most 55)", figures.mean_mm),
                  figures.mean_mm <= 55);
    context.claim(fmt::format("{:.1f} % within 100 mm (at least 90)", 100 * figures.within_100),
                  figures.within_100 >= 0.9);
    context.claim(fmt::format("{:.1f} % within 150 mm (at least 97)", 100 * figures.within_150),
                  figures.within_150 >= 0.97);
    context.claim(
        fmt::format("of people with at least {} of 20 joints seen: mean {:.0f} mm, {:.1f} % "
                    "within 100 mm, {:.1f} % within 150 mm (the same bounds)",
                    kInView, in_view.mean_mm, 100 * in_view.within_100, 100 * in_view.within_150),
        in_view.mean_mm <= 55 && in_view.within_100 >= 0.9 && in_view.within_150 >= 0.97);
    for (std::size_t s = 0; s < kStages.size(); ++s) {
        BenchRow row = row_of("one person, 640x480", "stage", kStages[s]);
        row.ms_median = bench::quantile(variants[0].stage_ms[s], 0.5);
        row.ms_p95 = bench::quantile(variants[0].stage_ms[s], 0.95);
        context.add(row);
    }
    BenchRow row = row_of("one person, 640x480", "stage", "all");
    row.ms_median = bench::quantile(variants[0].ms, 0.5);
    row.ms_p95 = bench::quantile(variants[0].ms, 0.95);
    context.add(row);
    context.claim(
        fmt::format("one person at 640x480 takes {:.1f} ms, median (at most 8)", row.ms_median),
        row.ms_median <= 8);
    return {};
}

/// Frames of one person at 2 m: the truth, what the tracker finds with its own filter, and without.
struct Played {
    std::vector<TimeNs> time;
    std::vector<Body> truth, shipped, raw;
};

Result<Played> play_alone(const std::string& motion, const SharedForest& forest) {
    ActorTake take = take_of(motion, 500);
    take.distance_m = 2;
    take.furniture = false;
    KINO_ASSIGN(const auto sequence, ActorSequence::create(take));
    KINO_ASSIGN(const Rig rig, Rig::create(sequence->rig()));
    KINO_ASSIGN(BodyTracker tracker, BodyTracker::create(rig.depth_rays(), forest));
    Played played;
    ActorFrame frame;
    BodyFrame found;
    // Bones are learned in the first seconds.
    const int settled = static_cast<int>((kLeadInS + 3) * sequence->rate_hz());
    const int last = std::min(sequence->frames(), settled + 240);
    for (int i = 0; i < last; ++i) {
        sequence->render(i, frame);
        tracker.track(frame.depth_m, frame.time + 1, std::nullopt, found);
        if (i < settled || found.bodies.empty() || frame.truth.bodies.empty()) continue;
        played.time.push_back(frame.time + 1);
        played.truth.push_back(frame.truth.bodies[0]);
        played.shipped.push_back(found.bodies[0]);
        played.raw.push_back(tracker.unfiltered().bodies.at(0));
    }
    return played;
}

Result<std::vector<Body>> filtered_by(const std::string& name, const Played& played) {
    KINO_ASSIGN(const auto filter, make_body_filter(name));
    std::vector<Body> out;
    for (std::size_t i = 0; i < played.raw.size(); ++i)
        out.push_back(filter ? filter->update(played.raw[i], played.time[i]) : played.raw[i]);
    return out;
}

/// RMS of the error's movement over all tracked joints: the truth may sway.
double jitter_mm(const Played& played, const std::vector<Body>& bodies) {
    double sum = 0;
    std::size_t n = 0;
    for (std::size_t j = 0; j < kJointCount; ++j) {
        std::vector<glm::dvec3> error;
        for (std::size_t i = 0; i < bodies.size(); ++i)
            if (bodies[i].joints[j].state == JointState::tracked)
                error.push_back(glm::dvec3(bodies[i].joints[j].position_m) -
                                glm::dvec3(played.truth[i].joints[j].position_m));
        const double rms = rms_about_mean_m(error);
        sum += rms * rms * static_cast<double>(error.size());
        n += error.size();
    }
    return n > 0 ? 1000 * std::sqrt(sum / static_cast<double>(n)) : bench::kNotMeasured;
}

/// Of the hand that moves more.
double lag_ms(const Played& played, const std::vector<Body>& bodies) {
    double most = 0, lag = bench::kNotMeasured;
    for (const Joint hand : {Joint::hand_left, Joint::hand_right}) {
        std::vector<glm::dvec3> truth, found;
        for (std::size_t i = 0; i < bodies.size(); ++i) {
            truth.emplace_back(played.truth[i][hand].position_m);
            found.emplace_back(bodies[i][hand].position_m);
        }
        if (truth.size() < 60 || rms_about_mean_m(truth) <= most) continue;
        most = rms_about_mean_m(truth);
        lag = 1000 * measure_lag(truth, found, 1.0 / 30, 0.3).lag_s;
    }
    return lag;
}

Result<void> steadiness(BenchContext& context, const SharedForest& forest) {
    context.progress("standing still");
    KINO_ASSIGN(const Played still, play_alone("idle", forest));
    context.progress("a fast arm");
    KINO_ASSIGN(const Played fast, play_alone("swipe", forest));
    const auto add = [&](const std::string& level, double jitter, double lag) {
        BenchRow row = row_of("jitter against lag", "filter", level);
        row.error = jitter;
        row.metric = "mm RMS jitter of tracked joints, standing at 2 m";
        context.add(row);
        row.error = lag;
        row.metric = "ms lag of a swiping hand at 2 m";
        context.add(row);
    };
    for (const char* name :
         {"none", "holt:default", "holt:somewhat-latent", "holt:very-smooth", "one-euro:calm",
          "one-euro:default", "one-euro:quick", "kalman:calm", "kalman:default", "kalman:quick"}) {
        KINO_ASSIGN(const auto a, filtered_by(name, still));
        KINO_ASSIGN(const auto b, filtered_by(name, fast));
        add(name, jitter_mm(still, a), lag_ms(fast, b));
    }
    const double jitter = jitter_mm(still, still.shipped), lag = lag_ms(fast, fast.shipped);
    add("as shipped: " + BodyTrackerOptions{}.filter, jitter, lag);
    context.claim(
        fmt::format("as shipped: {:.1f} mm jitter (at most 4) with {:.0f} ms lag (at most "
                    "50)",
                    jitter, lag),
        jitter <= 4 && lag <= 50);
    return {};
}

/// The person of each frame alone, as if the room had been learned and cut away.
Result<void> real_frames(BenchContext& context, const SharedForest& forest) {
    constexpr double kNearPx = 15;
    for (const auto& folder : context.marked) {
        KINO_ASSIGN(const auto frames, read_marked_frames(folder));
        std::size_t near = 0, all = 0;
        std::map<std::string, std::pair<std::size_t, std::size_t>> by_joint;
        for (const MarkedFrame& marked : frames) {
            const int w = marked.depth_mm.width(), h = marked.depth_mm.height();
            Image<RayXy> rays(w, h);
            Image<float> empty(w, h), depth(w, h);
            empty.fill(0);
            for (int y = 0; y < h; ++y)
                for (int x = 0; x < w; ++x) {
                    rays.at(x, y) = {static_cast<float>((x - 0.5 * (w - 1)) / kMarkedFocalPx),
                                     static_cast<float>((y - 0.5 * (h - 1)) / kMarkedFocalPx)};
                    depth.at(x, y) = marked.body.at(x, y) != 0
                                         ? 0.001f * static_cast<float>(marked.depth_mm.at(x, y))
                                         : 0.0f;
                }
            KINO_ASSIGN(BodyTracker tracker, BodyTracker::create(rays, forest));
            BodyFrame found;
            for (int i = 0; i < 75; ++i)
                tracker.track(i < 45 ? empty : depth, from_seconds(1.0 + i / 30.0), std::nullopt,
                              found);
            for (const MarkedJoint& joint : marked.joints) {
                auto& [hits, n] = by_joint[joint.name.substr(joint.name[2] == '_' ? 3 : 0)];
                ++n;
                ++all;
                if (found.bodies.empty()) continue;
                const JointPosition& at = found.bodies[0][joint.joint];
                if (at.state == JointState::lost || !(at.position_m.z > 0)) continue;
                const double x = at.position_m.x / at.position_m.z * kMarkedFocalPx;
                const double y = at.position_m.y / at.position_m.z * kMarkedFocalPx;
                if (std::hypot(x + 0.5 * (w - 1) - joint.x, y + 0.5 * (h - 1) - joint.y) > kNearPx)
                    continue;
                ++hits;
                ++near;
            }
        }
        const std::string name = folder.filename().string();
        const auto add = [&](const std::string& level, std::size_t hits, std::size_t n) {
            const ShareInterval i = wilson(hits, n);
            BenchRow row = row_of(name, "joint", level);
            row.error = i.share;
            row.metric =
                fmt::format("share within 15 px, n = {}, 95 %: {:.2f} to {:.2f}", n, i.low, i.high);
            context.add(row);
        };
        add("all", near, all);
        for (const auto& [joint, counts] : by_joint) add(joint, counts.first, counts.second);
    }
    return {};
}

Result<void> run(BenchContext& context) {
    KINO_ASSIGN(const SharedForest forest, default_forest());
    KINO_TRY(real_frames(context, forest));
    KINO_TRY(steadiness(context, forest));
    KINO_TRY(accuracy(context, forest));
    context.note(
        "recorded motion: logs of body trackers (tests/data/motion) drive bodies that no training "
        "picture shows, in furnished rooms before a computed Kinect v1, 640x480; the room is seen "
        "empty for 2 s; a lost joint and every joint of a missed person count as 300 mm");
    context.note(
        "a person counts from the first pixel on: body 502 stands behind a cupboard for most of "
        "the "
        "multitrack motions with nothing but hair in view, which is why people with at least five "
        "joints seen are shown apart");
    context.note("depth: leaves in the place of subtrees vote as the mean of their leaves");
    context.note(
        "step: every n-th pixel of every n-th row is labelled; as shipped, so that about 1800 are");
    context.note(
        "marked frames: the person alone is shown for 30 pictures after 45 empty ones; the marks "
        "are right to about 6 px (head, hands) and 12 px (shoulders, elbows), and lie on the skin");
    return {};
}

}  // namespace

void bench_bodies(BenchContext& context) {
    if (auto done = run(context); !done) context.fail(done.error());
}

}  // namespace kino
