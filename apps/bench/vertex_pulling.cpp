#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <glm/gtc/matrix_transform.hpp>
#include <random>

#include "apps/bench/registry.h"
#include "tests/reference/mesh_reference.h"
#include "viz/graph/executor.h"
#include "viz/surface/mesh_drawer.h"
#include "viz/surface/mesh_shapes.h"

namespace kino {
namespace {

using bench::Comparison;
using bench::Timing;

constexpr int kWidth = 1280;
constexpr int kHeight = 720;

struct Way {
    std::string name;
    MeshListOptions options;
    std::uint32_t formats = 0;  ///< other than the list's own: all these are compiled
};

struct Cost {
    double host_ms = 0;    ///< table and commands written, passes recorded
    double device_ms = 0;  ///< submit to fence of the mesh passes
};

MeshNode node_at(const std::shared_ptr<const MeshAsset>& mesh, const glm::dmat4& place,
                 std::uint32_t material) {
    MeshNode node;
    node.mesh = mesh;
    node.world_from_object = node.previous_world_from_object = place;
    node.material = material;
    return node;
}

class PullingBench {
  public:
    PullingBench(BenchContext& context, gpu::Device& device)
        : context_(context),
          device_(device),
          drawer_(device),
          pipelines_(device),
          executor_(device, pipelines_) {
        view_ = {.width = kWidth,
                 .height = kHeight,
                 .projection = perspective(1.0, kWidth, kHeight),
                 .world_from_view = look_at({0, 0, 0}, {0, 0, -1})};
    }

    /// One frame: targets cleared, meshes drawn.
    Cost frame(const Scene& scene, const View& view, const Way& way) {
        const auto begin = std::chrono::steady_clock::now();
        if (const auto uploaded = drawer_.upload(scene); !uploaded) {
            context_.fail(uploaded.error());
            return {};
        }
        graph::FrameGraph graph(executor_.history());
        const graph::TextureDesc size{kWidth, kHeight, VK_FORMAT_R8G8B8A8_UNORM};
        SurfaceTargets targets;
        targets.albedo = graph.create_texture("albedo", size);
        targets.view_z = graph.create_texture("view depth", {kWidth, kHeight, kViewZFormat});
        graph::TextureId depth = graph.create_texture("depth", {kWidth, kHeight, kDepthFormat});
        graph.add_pass(
            "bench/clear", "clear",
            [&](graph::PassBuilder& b) {
                targets.albedo = b.write(targets.albedo, graph::Use::color_attachment);
                targets.view_z = b.write(targets.view_z, graph::Use::color_attachment);
                depth = b.write(depth, graph::Use::depth_attachment);
            },
            [targets, depth](graph::PassContext& c) {
                const std::array<gpu::Target, 2> colors = {
                    {{.view = c.view(targets.albedo), .clear = true},
                     {.view = c.view(targets.view_z), .clear = true}}};
                const gpu::Target far{.view = c.view(depth), .clear = true};
                c.commands().begin_rendering({kWidth, kHeight}, colors, &far);
                c.commands().end_rendering();
            });
        MeshList list = drawer_.prepare(graph, scene, view, way.options);
        if (way.formats != 0) list.formats = way.formats;
        const auto drawn = drawer_.add(graph, list, targets, depth);
        graph.require(drawn.targets.albedo);
        const auto report = executor_.run(graph, graph::Timing::every_group);
        if (!report) {
            context_.fail(report.error());
            return {};
        }
        const std::chrono::duration<double, std::milli> all =
            std::chrono::steady_clock::now() - begin;
        Cost cost{.host_ms = all.count() - to_ms(report->submit_to_fence)};
        for (const graph::GroupTime& group : executor_.group_times()) {
            if (group.group == "meshes") cost.device_ms = group.ms;
        }
        return cost;
    }

    struct Found {
        Comparison host, device;
    };
    /// All ways in turn, round after round.
    Found compare(const std::string& what, const Scene& scene, const View& view,
                  const std::vector<Way>& ways, int rounds) {
        context_.progress(what);
        std::vector<Timing> host;
        std::vector<Timing> device;
        for (const Way& way : ways) {
            host.push_back({way.name, {}});
            device.push_back({way.name, {}});
        }
        if (context_.quick()) rounds = std::max(rounds / 5, 3);
        for (int round = -2; round < rounds; ++round) {
            for (std::size_t i = 0; i < ways.size(); ++i) {
                const Cost cost = frame(scene, view, ways[i]);
                if (round < 0) continue;  // shaders compile at first use
                host[i].ms.push_back(cost.host_ms);
                device[i].ms.push_back(cost.device_ms);
            }
        }
        return {Comparison(host), Comparison(device)};
    }

