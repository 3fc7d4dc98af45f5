#include "skeleton/filters/filter_bank.h"

#include <cmath>
#include <utility>

namespace kino {
namespace {

constexpr TimeNs kForget = kNsPerSecond;

Body sound(Body body) {
    for (JointPosition& joint : body.joints) {
        const glm::vec3& p = joint.position_m;
        if (std::isfinite(p.x) && std::isfinite(p.y) && std::isfinite(p.z) &&
            std::isfinite(joint.confidence))
            continue;
        joint = {};
    }
    return body;
}

}  // namespace

Result<FilterBank> FilterBank::create(std::string name) {
    KINO_TRY(make_body_filter(name));
    FilterBank bank;
    bank.name_ = std::move(name);
    return bank;
}

BodyFrame FilterBank::update(const BodyFrame& frame) {
    if (frame.time < last_.time) entries_.clear();
    last_.time = frame.time;
    last_.bodies.clear();
    for (const Body& body : frame.bodies) {
        if (body.id == 0 || name_ == "none") {
            last_.bodies.push_back(sound(body));
            continue;
        }
        Entry& entry = entries_[body.id];
        if (!entry.filter) entry.filter = std::move(*make_body_filter(name_));
        entry.seen = frame.time;
        last_.bodies.push_back(entry.filter->update(body, frame.time));
    }
    std::erase_if(entries_, [&](const auto& e) { return frame.time - e.second.seen > kForget; });
    return last_;
}

BodyFrame FilterBank::predict(TimeNs time) const {
    BodyFrame out = last_;
    out.time = time;
    for (Body& body : out.bodies) {
        const auto found = entries_.find(body.id);
        if (found != entries_.end()) body = found->second.filter->predict(time);
    }
    return out;
}

}  // namespace kino
