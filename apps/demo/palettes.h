#pragma once

#include <array>
#include <cstddef>
#include <glm/vec3.hpp>
#include <string>
#include <vector>

namespace kino::demo {

constexpr std::size_t kPaletteColors = 6;

struct DemoPalette {
    std::string name;
    std::array<glm::vec3, kPaletteColors> linear;
};
/// In the order of swiping. The first one leaves the stage its own colours.
[[nodiscard]] const std::vector<DemoPalette>& demo_palettes();

/// Somebody's colours, which change over within half a second.
class Colors {
  public:
    void set(std::size_t palette);  ///< at once
    void turn_to(std::size_t palette) { palette_ = palette; }
    void step(double dt_s);
    [[nodiscard]] std::size_t palette() const { return palette_; }
    [[nodiscard]] const glm::vec3& at(std::size_t i) const { return now_[i % kPaletteColors]; }
    /// In between; 1 is once through.
    [[nodiscard]] glm::vec3 along(double rounds) const;
    /// The colour whose stretch this is.
    [[nodiscard]] static std::size_t index(double rounds);

  private:
    std::size_t palette_ = 0;
    std::array<glm::vec3, kPaletteColors> now_{};
};

}  // namespace kino::demo
