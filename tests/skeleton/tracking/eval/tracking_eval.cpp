#include <fmt/format.h>

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <string>
#include <string_view>
#include <vector>

#include "sensor/png_io.h"
#include "skeleton/forest/default_forest.h"
#include "skeleton/forest/forest_file.h"
#include "skeleton/tracking/body_tracker.h"
#include "tests/skeleton/tracking/eval/score.h"
#include "tests/skeleton/tracking/eval/skeleton_picture.h"
#include "tests/skeleton/tracking/eval/take.h"
#include "tests/skeleton/tracking/eval/truth_tracker.h"

namespace kino::test {
namespace {

struct Arguments {
    std::string source = "actors", motion, forest, sheet, filter = "none", people = "truth";
    int first = 1, last = 1, width = 320, every = 1, from = 0, frames = 100000, sheet_every = 15;
    int actors = 1, columns = 6;
    double distance = 0, lead_s = 2;
    bool noise = true, furniture = true, takes = true, joints = true, worst = false;
};

int usage() {
    fmt::print(
        stderr,
        "usage: tracking_eval [--source synthetic|actors] [--motion M] [--seeds A-B]\n"
        "  [--width W] [--distance M] [--actors N] [--noise 0|1] [--furniture 0|1]\n"
        "  [--people truth|mask|finder] [--forest FILE] [--filter F] [--from N] [--frames N]\n"
        "  [--lead S] [--sheet out.png] [--sheet-every N] [--columns N] [--every N] [--joints "
        "0|1]\n"
        "  [--takes 0|1]\n"
        "people truth: true masks and true parts; mask: true masks, parts of the forest; finder: "
        "the whole tracker.\n");
    return 2;
}

struct Clocks {
    std::vector<double> people, parts, proposals, fit, filter, total;
};

std::string quantiles(const char* name, std::vector<double>& ms) {
    if (ms.empty()) return {};
    std::ranges::sort(ms);
    return fmt::format("{} {:.2f}/{:.2f}  ", name, ms.front(), ms[ms.size() / 2]);
}

Result<void> run(const Arguments& args) {
    Score all;
    Clocks clocks;
    std::shared_ptr<const Forest> forest;
    if (args.people != "truth") {
        if (args.forest.empty()) {
            KINO_ASSIGN(forest, default_forest());
        } else {
            KINO_ASSIGN(Forest read, read_forest(args.forest));
            forest = std::make_shared<const Forest>(std::move(read));
        }
    }
    std::vector<Image<Rgba8>> pictures;
    for (int seed = args.first; seed <= args.last; ++seed) {
        Take take;
        if (args.source == "synthetic") {
            KINO_ASSIGN(take, synthetic_take(args.motion, args.width, args.noise));
        } else {
            ActorTake options;
            options.seed = static_cast<std::uint64_t>(seed);
            options.motion = args.motion;
            options.actors = args.actors;
            options.noise = args.noise;
            options.furniture = args.furniture;
            options.width = args.width;
            options.height = args.width * 3 / 4;
            options.lead_in_s = args.people == "finder" ? args.lead_s : 0;
            if (args.distance > 0) options.distance_m = args.distance;
            KINO_ASSIGN(take, actor_take(options));
        }
        const PinholeFit camera = PinholeFit::of(take.rays);
        TruthTracker truth_tracker(take.rays);
        std::optional<BodyTracker> tracker;
        if (args.people == "mask") truth_tracker.label_by(*forest);
        if (args.people == "finder") {
            BodyTrackerOptions options;
            options.filter = args.filter;
            KINO_ASSIGN(BodyTracker made, BodyTracker::create(take.rays, forest, options));
            tracker.emplace(std::move(made));
        }
        Score score;
        TakeFrame frame;
        const int end = std::min(take.frames, args.from + args.frames * args.every);
        for (int i = args.from; i < end; i += args.every) {
            take.render(i, frame);
            BodyFrame found;
            if (tracker) {
                tracker->track(frame.depth_m, frame.time, std::nullopt, found);
                const TrackingTimes& t = tracker->times();
                const auto ms = [](TimeNs ns) { return static_cast<double>(ns) * 1e-6; };
                if (!found.bodies.empty()) {
                    clocks.people.push_back(ms(t.people));
                    clocks.parts.push_back(ms(t.parts));
                    clocks.proposals.push_back(ms(t.proposals));
                    clocks.fit.push_back(ms(t.fit));
                    clocks.filter.push_back(ms(t.filter));
                    clocks.total.push_back(ms(t.total()));
                }
            } else {
                found = truth_tracker.track(frame);
                clocks.proposals.push_back(truth_tracker.modes_ms);
                clocks.fit.push_back(truth_tracker.fit_ms);
            }
            for (const Body& body : frame.truth.bodies) {
                const Body* nearest = nullptr;
                float least = 1.0f;
                for (const Body& candidate : found.bodies) {
                    const glm::vec3 d = candidate[Joint::hip_center].position_m -
                                        body[Joint::hip_center].position_m;
                    const float distance = std::sqrt(d.x * d.x + d.y * d.y + d.z * d.z);
                    if (distance < least) {
                        least = distance;
                        nearest = &candidate;
                    }
                }
                score.add(body, nearest);
            }
            if (!args.sheet.empty() && (i - args.from) / args.every % args.sheet_every == 0) {
                pictures.push_back(
                    skeleton_picture(frame.depth_m, frame.part, frame.truth, found, camera, 320));
            }
        }
        if (args.takes) {
            const std::string text = score.summary();
            fmt::print("{} {}", take.name, text.substr(0, text.find('\n') + 1));
            if (!tracker) {
                const PersonSkeleton* s = truth_tracker.skeleton(1);
                if (s) {
                    std::string shape;
                    for (const float f : s->model().shape.factor)
                        shape += fmt::format(" {:.2f}", f);
                    fmt::print("   restarts {} shape{} cost {:.2f} on {:.2f} free {:.2f}\n",
                               s->restarts(), shape, s->result().cost, s->result().on_model,
                               s->result().free);
                }
            }
            std::fflush(stdout);
        }
        all.add(score);
    }
    fmt::print("{}", all.summary());
    if (args.joints) fmt::print("{}{}", all.by_joint(), all.by_range());
    fmt::print("ms, fastest/median: {}{}{}{}{}{}\n", quantiles("people", clocks.people),
               quantiles("parts", clocks.parts), quantiles("proposals", clocks.proposals),
               quantiles("fit", clocks.fit), quantiles("filter", clocks.filter),
               quantiles("total", clocks.total));
    if (!args.sheet.empty()) {
        KINO_TRY(write_png_rgba8(args.sheet, skeleton_sheet(pictures, args.columns)));
    }
    return {};
}

int main_of(int argc, char** argv) {
    Arguments args;
    for (int i = 1; i + 1 < argc; i += 2) {
        const std::string_view key = argv[i];
        const std::string value = argv[i + 1];
        if (key == "--source")
            args.source = value;
        else if (key == "--motion")
            args.motion = value;
        else if (key == "--seeds") {
            const auto dash = value.find('-');
            args.first = std::atoi(value.c_str());
            args.last =
                dash == std::string::npos ? args.first : std::atoi(value.c_str() + dash + 1);
        } else if (key == "--width")
            args.width = std::atoi(value.c_str());
        else if (key == "--distance")
            args.distance = std::atof(value.c_str());
        else if (key == "--actors")
            args.actors = std::atoi(value.c_str());
        else if (key == "--noise")
            args.noise = value != "0";
        else if (key == "--furniture")
            args.furniture = value != "0";
        else if (key == "--people")
            args.people = value;
        else if (key == "--forest")
            args.forest = value;
        else if (key == "--filter")
            args.filter = value;
        else if (key == "--every")
            args.every = std::max(1, std::atoi(value.c_str()));
        else if (key == "--from")
            args.from = std::atoi(value.c_str());
        else if (key == "--frames")
            args.frames = std::atoi(value.c_str());
        else if (key == "--lead")
            args.lead_s = std::atof(value.c_str());
        else if (key == "--sheet")
            args.sheet = value;
        else if (key == "--sheet-every")
            args.sheet_every = std::max(1, std::atoi(value.c_str()));
        else if (key == "--columns")
            args.columns = std::max(1, std::atoi(value.c_str()));
        else if (key == "--takes")
            args.takes = value != "0";
        else if (key == "--joints")
            args.joints = value != "0";
        else
            return usage();
    }
    if (argc % 2 == 0) return usage();
    if (const Result<void> done = run(args); !done) {
        fmt::print(stderr, "{}\n", done.error().what);
        return 1;
    }
    return 0;
}

}  // namespace
}  // namespace kino::test

int main(int argc, char** argv) {
    return kino::test::main_of(argc, argv);
}
