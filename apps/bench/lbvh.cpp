#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <memory>

#include "apps/bench/lbvh_rays.h"
#include "apps/bench/registry.h"
#include "tests/scenes/depth_scene.h"
#include "viz/accel/ambient_occlusion.h"
#include "viz/accel/scene_bvh.h"

namespace kino {
namespace {

using bench::Candidate;
using bench::Comparison;
using test::NamedMesh;

/// Rays of three kinds for one mesh.
struct RaySet {
    std::string name;
    std::vector<Ray> rays;
};

std::vector<RaySet> ray_sets(const NamedMesh& mesh, std::size_t count) {
    const MeshBox box = box_of(mesh.triangles);
    const glm::vec3 middle = 0.5f * (box.lo + box.hi);
    const float reach = 0.5f * glm::length(box.hi - box.lo);
    const Bvh bvh = build_bvh(mesh.triangles);
    test::Random random(51);
    const auto place = [&](float scale) {
        return middle + scale * reach *
                            glm::vec3(random.real(-1, 1), random.real(-1, 1), random.real(-1, 1));
    };
    RaySet camera{"camera rays", {}};
    const auto width = static_cast<std::size_t>(std::sqrt(double(count) * 4 / 3));
    const std::size_t height = count / width;
    const glm::vec3 eye = middle + reach * glm::vec3(0.3f, 0.35f, 1.1f);
    const glm::vec3 forward = glm::normalize(middle - eye);
    const glm::vec3 right = glm::normalize(glm::cross(forward, glm::vec3(0, 1, 0)));
    const glm::vec3 up = glm::cross(right, forward);
    for (std::size_t i = 0; i < width * height; ++i) {
        const float x = 2 * (float(i % width) + 0.5f) / float(width) - 1;
        const float y = 2 * (float(i / width) + 0.5f) / float(height) - 1;
        camera.rays.push_back(
            {.origin = eye, .direction = forward + 0.6f * x * right - 0.45f * y * up});
    }
    RaySet scattered{"random rays", {}};
    while (scattered.rays.size() < count) {
        const glm::vec3 from = place(1);
        scattered.rays.push_back({.origin = from, .direction = place(0.5f) - from});
    }
    RaySet shadow{"shadow rays", {}};
    const glm::vec3 light = middle + reach * glm::vec3(-0.4f, 0.8f, 0.5f);
    for (const Ray& ray : camera.rays) {
        const RayHit hit = closest_hit(bvh, ray);
        if (!hit.hit()) continue;
        const glm::vec3 at = ray.origin + hit.t * ray.direction;
        shadow.rays.push_back(
            {.origin = at, .direction = light - at, .t_max = 0.999f, .skip = hit.triangle});
    }
    return {camera, scattered, shadow};
}

class LbvhBench {
  public:
    LbvhBench(BenchContext& context, gpu::Device& device)
        : context_(context), device_(device), pipelines_(device), executor_(device, pipelines_) {}

    graph::Executor& executor() { return executor_; }

    void builds(const NamedMesh& mesh) {
        const auto& triangles = mesh.triangles;
        Bvh refitted = build_bvh(triangles);
        DeviceBvh on_device(device_);
        if (auto made = on_device.upload_soup(triangles, {}); !made) return fail(made.error());
        DeviceBvh uploaded(device_);
        const auto run = [&](auto add) {
            graph::FrameGraph graph(executor_.history());
            const BvhBuffers made = (on_device.*add)(graph);
            graph.require(made.nodes);
            graph.require(made.triangles);
            if (const auto report = executor_.run(graph, graph::Timing::frame); !report) {
                fail(report.error());
            }
        };
        const std::vector<Candidate> candidates = {
            {"host build", [&] { refitted = build_bvh(triangles); }},
            {"host build and copy",
             [&] {
                 if (auto made = uploaded.upload(build_bvh(triangles)); !made) fail(made.error());
             }},
            {"device build", [&] { run(&DeviceBvh::add_build); }},
            {"Embree, two threads", [&] { test::EmbreePeer(triangles, int(kRayThreads)); }},
            {"host refit", [&] { refit_bvh(refitted, triangles); }},
            {"device refit", [&] { run(&DeviceBvh::add_refit); }}};
        const Comparison comparison =
            context_.compare(fmt::format("{}: build", mesh.name), candidates,
                             {.repeats = context_.quick() ? 5 : 15, .max_seconds = 10});
        for (const Candidate& candidate : candidates) {
            context_.add({.case_name = fmt::format("{}, {} triangles", mesh.name, triangles.size()),
                          .knob = "build",
                          .level = candidate.name,
                          .baseline = "host build"},
                         comparison);
        }
    }

