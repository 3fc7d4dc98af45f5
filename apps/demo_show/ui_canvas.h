#pragma once

#include <glm/vec2.hpp>
#include <glm/vec4.hpp>
#include <span>
#include <string_view>

struct ImDrawList;

namespace kino {

/// The picture as something to write and draw lines on, over all else; px, colours sRGB with alpha.
/// Valid between the begin and the end of a UiContext's frame.
class UiCanvas {
  public:
    UiCanvas(int width, int height);

    [[nodiscard]] glm::vec2 size() const { return size_; }
    /// A length as a part of the picture's height.
    [[nodiscard]] float high(float part) const { return part * size_.y; }

    void line(std::span<const glm::vec2> points, glm::vec4 color, float width) const;
    void filled(std::span<const glm::vec2> convex, glm::vec4 color) const;
    void disc(glm::vec2 middle, float radius, glm::vec4 color) const;
    void ring(glm::vec2 middle, float radius, glm::vec4 color, float width) const;
    /// Clockwise from the top; `part` of the whole ring.
    void part_ring(glm::vec2 middle, float radius, float part, glm::vec4 color, float width) const;
    void plate(glm::vec2 from, glm::vec2 to, glm::vec4 color, float rounding) const;
    /// One line of text of this height about `middle`, with a dark rim so that it can be read over
    /// anything; narrower where it would not fit into the picture. Never leaves the picture.
    void words(std::string_view text, glm::vec2 middle, float height, glm::vec4 color) const;
    /// The same from a left edge, without a rim.
    void words_from(std::string_view text, glm::vec2 left_middle, float height,
                    glm::vec4 color) const;
    [[nodiscard]] float width_of(std::string_view text, float height) const;

  private:
    glm::vec2 size_;
    ImDrawList* list_;
};

}  // namespace kino
