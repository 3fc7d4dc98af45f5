#include <fmt/format.h>

#include <array>
#include <cmath>
#include <glm/gtc/matrix_transform.hpp>
#include <memory>
#include <numbers>
#include <utility>

#include "apps/bench/registry.h"
#include "tests/reference/skinned_readback.h"
#include "viz/graph/executor.h"
#include "viz/surface/mesh_drawer.h"
#include "viz/surface/mesh_shapes.h"

namespace kino {
namespace {

using bench::Comparison;
using bench::Timing;
using test::SkinnedVertex;

constexpr double kLimbM = 1.0, kRadiusM = 0.05;
constexpr std::array<std::pair<SkinBlend, const char*>, 2> kBlends = {
    {{SkinBlend::linear, "linear"}, {SkinBlend::dual_quaternion, "dual quaternion"}}};

/// A limb along y from 0 to 1 m that two joints hold: the first below, the second above, both over
/// the middle fifth.
std::shared_ptr<const MeshAsset> limb(int segments, int rings) {
    MeshAsset mesh;
    mesh.name = "limb";
    for (int r = 0; r <= rings; ++r) {
        const double y = kLimbM * r / rings;
        const double t = std::clamp((y / kLimbM - 0.4) / 0.2, 0.0, 1.0);
        const auto upper = static_cast<float>(t * t * (3 - 2 * t));
        for (int s = 0; s < segments; ++s) {
            const double a = 2 * std::numbers::pi * s / segments;
            mesh.positions.emplace_back(kRadiusM * std::sin(a), y, kRadiusM * std::cos(a));
            mesh.normals.emplace_back(std::sin(a), 0, std::cos(a));
            mesh.joints.push_back({0, 1, 0, 0});
            mesh.weights.emplace_back(1 - upper, upper, 0, 0);
        }
    }
    const auto n = static_cast<std::uint32_t>(segments);
    for (std::uint32_t r = 0; r < static_cast<std::uint32_t>(rings); ++r) {
        for (std::uint32_t s = 0; s < n; ++s) {
            const std::uint32_t a = r * n + s;
            const std::uint32_t b = r * n + (s + 1) % n;
            mesh.indices.insert(mesh.indices.end(), {a, b, b + n, a, b + n, a + n});
        }
    }
    // Lids, so that the limb has a volume.
    for (std::uint32_t s = 1; s + 1 < n; ++s) {
        const std::uint32_t top = static_cast<std::uint32_t>(rings) * n;
        mesh.indices.insert(mesh.indices.end(), {0, s + 1, s, top, top + s, top + s + 1});
    }
    set_bounding_sphere(mesh);
    return std::make_shared<const MeshAsset>(std::move(mesh));
}

/// The second joint turned about the limb's middle: a twist about y, or a bend about z.
MeshNode posed(const std::shared_ptr<const MeshAsset>& mesh, SkinBlend blend, double angle_deg,
               const glm::dvec3& axis) {
    MeshNode node;
    node.mesh = mesh;
    node.skin = blend;
    const glm::dvec3 middle(0, 0.5 * kLimbM, 0);
    const glm::dmat4 turn = glm::translate(glm::dmat4(1), middle) *
                            glm::rotate(glm::dmat4(1), angle_deg * std::numbers::pi / 180, axis) *
                            glm::translate(glm::dmat4(1), -middle);
    node.pose = std::make_shared<const std::vector<glm::mat4>>(
        std::vector<glm::mat4>{glm::mat4(1), glm::mat4(turn)});
    return node;
}

double volume(const MeshAsset& mesh, const std::vector<SkinnedVertex>& vertices) {
    double six = 0;
    for (std::size_t i = 0; i + 2 < mesh.indices.size(); i += 3) {
        const glm::dvec3& a = vertices[mesh.indices[i]].position;
        const glm::dvec3& b = vertices[mesh.indices[i + 1]].position;
        const glm::dvec3& c = vertices[mesh.indices[i + 2]].position;
        six += glm::dot(a, glm::cross(b, c));
    }
    return std::abs(six) / 6;
}

double least_radius(const std::vector<SkinnedVertex>& vertices) {
    double least = 1e9;
    for (const SkinnedVertex& v : vertices) {
        least = std::min(least, std::hypot(v.position.x, v.position.z));
    }
    return least;
}

class SkinningBench {
  public:
    SkinningBench(BenchContext& context, gpu::Device& device)
        : context_(context),
          device_(device),
          drawer_(device),
          pipelines_(device),
          executor_(device, pipelines_) {
        view_ = {.width = 64,
                 .height = 48,
                 .projection = perspective(1.0, 64, 48),
                 .world_from_view = look_at({0, 0.5, 3}, {0, 0.5, 0})};
    }

