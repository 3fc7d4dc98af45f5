#include "sensor/trajectory.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "sensor/decimal.h"

namespace kino {
namespace {

const Pose& y_up_from_z_up() {
    static const Pose pose{glm::dquat(std::sqrt(0.5), -std::sqrt(0.5), 0, 0), glm::dvec3(0)};
    return pose;
}

std::optional<Pose> parse_pose(std::string_view line) {
    std::array<double, 7> v{};
    for (double& value : v) {
        const std::optional<double> number = parse_number(next_word(line));
        // Beyond this, squares in later arithmetic could overflow; no room is that large.
        if (!number || std::abs(*number) > 1e9) return std::nullopt;
        value = *number;
    }
    const glm::dquat q(v[6], v[3], v[4], v[5]);
    const double length = glm::length(q);
    // Files carry four digits, so the length is unity only roughly.
    if (!(std::abs(length - 1.0) <= 0.01)) return std::nullopt;
    return y_up_from_z_up() * Pose{glm::normalize(q), glm::dvec3(v[0], v[1], v[2])};
}

}  // namespace

std::optional<Pose> Trajectory::at(TimeNs time, TimeNs max_gap) const {
    const auto after = std::lower_bound(times.begin(), times.end(), time);
    if (after == times.end()) return std::nullopt;
    const auto i = static_cast<std::size_t>(after - times.begin());
    if (*after == time) return poses[i];
    if (i == 0 || times[i] - times[i - 1] > max_gap) return std::nullopt;
    const double t =
        static_cast<double>(time - times[i - 1]) / static_cast<double>(times[i] - times[i - 1]);
    return interpolate(poses[i - 1], poses[i], t);
}

ParsedTrajectory parse_tum_trajectory(std::string_view text) {
    ParsedTrajectory out;
    while (!text.empty()) {
        const std::size_t end = std::min(text.find('\n'), text.size());
        std::string_view line = text.substr(0, end);
        text.remove_prefix(std::min(end + 1, text.size()));
        const std::string_view first = next_word(line);
        if (first.empty() || first.front() == '#') continue;
        const std::optional<TimeNs> time = parse_time(first);
        const std::optional<Pose> pose = time ? parse_pose(line) : std::nullopt;
        Trajectory& track = out.trajectory;
        if (!pose || (!track.times.empty() && *time <= track.times.back())) {
            ++out.skipped;
            continue;
        }
        track.times.push_back(*time);
        track.poses.push_back(*pose);
    }
    return out;
}

}  // namespace kino
