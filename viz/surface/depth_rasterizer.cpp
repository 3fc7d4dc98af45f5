#include "viz/surface/depth_rasterizer.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "base/check.h"
#include "viz/surface/depth_passes.h"
#include "viz/surface/surface_shared.h"

namespace kino {
namespace {

Result<void> fit(gpu::Device& device, gpu::Buffer& buffer, const char* name, std::uint64_t bytes,
                 gpu::MemoryUse use) {
    if (buffer.bytes() == bytes) return {};
    buffer = gpu::Buffer();
    KINO_ASSIGN(buffer, gpu::Buffer::create(device, name, bytes, use));
    return {};
}

std::vector<std::uint32_t> grid_indices(std::uint32_t width, std::uint32_t height) {
    std::vector<std::uint32_t> indices;
    indices.reserve(std::size_t{6} * (width - 1) * (height - 1));
    for (std::uint32_t y = 0; y + 1 < height; ++y) {
        for (std::uint32_t x = 0; x + 1 < width; ++x) {
            const std::uint32_t i = y * width + x;
            for (const std::uint32_t corner :
                 {i, i + 1, i + width, i + 1, i + width + 1, i + width})
                indices.push_back(corner);
        }
    }
    return indices;
}

/// 1/fx, 1/fy, cx, cy if the rays are those of a camera without distortion, to a hundredth of a
/// millimetre at 10 m.
std::optional<glm::vec4> find_pinhole(const Image<RayXy>& rays) {
    const int right = rays.width() - 1;
    const int bottom = rays.height() - 1;
    const RayXy first = rays.at(0, 0);
    const RayXy last = rays.at(right, bottom);
    const double step_x = (double{last.x} - first.x) / right;
    const double step_y = (double{last.y} - first.y) / bottom;
    if (!(step_x > 0) || !(step_y > 0)) return std::nullopt;
    for (int y = 0; y <= bottom; ++y) {
        for (int x = 0; x <= right; ++x) {
            const RayXy ray = rays.at(x, y);
            const double off_x = std::abs(first.x + step_x * x - ray.x);
            const double off_y = std::abs(first.y + step_y * y - ray.y);
            if (!(off_x < 1e-6) || !(off_y < 1e-6)) return std::nullopt;
        }
    }
    return glm::vec4(step_x, step_y, -first.x / step_x, -first.y / step_y);
}

}  // namespace

Result<void> DepthRasterizer::upload(const DepthSurface& surface) {
    KINO_CHECK(surface.rays != nullptr);
    const auto width = static_cast<std::uint32_t>(surface.depth_m.width());
    const auto height = static_cast<std::uint32_t>(surface.depth_m.height());
    KINO_CHECK(surface.rays->size() == surface.depth_m.size());
    if (width < 2 || height < 2) {
        return fail(fmt::format("a depth image of {}x{} has no surface", width, height));
    }
    if (version_ == surface.version && width == width_ && height == height_ && version_ != 0) {
        return {};
    }
    const std::uint64_t pixels = std::uint64_t{width} * height;
    if (width != width_ || height != height_) indices_ = gpu::Buffer();
    KINO_TRY(fit(device_, depth_, "depth", pixels * sizeof(float), gpu::MemoryUse::upload));
    depth_.write(surface.depth_m.pixels());
    if (uploaded_rays_ != surface.rays) {
        KINO_TRY(fit(device_, rays_, "rays", pixels * sizeof(RayXy), gpu::MemoryUse::upload));
        rays_.write(surface.rays->pixels());
        uploaded_rays_ = surface.rays;
        pinhole_ = find_pinhole(*surface.rays);
    }
    has_color_ = surface.color.size() == pixels;
    if (has_color_) {
        KINO_TRY(fit(device_, color_, "colour", pixels * sizeof(Rgba8), gpu::MemoryUse::upload));
        color_.write(surface.color.pixels());
    } else {
        color_ = gpu::Buffer();
    }
    width_ = width;
    height_ = height;
    focal_px_ = surface.focal_px;
    bounds_ = measure_depth_bounds(surface.depth_m);
    version_ = surface.version;
    return {};
}

SurfaceTargets DepthRasterizer::add(graph::FrameGraph& graph, const LiveDepth& live,
                                    const View& view, RasterPath path, SurfaceTargets targets,
                                    std::uint32_t background_top, std::uint32_t background_bottom,
                                    const Recolor& recolor) const {
    KINO_CHECK(!depth_.empty());
    // Composed in double, handed over relative to the camera: a room far from the origin does
    // not lose its millimetres.
    const Pose view_from_depth = inverse(view.world_from_view) * live.world_from_depth;
    const glm::dmat3 r = glm::mat3_cast(view_from_depth.rotation);
    const glm::dvec3 t = view_from_depth.translation;
    shared::SurfaceParams params{};
    params.view_from_depth_x = {r[0][0], r[1][0], r[2][0], t.x};
    params.view_from_depth_y = {r[0][1], r[1][1], r[2][1], t.y};
    params.view_from_depth_z = {r[0][2], r[1][2], r[2][2], t.z};
    params.k = {view.projection.fx, view.projection.fy, view.projection.cx, view.projection.cy};
    params.target = {view.width, view.height};
    params.grid = {width_, height_};
    if (pinhole_) params.depth_k = *pinhole_;
    params.near_m = static_cast<float>(view.projection.near_m);
    params.depth_focal_px = static_cast<float>(focal_px_);
    params.fixed_edge_m = live.edge_rule == EdgeRule::fixed ? 0.075f : 0.0f;
    params.splat_cap_px = static_cast<std::uint32_t>(std::clamp(live.splat_cap_px, 1, 64));
    params.background = {background_top, background_bottom};
    params.fill_holes = live.fill_holes && live.style == DepthStyle::cloud ? 1 : 0;

    DepthPassInputs inputs{.params = params,
                           .depth = graph.import_buffer("depth", depth_),
                           .rays = graph.import_buffer("rays", rays_),
                           .has_color = has_color_,
                           .pinhole = pinhole_.has_value(),
                           .bounds = {.x1 = width_, .y1 = height_},
                           .picture = {{0, 0}, {params.target.x, params.target.y}}};
    const bool mesh = live.style == DepthStyle::mesh;
    if (path != RasterPath::hardware && !recolor && pinhole_) {
        // One reading at least, so that no pass has to be left out.
        if (!bounds_.empty()) inputs.bounds = bounds_;
        // Splats and filled holes reach beyond the points.
        const double margin_px = 2.0 + (mesh ? 0.0 : 0.5 * params.splat_cap_px + 1.0);
        inputs.picture =
            bounds_.empty() ? VkRect2D{{0, 0}, {1, 1}} : picture_bounds(params, bounds_, margin_px);
        targets.live = inputs.picture;
    }
    inputs.color = has_color_ ? graph.import_buffer("colour", color_) : inputs.depth;
    if (targets.normal.valid() || recolor) inputs.normals = add_normals_pass(graph, inputs);
    if (recolor) {
        inputs.color = recolor(graph, inputs);
        inputs.has_color = true;
    }
    if (path == RasterPath::hardware && mesh && device_.info().has_geometry_shader) {
        if (indices_.empty()) {
            const std::vector<std::uint32_t> indices = grid_indices(width_, height_);
            auto made =
                gpu::Buffer::create(device_, "grid indices", indices.size() * sizeof(std::uint32_t),
                                    gpu::MemoryUse::upload);
            KINO_CHECK(made.has_value());
            indices_ = std::move(*made);
            indices_.write(std::span<const std::uint32_t>(indices));
        }
        return add_hardware_mesh(graph, inputs, graph.import_buffer("grid indices", indices_),
                                 targets);
    }
    if (path == RasterPath::hardware && !mesh) return add_hardware_points(graph, inputs, targets);
    const bool key32 = path == RasterPath::compute_32bit || !device_.info().has_int64_atomics;
    return mesh ? add_compute_mesh(graph, inputs, key32, targets)
                : add_compute_cloud(graph, inputs, key32, targets);
}

std::uint64_t DepthRasterizer::bytes() const {
    return depth_.bytes() + rays_.bytes() + color_.bytes() + indices_.bytes();
}

void DepthRasterizer::clear() {
    for (gpu::Buffer* buffer : {&depth_, &rays_, &color_, &indices_}) *buffer = gpu::Buffer();
    uploaded_rays_ = nullptr;
    version_ = 0;
    width_ = height_ = 0;
}

}  // namespace kino
