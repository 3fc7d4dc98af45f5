#pragma once

#include <algorithm>
#include <cmath>
#include <glm/gtc/quaternion.hpp>
#include <glm/vec2.hpp>

#include "base/camera_model.h"
#include "base/pose.h"
#include "calibration/boards/board.h"
#include "calibration/boards/grey_picture.h"
#include "calibration/projection.h"
#include "tests/support/random.h"

namespace kino::test {

/// Rays through the pixels' centres, a column and a row more than the picture has; kept for the
/// camera that asks next. Only for cameras whose whole picture has rays.
inline const Image<glm::dvec2>& pixel_rays(const CameraModel& camera) {
    static CameraModel known;
    static Image<glm::dvec2> rays;
    if (known == camera) return rays;
    const Projection projection(camera);
    rays.resize(camera.width + 1, camera.height + 1);
    for (int y = 0; y <= camera.height; ++y) {
        for (int x = 0; x <= camera.width; ++x) {
            rays.at(x, y) = projection.unproject_clamped({x, y});
        }
    }
    known = camera;
    return rays;
}

/// A chessboard drawn by casting 4 x 4 rays a pixel: dark squares where column + row is even, a
/// bright margin of a square, grey around. Gaussian noise of a few grey levels.
inline GreyPicture draw_chessboard(const CameraModel& camera, const Board& board,
                                   const Pose& camera_from_board, std::uint64_t seed) {
    const Image<glm::dvec2>& rays = pixel_rays(camera);
    const Pose board_from_camera = inverse(camera_from_board);
    const glm::dvec3 eye = board_from_camera.translation;
    const glm::dmat3 turn = glm::mat3_cast(board_from_camera.rotation);
    const auto brightness = [&](const glm::dvec2& ray) -> double {
        const glm::dvec3 way = turn * glm::dvec3(ray, 1);
        if (std::abs(way.z) < 1e-9) return 128;
        const glm::dvec3 at = eye - way * (eye.z / way.z);
        const double x = at.x / board.square_m + 1;
        const double y = at.y / board.square_m + 1;
        if (x < -1 || y < -1 || x > board.columns + 2 || y > board.rows + 2) return 128;
        if (x < 0 || y < 0 || x > board.columns + 1 || y > board.rows + 1) return 230;
        return (static_cast<int>(x) + static_cast<int>(y)) % 2 == 0 ? 30 : 230;
    };
    Random random(seed);
    GreyPicture out(camera.width, camera.height);
    for (int y = 0; y < camera.height; ++y) {
        for (int x = 0; x < camera.width; ++x) {
            // Within a pixel the lens bends nothing that could be seen.
            const glm::dvec2 ray = rays.at(x, y);
            const glm::dvec2 right = (rays.at(x + 1, y) - ray) / 4.0;
            const glm::dvec2 down = (rays.at(x, y + 1) - ray) / 4.0;
            double sum = 0;
            for (int i = 0; i < 16; ++i) {
                sum += brightness(ray + (i % 4 - 1.5) * right + (i / 4 - 1.5) * down);
            }
            const double noise = 3 * (random.real(-1, 1) + random.real(-1, 1));
            out.at(x, y) = static_cast<std::uint8_t>(std::clamp(sum / 16 + noise, 0.0, 255.0));
        }
    }
    return out;
}

/// Mean of a square of (2 reach + 1)^2 pixels, twice.
inline GreyPicture blurred(const GreyPicture& picture, int reach) {
    GreyPicture out = picture;
    for (int pass = 0; pass < 2; ++pass) {
        const GreyPicture from = out;
        for (int y = 0; y < out.height(); ++y) {
            for (int x = 0; x < out.width(); ++x) {
                int sum = 0;
                int count = 0;
                for (int dy = -reach; dy <= reach; ++dy) {
                    for (int dx = -reach; dx <= reach; ++dx) {
                        if (!from.contains(x + dx, y + dy)) continue;
                        sum += from.at(x + dx, y + dy);
                        ++count;
                    }
                }
                out.at(x, y) = static_cast<std::uint8_t>(sum / count);
            }
        }
    }
    return out;
}

}  // namespace kino::test
