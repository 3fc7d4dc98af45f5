#include "apps/bench/stage_player.h"

#include <algorithm>
#include <glm/gtc/packing.hpp>

#include "tests/viz/host_copies.h"

namespace kino::bench {

StagePlayer::StagePlayer(gpu::Device& device)
    : device_(device),
      pipelines_(device),
      executor_(device, pipelines_),
      live_(device),
      meshes_(device),
      bvh_(device) {}

StagePlayer::~StagePlayer() {
    device_.wait_idle();
}

Result<StagePlayer::Drawn> StagePlayer::draw(const Scene& scene, const View& view,
                                             const StageOptions& options, bool read,
                                             graph::Timing timing) {
    if (scene.live && scene.live->surface) KINO_TRY(live_.upload(*scene.live->surface));
    KINO_TRY(meshes_.upload(scene));
    if (wants_ray_shadows(scene)) {
        KINO_TRY(bvh_.upload(scene, {.live_columns = options.shadows.live_columns}));
    }
    graph::FrameGraph graph(executor_.history());
    const Stage stage = add_stage(graph, scene, view, {live_, meshes_, bvh_}, options);
    graph.require(stage.linear);
    const std::size_t pixels =
        static_cast<std::size_t>(view.width) * static_cast<std::size_t>(view.height);
    if (read) {
        if (readback_.bytes() < pixels * 8) {
            readback_ = gpu::Buffer();
            KINO_ASSIGN(readback_, gpu::Buffer::create(device_, "stage readback", pixels * 8,
                                                       gpu::MemoryUse::readback));
        }
        test::read_back(graph, stage.linear, readback_);
    }
    Drawn drawn;
    KINO_ASSIGN(const graph::FrameReport report, executor_.run(graph, timing));
    drawn.ms = to_ms(report.submit_to_fence);
    drawn.transient_bytes = report.transient_bytes;
    drawn.groups = executor_.group_times();
    if (read) {
        drawn.linear.resize(view.width, view.height);
        const auto halves = readback_.read<std::uint64_t>().first(pixels);
        std::transform(halves.begin(), halves.end(), drawn.linear.pixels().begin(),
                       [](std::uint64_t bits) { return glm::unpackHalf4x16(bits); });
    }
    return drawn;
}

Image<glm::dvec3> StagePlayer::shown(const Scene& scene, const Image<glm::vec4>& linear) {
    constexpr double kKnee = 0.7;
    Image<glm::dvec3> shown(linear.width(), linear.height());
    for (std::size_t i = 0; i < linear.size(); ++i) {
        const glm::vec4 c = linear.pixels()[i];
        for (int k = 0; k < 3; ++k) {
            double v = c[k];
            if (c.a > 0) {
                v *= scene.exposure;
                const double over = std::max(v - kKnee, 0.0);
                v = std::min(v, kKnee) + (1 - kKnee) * over / (over + 1 - kKnee);
            }
            shown.pixels()[i][k] = std::clamp(v, 0.0, 1.0);
        }
    }
    return shown;
}

}  // namespace kino::bench
