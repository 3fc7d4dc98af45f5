#include <cmath>
#include <glm/geometric.hpp>
#include <memory>

#include "skeleton/forest/body_part.h"
#include "skeleton/forest/training_images.h"
#include "skeleton/synthetic/synthetic_source.h"
#include "tests/skeleton/tracking/eval/take.h"

namespace kino::test {
namespace {

BodyPart body_part_at(PartId id, const glm::dvec3& p,
                      const std::array<glm::dvec3, kJointCount>& joints) {
    const auto flesh = static_cast<Joint>(id - 1);
    const CoarsePart coarse = coarse_part_at(flesh, p, joints);
    const auto at = [&](Joint j) { return joints[static_cast<std::size_t>(j)]; };
    if (coarse == CoarsePart::head) return BodyPart::head;
    if (coarse == CoarsePart::torso) {
        const glm::dvec3 left = at(Joint::shoulder_left) + at(Joint::hip_left) -
                                at(Joint::shoulder_right) - at(Joint::hip_right);
        const glm::dvec3 up = at(Joint::shoulder_center) - at(Joint::hip_center);
        const double height = glm::dot(p - at(Joint::hip_center), up) / glm::dot(up, up);
        if (height > 1.05) return BodyPart::neck;
        const bool is_left = glm::dot(p - at(Joint::hip_center), left) > 0;
        if (height > 0.5) return is_left ? BodyPart::chest_left : BodyPart::chest_right;
        return is_left ? BodyPart::belly_left : BodyPart::belly_right;
    }
    const int k = static_cast<int>(coarse) - static_cast<int>(CoarsePart::upper_arm_left);
    const int limb = k / 3, bone = k % 3;
    const auto first =
        static_cast<BodyPart>(static_cast<int>(BodyPart::upper_arm_left_high) + 5 * limb);
    const auto part = [first](int n) { return static_cast<BodyPart>(static_cast<int>(first) + n); };
    if (bone == 2) return part(4);
    const auto from = static_cast<Joint>(static_cast<int>(Joint::shoulder_left) + 4 * limb + bone);
    const glm::dvec3 a = at(from), b = at(static_cast<Joint>(static_cast<int>(from) + 1));
    const double t = glm::dot(p - a, b - a) / glm::dot(b - a, b - a);
    return part(2 * bone + (t > 0.5 ? 1 : 0));
}

}  // namespace

Result<Take> synthetic_take(const std::string& motion, int width, bool noise) {
    const auto known = motion_from_name(motion);
    if (!known) return fail("The take", "no motion '" + motion + "'", "name another");
    KINO_ASSIGN(std::shared_ptr<SyntheticSource> source,
                SyntheticSource::create(make_scene(*known, width, width * 3 / 4)));
    KINO_ASSIGN(Rig rig, Rig::create(source->scene().rig));
    Take take;
    take.name = motion;
    take.rays = rig.depth_rays();
    take.frames = static_cast<int>(SyntheticSource::kFrames);
    take.render = [source, noise, rays = rig.depth_rays()](int index, TakeFrame& out) {
        const SyntheticTruth truth = source->truth(index);
        out.time = static_cast<TimeNs>(index * 1e9 / 30) + 1;
        out.depth_m = truth.depth_m;
        out.truth = truth.bodies;
        out.part = Image<std::uint8_t>(rays.width(), rays.height(), kNotBody);
        out.actor = Image<std::uint8_t>(rays.width(), rays.height(), 0);
        std::array<glm::dvec3, kJointCount> joints{};
        for (Body& body : out.truth.bodies) {
            body.id = 1;
            for (std::size_t j = 0; j < kJointCount; ++j) {
                joints[j] = glm::dvec3(body.joints[j].position_m);
            }
        }
        for (int y = 0; y < rays.height(); ++y) {
            for (int x = 0; x < rays.width(); ++x) {
                const PartId id = truth.part.at(x, y);
                float& z = out.depth_m.at(x, y);
                if (noise && (!truth.lit.at(x, y) || z > 8)) z = 0;
                if (!is_body_part(id) || z <= 0) continue;
                const RayXy& ray = rays.at(x, y);
                out.actor.at(x, y) = 1;
                out.part.at(x, y) = static_cast<std::uint8_t>(
                    body_part_at(id, glm::dvec3(ray.x * z, ray.y * z, z), joints));
            }
        }
    };
    return take;
}

}  // namespace kino::test
