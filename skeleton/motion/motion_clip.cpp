#include "skeleton/motion/motion_clip.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <glm/geometric.hpp>
#include <map>
#include <string>

#include "sensor/file_bytes.h"
#include "skeleton/motion/bvh_file.h"
#include "skeleton/motion/c3d_file.h"
#include "skeleton/motion/csv_file.h"
#include "skeleton/motion/glb_file.h"
#include "skeleton/motion/joint_track.h"
#include "skeleton/motion/skeletal_motion.h"

namespace kino {
namespace {

using namespace motion_export;

/// 2.3 hours at 30 Hz: what keeps the work within half a gigabyte.
constexpr std::size_t kMostFrames = 250'000;

void measure(const SkeletalMotion& motion, const JointTrack& given, MotionSummary& summary) {
    double sum_m = 0, max_m = 0;
    std::size_t count = 0;
    for (std::size_t i = 0; i < motion.poses.size(); ++i) {
        const auto places = node_positions(motion, motion.poses[i]);
        for (std::size_t j = 0; j < kJointCount; ++j) {
            if (!given.frames[i].seen[j]) continue;
            const double off_m = glm::length(places[j] - given.frames[i].world_m[j]);
            sum_m += off_m;
            max_m = std::max(max_m, off_m);
            ++count;
        }
    }
    summary.mean_error_mm = count == 0 ? 0 : 1000 * sum_m / static_cast<double>(count);
    summary.max_error_mm = 1000 * max_m;
}

Result<std::string> skeleton_file(JointTrack& track, MotionSummary& summary) {
    summary.bone_m = bone_lengths(track);
    const auto ever = ever_seen(track);
    KINO_TRY(bridge(track, summary.bone_m));
    KINO_ASSIGN(const JointTrack even, resample(track, summary.rate_hz, Gaps::carry, kMostFrames));
    const SkeletalMotion motion = rotations_of(even, summary.bone_m, ever, summary.rate_hz);
    measure(motion, even, summary);
    summary.frames = motion.poses.size();
    return summary.format == MotionFormat::bvh ? bvh_text(motion) : glb_bytes(motion);
}

Result<std::string> content(const MotionClip& clip, JointTrack& track, MotionSummary& summary) {
    switch (summary.format) {
        case MotionFormat::bvh:
        case MotionFormat::glb:
            return skeleton_file(track, summary);
        case MotionFormat::c3d: {
            KINO_ASSIGN(const JointTrack even,
                        resample(track, summary.rate_hz, Gaps::mark, kC3dMostFrames));
            summary.frames = even.frames.size();
            return c3d_bytes(even, summary.rate_hz);
        }
        case MotionFormat::csv:
            break;
    }
    summary.rate_hz = track.median_step_s > 0 ? 1 / track.median_step_s : 0;
    CsvText csv = csv_text(clip, track);
    summary.frames = csv.frames;
    return std::move(csv.text);
}

Result<MotionSummary> write_known(const std::filesystem::path& path, MotionFormat format,
                                  const MotionClip& clip, std::uint32_t person) {
    KINO_ASSIGN(JointTrack track, track_of(clip, person));
    MotionSummary summary;
    summary.format = format;
    summary.person = track.person;
    summary.moments = track.frames.size();
    summary.duration_s = track.frames.back().time_s;
    summary.rate_hz = output_rate_hz(clip, track);
    for (const TrackFrame& f : track.frames) {
        summary.joints_lost +=
            static_cast<std::size_t>(std::count(f.seen.begin(), f.seen.end(), false));
    }
    const auto ever = ever_seen(track);
    for (std::size_t j = 0; j < kJointCount; ++j) {
        if (!ever[j]) summary.never_seen.push_back(static_cast<Joint>(j));
    }
    KINO_ASSIGN(const std::string bytes, content(clip, track, summary));
    KINO_TRY(write_file_bytes(path, bytes.data(), bytes.size()));
    summary.bytes = bytes.size();
    return summary;
}

}  // namespace

std::vector<MotionPerson> people_in(const MotionClip& clip) {
    std::map<std::uint32_t, std::size_t> count;
    for (const MotionMoment& moment : clip.moments) {
        for (const Body& body : moment.bodies.bodies) {
            if (body.id != 0) ++count[body.id];
        }
    }
    std::vector<MotionPerson> people;
    for (const auto& [id, moments] : count) people.push_back({id, moments});
    std::stable_sort(
        people.begin(), people.end(),
        [](const MotionPerson& a, const MotionPerson& b) { return a.moments > b.moments; });
    return people;
}

Result<MotionFormat> motion_format(const std::filesystem::path& path) {
    std::string extension = path.extension().string();
    std::transform(extension.begin(), extension.end(), extension.begin(),
                   [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
    if (extension == ".bvh") return MotionFormat::bvh;
    if (extension == ".glb") return MotionFormat::glb;
    if (extension == ".csv") return MotionFormat::csv;
    if (extension == ".c3d") return MotionFormat::c3d;
    return fail("motion is not written to files of this kind", path.string(),
                "name it .bvh, .glb, .csv or .c3d");
}

Result<MotionSummary> write_motion(const std::filesystem::path& path, const MotionClip& clip,
                                   std::uint32_t person) {
    KINO_ASSIGN(const MotionFormat format, motion_format(path));
    auto written = write_known(path, format, clip, person);
    if (!written) return fail(std::move(written).error(), path.string());
    return written;
}

}  // namespace kino
