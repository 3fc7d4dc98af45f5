#include "calibration/rig.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <glm/gtc/quaternion.hpp>

#include "calibration/disparity.h"
#include "calibration/projection.h"
#include "calibration/registration_holes.h"
#include "calibration/registration_kernel.h"
#include "calibration/registration_rays.h"
#include "calibration/registration_splat.h"

namespace kino {
namespace {

static_assert(sizeof(ColorUv) == 4 && std::endian::native == std::endian::little);

// Decoding, projecting and scattering go chunk by chunk, so that each finds the last one's results
// in the first-level cache.
constexpr std::size_t kChunk = 1024;
constexpr int kWidestColor = 4096;

struct RawRange {
    std::uint16_t first = 1;
    std::uint16_t last = 0;
};

// Whole units inside the range in metres, found in double: float products would lose a limit that
// is itself a whole unit. 0 and 65535 never count.
RawRange raw_range(const RigParameters& p, double metres_per_unit) {
    const double first = std::max(1.0, std::ceil(p.min_depth_m / metres_per_unit - 1e-6));
    const double last = std::min(65534.0, std::floor(p.max_depth_m / metres_per_unit + 1e-6));
    if (first > last) return {};
    return {static_cast<std::uint16_t>(first), static_cast<std::uint16_t>(last)};
}

Image<RayXy> all_rays(const registration::RayNodes& nodes) {
    const registration::RayTable table(nodes, glm::dmat3(1));
    Image<RayXy> rays(nodes.width, nodes.height);
    std::vector<float> row(3 * static_cast<std::size_t>(nodes.width));
    const auto width = static_cast<std::size_t>(nodes.width);
    for (int y = 0; y < nodes.height; ++y) {
        table.read(static_cast<std::size_t>(y) * width, width, row.data(), row.data() + width,
                   row.data() + 2 * width);
        for (std::size_t x = 0; x < width; ++x) rays.row(y)[x] = {row[x], row[width + x]};
    }
    return rays;
}

registration::Distortion distortion_kind(const CameraModel& c) {
    if (c.k4 != 0 || c.k5 != 0 || c.k6 != 0) return registration::Distortion::rational;
    return c.has_distortion() ? registration::Distortion::polynomial
                              : registration::Distortion::none;
}

double pixel_ratio(const CameraModel& depth, const CameraModel& color) {
    return std::max(color.fx / depth.fx, color.fy / depth.fy);
}

int occlusion_cell_px(const CameraModel& depth, const CameraModel& color) {
    const double ratio = pixel_ratio(depth, color);
    const int largest = std::max(color.width, color.height);
    return static_cast<int>(std::clamp(std::ceil(ratio - 0.1), 1.0, static_cast<double>(largest)));
}

// Nearest wins. `key` and the buffer hold the bits of positive floats, whose order as integers is
// theirs; 0 is "nothing", and taking one away turns it into the farthest of all.
void scatter_nearest(const std::int32_t* cell, const std::uint32_t* key, std::size_t n,
                     float* z_buffer) {
    for (std::size_t i = 0; i < n; ++i) {
        float& place = z_buffer[cell[i]];
        const auto held = std::bit_cast<std::uint32_t>(place);
        place = std::bit_cast<float>(key[i] - 1 < held - 1 ? key[i] : held);
    }
}

}  // namespace

struct Rig::State {
    RigParameters parameters;
    RigOptions options;
    const registration::Functions* run = nullptr;
    Disparity disparity;
    Image<RayXy> rays;

    // Only with a colour camera: the depth camera's rays in its axes, and per-frame scratch.
    registration::RayTable turned;
    registration::Geometry geometry{};
    std::vector<std::int32_t> cell;
    std::vector<std::uint32_t> key;
    std::array<std::array<float, kChunk>, 3> chunk_rays{};

    // Only if a reading covers more than the pixel it falls into.
    std::vector<float> u, v, z_in_color;
    registration::Splat splat;
    registration::HoleFiller holes;

    // Only if the colour camera is the finer one: the z-buffer in squares of cell_px.
    int cell_px = 1;
    int coarse_width = 0;
    std::vector<std::int32_t> coarse_cell;
    std::vector<float> coarse_z;

    State(RigParameters p, RigOptions o)
        : parameters(std::move(p)),
          options(o),
          run(o.simd ? &registration::best() : &registration::kPortable),
          disparity(parameters.disparity, parameters.min_depth_m, parameters.max_depth_m) {
        const auto nodes = registration::find_rays(parameters.depth, options.ray_table_step);
        rays = all_rays(nodes);
        if (parameters.color) prepare_color(*parameters.color, nodes);
    }