    /// Closest and any hit of each kind of rays by everyone.
    void traces(const NamedMesh& mesh) {
        const Bvh bvh = build_bvh(mesh.triangles);
        const test::EmbreePeer embree(mesh.triangles, int(kRayThreads));
        DeviceBvh tree(device_);
        if (auto made = tree.upload(bvh); !made) return fail(made.error());
        for (const RaySet& set : ray_sets(mesh, context_.quick() ? 20000 : 200000)) {
            const bool any = set.name == "shadow rays";
            const std::size_t count = set.rays.size();
            std::vector<RayHit> hits(count);
            std::vector<std::uint8_t> found(count);
            const auto trace = [&](auto closest, auto is_hit) {
                if (any) {
                    for_each_ray(count, [&](std::size_t i) { found[i] = is_hit(set.rays[i]); });
                } else {
                    for_each_ray(count, [&](std::size_t i) { hits[i] = closest(set.rays[i]); });
                }
            };
            std::vector<shared::TraceRay> records;
            for (const Ray& r : set.rays)
                records.push_back({r.origin, r.t_min, r.direction, r.t_max});
            auto buffer = gpu::Buffer::create(device_, "rays", count * sizeof(records[0]),
                                              gpu::MemoryUse::upload);
            if (!buffer) return fail(buffer.error());
            buffer->write(std::span<const shared::TraceRay>(records));
            const std::vector<Candidate> candidates = {
                {"bit trail",
                 [&] {
                     trace([&](const Ray& r) { return closest_hit(bvh, r); },
                           [&](const Ray& r) { return any_hit(bvh, r); });
                 }},
                {"stack",
                 [&] {
                     trace([&](const Ray& r) { return closest_hit_by_stack(bvh, r); },
                           [&](const Ray& r) { return any_hit_by_stack(bvh, r); });
                 }},
                {"Embree",
                 [&] {
                     trace([&](const Ray& r) { return embree.closest_hit(r); },
                           [&](const Ray& r) { return embree.any_hit(r); });
                 }},
                {"bit trail on the device", [&] {
                     graph::FrameGraph graph(executor_.history());
                     const graph::BufferId in = graph.import_buffer("rays", *buffer);
                     graph.require(add_trace(graph, tree.add(graph), in,
                                             static_cast<std::uint32_t>(count), any));
                     if (const auto report = executor_.run(graph, graph::Timing::frame); !report) {
                         fail(report.error());
                     }
                 }}};
            const std::string name = fmt::format("{}: {}", mesh.name, set.name);
            const Comparison comparison =
                context_.compare(name, candidates, {.repeats = 11, .max_seconds = 8});
            for (const Candidate& candidate : candidates) {
                const double speed = mrays_per_s(count, comparison[candidate.name].median_ms());
                rates_ += fmt::format("| {} | {} | {:.2f} |\n", name, candidate.name, speed);
                context_.add({.case_name = fmt::format("{}, {} {}", mesh.name, count, set.name),
                              .knob = "traversal",
                              .level = candidate.name,
                              .error = speed,
                              .metric = "Mray/s",
                              .baseline = "Embree"},
                             comparison);
            }
        }
    }

    /// One knob of the tree: build and trace time, tests a ray.
    void trees(const NamedMesh& mesh, const std::string& knob,
               const std::vector<std::pair<std::string, BvhOptions>>& levels) {
        const auto rays = ray_sets(mesh, context_.quick() ? 10000 : 60000)[1].rays;
        std::vector<Bvh> trees;
        std::vector<Candidate> candidates;
        std::vector<RayHit> hits(rays.size());
        trees.reserve(levels.size());
        for (const auto& [name, options] : levels) {
            trees.push_back(build_bvh(mesh.triangles, options));
            candidates.push_back({name, [&hits, &rays, bvh = &trees.back()] {
                                      for_each_ray(rays.size(), [&](std::size_t i) {
                                          hits[i] = closest_hit(*bvh, rays[i]);
                                      });
                                  }});
        }
        const Comparison comparison = context_.compare(
            fmt::format("{}: {}", mesh.name, knob), candidates, {.repeats = 7, .max_seconds = 8});
        for (std::size_t i = 0; i < levels.size(); ++i) {
            TraceCount count;
            for (const Ray& ray : rays) (void)count_closest_hit(trees[i], ray, 1, count);
            const double n = static_cast<double>(rays.size());
            const BvhStats stats = stats_of(trees[i]);
            tests_ += fmt::format("| {} | {} | {} | {:.1f} | {:.1f} | {:.2f} | {:.1f} | {} |\n",
                                  mesh.name, knob, levels[i].first, double(count.box_tests) / n,
                                  double(count.triangle_tests) / n,
                                  double(mesh.triangles.size()) / double(stats.leaves),
                                  double(trees[i].nodes.size() * sizeof(shared::BvhNode)) / 1048576,
                                  stats.longest_leaf);
            context_.add({.case_name = fmt::format("{}, {} random rays", mesh.name, rays.size()),
                          .knob = knob,
                          .level = levels[i].first,
                          .error = double(count.box_tests + count.triangle_tests) / n,
                          .metric = "tests a ray",
                          .baseline = levels[0].first},
                         comparison);
        }
    }

