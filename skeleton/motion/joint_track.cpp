#include "skeleton/motion/joint_track.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <glm/common.hpp>

namespace kino::motion_export {
namespace {

// Times are whole nanoseconds, so a frame of a constant rate is not where the rate says to the last
// digit, and a rate taken from the clip drifts: this near, in steps, it is the same moment.
constexpr double kSameMoment = 1e-6;  ///< for places
constexpr double kNearMoment = 1e-3;  ///< for what was seen

const Body* find_body(const BodyFrame& frame, std::uint32_t person) {
    const auto found = std::find_if(frame.bodies.begin(), frame.bodies.end(),
                                    [&](const Body& body) { return body.id == person; });
    return found == frame.bodies.end() ? nullptr : &*found;
}

Result<void> check_clip(const MotionClip& clip) {
    if (clip.moments.empty()) return fail("there are no moments to write");
    if (!std::isfinite(clip.rate_hz) || clip.rate_hz < 0 || clip.rate_hz > 1000) {
        return fail(fmt::format("a rate of {} frames a second cannot be written", clip.rate_hz), {},
                    "use more than 0 and at most 1000, or 0 for the clip's own rate");
    }
    for (std::size_t i = 0; i < clip.moments.size(); ++i) {
        const std::string where = fmt::format("moment {}", i);
        if (i > 0 && clip.moments[i].bodies.time <= clip.moments[i - 1].bodies.time) {
            return fail("times do not rise", where, "sort the moments and drop repeated ones");
        }
        if (!is_valid(clip.moments[i].world_from_depth)) {
            return fail("the camera's pose is not a rigid transform of finite numbers", where);
        }
    }
    return {};
}

Result<std::uint32_t> choose_person(const MotionClip& clip, std::uint32_t wanted) {
    const std::vector<MotionPerson> people = people_in(clip);
    if (people.empty()) return fail("nobody is in the clip");
    if (wanted == 0) return people.front().id;
    std::string there;
    for (const MotionPerson& p : people) {
        if (p.id == wanted) return wanted;
        there += fmt::format("{}{} ({} moments)", there.empty() ? "" : ", ", p.id, p.moments);
    }
    return fail(fmt::format("person {} is not in the clip", wanted), {}, "there are: " + there);
}

TrackFrame frame_of(const MotionMoment& moment, const Body* body) {
    TrackFrame frame;
    for (std::size_t j = 0; body != nullptr && j < kJointCount; ++j) {
        frame.seen[j] = is_seen(body->joints[j]);
        if (!frame.seen[j]) continue;
        frame.world_m[j] = moment.world_from_depth * glm::dvec3(body->joints[j].position_m);
    }
    return frame;
}

bool any_seen(const TrackFrame& frame) {
    return std::find(frame.seen.begin(), frame.seen.end(), true) != frame.seen.end();
}

double median_step(const std::vector<TrackFrame>& frames) {
    if (frames.size() < 2) return 0;
    std::vector<double> steps;
    for (std::size_t i = 1; i < frames.size(); ++i) {
        steps.push_back(frames[i].time_s - frames[i - 1].time_s);
    }
    const auto middle = steps.begin() + static_cast<std::ptrdiff_t>(steps.size() / 2);
    std::nth_element(steps.begin(), middle, steps.end());
    return *middle;
}

/// Fills value(i) where known(i) is false from the known ones on both sides.
template <class Known, class Value>
void fill_gaps(std::vector<TrackFrame>& frames, const Known& known, const Value& value) {
    const std::size_t none = frames.size();
    std::size_t before = none;
    for (std::size_t i = 0; i <= frames.size(); ++i) {
        if (i < frames.size() && !known(i)) continue;
        for (std::size_t k = before == none ? 0 : before + 1; k < i; ++k) {
            if (before == none || i == frames.size()) {
                value(k) = value(before == none ? i : before);
            } else {
                const double w = (frames[k].time_s - frames[before].time_s) /
                                 (frames[i].time_s - frames[before].time_s);
                value(k) = glm::mix(value(before), value(i), w);
            }
        }
        before = i;
    }
}

}  // namespace

bool is_seen(const JointPosition& joint) {
    const auto near = [](float v) { return std::abs(v) <= kFarthestJointM; };  // false for NaN
    const glm::vec3& p = joint.position_m;
    return joint.state != JointState::lost && near(p.x) && near(p.y) && near(p.z);
}

Result<JointTrack> track_of(const MotionClip& clip, std::uint32_t person) {
    KINO_TRY(check_clip(clip));
    JointTrack track;
    KINO_ASSIGN(track.person, choose_person(clip, person));
    for (std::size_t i = 0; i < clip.moments.size(); ++i) {
        const std::vector<Body>& bodies = clip.moments[i].bodies.bodies;
        const auto same = [&](const Body& body) { return body.id == track.person; };
        if (std::count_if(bodies.begin(), bodies.end(), same) > 1) {
            return fail(fmt::format("person {} is there twice", track.person),
                        fmt::format("moment {}", i));
        }
        TrackFrame frame =
            frame_of(clip.moments[i], find_body(clip.moments[i].bodies, track.person));
        if (track.frames.empty() && !any_seen(frame)) continue;
        // Differences of integers: host times are too large for the fractions of a double.
        const TimeNs first = clip.moments[track.moments.empty() ? i : track.moments[0]].bodies.time;
        frame.time_s = to_seconds(clip.moments[i].bodies.time - first);
        track.frames.push_back(frame);
        track.moments.push_back(i);
    }
    while (!track.frames.empty() && !any_seen(track.frames.back())) {
        track.frames.pop_back();
        track.moments.pop_back();
    }
    if (track.frames.empty()) {
        return fail(fmt::format("no joint of person {} is ever seen", track.person));
    }
    track.median_step_s = median_step(track.frames);
    return track;
}

std::array<bool, kJointCount> ever_seen(const JointTrack& track) {
    std::array<bool, kJointCount> ever{};
    for (const TrackFrame& frame : track.frames) {
        for (std::size_t j = 0; j < kJointCount; ++j) ever[j] = ever[j] || frame.seen[j];
    }
    return ever;
}

double output_rate_hz(const MotionClip& clip, const JointTrack& track) {
    if (clip.rate_hz > 0) return clip.rate_hz;
    if (!(track.median_step_s > 0)) return 30;
    return std::clamp(1 / track.median_step_s, 0.001, 1000.0);
}

Result<void> bridge(JointTrack& track, const std::array<double, kJointCount>& bone_m) {
    const std::array<bool, kJointCount> ever = ever_seen(track);
    std::vector<TrackFrame>& frames = track.frames;
    constexpr auto kRoot = static_cast<std::size_t>(Joint::hip_center);
    const std::size_t trunk[] = {kRoot, static_cast<std::size_t>(Joint::spine),
                                 static_cast<std::size_t>(Joint::shoulder_center)};
    const auto top =
        std::find_if(std::begin(trunk), std::end(trunk), [&](std::size_t j) { return ever[j]; });
    if (top == std::end(trunk)) {
        return fail("hip centre, spine and shoulder centre are never seen", {},
                    "a skeleton hangs on one of them; .csv and .c3d need none");
    }
    const auto position = [&](std::size_t j) {
        return [&frames, j](std::size_t i) -> glm::dvec3& { return frames[i].world_m[j]; };
    };
    const auto seen = [&](std::size_t j) {
        return [&frames, j](std::size_t i) { return frames[i].seen[j]; };
    };
    fill_gaps(frames, seen(*top), position(*top));
    for (auto above = top; above != std::begin(trunk); --above) {
        const glm::dvec3 bone(0, bone_m[*above], 0);
        for (TrackFrame& f : frames) f.world_m[above[-1]] = f.world_m[*above] - bone;
    }
    for (std::size_t j = 1; j < kJointCount; ++j) {
        if (!ever[j] || j == *top) continue;
        const auto parent = static_cast<std::size_t>(kJointParent[j]);
        for (TrackFrame& f : frames) f.world_m[j] -= f.world_m[parent];
        fill_gaps(frames, seen(j), position(j));
        for (TrackFrame& f : frames) f.world_m[j] += f.world_m[parent];
    }
    return {};
}

Result<JointTrack> resample(const JointTrack& track, double rate_hz, Gaps gaps, std::size_t limit) {
    const double last_s = track.frames.back().time_s;
    const double steps = std::floor(last_s * rate_hz + 1e-3);
    if (!(steps < static_cast<double>(limit))) {
        return fail(
            fmt::format("{:.0f} frames are more than the {} this format holds", steps + 1, limit),
            {}, "cut the clip or lower the rate");
    }
    JointTrack out{track.person, {}, {}, 1 / rate_hz};
    out.frames.resize(static_cast<std::size_t>(steps) + 1);
    const double widest_s = std::max(0.25, 2 * track.median_step_s);
    std::size_t i = 0;
    for (std::size_t k = 0; k < out.frames.size(); ++k) {
        TrackFrame& to = out.frames[k];
        to.time_s = static_cast<double>(k) / rate_hz;
        while (i + 1 < track.frames.size() && track.frames[i + 1].time_s <= to.time_s) ++i;
        const TrackFrame& a = track.frames[i];
        const TrackFrame& b = track.frames[std::min(i + 1, track.frames.size() - 1)];
        const double span_s = b.time_s - a.time_s;
        double w = span_s > 0 ? std::clamp((to.time_s - a.time_s) / span_s, 0.0, 1.0) : 0;
        if (w < kSameMoment) w = 0;
        if (w > 1 - kSameMoment) w = 1;
        const TrackFrame& nearest = w < 0.5 ? a : b;
        const bool near = std::abs(to.time_s - nearest.time_s) * rate_hz < kNearMoment;
        const bool wide = gaps == Gaps::mark && span_s > widest_s;
        for (std::size_t j = 0; j < kJointCount; ++j) {
            const bool both = a.seen[j] && b.seen[j];
            to.world_m[j] = gaps == Gaps::carry || both ? glm::mix(a.world_m[j], b.world_m[j], w)
                                                        : nearest.world_m[j];
            to.seen[j] = near ? nearest.seen[j] : both && !wide;
        }
    }
    return out;
}

}  // namespace kino::motion_export
