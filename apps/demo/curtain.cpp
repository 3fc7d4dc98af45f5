#include "apps/demo/curtain.h"

#include <algorithm>

namespace kino::demo {
namespace {

constexpr double kCloseS = 0.28, kDarkS = 0.12, kOpenS = 0.3;
constexpr double kAtOnce = 0.12;  // of the light goes in the very step

}  // namespace

void Curtain::close() {
    if (closing_ || dark_s_ > 0) {
        closing_ = true;
        return;
    }
    closing_ = true;
    light_ = std::max(0.0, light_ - kAtOnce);
}

bool Curtain::step(double dt_s) {
    if (closing_) {
        light_ = std::max(0.0, light_ - dt_s / kCloseS);
        if (light_ > 0) return false;
        closing_ = false;
        dark_s_ = kDarkS;
        return true;
    }
    if (dark_s_ > 0) {
        dark_s_ = std::max(0.0, dark_s_ - dt_s);
    } else {
        light_ = std::min(1.0, light_ + dt_s / kOpenS);
    }
    return false;
}

}  // namespace kino::demo