    void prepare_color(const CameraModel& color, const registration::RayNodes& nodes) {
        const std::size_t n = rays.size();
        turned = {nodes, glm::mat3_cast(parameters.color_from_depth.rotation)};
        const auto f = [](double value) { return static_cast<float>(value); };
        const glm::dvec3& t = parameters.color_from_depth.translation;
        const double radius = Projection(color).max_radius();
        geometry = {.ray_x = turned.whole(0),
                    .ray_y = turned.whole(1),
                    .ray_z = turned.whole(2),
                    .tx = f(t.x),
                    .ty = f(t.y),
                    .tz = f(t.z),
                    .fx = f(color.fx),
                    .fy = f(color.fy),
                    .cx = f(color.cx),
                    .cy = f(color.cy),
                    .k1 = f(color.k1),
                    .k2 = f(color.k2),
                    .k3 = f(color.k3),
                    .k4 = f(color.k4),
                    .k5 = f(color.k5),
                    .k6 = f(color.k6),
                    .p1 = f(color.p1),
                    .p2 = f(color.p2),
                    .max_radius_squared = f(radius * radius),
                    .width = color.width,
                    .height = color.height,
                    .distortion = distortion_kind(color)};
        cell.resize(n);
        key.resize(n);
        if (options.coverage != Coverage::nearest) {
            u.resize(n);
            v.resize(n);
            z_in_color.resize(n);
        }
        const bool splatted = options.coverage == Coverage::splat;
        if (splatted) {
            splat = {parameters.depth.width, parameters.depth.height,
                     (parameters.depth.fx + parameters.depth.fy) / 2,
                     pixel_ratio(parameters.depth, color)};
        }
        const bool in_squares = options.occlusion_test && !splatted;
        cell_px = in_squares ? occlusion_cell_px(parameters.depth, color) : 1;
        if (cell_px > 1) {
            coarse_width = (color.width + cell_px - 1) / cell_px;
            const int coarse_height = (color.height + cell_px - 1) / cell_px;
            coarse_cell.resize(n);
            coarse_z.resize(static_cast<std::size_t>(coarse_width) *
                            static_cast<std::size_t>(coarse_height));
        }
    }

    void decode(const DepthFrame& frame, RawRange range, std::size_t begin, std::size_t n,
                float* z) const {
        const std::uint16_t* raw = frame.raw.data() + begin;
        if (frame.unit == DepthUnit::linear) {
            run->decode_linear(raw, n, range.first, range.last,
                               static_cast<float>(frame.metres_per_unit), z + begin);
        } else {
            run->decode_table(raw, n, disparity.table().data(), z + begin);
        }
    }

    void project(const float* z, std::size_t begin, std::size_t n,
                 const registration::Projected& out) {
        if (geometry.ray_x) return run->project(geometry, z, begin, n, out);
        registration::Geometry from_chunk = geometry;
        from_chunk.ray_x = chunk_rays[0].data();
        from_chunk.ray_y = chunk_rays[1].data();
        from_chunk.ray_z = chunk_rays[2].data();
        turned.read(begin, n, chunk_rays[0].data(), chunk_rays[1].data(), chunk_rays[2].data());
        run->project(from_chunk, z, 0, n, out);
    }

    void draw(const float* depth_m, std::uint32_t* uv, float* depth_in_color_m) {
        const registration::Places places = {
            depth_m, u.data(), v.data(), z_in_color.data(), uv, key.data(), depth_in_color_m};
        if (options.coverage == Coverage::splat) {
            splat.draw(geometry, turned, places, options.occlusion_test);
        } else {
            registration::draw_four_pixels(geometry, places, key.size());
        }
    }

