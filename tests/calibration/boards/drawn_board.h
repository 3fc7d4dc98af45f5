#pragma once

#include <algorithm>
#include <cmath>
#include <glm/vec2.hpp>
#include <optional>

#include "base/camera_model.h"
#include "base/pose.h"
#include "calibration/boards/board.h"
#include "calibration/boards/grey_picture.h"
#include "calibration/projection.h"
#include "tests/support/random.h"

namespace kino::test {

/// A chessboard drawn by casting 4 x 4 rays a pixel: dark squares where column + row is even, a
/// bright margin of a square, grey around. Gaussian noise of a few grey levels.
inline GreyPicture draw_chessboard(const CameraModel& camera, const Board& board,
                                   const Pose& camera_from_board, std::uint64_t seed) {
    const Projection projection(camera);
    const Pose board_from_camera = inverse(camera_from_board);
    const auto brightness = [&](const glm::dvec2& px) -> double {
        const auto ray = projection.unproject(px);
        if (!ray) return 128;
        const glm::dvec3 eye = board_from_camera.translation;
        const glm::dvec3 way = board_from_camera.rotation * glm::dvec3(*ray, 1);
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
            double sum = 0;
            for (int i = 0; i < 16; ++i) {
                sum += brightness({x + (i % 4 - 1.5) / 4, y + (i / 4 - 1.5) / 4});
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