    void add(const std::string& case_name, const std::string& knob, const Found& found,
             const std::string& baseline) {
        for (const Timing& timing : found.device.timings()) {
            context_.add({.case_name = case_name,
                          .knob = knob,
                          .level = timing.name,
                          .error = found.host[timing.name].median_ms(),
                          .metric = "host ms a frame",
                          .baseline = baseline},
                         found.device);
        }
    }

    /// `count` bodies of about `pixels` x `pixels` in rows over the picture.
    Scene spread(int count, const std::vector<std::shared_ptr<const MeshAsset>>& meshes,
                 double pixels) const {
        Scene scene;
        scene.materials = {{.base_color = {0.7f, 0.2f, 0.1f}}, {.base_color = {0.2f, 0.5f, 0.8f}}};
        const double distance = 10;
        const double size = pixels * distance / view_.projection.fx;
        const int columns = std::max(1, static_cast<int>(std::sqrt(count * 16.0 / 9)));
        const int rows = (count + columns - 1) / columns;
        const double width = 0.96 * kWidth * distance / view_.projection.fx;
        const double height = 0.96 * kHeight * distance / view_.projection.fx;
        for (int i = 0; i < count; ++i) {
            const double x = (i % columns + 0.5) / columns - 0.5;
            const double y = (i / columns + 0.5) / rows - 0.5;
            glm::dmat4 m = glm::translate(glm::dmat4(1.0), {x * width, y * height, -distance});
            m = glm::rotate(m, 0.37 * i, glm::dvec3(0, 0, 1));
            scene.meshes.push_back(node_at(meshes[static_cast<std::size_t>(i) % meshes.size()],
                                           glm::scale(m, glm::dvec3(size)),
                                           static_cast<std::uint32_t>(i % 3)));
        }
        return scene;
    }

    static std::shared_ptr<const MeshAsset> upright_quad() {
        MeshAsset mesh = *make_grid(1, 1);
        for (std::size_t v = 0; v < mesh.positions.size(); ++v) {
            mesh.positions[v] = {mesh.positions[v].x, -mesh.positions[v].z, 0};
            mesh.normals[v] = {0, 0, 1};
        }
        return std::make_shared<const MeshAsset>(mesh);
    }

    void submission() {
        const std::vector<Way> ways = {
            {"multi-draw, culled", {}},
            {"multi-draw, compacted", {.culling = MeshCulling::compact}},
            {"multi-draw, not culled", {.culling = MeshCulling::none}},
            {"one call each", {.submit = MeshSubmit::one_call_each, .culling = MeshCulling::none}},
            {"one call each, id pushed",
             {.submit = MeshSubmit::one_call_each,
              .culling = MeshCulling::none,
              .carrier = DrawIdCarrier::pushed}},
            {"fixed function",
             {.submit = MeshSubmit::fixed_function, .culling = MeshCulling::none}}};
        std::vector<Way> with_instances = ways;
        with_instances.push_back({"instanced", {.carrier = DrawIdCarrier::instance}});
        for (const int count : {1024, 4096, 16384, 65536}) {
            if (context_.quick() && count != 16384 && count != 1024) continue;
            const std::string name = fmt::format("{} quads of 16 px", count);
            const Found found = compare(name, spread(count, {upright_quad()}, 4), view_,
                                        with_instances, count > 20000 ? 7 : 15);
            add(name, "submission", found, "one call each");
            if (count != 16384) continue;
            const double calls =
                found.device.speedup("multi-draw, not culled", "one call each, id pushed");
            const double instanced = found.device.speedup("multi-draw, not culled", "instanced");
            context_.claim(fmt::format("16,384 quads: the device does one multi-draw {:.1f}x as "
                                       "fast as calls that push an id each (promised: 5x)",
                                       calls),
                           calls >= 5);
            context_.claim(
                fmt::format("and within 1.5x of one instanced draw ({:.2f}x)", 1 / instanced),
                1 / instanced <= 1.5);
            const Timing& one = found.device["multi-draw, not culled"];
            context_.note(fmt::format(
                "Device time a quad, us: multi-draw {:.2f}, one call each "
                "{:.2f}, with a pushed id {:.2f}, fixed function {:.2f}, instanced {:.2f}.",
                1000 * one.median_ms() / count,
                1000 * found.device["one call each"].median_ms() / count,
                1000 * found.device["one call each, id pushed"].median_ms() / count,
                1000 * found.device["fixed function"].median_ms() / count,
                1000 * found.device["instanced"].median_ms() / count));
        }
        const std::vector<std::shared_ptr<const MeshAsset>> meshes = {
            make_box({1, 1, 1}),       make_sphere(0.5f, 8, 4),       make_cone(0.5f, 1, 8),
            make_cylinder(0.5f, 1, 8), make_torus(0.4f, 0.15f, 8, 5), upright_quad()};
        const std::string name = "16384 mixed meshes of 64 px";
        const Found found = compare(name, spread(16384, meshes, 8), view_, ways, 11);
        add(name, "submission", found, "one call each");
        double triangles = 0;
        for (const auto& mesh : meshes) triangles += static_cast<double>(mesh->indices.size()) / 3;
        context_.note(fmt::format("The six mixed meshes have {:.0f} triangles on the average.",
                                  triangles / static_cast<double>(meshes.size())));
    }