    void scatter_coarse() {
        std::fill(coarse_z.begin(), coarse_z.end(), 0.0f);
        const int width = geometry.width;
        for (std::size_t i = 0; i < cell.size(); ++i) {
            const int y = cell[i] / width;
            const int x = cell[i] - y * width;
            coarse_cell[i] = (y / cell_px) * coarse_width + x / cell_px;
        }
        scatter_nearest(coarse_cell.data(), key.data(), key.size(), coarse_z.data());
    }
};

Rig::Rig(std::unique_ptr<State> state) : state_(std::move(state)) {}
Rig::~Rig() = default;
Rig::Rig(Rig&&) noexcept = default;
Rig& Rig::operator=(Rig&&) noexcept = default;

const RigParameters& Rig::parameters() const {
    return state_->parameters;
}
const Image<RayXy>& Rig::depth_rays() const {
    return state_->rays;
}

Result<Rig> Rig::create(RigParameters parameters, RigOptions options) {
    KINO_TRY(validate(parameters));
    if (const auto& color = parameters.color;
        color && (color->width > kWidestColor || color->height > kWidestColor)) {
        return fail(fmt::format("colour of {}x{} is too large", color->width, color->height),
                    "colour camera",
                    fmt::format("registration handles up to {} px a side", kWidestColor));
    }
    if (!(options.occlusion_margin_m >= 0) || !std::isfinite(options.occlusion_margin_m)) {
        return fail("the occlusion margin must be zero or more metres", "occlusion margin");
    }
    if (const int step = options.ray_table_step; step != 1 && step != 2 && step != 4 && step != 8) {
        return fail(fmt::format("a ray every {} pixels is not among the choices", step),
                    "ray table", "1, 2, 4 or 8");
    }
    if (options.fill_holes_px < 0) {
        return fail("holes to fill cannot have fewer than no pixels", "hole size");
    }
    return Rig(std::make_unique<State>(std::move(parameters), options));
}

Result<void> Rig::register_depth(const DepthFrame& frame, RegisteredDepth& out) {
    State& s = *state_;
    const CameraModel& depth = s.parameters.depth;
    if (frame.raw.width() != depth.width || frame.raw.height() != depth.height) {
        return fail(fmt::format("the depth frame is {}x{}, the calibration is for {}x{}",
                                frame.raw.width(), frame.raw.height(), depth.width, depth.height),
                    "depth camera", "use the calibration of this sensor and mode");
    }
    RawRange range;
    if (frame.unit == DepthUnit::linear) {
        if (!(frame.metres_per_unit > 0) || !std::isfinite(frame.metres_per_unit)) {
            return fail(fmt::format("a depth unit of {} m is not usable", frame.metres_per_unit),
                        "depth frame", "the scale must be positive, e.g. 0.001 for millimetres");
        }
        range = raw_range(s.parameters, frame.metres_per_unit);
    }

    const std::size_t pixels = frame.raw.size();
    out.depth_m.resize(depth.width, depth.height);
    out.uv.resize(depth.width, depth.height);
    float* z = out.depth_m.data();
    if (!s.parameters.color) {
        s.decode(frame, range, 0, pixels, z);
        out.uv.fill(ColorUv{});
        out.depth_in_color_m.resize(0, 0);
        return {};
    }

    out.depth_in_color_m.resize(s.geometry.width, s.geometry.height);
    out.depth_in_color_m.fill(0.0f);
    float* z_buffer = out.depth_in_color_m.data();
    auto* uv = reinterpret_cast<std::uint32_t*>(out.uv.data());
    const bool one_pixel_each = s.options.coverage == Coverage::nearest;
    for (std::size_t begin = 0; begin < pixels; begin += kChunk) {
        const std::size_t n = std::min(kChunk, pixels - begin);
        registration::Projected projected = {uv + begin, s.cell.data() + begin,
                                             s.key.data() + begin};
        if (!one_pixel_each) {
            projected.u = s.u.data() + begin;
            projected.v = s.v.data() + begin;
            projected.z = s.z_in_color.data() + begin;
        }
        s.decode(frame, range, begin, n, z);
        s.project(z + begin, begin, n, projected);
        if (one_pixel_each) scatter_nearest(projected.cell, projected.key, n, z_buffer);
    }
    if (!one_pixel_each) s.draw(z, uv, z_buffer);
    const auto finish = [&] {
        if (s.options.fill_holes_px > 0)
            s.holes.fill(out.depth_in_color_m, s.options.fill_holes_px);
        return Result<void>{};
    };
    if (!s.options.occlusion_test) return finish();

    const registration::Occlusion occlusion = {static_cast<float>(s.options.occlusion_margin_m),
                                               2 * quantisation_step_m(1.0f)};
    if (s.cell_px > 1) {
        s.scatter_coarse();
        s.run->occlude(occlusion, s.coarse_cell.data(), s.key.data(), pixels, s.coarse_z.data(),
                       uv);
    } else {
        s.run->occlude(occlusion, s.cell.data(), s.key.data(), pixels, z_buffer, uv);
    }
    return finish();
}

}  // namespace kino
