#include "skeleton/actors/base_mesh.h"

#include <cmath>
#include <cstring>
#include <map>
#include <tuple>

#include "base/check.h"
#include "skeleton/actors/embedded_data.h"

namespace kino {
namespace {

class Bytes {
  public:
    explicit Bytes(std::span<const std::byte> all) : rest_(all) {}
    template <class T>
    T next() {
        KINO_CHECK(rest_.size() >= sizeof(T));
        T value;
        std::memcpy(&value, rest_.data(), sizeof(T));
        rest_ = rest_.subspan(sizeof(T));
        return value;
    }
    glm::dvec3 next_point() {
        const auto x = next<float>(), y = next<float>(), z = next<float>();
        return {x, y, z};
    }
    [[nodiscard]] bool empty() const { return rest_.empty(); }

  private:
    std::span<const std::byte> rest_;
};

void find_mirror(BaseMesh& mesh) {
    std::map<std::tuple<long, long, long>, std::uint32_t> at;
    const auto key = [](double sign, const glm::dvec3& v) {
        return std::tuple(std::lround(sign * v.x * 1e4), std::lround(v.y * 1e4),
                          std::lround(v.z * 1e4));
    };
    for (std::uint32_t i = 0; i < mesh.vertex_m.size(); ++i) at[key(1, mesh.vertex_m[i])] = i;
    for (const glm::dvec3& v : mesh.vertex_m) {
        const auto found = at.find(key(-1, v));
        KINO_CHECK(found != at.end());
        mesh.mirror.push_back(found->second);
    }
}

BaseMesh unpack() {
    Bytes file(actor_body_file());
    char magic[8];
    for (char& c : magic) c = file.next<char>();
    KINO_CHECK(std::memcmp(magic, "KACTOR1", 8) == 0);
    const auto vertices = file.next<std::uint32_t>(), quads = file.next<std::uint32_t>();
    KINO_CHECK_EQ(file.next<std::uint32_t>(), kActorBoneCount);
    BaseMesh mesh;
    for (std::size_t i = 0; i < kActorBoneCount; ++i) {
        mesh.head_m[i] = file.next_point();
        mesh.tail_m[i] = file.next_point();
    }
    for (int side = 0; side < 2; ++side) {
        for (const ActorBone low : {ActorBone::upper_arm_low, ActorBone::forearm_low,
                                    ActorBone::thigh_low, ActorBone::shin_low}) {
            // It twists about the line from joint to joint, not about its own middle.
            const std::size_t i = bone_index(low, side);
            mesh.head_m[i] = mesh.head_m[i - 1];
        }
    }
    for (glm::dvec3& joint : mesh.joint_m) joint = file.next_point();
    for (std::uint32_t i = 0; i < vertices; ++i) {
        const auto x = file.next<std::int16_t>(), y = file.next<std::int16_t>(),
                   z = file.next<std::int16_t>();
        mesh.vertex_m.push_back(glm::dvec3(x, y, z) * 1e-4);
    }
    for (std::uint32_t i = 0; i < quads; ++i) {
        std::array<std::uint32_t, 4> q{};
        for (auto& corner : q) {
            corner = file.next<std::uint16_t>();
            KINO_CHECK(corner < vertices);
        }
        mesh.triangles.push_back({q[0], q[1], q[2]});
        mesh.triangles.push_back({q[0], q[2], q[3]});
    }
    for (std::uint32_t i = 0; i < vertices; ++i) {
        BoneWeights w;
        for (std::size_t k = 0; k < 4; ++k) {
            w.bone[k] = file.next<std::uint8_t>();
            w.weight[k] = static_cast<float>(file.next<std::uint8_t>()) / 255.0f;
            KINO_CHECK(w.bone[k] < kActorBoneCount);
        }
        mesh.weights.push_back(w);
    }
    KINO_CHECK(file.empty());
    find_mirror(mesh);
    return mesh;
}

}  // namespace

double BaseMesh::share(std::size_t vertex, std::initializer_list<std::size_t> bones) const {
    double sum = 0;
    for (std::size_t k = 0; k < 4; ++k) {
        for (const std::size_t b : bones) {
            if (weights[vertex].bone[k] == b) sum += weights[vertex].weight[k];
        }
    }
    return sum;
}

const BaseMesh& base_mesh() {
    static const BaseMesh mesh = unpack();
    return mesh;
}

}  // namespace kino
