#include <fmt/format.h>
#include <time.h>

#include <algorithm>
#include <array>
#include <cstdio>
#include <cstdlib>
#include <map>
#include <set>
#include <string>
#include <vector>

#include "base/time.h"
#include "calibration/rig.h"
#include "sensor/openers.h"
#include "sensor/png_io.h"
#include "sensor/source.h"
#include "skeleton/actors/actor_sequence.h"
#include "skeleton/people/head_finder.h"
#include "skeleton/people/people_finder.h"
#include "tests/skeleton/people/eval/label_picture.h"
#include "tests/skeleton/people/people_scene.h"

namespace kino {
namespace {

struct Arguments {
    std::string what, uri, sheet, motion;
    int takes = 8, actors = 1, seed = 1, most = 90;
    double lead_in_s = 0;
    int every = 12, columns = 6, width = 200, from = 0;
    bool moving = false, heads = false, verbose = false;
};

void mark_heads(const PeopleFinder& finder, const PeopleFrame& people, Image<Rgba8>& picture) {
    HeadFinder heads;
    const DepthGrid& grid = finder.grid();
    Image<std::uint8_t> mask(grid.width(), grid.height());
    for (std::size_t i = 0; i < mask.size(); ++i) mask.data()[i] = grid.z_m().data()[i] > 0;
    heads.find(grid, mask, people.floor.up);
    for (const Head& h : heads.heads()) {
        const int x = (h.cell % grid.width()) * picture.width() / grid.width();
        const int y = (h.cell / grid.width()) * picture.height() / grid.height();
        fmt::print("  {:.2f} ({:.1f} {:.1f} {:.1f})", h.score, h.place_m.x, h.place_m.y,
                   h.place_m.z);
        const Rgba8 color = h.score >= kSureHead ? Rgba8{255, 0, 0, 255} : Rgba8{255, 255, 0, 255};
        for (int d = -4; d <= 4; ++d) {
            if (picture.contains(x + d, y)) picture.at(x + d, y) = color;
            if (picture.contains(x, y + d)) picture.at(x, y + d) = color;
        }
    }
    fmt::print("\n");
}

/// Takes of varied people in varied rooms: who is found, with what mask, and who is not there.
int actors(const Arguments& a) {
    std::vector<Image<Rgba8>> pictures;
    double frames = 0, right = 0, missed = 0, more = 0, mask = 0, masks = 0, changes = 0;
    for (int i = 0; i < a.takes; ++i) {
        ActorTake take;
        take.seed = static_cast<std::uint64_t>(a.seed + i);
        take.motion = a.motion;
        take.actors = a.actors;
        take.lead_in_s = a.lead_in_s;
        auto sequence = ActorSequence::create(take);
        if (!sequence) {
            std::fprintf(stderr, "%s\n", sequence.error().to_string().c_str());
            return 1;
        }
        auto rig = Rig::create((*sequence)->rig());
        PeopleOptions options;
        options.moving_sensor = a.moving;
        auto finder = PeopleFinder::create(rig->depth_rays(), options);
        ActorFrame frame;
        PeopleFrame people;
        std::set<std::uint32_t> ids;
        double take_frames = 0, take_right = 0, take_missed = 0, take_more = 0, take_mask = 0,
               take_masks = 0;
        const int count = std::min((*sequence)->frames(), a.most);
        const int start = static_cast<int>((a.lead_in_s + 0.7) * (*sequence)->rate_hz());
        for (int k = 0; k < count; ++k) {
            (*sequence)->render(k, frame);
            finder->find(frame.depth_m, frame.time, std::nullopt, people);
            std::array<int, 16> seen{};
            std::array<std::array<int, 16>, kPersonSlots + 1> both{};
            std::array<int, kPersonSlots + 1> labelled{};
            for (std::size_t p = 0; p < frame.actor.size(); ++p) {
                const int who = frame.depth_m.data()[p] > 0 ? frame.actor.data()[p] : 0;
                ++seen[static_cast<std::size_t>(who)];
                const std::uint8_t slot = people.labels.data()[p];
                ++labelled[slot];
                ++both[slot][static_cast<std::size_t>(who)];
            }
            if (k % a.every == a.from) {
                pictures.push_back(test::label_picture(frame.depth_m, people.labels, a.width));
                if (a.heads) mark_heads(*finder, people, pictures.back());
            }
            if (k < start) continue;
            int there = 0, found = 0;
            std::array<bool, kPersonSlots + 1> used{};
            for (int who = 1; who <= a.actors; ++who) {
                const auto w = static_cast<std::size_t>(who);
                if (seen[w] < 600) continue;
                ++there;
                for (const Person& p : people.people) {
                    const double overlap = static_cast<double>(both[p.slot][w]) /
                                           (seen[w] + labelled[p.slot] - both[p.slot][w]);
                    if (both[p.slot][w] < seen[w] / 2 || used[p.slot]) continue;
                    used[p.slot] = true;
                    ++found;
                    ids.insert(p.id);
                    take_mask += overlap;
                    ++take_masks;
                }
            }
            take_frames += 1;
            take_missed += found < there;
            take_more += static_cast<int>(people.people.size()) > found;
            take_right += found == there && static_cast<int>(people.people.size()) == found;
        }
        fmt::print(
            "seed {:3}: right {:5.1f} %, missed {:5.1f} %, more {:5.1f} %, overlap {:.3f}, ids "
            "{}\n",
            take.seed, 100 * take_right / take_frames, 100 * take_missed / take_frames,
            100 * take_more / take_frames, take_mask / std::max(take_masks, 1.0), ids.size());
        frames += take_frames;
        right += take_right;
        missed += take_missed;
        more += take_more;
        mask += take_mask;
        masks += take_masks;
        changes += static_cast<double>(ids.size()) - a.actors;
    }
    fmt::print(
        "{} takes, {:.0f} frames: right {:.1f} %, missed {:.1f} %, more {:.1f} %, overlap "
        "{:.3f}, ids too many {:.0f}\n",
        a.takes, frames, 100 * right / frames, 100 * missed / frames, 100 * more / frames,
        mask / std::max(masks, 1.0), changes);
    if (a.sheet.empty()) return 0;
    return write_png_rgba8(a.sheet, test::contact_sheet(pictures, a.columns)) ? 0 : 1;
}

/// Time of find(), 640x480: the room still unknown, then with so many people in it.
int times(const Arguments&) {
    test::RoomOptions room;
    room.width = 640;
    room.height = 480;
    test::PeopleScene scene(room);
    PeopleFrame people;
    for (const int count : {0, 1, 3}) {
        auto finder = PeopleFinder::create(scene.rays());
        std::vector<double> first, later;
        for (int i = 0; i < 90; ++i) {
            std::vector<test::Actor> cast;
            const double t = i / 30.0;
            for (int k = 0; k < count && i >= 30; ++k)
                cast.push_back(
                    test::actor_at(-0.8 * k + 0.4 * (count > 1), -2.2 - 0.3 * k, Motion::wave, t));
            scene.draw(cast, static_cast<std::uint64_t>(i));
            timespec a{}, b{};
            clock_gettime(CLOCK_THREAD_CPUTIME_ID, &a);
            finder->find(scene.depth_m(), (i + 1) * kNsPerSecond / 30, std::nullopt, people);
            clock_gettime(CLOCK_THREAD_CPUTIME_ID, &b);
            const double ms = 1e3 * static_cast<double>(b.tv_sec - a.tv_sec) +
                              1e-6 * static_cast<double>(b.tv_nsec - a.tv_nsec);
            if (i < 12) first.push_back(ms);
            if (i >= 40) later.push_back(ms);
        }
        std::sort(first.begin(), first.end());
        std::sort(later.begin(), later.end());
        fmt::print(
            "{} people (found {}): {:.2f} ms least, {:.2f} ms median; room unknown: {:.2f} "
            "ms least, {:.2f} ms median\n",
            count, people.people.size(), later.front(), later[later.size() / 2], first.front(),
            first[first.size() / 2]);
    }
    return 0;
}

int rooms(const Arguments& a) {
    std::vector<Image<Rgba8>> pictures;
    for (int i = 0; i < 12; ++i) {
        test::RoomOptions room;
        room.camera_x_m = -0.6 + 0.1 * i;
        room.tilt_deg = -10 + i;
        room.width = 640;
        room.height = 480;
        test::PeopleScene scene(room);
        PeopleOptions options;
        options.moving_sensor = true;
        auto finder = PeopleFinder::create(scene.rays(), options);
        PeopleFrame people;
        for (int k = 0; k < 6; ++k) {
            scene.draw({}, static_cast<std::uint64_t>(10 * i + k));
            finder->find(scene.depth_m(), (k + 1) * kNsPerSecond / 30, std::nullopt, people);
        }
        fmt::print("room {}: {} people", i, people.people.size());
        pictures.push_back(test::label_picture(scene.depth_m(), people.labels, a.width));
        mark_heads(*finder, people, pictures.back());
    }
    return write_png_rgba8(a.sheet, test::contact_sheet(pictures, a.columns)) ? 0 : 1;
}

/// The pictures of docs/people.md: three rows of the clip, one of single pictures, one of takes.
int sheet(const Arguments& a) {
    std::vector<Image<Rgba8>> pictures;
    const auto add = [&](const std::string& uri, bool still, int from, int every, int most) {
        auto source = open_source(uri);
        if (!source || !subscribe_all(**source)) return;
        auto rig = Rig::create(*(*source)->calibration());
        PeopleOptions options;
        options.moving_sensor = still;
        auto finder = PeopleFinder::create(rig->depth_rays(), options);
        RegisteredDepth depth;
        PeopleFrame people;
        int taken = 0;
        for (int i = 0; taken < most; ++i) {
            auto set = (*source)->next(0);
            if (!set || !*set) break;
            if (!(*set)->depth || !rig->register_depth(*(*set)->depth, depth)) continue;
            if (still) finder->reset();
            finder->find(depth.depth_m, (*set)->time, std::nullopt, people);
            if (still)
                finder->find(depth.depth_m, (*set)->time + kNsPerSecond / 5, std::nullopt, people);
            if (i < from || (i - from) % every != 0) continue;
            pictures.push_back(test::label_picture(depth.depth_m, people.labels, a.width));
            ++taken;
        }
    };
    add("recordings/person", false, 4, 16, 18);
    add("recordings/gestures", true, 2, 1, 5);
    add("recordings/bust", true, 0, 1, 1);
    struct Scene {
        const char* motion;
        int actors, seed, frame;
    };
    for (const Scene& scene :
         {Scene{"sideways", 1, 4, 70}, Scene{"lie", 1, 4, 70}, Scene{"hold", 1, 4, 70},
          Scene{"hug", 2, 5, 104}, Scene{"cross", 2, 5, 100}, Scene{"sit", 1, 5, 100}}) {
        ActorTake take;
        take.motion = scene.motion;
        take.actors = scene.actors;
        take.seed = static_cast<std::uint64_t>(scene.seed);
        take.lead_in_s = 1;
        auto sequence = ActorSequence::create(take);
        if (!sequence) return 1;
        auto rig = Rig::create((*sequence)->rig());
        auto finder = PeopleFinder::create(rig->depth_rays());
        ActorFrame frame;
        PeopleFrame people;
        for (int i = 0; i <= std::min(scene.frame, (*sequence)->frames() - 1); ++i) {
            (*sequence)->render(i, frame);
            finder->find(frame.depth_m, frame.time, std::nullopt, people);
        }
        pictures.push_back(test::label_picture(frame.depth_m, people.labels, a.width));
    }
    return write_png_rgba8(a.uri, test::contact_sheet(pictures, 6), {.compression = 9}) ? 0 : 1;
}

int run(const Arguments& a) {
    auto source = open_source(a.uri);
    if (!source) return std::fprintf(stderr, "%s\n", source.error().to_string().c_str()), 1;
    if (!subscribe_all(**source)) return 1;
    auto rig = Rig::create(*(*source)->calibration());
    if (!rig) return 1;
    PeopleOptions options;
    options.moving_sensor = a.moving;
    auto finder = PeopleFinder::create(rig->depth_rays(), options);
    RegisteredDepth depth;
    PeopleFrame people;
    std::array<int, 8> histogram{};
    std::map<std::uint32_t, int> ids;
    std::vector<Image<Rgba8>> pictures;
    int frames = 0;
    while (true) {
        auto set = (*source)->next(0);
        if (!set || !*set) break;
        if (!(*set)->depth) continue;
        if (!rig->register_depth(*(*set)->depth, depth)) return 1;
        if (a.what == "stills") finder->reset();
        finder->find(depth.depth_m, (*set)->time, std::nullopt, people);
        if (a.what == "stills")
            finder->find(depth.depth_m, (*set)->time + 2 * kNsPerSecond / 5, std::nullopt, people);
        ++histogram[people.people.size()];
        for (const Person& p : people.people) ++ids[p.id];
        if (a.verbose) {
            fmt::print("frame {} t {:.2f} floor {:.2f} known {:.2f}:", frames,
                       to_seconds((*set)->time), people.floor.confidence, people.background_known);
            for (const Person& p : people.people)
                fmt::print("  #{} at ({:.2f} {:.2f} {:.2f}) area {:.2f} conf {:.2f}", p.id,
                           p.centroid_m.x, p.centroid_m.y, p.centroid_m.z, p.area_m2, p.confidence);
            fmt::print("\n");
        }
        if (frames >= a.from && (frames - a.from) % a.every == 0) {
            pictures.push_back(test::label_picture(depth.depth_m, people.labels, a.width));
            if (a.heads) mark_heads(*finder, people, pictures.back());
        }
        ++frames;
    }
    fmt::print("{} frames; people in a frame:", frames);
    for (std::size_t n = 0; n < histogram.size(); ++n)
        fmt::print(" {}: {:.1f} %", n, 100.0 * histogram[n] / std::max(frames, 1));
    fmt::print("\nframes of each id:");
    for (const auto& [id, n] : ids) fmt::print(" #{}: {}", id, n);
    fmt::print("\n");
    if (!a.sheet.empty()) {
        const auto written =
            write_png_rgba8(a.sheet, test::contact_sheet(pictures, a.columns), {.compression = 9});
        if (!written) return std::fprintf(stderr, "%s\n", written.error().to_string().c_str()), 1;
    }
    return 0;
}

}  // namespace
}  // namespace kino

