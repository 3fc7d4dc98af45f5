#include "apps/bench/sample_pictures.h"

#include <cmath>
#include <glm/gtc/matrix_transform.hpp>
#include <utility>

namespace kino::bench {

MeshNode standing_node(std::shared_ptr<const MeshAsset> mesh, const glm::dvec3& at, double turn,
                       std::uint32_t material, std::uint32_t id) {
    MeshNode node{.id = id, .mesh = std::move(mesh), .material = material};
    node.world_from_object =
        glm::rotate(glm::translate(glm::dmat4(1), at), turn, glm::dvec3(0.2, 1, 0.1));
    return node;
}

Result<Image<glm::dvec3>> mean_of_pictures(StagePlayer& player, const Scene& scene,
                                           const View& view, int side) {
    Image<glm::dvec3> mean(view.width, view.height);
    for (int i = 0; i < side * side; ++i) {
        View at = view;
        at.projection.cx -= static_cast<float>((i % side + 0.5) / side - 0.5);
        at.projection.cy -= static_cast<float>((i / side + 0.5) / side - 0.5);
        KINO_ASSIGN(const auto drawn, player.draw(scene, at, {}, true));
        const auto shown = StagePlayer::shown(scene, drawn.linear);
        for (std::size_t k = 0; k < mean.size(); ++k) {
            mean.pixels()[k] += shown.pixels()[k] / static_cast<double>(side * side);
        }
    }
    return mean;
}

double coded_srgb(double linear) {
    return linear <= 0.0031308 ? 12.92 * linear : 1.055 * std::pow(linear, 1 / 2.4) - 0.055;
}

}  // namespace kino::bench
