#include "apps/demo_show/gesture_places.h"

#include <cmath>

namespace kino {
namespace {

std::optional<glm::dvec3> hand_of(const Body& body, Joint joint) {
    const JointPosition& at = body[joint];
    const glm::dvec3 place(at.position_m);
    const bool usable = at.state != JointState::lost && std::isfinite(place.x + place.y + place.z);
    return usable ? std::optional(place) : std::nullopt;
}

}  // namespace

void GesturePlaces::hear(const GestureEvent& event) {
    last_[static_cast<std::size_t>(event.kind)] = {event.body_id, event.hand};
}

std::optional<glm::dvec3> GesturePlaces::of(GestureKind kind, const BodyFrame* bodies,
                                            const Pose& world_from_depth, bool mirror) const {
    const Made& made = last_[static_cast<std::size_t>(kind)];
    if (bodies == nullptr || made.body_id == 0) return std::nullopt;
    for (const Body& body : bodies->bodies) {
        if (body.id != made.body_id) continue;
        const auto left = hand_of(body, Joint::hand_left), right = hand_of(body, Joint::hand_right);
        std::optional<glm::dvec3> at;
        if (made.hand == Hand::left) at = left;
        if (made.hand == Hand::right) at = right;
        if (made.hand == Hand::both && left && right) at = 0.5 * (*left + *right);
        if (!at) return std::nullopt;
        if (mirror) at->x = -at->x;
        return world_from_depth * *at;
    }
    return std::nullopt;
}

}  // namespace kino