    void restart(const NamedMesh& mesh) {
        const Bvh bvh = build_bvh(mesh.triangles);
        const auto rays = ray_sets(mesh, 40000)[0].rays;
        TraceCount root, leaf;
        test::Random random(52);
        std::vector<std::pair<Ray, std::uint32_t>> secondary;
        for (const Ray& ray : rays) {
            const RayHit hit = closest_hit(bvh, ray);
            if (!hit.hit()) continue;
            const glm::vec3 way(random.real(-1, 1), random.real(-1, 1), random.real(-1, 1));
            secondary.push_back({{.origin = ray.origin + hit.t * ray.direction,
                                  .direction = way,
                                  .skip = hit.triangle},
                                 hit.leaf});
        }
        for (const auto& [ray, start] : secondary) {
            (void)count_closest_hit(bvh, ray, 1, root);
            (void)count_closest_hit(bvh, ray, start, leaf);
        }
        std::vector<RayHit> hits(secondary.size());
        const auto run = [&](bool at_leaf) {
            return [&, at_leaf] {
                for_each_ray(secondary.size(), [&](std::size_t i) {
                    hits[i] =
                        closest_hit(bvh, secondary[i].first, at_leaf ? secondary[i].second : 1);
                });
            };
        };
        const std::vector<Candidate> candidates = {{"root", run(false)}, {"leaf", run(true)}};
        const Comparison comparison = context_.compare("restart", candidates, {.repeats = 11});
        for (const Candidate& candidate : candidates) {
            const TraceCount& count = candidate.name == "root" ? root : leaf;
            context_.add(
                {.case_name = fmt::format("{}, rays from surfaces", mesh.name),
                 .knob = "start",
                 .level = candidate.name,
                 .error = double(count.box_tests + count.triangle_tests) / double(secondary.size()),
                 .metric = "tests a ray",
                 .baseline = "root"},
                comparison);
        }
    }

    /// Rays that one ray a frame would have to be for a build to pay.
    void break_even(const NamedMesh& mesh) {
        const auto rays = ray_sets(mesh, 300)[1].rays;
        const Bvh bvh = build_bvh(mesh.triangles);
        const std::vector<Candidate> candidates = {
            {"build", [&] { (void)build_bvh(mesh.triangles); }},
            {"all triangles", [&] { (void)closest_hit_of_all(bvh.triangles, rays[0]); }}};
        const Comparison comparison = context_.compare("break-even", candidates, {.repeats = 9});
        const double build = comparison["build"].median_ms();
        const double linear = comparison["all triangles"].median_ms();
        context_.note(
            fmt::format("{}: a ray against all triangles takes {:.2f} ms on one core; the build "
                        "pays from {:.0f} "
                        "rays a frame on.",
                        mesh.name, linear, std::ceil(build / linear)));
    }

    /// The ambient-occlusion reference: error against its own rays.
    void ambient(const NamedMesh& mesh) {
        const Bvh bvh = build_bvh(mesh.triangles);
        const MeshBox box = box_of(mesh.triangles);
        const float reach = 0.1f * glm::length(box.hi - box.lo);
        std::vector<SurfacePlace> places;
        for (std::size_t i = 0; i < 400; ++i) {
            // Balls, from outside; the walls come first.
            const Triangle& t = mesh.triangles[12 + i * (mesh.triangles.size() - 12) / 400];
            places.push_back(
                {(t.a + t.b + t.c) / 3.0f, glm::normalize(glm::cross(t.b - t.a, t.c - t.a))});
        }
        std::vector<double> exact(places.size());
        for_each_ray(places.size(), [&](std::size_t i) {
            exact[i] = ambient_openness(bvh, places[i], reach, 4096, 77);
        });
        std::vector<Candidate> candidates;
        std::vector<std::vector<double>> found;
        const std::vector<int> levels = {4, 16, 64, 256};
        found.resize(levels.size(), std::vector<double>(places.size()));
        for (std::size_t k = 0; k < levels.size(); ++k) {
            candidates.push_back({fmt::format("{}", levels[k]), [&, k] {
                                      for_each_ray(places.size(), [&](std::size_t i) {
                                          found[k][i] =
                                              ambient_openness(bvh, places[i], reach, levels[k],
                                                               static_cast<std::uint32_t>(i));
                                      });
                                  }});
        }
        const Comparison comparison = context_.compare("ambient", candidates, {.repeats = 5});
        for (std::size_t k = 0; k < levels.size(); ++k) {
            double sum = 0;
            for (std::size_t i = 0; i < places.size(); ++i) {
                sum += (found[k][i] - exact[i]) * (found[k][i] - exact[i]);
            }
            context_.add({.case_name = fmt::format("{}, ambient openness of 400 places", mesh.name),
                          .knob = "rays a place",
                          .level = candidates[k].name,
                          .error = std::sqrt(sum / double(places.size())),
                          .metric = "RMS against 4,096 rays",
                          .baseline = "256"},
                         comparison);
        }
    }

