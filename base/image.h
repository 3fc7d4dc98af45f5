#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "base/check.h"

namespace kino {

/// A rectangle of pixels somebody else owns. `pitch` counts elements from row to row, so padded
/// driver rows need no copy to be read.
template <class T>
struct ImageView {
    T* data = nullptr;
    int width = 0;
    int height = 0;
    std::ptrdiff_t pitch = 0;

    [[nodiscard]] T* row(int y) const { return data + y * pitch; }
    [[nodiscard]] T& at(int x, int y) const { return row(y)[x]; }
};

/// Pixels by rows, top row first, without padding. x runs right, y down, pixel centres are at
/// integer coordinates (base/camera_model.h).
template <class T>
class Image {
  public:
    Image() = default;
    Image(int width, int height, T fill = T{})
        : width_(width),
          height_(height),
          pixels_(static_cast<std::size_t>(width) * static_cast<std::size_t>(height), fill) {}

    [[nodiscard]] int width() const { return width_; }
    [[nodiscard]] int height() const { return height_; }
    [[nodiscard]] bool empty() const { return pixels_.empty(); }
    [[nodiscard]] std::size_t size() const { return pixels_.size(); }

    [[nodiscard]] T* data() { return pixels_.data(); }
    [[nodiscard]] const T* data() const { return pixels_.data(); }
    [[nodiscard]] std::span<T> pixels() { return pixels_; }
    [[nodiscard]] std::span<const T> pixels() const { return pixels_; }

    [[nodiscard]] T* row(int y) { return pixels_.data() + offset(0, y); }
    [[nodiscard]] const T* row(int y) const { return pixels_.data() + offset(0, y); }
    [[nodiscard]] T& at(int x, int y) { return pixels_[offset(x, y)]; }
    [[nodiscard]] const T& at(int x, int y) const { return pixels_[offset(x, y)]; }
    [[nodiscard]] bool contains(int x, int y) const {
        return x >= 0 && y >= 0 && x < width_ && y < height_;
    }

    /// Changes the size, keeping the allocation where it is large enough; pixels are unspecified.
    void resize(int width, int height) {
        width_ = width;
        height_ = height;
        pixels_.resize(static_cast<std::size_t>(width) * static_cast<std::size_t>(height));
    }
    void fill(T value) { pixels_.assign(pixels_.size(), value); }

    [[nodiscard]] ImageView<T> view() { return {data(), width_, height_, width_}; }
    [[nodiscard]] ImageView<const T> view() const { return {data(), width_, height_, width_}; }

    friend bool operator==(const Image&, const Image&) = default;

  private:
    [[nodiscard]] std::size_t offset(int x, int y) const {
        return static_cast<std::size_t>(y) * static_cast<std::size_t>(width_) +
               static_cast<std::size_t>(x);
    }

    int width_ = 0;
    int height_ = 0;
    std::vector<T> pixels_;
};

struct Rgba8 {
    std::uint8_t r = 0, g = 0, b = 0, a = 255;
    friend bool operator==(const Rgba8&, const Rgba8&) = default;
};
static_assert(sizeof(Rgba8) == 4);

}  // namespace kino
