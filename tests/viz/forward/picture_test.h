#pragma once

#include <algorithm>
#include <cmath>

#include "tests/viz/forward/solid_scene.h"
#include "tests/viz/viz_fixture.h"

namespace kino::test {

/// Pictures by one renderer for the whole program: its pipelines take longer to make than most
/// tests.
class PictureTest : public VizTest {
  protected:
    static Renderer& renderer() {
        static auto* made = new Renderer(device());
        return *made;
    }
    static FrameResult draw(const Scene& scene, const View& view, const FrameOptions& options) {
        auto frame = renderer().render_to_image(scene, view, options);
        EXPECT_TRUE(frame) << (frame ? "" : frame.error().to_string());
        return frame ? std::move(*frame) : FrameResult{};
    }
    /// One picture for each of Vulkan's samples, taken through the middle of its pixels.
    static std::vector<Image<Rgba8>> sample_pictures(const Scene& scene, const View& view) {
        std::vector<Image<Rgba8>> pictures;
        for (const auto& place : kSamplePlaces) {
            pictures.push_back(draw(scene, moved_by(view, place[0], place[1]), {}).picture);
        }
        return pictures;
    }
};

inline glm::dvec3 numbers(Rgba8 p) {
    return {p.r, p.g, p.b};
}

inline double largest(const glm::dvec3& v) {
    return std::max({std::abs(v.x), std::abs(v.y), std::abs(v.z)});
}

/// Colours that tell surfaces apart and nothing else.
inline Scene flat(Scene scene) {
    for (Material& material : scene.materials) material.kind = MaterialKind::unlit;
    scene.lights.clear();
    return scene;
}

}  // namespace kino::test
