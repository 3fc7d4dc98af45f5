#include "skeleton/motion/csv_file.h"

#include <fmt/format.h>

#include <cmath>
#include <iterator>

namespace kino::motion_export {
namespace {

const char* state_name(JointState state) {
    switch (state) {
        case JointState::lost:
            return "lost";
        case JointState::inferred:
            return "inferred";
        case JointState::tracked:
            return "tracked";
    }
    return "lost";
}

void append_row(std::string& out, std::size_t moment, const MotionMoment& from, const Body& body,
                Joint joint, const glm::dvec3& world_m) {
    const JointPosition& p = body[joint];
    const bool seen = is_seen(p);
    auto to = std::back_inserter(out);
    fmt::format_to(to, "{},{},{},{},{},{}", moment, from.bodies.time, body.id, joint_name(joint),
                   state_name(seen ? p.state : JointState::lost),
                   std::isfinite(p.confidence) ? p.confidence : 0.0F);
    if (seen) {
        fmt::format_to(to, ",{},{},{},{},{},{}\n", p.position_m.x, p.position_m.y, p.position_m.z,
                       world_m.x, world_m.y, world_m.z);
    } else {
        out += ",,,,,,\n";
    }
}

}  // namespace

CsvText csv_text(const MotionClip& clip, const JointTrack& track) {
    CsvText csv;
    csv.text =
        "moment,time_ns,person,joint,state,confidence,x_m,y_m,z_m,world_x_m,world_y_m,world_z_m\n";
    for (std::size_t i = 0; i < track.frames.size(); ++i) {
        const MotionMoment& moment = clip.moments[track.moments[i]];
        for (const Body& body : moment.bodies.bodies) {
            if (body.id != track.person) continue;
            ++csv.frames;
            for (std::size_t j = 0; j < kJointCount; ++j) {
                append_row(csv.text, track.moments[i], moment, body, static_cast<Joint>(j),
                           track.frames[i].world_m[j]);
            }
        }
    }
    return csv;
}

}  // namespace kino::motion_export
