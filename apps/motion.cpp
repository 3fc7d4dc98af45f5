#include "apps/motion.h"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "apps/pipeline/opened_source.h"

namespace kino {
namespace {

constexpr const char* kInterrupted = "interrupted: nothing was written";

struct Bounds {
    std::int64_t first = 0, end = 0;
};

Result<Bounds> bounds_of(Source& source, const MotionRequest& request) {
    const Timeline* timeline = source.timeline();
    const std::string& uri = source.info().uri;
    if (timeline == nullptr) {
        return fail("motion is taken from recordings", uri, "record it first: kinoscope record");
    }
    const std::int64_t frames = timeline->frame_count();
    if (request.from >= frames) {
        return fail(fmt::format("frame {} is beyond the last, {}", request.from, frames - 1), uri);
    }
    const std::int64_t left = frames - request.from;
    return Bounds{request.from, request.from + std::min(left, request.count.value_or(left))};
}

void add(MotionClip& clip, const BodyFrame& bodies, const Pose& world_from_depth) {
    // A frame of bodies may stand beside two depth frames.
    if (!clip.moments.empty() && bodies.time <= clip.moments.back().bodies.time) return;
    clip.moments.push_back({bodies, world_from_depth});
}

/// Empty where the recording has no bodies.
Result<MotionClip> recorded_bodies(const std::string& uri, const MotionRequest& request,
                                   const MotionWatch& watch) {
    MotionClip clip;
    KINO_ASSIGN(const auto source, open_source(uri));
    KINO_ASSIGN(const Bounds bounds, bounds_of(*source, request));
    bool any = false;
    for (const StreamInfo& stream : source->info().streams) {
        if (stream.id.kind != StreamKind::bodies) continue;
        KINO_TRY(source->subscribe(stream.id));
        any = true;
    }
    if (!any) return clip;
    const std::string& name = request.bodies.joint_filter;
    KINO_ASSIGN(FilterBank filter, FilterBank::create(name.empty() ? std::string("none") : name));
    KINO_TRY(source->timeline()->seek(bounds.first));
    for (std::int64_t i = bounds.first; i < bounds.end; ++i) {
        const auto set = source->next(0);
        // One text that cannot be read is a hole like a frame without bodies.
        if (set && *set && (*set)->bodies) {
            add(clip, filter.update(*(*set)->bodies), (*set)->world_from_depth);
        }
        if (!watch(i - bounds.first + 1, bounds.end - bounds.first)) return fail(kInterrupted);
    }
    return clip;
}

Result<MotionClip> tracked_bodies(const std::string& uri, const MotionRequest& request,
                                  const MotionWatch& watch) {
    MotionClip clip;
    BodyOptions bodies = request.bodies;
    bodies.mode = BodyMode::on;
    KINO_ASSIGN(OpenedSource opened, open_for_playing(uri, {.bodies = bodies}));
    KINO_ASSIGN(const Bounds bounds, bounds_of(*opened.source, request));
    std::optional<Error> unreadable;
    for (std::int64_t i = bounds.first; i < bounds.end; ++i) {
        const auto frame = read_frame(opened, i, kNsPerSecond);
        if (!frame) {
            unreadable = frame.error();
        } else if (*frame && (*frame)->set.bodies) {
            add(clip, *(*frame)->set.bodies, (*frame)->set.world_from_depth);
        }
        if (!watch(i - bounds.first + 1, bounds.end - bounds.first)) return fail(kInterrupted);
    }
    if (clip.moments.empty() && unreadable) return fail(*unreadable);
    return clip;
}

}  // namespace

Result<MotionOutcome> export_motion(const std::string& uri, const MotionRequest& request,
                                    const MotionWatch& watch) {
    KINO_TRY(motion_format(request.file));
    std::error_code ignored;
    if (!request.replace && std::filesystem::exists(request.file, ignored)) {
        return fail("is there already", request.file.string(), "--force replaces it");
    }
    MotionOutcome outcome;
    MotionClip clip;
    if (request.bodies.mode != BodyMode::on) {
        KINO_ASSIGN(clip, recorded_bodies(uri, request, watch));
    }
    if (people_in(clip).empty() && request.bodies.mode != BodyMode::recorded) {
        KINO_ASSIGN(clip, tracked_bodies(uri, request, watch));
        outcome.tracked = true;
    }
    outcome.people = people_in(clip).size();
    if (outcome.people == 0) {
        return outcome.tracked
                   ? fail(fmt::format("there is no motion to write: nobody was found in {} frames",
                                      clip.moments.size()),
                          uri)
                   : fail("there is no motion to write: no bodies were recorded", uri,
                          "--bodies on finds them in the depth");
    }
    clip.rate_hz = request.rate_hz;
    KINO_ASSIGN(outcome.summary, write_motion(request.file, clip, request.person));
    return outcome;
}

}  // namespace kino
