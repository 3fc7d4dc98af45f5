#include "apps/headless/kept_pictures.h"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

namespace kino {

bool keeps_picture(std::int64_t i, std::int64_t frames, std::int64_t most) {
    if (most < 0 || frames <= most) return true;
    if (most < 2) return most == 1 && i == 0;
    // Small enough that the products below fit.
    most = std::min<std::int64_t>(most, 1'000'000);
    const std::int64_t k = (i * (most - 1) + frames - 2) / (frames - 1);
    return k * (frames - 1) / (most - 1) == i;
}

std::string picture_name(std::int64_t i) {
    return fmt::format("frame-{:05}.png", i);
}

std::uint64_t hash_picture(const Image<Rgba8>& picture, std::uint64_t hash) {
    constexpr std::uint64_t kPrime = 0x100000001b3ull;
    for (const Rgba8& p : picture.pixels()) {
        for (const std::uint8_t byte : {p.r, p.g, p.b, p.a}) hash = (hash ^ byte) * kPrime;
    }
    return hash;
}

Result<void> RunVideo::add(const Image<Rgba8>& picture, TimeNs duration) {
    if (!std::exchange(tried_, true)) {
        auto video = VideoWriter::create(folder_ / "video.mp4", picture.width(), picture.height());
        if (video) {
            video_.emplace(std::move(*video));
        } else {
            fmt::print(stderr, "kinoscope: no video: {}\n", video.error().to_string());
        }
    }
    if (!video_) return {};
    return video_->add(picture.view(), duration);
}

Result<void> RunVideo::finish() {
    if (!video_) return {};
    return video_->finish();
}

}  // namespace kino