    /// Device time of the skinning pass alone.
    double skin_ms(const Scene& scene) {
        if (const auto uploaded = drawer_.upload(scene); !uploaded) {
            context_.fail(uploaded.error());
            return 0;
        }
        graph::FrameGraph graph(executor_.history());
        graph.require(drawer_.prepare(graph, scene, view_, {}).skinned);
        if (const auto ran = executor_.run(graph, graph::Timing::every_pass); !ran) {
            context_.fail(ran.error());
            return 0;
        }
        double ms = 0;
        for (const graph::GroupTime& group : executor_.group_times()) {
            if (group.group == "meshes/skin") ms = group.ms;
        }
        return ms;
    }

    /// Both blends in turn, round after round.
    Comparison compare(const std::shared_ptr<const MeshAsset>& mesh, double angle_deg,
                       const glm::dvec3& axis, int rounds) {
        std::vector<Timing> found;
        for (const auto& [blend, name] : kBlends) found.push_back({name, {}});
        if (context_.quick()) rounds = std::max(rounds / 5, 3);
        // Shaders compile at first use.
        for (int round = -2; round < rounds; ++round) {
            for (std::size_t i = 0; i < kBlends.size(); ++i) {
                Scene scene;
                scene.meshes = {posed(mesh, kBlends[i].first, angle_deg, axis)};
                const double ms = skin_ms(scene);
                if (round >= 0) found[i].ms.push_back(ms);
            }
        }
        return Comparison(found);
    }

    void times() {
        std::vector<int> sizes = {1024, 8192, 32768};
        if (!context_.quick()) sizes.push_back(131072);
        for (const int vertices : sizes) {
            const auto mesh = limb(64, vertices / 64 - 1);
            context_.progress(fmt::format("{} vertices", vertices));
            const Comparison comparison = compare(mesh, 70, {0, 1, 0}, 41);
            for (const auto& [blend, name] : kBlends) {
                context_.add({.case_name = fmt::format("{} vertices", vertices),
                              .knob = "blend",
                              .level = name,
                              .error = worst_mm(posed(mesh, blend, 70, {0, 1, 0})),
                              .metric = "mm from the double reference, max",
                              .baseline = "linear"},
                             comparison);
            }
            if (vertices == 32768) {
                ratio_ = 1 / comparison.speedup("dual quaternion", "linear");
            }
        }
    }

    double worst_mm(const MeshNode& node) {
        Scene scene;
        scene.meshes = {node};
        const auto made = test::read_skinned(device_, drawer_, executor_, scene, view_);
        if (!made) {
            context_.fail(made.error());
            return bench::kNotMeasured;
        }
        const auto reference = test::skin_mesh(node);
        const auto other = test::skin_mesh(node, true);
        double worst = 0;
        for (std::size_t v = 0; v < reference.size(); ++v) {
            worst =
                std::max(worst, std::min(glm::length((*made)[v].position - reference[v].position),
                                         glm::length((*made)[v].position - other[v].position)));
        }
        worst_ = std::max(worst_, 1e3 * worst);
        return 1e3 * worst;
    }