    void carriers() {
        const std::vector<Way> ways = {
            {"firstInstance", {.culling = MeshCulling::none}},
            {"gl_DrawID", {.culling = MeshCulling::none, .carrier = DrawIdCarrier::draw_id}},
            {"attribute", {.culling = MeshCulling::none, .carrier = DrawIdCarrier::attribute}}};
        const Found found =
            compare("draw-ID carriers", spread(16384, {upright_quad()}, 4), view_, ways, 15);
        add("16384 quads of 16 px", "draw-ID carrier", found, "firstInstance");
    }

    /// Vertices only: everything lies behind the camera, and is drawn all the same.
    void fetch() {
        Scene scene;
        const auto grid = make_grid(20, 10, 1023, 511);
        scene.meshes = {node_at(grid, glm::translate(glm::dmat4(1.0), {0, -1, 20}), 0)};
        const MeshListOptions unculled{.culling = MeshCulling::none};
        MeshListOptions fixed = unculled;
        fixed.submit = MeshSubmit::fixed_function;
        const std::vector<Way> ways = {
            {"fixed function", fixed},        {"pulled, 1 format compiled", unculled, 0b00001},
            {"2 formats", unculled, 0b00011}, {"3 formats", unculled, 0b01011},
            {"4 formats", unculled, 0b11011}, {"5 formats", unculled, 0b11111}};
        const Found found = compare("fetch", scene, view_, ways, 15);
        add("524288 vertices behind the camera", "fetch", found, "fixed function");
        const double pulled =
            1 / found.device.speedup("pulled, 1 format compiled", "fixed function");
        const double all = 1 / found.device.speedup("5 formats", "pulled, 1 format compiled");
        context_.note(fmt::format(
            "Fetching in the shader costs {:.2f}x the fixed-function input with one format "
            "compiled, and {:.2f}x of that with all five: a pass compiles what its draws hold.",
            pulled, all));
    }

    void culling() {
        for (const int percent : {0, 10, 50, 100}) {
            Scene scene = spread(16384, {upright_quad()}, 4);
            std::mt19937 random(9);
            for (MeshNode& node : scene.meshes) {
                if (static_cast<int>(random() % 100) >= percent) {
                    node.world_from_object[3][2] += 40;  // behind the camera
                }
            }
            const std::vector<Way> ways = {
                {"none", {.culling = MeshCulling::none}},
                {"zero instances", {.culling = MeshCulling::zero_instance}},
                {"compacted", {.culling = MeshCulling::compact}}};
            const std::string name = fmt::format("16384 quads, {} % in view", percent);
            const Found found = compare(name, scene, view_, ways, 15);
            add(name, "culling", found, "none");
            if (percent == 0) none_live_ms_ = found.device["zero instances"].median_ms();
            if (percent == 100) {
                const double live = found.device["zero instances"].median_ms();
                context_.claim(fmt::format("a draw that is culled costs {:.3f} of one that is "
                                           "drawn (promised: 1/10)",
                                           none_live_ms_ / live),
                               none_live_ms_ <= 0.1 * live);
            }
        }
        false_positives();
    }

