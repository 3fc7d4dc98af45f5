#include "tests/scenes/depth_scene.h"

#include "calibration/color_in_depth.h"
#include "calibration/rig.h"
#include "sensor/color_conversion.h"
#include "sensor/source.h"

namespace kino::test {

std::uint64_t next_version() {
    static std::uint64_t version = 0;
    return ++version;
}

Result<RecordedScene> load_recording(const std::string& uri, std::int64_t frame) {
    RecordedScene out;
    KINO_ASSIGN(const std::unique_ptr<Source> source, open_source(uri));
    KINO_ASSIGN(out.rig, source->calibration());
    KINO_TRY(subscribe_all(*source));
    KINO_TRY(source->timeline()->seek(frame));
    KINO_ASSIGN(const std::optional<FrameSet> set, source->next(0));
    if (!set) return fail("no frame", uri);
    KINO_ASSIGN(Rig rig, Rig::create(out.rig));
    RegisteredDepth registered;
    KINO_TRY(rig.register_depth(*set->depth, registered));
    auto surface = std::make_shared<DepthSurface>();
    surface->depth_m = registered.depth_m;
    surface->rays = std::make_shared<Image<RayXy>>(rig.depth_rays());
    surface->focal_px = out.rig.depth.fx;
    surface->version = next_version();
    if (set->color && out.rig.color) {
        Image<Rgba8> color;
        KINO_TRY(to_rgba8(*set->color, color));
        register_color(registered.uv, color, ColorSampling::bilinear, surface->color);
    }
    out.scene.live = LiveDepth{.surface = surface,
                               .world_from_depth = set->world_from_depth,
                               .previous_world_from_depth = set->world_from_depth};
    return out;
}

}  // namespace kino::test