int main(int argc, char** argv) {
    kino::Arguments a;
    if (argc < 3)
        return std::fprintf(stderr,
                            "people_eval clip|stills|actors|rooms|times|sheet SOURCE|OUT|- [...]: "
                            "docs/people.md\n"),
               2;
    a.what = argv[1];
    a.uri = argv[2];
    for (int i = 3; i < argc; ++i) {
        const std::string word = argv[i];
        const auto next = [&] { return i + 1 < argc ? std::string(argv[++i]) : std::string(); };
        if (word == "--sheet") a.sheet = next();
        if (word == "--every") a.every = std::max(1, std::atoi(next().c_str()));
        if (word == "--from") a.from = std::atoi(next().c_str());
        if (word == "--columns") a.columns = std::max(1, std::atoi(next().c_str()));
        if (word == "--width") a.width = std::max(16, std::atoi(next().c_str()));
        if (word == "--takes") a.takes = std::atoi(next().c_str());
        if (word == "--actors") a.actors = std::atoi(next().c_str());
        if (word == "--seed") a.seed = std::atoi(next().c_str());
        if (word == "--frames") a.most = std::atoi(next().c_str());
        if (word == "--motion") a.motion = next();
        if (word == "--lead-in") a.lead_in_s = std::atof(next().c_str());
        if (word == "--heads") a.heads = true;
        if (word == "--moving") a.moving = true;
        if (word == "--verbose") a.verbose = true;
    }
    if (a.what == "actors") return kino::actors(a);
    if (a.what == "times") return kino::times(a);
    if (a.what == "sheet") return kino::sheet(a);
    return a.what == "rooms" ? kino::rooms(a) : kino::run(a);
}
