#include "skeleton/actors/recorded_motion.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <map>

#include "base/check.h"
#include "skeleton/actors/embedded_data.h"

namespace kino {
namespace {

using glm::dvec3;
using Joints = std::array<dvec3, kJointCount>;

Joints mix(const Joints& a, const Joints& b, double w) {
    Joints out;
    for (std::size_t j = 0; j < kJointCount; ++j) out[j] = glm::mix(a[j], b[j], w);
    return out;
}

std::vector<Joints> resampled(const JointRecording& recording) {
    const auto last = static_cast<double>(recording.frames.size() - 1);
    const int count = 1 + static_cast<int>(last / recording.rate_hz * kActorRateHz + 1e-6);
    std::vector<Joints> out;
    for (int k = 0; k < count; ++k) {
        const double at = std::min(k / kActorRateHz * recording.rate_hz, last);
        const auto i = static_cast<std::size_t>(at);
        const std::size_t next = std::min(i + 1, recording.frames.size() - 1);
        out.push_back(mix(recording.frames[i], recording.frames[next], at - std::floor(at)));
    }
    return out;
}

std::vector<Joints> eased(const std::vector<Joints>& in) {
    constexpr double kWeights[5] = {1.0 / 9, 2.0 / 9, 3.0 / 9, 2.0 / 9, 1.0 / 9};
    std::vector<Joints> out(in.size());
    const auto last = static_cast<int>(in.size()) - 1;
    for (int k = 0; k <= last; ++k) {
        for (std::size_t j = 0; j < kJointCount; ++j) {
            dvec3 sum(0);
            for (int d = -2; d <= 2; ++d) {
                sum +=
                    kWeights[d + 2] * in[static_cast<std::size_t>(std::clamp(k + d, 0, last))][j];
            }
            out[static_cast<std::size_t>(k)][j] = sum;
        }
    }
    return out;
}

// Hips nearer to the ankles than standing legs have them.
bool sits(const Joints& joints) {
    double bent = 0;
    for (const Joint hip : {Joint::hip_left, Joint::hip_right}) {
        const auto i = static_cast<std::size_t>(hip);
        const double leg =
            glm::distance(joints[i], joints[i + 1]) + glm::distance(joints[i + 1], joints[i + 2]);
        bent += 0.5 * (joints[i].y - joints[i + 2].y) / std::max(leg, 0.1);
    }
    return bent < 0.75;
}

double lowest(const Joints& joints) {
    double y = joints[0].y;
    for (const dvec3& p : joints) y = std::min(y, p.y);
    return y;
}

class RecordedMotion : public ActorMotion {
  public:
    RecordedMotion(const JointRecording& recording, bool airborne)
        : joints_(eased(resampled(recording))), airborne_(airborne), floor_m_(lowest(joints_[0])) {
        for (const Joints& j : joints_) floor_m_ = std::min(floor_m_, lowest(j));
        const ActorPose first = actor_pose(joints_[0], floor_m_);
        yaw_rad_ = -std::atan2(first.chest[2].x, first.chest[2].z);
        const auto sitting = std::count_if(joints_.begin(), joints_.end(), sits);
        seated_ = 2 * sitting > static_cast<std::ptrdiff_t>(joints_.size());
        glm::dvec2 lo = first.place_m, hi = first.place_m;
        for (const Joints& j : joints_) {
            const glm::dvec2 place(j[0].x, j[0].z);
            lo = glm::min(lo, place);
            hi = glm::max(hi, place);
        }
        // Long ways are walked on the spot, mostly, so that nobody leaves the room.
        constexpr double kRoomM = 1.4;
        const double extent = std::max(hi.x - lo.x, hi.y - lo.y);
        stride_ = extent > kRoomM ? kRoomM / extent : 1;
        origin_m_ = (lo + hi) / 2.0;
    }
    [[nodiscard]] int frames() const override { return static_cast<int>(joints_.size()); }
    [[nodiscard]] ActorProps props() const override { return {.seat = seated_}; }
    [[nodiscard]] ActorPose pose(int frame) const override {
        const Joints& joints = joints_[static_cast<std::size_t>(frame)];
        ActorPose pose = actor_pose(joints, floor_m_);
        pose.place_m = (pose.place_m - origin_m_) * stride_;
        // Feet wander by some centimetres in a recording; a jump is more.
        if (airborne_) pose.lift_m = std::max(0.0, lowest(joints) - floor_m_ - 0.09);
        return turned(pose, yaw_rad_);
    }

  private:
    std::vector<Joints> joints_;
    bool airborne_, seated_ = false;
    double floor_m_, yaw_rad_ = 0, stride_ = 1;
    glm::dvec2 origin_m_{0};
};

}  // namespace

std::shared_ptr<const ActorMotion> recorded_motion(const JointRecording& recording, bool airborne) {
    KINO_CHECK(!recording.frames.empty());
    return std::make_shared<RecordedMotion>(recording, airborne);
}

const std::vector<BuiltInRecording>& built_in_recordings() {
    static const std::vector<BuiltInRecording> all = {{"cmu_01_01", true},
                                                      {"makehuman_walk1", false},
                                                      {"makehuman_dance1", false},
                                                      {"makehuman_tpose", false}};
    return all;
}

std::shared_ptr<const ActorMotion> built_in_motion(const std::string& name) {
    static const auto motions = [] {
        std::map<std::string, std::shared_ptr<const ActorMotion>> m;
        for (const BuiltInRecording& r : built_in_recordings()) {
            const auto recording = parse_joint_recording(actor_motion_file(r.name), r.name);
            KINO_CHECK(recording.has_value());
            m[r.name] = recorded_motion(*recording, r.airborne);
        }
        return m;
    }();
    const auto found = motions.find(name);
    return found == motions.end() ? nullptr : found->second;
}

}  // namespace kino
