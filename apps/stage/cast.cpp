#include "apps/stage/cast.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>

namespace kino {
namespace {

/// No sensor of ours sees farther; beyond this a joint is a mistake.
constexpr float kFarthestJointM = 50;

bool is_located(const JointPosition& joint) {
    // A NaN fails the comparison.
    return joint.state != JointState::lost && glm::length(joint.position_m) < kFarthestJointM;
}

}  // namespace

CastMember* Cast::place_for(std::uint32_t id) {
    CastMember* best = nullptr;
    for (CastMember& member : members_) {
        if (member.id == id) return &member;
        if (member.present) continue;
        // A free place before one that is kept, the longest kept before others.
        if (best == nullptr ||
            (best->id != 0 && (member.id == 0 || member.away_s > best->away_s))) {
            best = &member;
        }
    }
    if (best != nullptr) *best = CastMember{.id = id};
    return best;
}

void Cast::step(double dt_s, const BodyFrame* bodies, const Pose& world_from_depth) {
    for (CastMember& member : members_) {
        member.present = false;
        member.away_s += dt_s;
        for (CastJoint& joint : member.joints) joint.seen = false;
    }
    // Those who have a place come first, so that nobody new is put on it.
    for (const bool known : {true, false}) {
        if (bodies == nullptr) break;
        for (const Body& body : bodies->bodies) {
            const bool has_place = std::any_of(members_.begin(), members_.end(),
                                               [&](const auto& m) { return m.id == body.id; });
            if (body.id == 0 || has_place != known) continue;
            if (std::none_of(body.joints.begin(), body.joints.end(), is_located)) continue;
            CastMember* member = place_for(body.id);
            if (member == nullptr || member->present) continue;
            member->present = true;
            member->away_s = 0;
            for (std::size_t i = 0; i < kJointCount; ++i) {
                if (!is_located(body.joints[i])) continue;
                member->joints[i] = {
                    .world_m = world_from_depth * glm::dvec3(body.joints[i].position_m),
                    .known = true,
                    .seen = true};
            }
        }
    }
    for (CastMember& member : members_) {
        if (member.id != 0 && member.away_s > kKeptS) member = {};
    }
}

bool Cast::anybody() const {
    return std::any_of(members_.begin(), members_.end(), [](const auto& m) { return m.present; });
}

}  // namespace kino