    /// Bodies that the sphere test keeps though no triangle of theirs is in the picture.
    void false_positives() {
        Scene scene;
        std::mt19937 random(4);
        const auto uniform = [&](double low, double high) {
            return low + (high - low) * (static_cast<double>(random()) / 4294967296.0);
        };
        const auto box = make_box({1, 0.5f, 0.25f});
        for (int i = 0; i < 16384; ++i) {
            const glm::dmat4 m =
                glm::rotate(glm::translate(glm::dmat4(1.0),
                                           {uniform(-40, 40), uniform(-25, 25), uniform(-30, 30)}),
                            uniform(0, 6.28), glm::dvec3(0, 0.6, 0.8));
            scene.meshes.push_back(node_at(box, glm::scale(m, glm::dvec3(uniform(0.5, 3))), 0));
        }
        const auto sides = side_planes(view_);
        const Pose view_from_world = inverse(view_.world_from_view);
        int kept = 0;
        int needed = 0;
        int lost = 0;
        for (const MeshNode& node : scene.meshes) {
            const glm::dvec3 center =
                view_from_world * glm::dvec3(node.world_from_object *
                                             glm::dvec4(glm::dvec3(box->sphere_center), 1.0));
            const bool keep = may_be_seen(
                sides, view_.projection.near_m, center,
                box->sphere_radius_m * largest_stretch(glm::dmat3(node.world_from_object)));
            const test::WorldVertices placed = test::place_vertices(node);
            bool seen = false;
            for (std::size_t t = 0; t < box->indices.size() && !seen; t += 3) {
                seen = test::in_frustum(view_,
                                        {view_from_world * placed.positions[box->indices[t]],
                                         view_from_world * placed.positions[box->indices[t + 1]],
                                         view_from_world * placed.positions[box->indices[t + 2]]});
            }
            kept += keep;
            needed += seen;
            lost += seen && !keep;
        }
        context_.add({.case_name = "16384 boxes all round",
                      .knob = "culling shape",
                      .level = "sphere",
                      .error = static_cast<double>(kept - needed) / std::max(needed, 1),
                      .metric = "drawn in vain, share of the seen"});
        context_.claim(fmt::format("the sphere test loses none of {} boxes in view", needed),
                       lost == 0);
    }

    void triangles_per_draw() {
        constexpr int kTriangles = 262144;
        double best_ms = 1e9;
        int best = 0;
        for (const int per_draw : {2, 8, 32, 128, 512, 2048, 8192, 65536}) {
            if (context_.quick() && per_draw < 32) continue;
            const int draws = kTriangles / per_draw;
            int columns = 1;
            while (columns * columns * 4 <= per_draw) columns *= 2;
            MeshAsset mesh = *make_grid(1, 1, columns, per_draw / 2 / columns);
            for (std::size_t v = 0; v < mesh.positions.size(); ++v) {
                mesh.positions[v] = {mesh.positions[v].x, -mesh.positions[v].z, 0};
                mesh.normals[v] = {0, 0, 1};
            }
            const auto patch = std::make_shared<const MeshAsset>(mesh);
            // Together they cover the same share of the picture.
            const Scene scene = spread(draws, {patch}, 0.8 * std::sqrt(1280.0 * 720 / draws));
            const std::string name = fmt::format("{}", per_draw);
            const Found found = compare("triangles a draw: " + name, scene, view_,
                                        {{name, {.culling = MeshCulling::none}}}, 7);
            add("262144 triangles", "triangles a draw", found, name);
            const double ms = found.device[name].median_ms();
            if (ms < best_ms) {
                best_ms = ms;
                best = per_draw;
            }
        }
        context_.note(fmt::format("262,144 triangles are drawn fastest with {} a draw, {:.1f} ms.",
                                  best, best_ms));
    }

  private:
    BenchContext& context_;
    gpu::Device& device_;
    MeshDrawer drawer_;
    gpu::Pipelines pipelines_;
    graph::Executor executor_;
    View view_;
    double none_live_ms_ = 0;
};

}  // namespace

void bench_vertex_pulling(BenchContext& context) {
    auto device = gpu::Device::create({});
    if (!device) return context.fail(device.error());
    context.set_device((*device)->info().name + ", " + (*device)->info().driver);
    PullingBench bench(context, **device);
    bench.submission();
    bench.carriers();
    bench.fetch();
    bench.culling();
    bench.triangles_per_draw();
    context.note(
        "1280x720, albedo, view depth and depth written. Times are the device's, from submit to "
        "fence, of culling and drawing; the error column holds the host's time a frame, in which "
        "it makes the table of draws, writes it, and records. Drawing every way makes the same "
        "picture (tests/viz/meshes).");
}

}  // namespace kino