    void sections() {
        context_.section(
            "## Rays a second\n\nTwo threads of the processor each, or the device.\n\n"
            "| rays | by | Mray/s |\n|---|---|---:|\n" +
            rates_);
        context_.section(
            "## What a ray tests\n\nClosest hit of random rays by bit trail.\n\n"
            "| mesh | knob | level | boxes | triangles | triangles a leaf | MiB of nodes "
            "| longest leaf |\n|---|---|---|---:|---:|---:|---:|---:|\n" +
            tests_);
    }

  private:
    void fail(const Error& error) { context_.fail(error); }

    BenchContext& context_;
    gpu::Device& device_;
    gpu::Pipelines pipelines_;
    graph::Executor executor_;
    std::string rates_;
    std::string tests_;
};

}  // namespace

void bench_lbvh(BenchContext& context) {
    auto office = test::load_recording("recordings/office");
    if (!office) return context.fail(office.error());
    auto device = gpu::Device::create({});
    if (!device) return context.fail(device.error());
    context.set_device((*device)->info().name + ", " + (*device)->info().driver);
    const auto depth_mesh = [&](int stride) {
        return gather_triangles(office->scene,
                                {.meshes = false, .live = true, .live_stride = stride})
            .triangles;
    };
    const bool quick = context.quick();
    const NamedMesh real{"office", depth_mesh(quick ? 4 : 2)};
    const NamedMesh wall{"noisy wall",
                         quick ? test::noisy_wall(80, 60, 3) : test::noisy_wall(319, 239, 3)};
    const NamedMesh room{"room", quick ? test::room_mesh(20, 20, 5) : test::room_mesh(70, 32, 5)};
    LbvhBench bench(context, **device);
    for (const NamedMesh* mesh : {&real, &room}) {
        bench.builds(*mesh);
        bench.traces(*mesh);
    }
    std::vector<std::pair<std::string, BvhOptions>> depths;
    for (int levels = quick ? 14 : 12; levels <= (quick ? 16 : 20); ++levels) {
        depths.push_back({fmt::format("{}", levels), {.levels = levels}});
    }
    bench.trees(real, "levels", depths);
    std::vector<std::pair<std::string, BvhOptions>> leaves;
    for (const std::uint32_t most : {1u, 2u, 4u, 8u, 16u}) {
        leaves.push_back({fmt::format("{}", most), {.leaf_triangles = most}});
    }
    bench.trees(real, "leaf triangles", leaves);
    const std::vector<std::pair<std::string, BvhOptions>> axes = {
        {"x, y, z in turn", {.axes = AxisRule::fixed_xyz}},
        {"longest cell", {.axes = AxisRule::longest_cell}}};
    for (const NamedMesh* mesh : {&wall, &real, &room}) bench.trees(*mesh, "axes", axes);
    bench.restart(room);
    bench.break_even(real);
    bench.ambient(room);
    std::vector<NamedMesh> all = test::test_meshes();
    std::erase_if(all, [](const NamedMesh& m) { return m.name == "equal triangles"; });
    all.push_back(real);
    all.push_back(room);
    bench_ray_equality(context, all, quick ? 200000 : 10000000);
    std::vector<NamedMesh> closed;
    for (const NamedMesh& mesh : all) {
        if (mesh.name == "spot" || mesh.name == "sphere" || mesh.name == "1e6 m off") {
            closed.push_back(mesh);
        }
    }
    bench_watertight_rays(context, closed, quick ? 60000 : 1000000);
    bench.sections();
    bench_ray_shadows(context, **device, bench.executor());
    context.note(
        "Rays of the processor run on two threads, one by one; the device is the same "
        "processor. Embree 3.13 as Debian builds it, robust mode, single rays.");
}

}  // namespace kino
