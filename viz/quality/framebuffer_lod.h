#pragma once

#include <cstdint>

#include "viz/graph/graph.h"
#include "viz/scene/view.h"
#include "viz/surface/depth_rasterizer.h"

namespace kino {

/// How a coarse picture is brought to full size (Yang, Sander, Lawrence, "Geometry-Aware
/// Framebuffer Level of Detail", EGSR 2008).
enum class Reconstruction : std::uint8_t { bilinear, geometry_aware };
/// Distance of a fine pixel i from a coarse one j along depth.
enum class RangeMetric : std::uint8_t {
    depth,      ///< |z_i - z_j|, metres; sigma_z in metres, too
    log_depth,  ///< |ln z_i - ln z_j|
    plane       ///< |n_i . (P_i - P_j)| / z_i: a slanted surface is one surface
};
enum class LodFormat : std::uint8_t {
    packed,  ///< guides in one word: depth in steps of 0.015 %, normals in 8 + 8 bits
    wide     ///< everything as it is: the reference of the packed kernel
};

/// How coarse pixels count by their distance along the picture.
enum class LodKernel : std::uint8_t {
    tent,  ///< over 2x2 coarse pixels: bilinear
    gauss  ///< over 4x4, sigma 0.7 coarse pixels: smoother, and every pixel is weighed (no tiles)
};

struct FramebufferLodOptions {
    double r = 2;  ///< resizing factor, at least 1
    /// Memory is made for any factor from here to r, so that a factor that changes every frame
    /// allocates nothing; the picture does not depend on it. 0, or above r: for r alone.
    double least_r = 0;
    Reconstruction reconstruction = Reconstruction::geometry_aware;
    RangeMetric metric = RangeMetric::plane;
    float sigma_z = 0.02f;  ///< relative; infinite: depth does not count
    float sigma_n = 0.25f;  ///< of n.xy / n.z; infinite: normals do not count
    /// Divide the coarse light by its albedo and multiply by the fine one (fine-grained resizing).
    bool fine_grained = true;
    LodFormat format = LodFormat::packed;
    LodKernel kernel = LodKernel::tent;  ///< geometry-aware only
    /// Tiles whose coarse neighbours differ by less than this many sigmas are resized without
    /// guides; 0: every pixel is weighed. Packed only.
    float flat_tolerance = 0.5f;
    /// At most this share of the picture's pixels is listed for shading at full rate, those that no
    /// coarse pixel resembles; 0: none, and nothing is spent on it. Geometry-aware only.
    float fix_share = 0;
    /// Pixels less confident than this are listed; in (0, 1).
    float fix_confidence = 0.05f;
};

/// True where pixels may be listed for shading at full rate.
[[nodiscard]] bool wants_fixes(const FramebufferLodOptions& options);

/// The coarse picture's size, ceil(fine / r), then even, and not below 64x48 nor above the fine
/// one.
struct LodSize {
    int width = 0;
    int height = 0;
    friend bool operator==(const LodSize&, const LodSize&) = default;
};
[[nodiscard]] LodSize lod_size(int width, int height, double r);

/// The view a coarse picture of `size` shows. Coarse pixel j stands at fine pixel
///   c(j) = (j + 1/2) W / Lw - 1/2 + b,  b = 1 / (2 q) if p is even, else 0, W / Lw = p / q,
/// and its guides come from fine texel floor((j + 1/2) W / Lw), the nearest. b centres what the
/// rounding leaves: at whole W / Lw each coarse pixel sees exactly its texel's ray. At others it
/// lies up to half a fine pixel off; see add_coarse_surface.
[[nodiscard]] View coarse_view(const View& fine, const LodSize& size);

/// A coarse surface whose texels were picked from the fine one, and the view that fits it.
struct CoarseSurface {
    SurfaceTargets surface;
    View view;
    graph::TextureId guide;  ///< R32UI, viz/quality/lod_shared.h; packed geometry-aware only
    /// How far its points may lie off the surface they were picked from, as a share of their depth:
    /// where a plane cannot be followed, up to the way between a texel and the coarse pixel.
    float off_surface = 0;
};

/// Picks the coarse surface, one fine texel for each coarse one, never averaged; one pass. Where
/// the coarse pixel's ray is not the texel's, view_z is where it meets the texel's own plane, so
/// that the shaded point lies on the surface and on the ray. fine_grained: the albedo is at least
/// 32/255, so that light can be told from it everywhere. Depths that are no distance become 0.
/// With lod_size() equal to the fine size: no pass, the fine surface and view.
/// `fine` must have albedo, view_z and normal, and the size of `view`.
[[nodiscard]] CoarseSurface add_coarse_surface(graph::FrameGraph& graph, const SurfaceTargets& fine,
                                               const View& view,
                                               const FramebufferLodOptions& options);

/// Pixels to be shaded anew: the third pass of the source's outlook.
struct LodFixList {
    graph::BufferId pixels;  ///< y << 16 | x, in the order of rows; the same list every run
    /// shared::LodFixState (lod_fix_shared.h): a dispatch of groups of 64 at byte 0, then the
    /// count.
    graph::BufferId state;
    std::uint32_t cap = 0;  ///< most pixels
    [[nodiscard]] bool valid() const { return pixels.valid(); }
};

/// How a picture that is brought to full size is finished on the way, as add_final_pass()
/// (viz/light/light_passes.h) would do it afterwards.
struct LodFinish {
    graph::TextureId target;  ///< of the fine size, RGBA8 or BGRA8; all of it is written
    float exposure = 1;
    bool tone_map = true;
};

/// Brings `coarse_linear` (RGBA16F, shaded from `coarse`) to the size of the fine surface: RGBA16F,
/// alpha that of the fine albedo. With sigma_z finite, pixels whose albedo has alpha 0 (nothing
/// there) keep their own colour, made linear. Different objects do not mix (packed: objects whose
/// tags differ, 2047 of 2048; viz/quality/lod_object.glsl). Every output is finite for every input.
/// With the fine size: no pass, `coarse_linear` itself. With `fix` and fix_share above 0, *fix
/// becomes the list of pixels whose confidence, the sum of Eq. 1's weights, is below
/// fix_confidence; the most doubtful of them where there are too many. The picture can then be
/// written by compute shaders. With `finish` (not where a list is wanted) the picture goes there,
/// finished, and its id is returned; no linear one is made.
[[nodiscard]] graph::TextureId add_reconstruction(
    graph::FrameGraph& graph, graph::TextureId coarse_linear, const CoarseSurface& coarse,
    const SurfaceTargets& fine, const View& view, const FramebufferLodOptions& options,
    LodFixList* fix = nullptr, const LodFinish* finish = nullptr);

}  // namespace kino
