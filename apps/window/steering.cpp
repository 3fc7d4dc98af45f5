#include "apps/window/steering.h"

#include <cmath>
#include <glm/geometric.hpp>
#include <utility>

#define GLFW_INCLUDE_NONE
#include <GLFW/glfw3.h>

namespace kino {
namespace {

constexpr double kTurnPerPixel = 0.005;  ///< rad
constexpr double kPanPerPixel = 0.0012;  ///< parts of the distance, or m in flight
constexpr double kWheelStep = 0.9;
constexpr double kClickPixels = 4;
constexpr double kFlightSpeed = 1.2;  ///< m/s

glm::dvec3 held_direction(const Window& window) {
    const auto axis = [&](int plus, int minus) {
        return (window.is_key_down(plus) ? 1.0 : 0.0) - (window.is_key_down(minus) ? 1.0 : 0.0);
    };
    return {axis(GLFW_KEY_D, GLFW_KEY_A), axis(GLFW_KEY_E, GLFW_KEY_Q),
            axis(GLFW_KEY_W, GLFW_KEY_S)};
}

}  // namespace

bool Steering::take_click() {
    return std::exchange(clicked_, false);
}

bool Steering::steer(Window& window, const WindowInput& input, bool ui_has_mouse, double dt_s,
                     CameraControl& camera) {
    for (const MouseButtonEvent& event : input.buttons) {
        if (event.down && !ui_has_mouse && dragging_ < 0) {
            dragging_ = event.button;
            last_ = event.at;
            dragged_px_ = 0;
        } else if (!event.down && event.button == dragging_) {
            if (event.button == GLFW_MOUSE_BUTTON_LEFT && dragged_px_ < kClickPixels)
                clicked_ = true;
            dragging_ = -1;
        }
    }
    bool moved = false;
    if (dragging_ >= 0) {
        const glm::dvec2 delta = input.cursor_px - last_;
        last_ = input.cursor_px;
        dragged_px_ += glm::length(delta);
        const bool turn = dragging_ == GLFW_MOUSE_BUTTON_LEFT;
        if (dragged_px_ >= kClickPixels && delta != glm::dvec2(0)) {
            moved = true;
            if (camera.kind == ViewKind::orbit && turn) {
                camera.orbit.turn(-kTurnPerPixel * delta.x, kTurnPerPixel * delta.y);
            } else if (camera.kind == ViewKind::orbit) {
                camera.orbit.pan({-kPanPerPixel * delta.x, kPanPerPixel * delta.y});
            } else if (camera.kind == ViewKind::fly && turn) {
                camera.fly.look(-kTurnPerPixel * delta.x, -kTurnPerPixel * delta.y);
            } else if (camera.kind == ViewKind::fly) {
                camera.fly.move({-kPanPerPixel * delta.x, kPanPerPixel * delta.y, 0});
            }
        }
    }
    if (input.scroll.y != 0 && !ui_has_mouse) {
        moved = true;
        if (camera.kind == ViewKind::orbit) {
            camera.orbit.zoom(std::pow(kWheelStep, input.scroll.y));
        } else if (camera.kind == ViewKind::fly) {
            camera.fly.move({0, 0, 0.15 * input.scroll.y});
        }
    }
    if (camera.kind == ViewKind::fly) {
        const glm::dvec3 direction = held_direction(window);
        if (direction != glm::dvec3(0)) {
            const bool fast =
                window.is_key_down(GLFW_KEY_LEFT_SHIFT) || window.is_key_down(GLFW_KEY_RIGHT_SHIFT);
            camera.fly.move(direction * (kFlightSpeed * dt_s * (fast ? 3 : 1)));
            moved = true;
        }
    }
    return moved;
}

}  // namespace kino
