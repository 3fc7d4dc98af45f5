#include "tests/support/random.h"

#include <cmath>

#include "base/check.h"

namespace kino::test {

std::uint64_t Random::bits() {
    state_ += 0x9E3779B97F4A7C15u;
    std::uint64_t z = state_;
    z = (z ^ (z >> 30)) * 0xBF58476D1CE4E5B9u;
    z = (z ^ (z >> 27)) * 0x94D049BB133111EBu;
    return z ^ (z >> 31);
}

double Random::real(double from, double to) {
    const double unit = static_cast<double>(bits() >> 11) * 0x1p-53;
    return from + unit * (to - from);
}

int Random::integer(int from, int to) {
    KINO_CHECK_LE(from, to);
    const auto count = static_cast<std::uint64_t>(static_cast<std::int64_t>(to) - from + 1);
    return static_cast<int>(from + static_cast<std::int64_t>(bits() % count));
}

bool Random::chance(double probability) {
    return real(0, 1) < probability;
}

Image<Rgba8> random_rgba8(int width, int height, std::uint64_t seed) {
    Random random(seed);
    Image<Rgba8> image(width, height);
    for (Rgba8& pixel : image.pixels()) {
        const std::uint64_t bits = random.bits();
        pixel = {static_cast<std::uint8_t>(bits), static_cast<std::uint8_t>(bits >> 8),
                 static_cast<std::uint8_t>(bits >> 16), static_cast<std::uint8_t>(bits >> 24)};
    }
    return image;
}

Image<Rgba8> random_picture(int width, int height, std::uint64_t seed) {
    Random random(seed);
    const double angle = random.real(0.1, 1.4);
    const double wave_px = random.real(8, 40);
    const int edge_x = random.integer(0, width);
    const int edge_y = random.integer(0, height);
    Image<Rgba8> image(width, height);
    for (int y = 0; y < height; ++y) {
        for (int x = 0; x < width; ++x) {
            const double along = (std::cos(angle) * x + std::sin(angle) * y) / wave_px;
            const int step = (x < edge_x) != (y < edge_y) ? 70 : 0;
            const auto level = [&](double phase) {
                return static_cast<std::uint8_t>(92.5 + 90 * std::sin(along + phase) + step);
            };
            image.at(x, y) = {level(0), level(2), level(4), 255};
        }
    }
    return image;
}

Image<std::uint16_t> random_raw_depth(int width, int height, std::uint64_t seed, int from, int to,
                                      double holes) {
    KINO_CHECK(from >= 0 && to <= 0xFFFF);
    Random random(seed);
    Image<std::uint16_t> image(width, height);
    for (std::uint16_t& reading : image.pixels()) {
        const int value = random.integer(from, to);
        reading = random.chance(holes) ? std::uint16_t{0} : static_cast<std::uint16_t>(value);
    }
    return image;
}

}  // namespace kino::test