    /// What each blend makes of a limb, on the device, and how far that is from the reference.
    void shapes() {
        const auto mesh = limb(64, 127);
        const auto still = test::skin_mesh(posed(mesh, SkinBlend::linear, 0, {0, 1, 0}));
        const double whole = volume(*mesh, still);
        std::string table =
            "What is lost of a limb of 50 mm radius whose far half is twisted about its axis, or "
            "bent; both joints hold the middle fifth. In shares of the whole limb's volume and, "
            "twisted, "
            "of the radius at the thinnest place:\n\n"
            "| turn | linear: volume | radius | dual quaternion: volume | radius | off the "
            "reference, mm |\n|---|---|---|---|---|---|\n";
        for (const auto& [what, axis] :
             {std::pair{"twisted", glm::dvec3(0, 1, 0)}, std::pair{"bent", glm::dvec3(0, 0, 1)}}) {
            const bool twisted = axis.y > 0;
            for (const int angle : {0, 30, 60, 90, 120, 150, 180}) {
                // Bent right back, a limb lies within itself.
                if (!twisted && angle > 150) continue;
                const Comparison comparison = compare(mesh, angle, axis, 15);
                std::array<double, 2> lost{};
                std::array<double, 2> thin{};
                double off = 0;
                for (std::size_t i = 0; i < 2; ++i) {
                    const MeshNode node = posed(mesh, kBlends[i].first, angle, axis);
                    Scene scene;
                    scene.meshes = {node};
                    const auto made = test::read_skinned(device_, drawer_, executor_, scene, view_);
                    if (!made) return context_.fail(made.error());
                    // Zero and not minus zero.
                    lost[i] = std::max(1 - volume(*mesh, *made) / whole, 0.0);
                    thin[i] = 1 - least_radius(*made) / kRadiusM;
                    off = std::max(off, worst_mm(node));
                    context_.add({.case_name = fmt::format("{} {} degrees", what, angle),
                                  .knob = "blend",
                                  .level = kBlends[i].second,
                                  .error = 100 * lost[i],
                                  .metric = "% of the volume lost",
                                  .baseline = "linear"},
                                 comparison);
                }
                if (twisted) dual_loss_ = std::max(dual_loss_, std::max(lost[1], thin[1]));
                if (twisted && angle == 90) linear_loss_ = thin[0];
                const auto radius = [&](double share) {
                    return twisted ? fmt::format("{:.1f} %", 100 * share) : std::string("");
                };
                table += fmt::format("| {} {}° | {:.1f} % | {} | {:.1f} % | {} | {:.4f} |\n", what,
                                     angle, 100 * lost[0], radius(thin[0]), 100 * lost[1],
                                     radius(thin[1]), off);
            }
        }
        context_.section(table);
    }

    void claims() {
        context_.claim("Both blends are within 0.1 mm of the double-precision reference.",
                       worst_ < 0.1);
        context_.claim(
            "Twisted by any angle, dual quaternions lose less than 1 % of volume and radius.",
            dual_loss_ < 0.01);
        context_.claim("Twisted by 90 degrees, linear blending loses over a quarter of the radius.",
                       linear_loss_ > 0.25);
        context_.claim("Dual quaternions take less than three times as long as matrices.",
                       ratio_ < 3);
    }

  private:
    BenchContext& context_;
    gpu::Device& device_;
    MeshDrawer drawer_;
    gpu::Pipelines pipelines_;
    graph::Executor executor_;
    View view_;
    double worst_ = 0, dual_loss_ = 0, linear_loss_ = 0, ratio_ = 0;
};

}  // namespace

void bench_skinning(BenchContext& context) {
    auto device = gpu::Device::create({});
    if (!device) return context.fail(device.error());
    context.set_device((*device)->info().name + ", " + (*device)->info().driver);
    SkinningBench bench(context, **device);
    bench.times();
    bench.shapes();
    bench.claims();
    context.note(
        "Times are those of the skinning pass alone, on the device. Every vertex has four weights, "
        "of which two count. Twisted and bent limbs have 8192 vertices.");
}

}  // namespace kino
