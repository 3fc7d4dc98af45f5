#include "tests/sensor/device/fake_kinect/feed.h"

#include <cstddef>

#include "tests/sensor/device/fake_kinect/bits.h"

namespace kino::fake {
namespace {

std::size_t area(int width, int height) {
    return static_cast<std::size_t>(width) * static_cast<std::size_t>(height);
}

class NoiseFeed : public Feed {
  public:
    explicit NoiseFeed(std::uint64_t seed) : base_(area(1280, 1024)) {
        for (std::size_t i = 0; i < base_.size(); i += 4) {
            std::uint64_t random = mix(seed, i);
            for (std::size_t k = i; k < i + 4; ++k, random >>= 16) {
                base_[k] = static_cast<std::uint16_t>(random);
            }
        }
    }

    // A step that has no common divisor with the modulus visits every value before it repeats.
    std::vector<std::uint16_t> depth(int n) const override {
        const unsigned shift = static_cast<unsigned>(n) * 61 % 2047;
        std::vector<std::uint16_t> values(area(640, 480));
        for (std::size_t i = 0; i < values.size(); ++i) {
            const unsigned below = base_[i] & 2047u;
            const unsigned value = (below == 2047 ? 0 : below) + shift;
            values[i] = static_cast<std::uint16_t>(value >= 2047 ? value - 2047 : value);
        }
        return values;
    }
    std::vector<std::uint8_t> bayer(int n, int width, int height) const override {
        return bytes(area(width, height), n);
    }
    std::vector<std::uint16_t> infrared(int n, int width, int height) const override {
        std::vector<std::uint16_t> values(area(width, height));
        const unsigned shift = static_cast<unsigned>(n) * 37;
        for (std::size_t i = 0; i < values.size(); ++i) {
            values[i] = static_cast<std::uint16_t>((base_[i] + shift) & 1023);
        }
        return values;
    }
    std::vector<std::uint8_t> uyvy(int n) const override { return bytes(area(1280, 480), n); }

  private:
    std::vector<std::uint8_t> bytes(std::size_t count, int n) const {
        std::vector<std::uint8_t> values(count);
        const unsigned shift = static_cast<unsigned>(n) * 101;
        for (std::size_t i = 0; i < count; ++i) {
            values[i] = static_cast<std::uint8_t>((base_[i] >> 8) + shift);
        }
        return values;
    }

    std::vector<std::uint16_t> base_;
};

class SceneFeed : public Feed {
  public:
    std::vector<std::uint16_t> depth(int n) const override {
        std::vector<std::uint16_t> values(area(640, 480));
        for (int y = 0; y < 480; ++y) {
            for (int x = 0; x < 640; ++x) {
                const bool hole = x >= 600 || (y > 200 && y < 240 && x > 100 && x < 180);
                const int near = 600 + (y + n * 3) % 200 + x / 16;
                values[static_cast<std::size_t>(y * 640 + x)] =
                    static_cast<std::uint16_t>(hole ? 2047 : near);
            }
        }
        return values;
    }
    std::vector<std::uint8_t> bayer(int n, int width, int height) const override {
        std::vector<std::uint8_t> values(area(width, height));
        for (int y = 0; y < height; ++y) {
            for (int x = 0; x < width; ++x) {
                const int site = (x & 1) + 2 * (y & 1);
                values[static_cast<std::size_t>(y * width + x)] =
                    static_cast<std::uint8_t>(x / 8 + y / 4 + n * 5 + site * 20);
            }
        }
        return values;
    }
    std::vector<std::uint16_t> infrared(int n, int width, int height) const override {
        std::vector<std::uint16_t> values(area(width, height));
        for (int y = 0; y < height; ++y) {
            for (int x = 0; x < width; ++x) {
                values[static_cast<std::size_t>(y * width + x)] =
                    static_cast<std::uint16_t>((x + y / 2 + n * 7) & 1023);
            }
        }
        return values;
    }
    std::vector<std::uint8_t> uyvy(int n) const override {
        std::vector<std::uint8_t> values(area(1280, 480));
        for (std::size_t i = 0; i < values.size(); ++i) {
            values[i] = static_cast<std::uint8_t>(
                i % 2 == 0 ? 128 + n % 3 : 16 + (i / 2 + 9u * static_cast<unsigned>(n)) % 220);
        }
        return values;
    }
};

}  // namespace

std::unique_ptr<Feed> noise_feed(std::uint64_t seed) {
    return std::make_unique<NoiseFeed>(seed);
}
std::unique_ptr<Feed> scene_feed() {
    return std::make_unique<SceneFeed>();
}

}  // namespace kino::fake
