#include "skeleton/forest/training_set.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <optional>
#include <thread>

#include "base/check.h"
#include "skeleton/forest/training_random.h"

namespace kino {
namespace {

// Every listed pixel is taken with the chance that makes the number come out right (Knuth, The Art
// of Computer Programming 2, 3.4.2, algorithm S); the order stays.
void draw_plain(std::size_t listed, std::size_t wanted, TrainingRandom& random,
                std::vector<std::size_t>& out) {
    for (std::size_t i = 0; i < listed && wanted > 0; ++i) {
        if (random.below(listed - i) >= wanted) continue;
        out.push_back(i);
        --wanted;
    }
}

void draw_balanced(const std::vector<std::uint8_t>& labels, std::size_t wanted,
                   TrainingRandom& random, std::vector<std::size_t>& out) {
    std::array<std::vector<std::size_t>, kForestMaxLabels> of_label;
    for (std::size_t i = 0; i < labels.size(); ++i) of_label[labels[i]].push_back(i);
    std::vector<const std::vector<std::size_t>*> present;
    for (const auto& pixels : of_label)
        if (!pixels.empty()) present.push_back(&pixels);
    if (present.empty()) return;
    for (; wanted > 0; --wanted) {
        const auto& pixels = *present[random.below(present.size())];
        out.push_back(pixels[random.below(pixels.size())]);
    }
}

}  // namespace

void parallel_for(int threads, std::size_t count, const std::function<void(std::size_t)>& work) {
    std::atomic<std::size_t> next{0};
    const auto run = [&] {
        for (std::size_t i = next++; i < count; i = next++) work(i);
    };
    std::vector<std::jthread> helpers;
    const std::size_t wanted = std::min(static_cast<std::size_t>(threads), count);
    for (std::size_t t = 1; t < wanted; ++t) helpers.emplace_back(run);
    run();
}

std::int32_t feature_response(const forest::WalkImage& image, std::uint32_t xy, std::int32_t scale,
                              const ForestFeature& feature) {
    const auto x = static_cast<std::int32_t>(xy & 0xFFFF);
    const auto y = static_cast<std::int32_t>(xy >> 16);
    const auto depth = [&](const std::array<std::int16_t, 2>& o) -> std::int32_t {
        const std::int32_t px = x + ((o[0] * scale + (1 << 14)) >> 15);
        const std::int32_t py = y + ((o[1] * scale + (1 << 14)) >> 15);
        return image.depth[std::clamp<std::int32_t>(py, 0, image.max_y) * image.pitch +
                           std::clamp<std::int32_t>(px, 0, image.max_x)];
    };
    return depth(feature.u) - depth(feature.v);
}

Result<void> draw_pixels(const TrainingImages& images, std::int64_t index, const SampleDraw& draw,
                         TrainingImage& picture, DrawnPixels& out) {
    KINO_TRY(images.load(index, picture));
    if (picture.depth_mm.width() != picture.label.width() ||
        picture.depth_mm.height() != picture.label.height() || !(picture.focal_px > 0))
        return fail(fmt::format("picture {} is not sound", index));
    Image<std::uint8_t> mask(picture.label.width(), picture.label.height());
    std::transform(picture.label.pixels().begin(), picture.label.pixels().end(),
                   mask.pixels().begin(),
                   [](std::uint8_t l) { return static_cast<std::uint8_t>(l != kNotBody); });
    out.body.set(std::as_const(picture.depth_mm).view(), std::as_const(mask).view(), 1,
                 picture.focal_px);
    const std::size_t labels = images.labels().size();
    std::vector<std::uint8_t> label(out.body.count());
    for (std::size_t i = 0; i < label.size(); ++i) {
        label[i] = picture.label.at(out.body.x(i), out.body.y(i));
        if (label[i] >= labels)
            return fail(fmt::format("picture {} has a pixel with label {}", index, label[i]));
    }
    TrainingRandom random{draw.seed, draw.stream, static_cast<std::uint64_t>(index)};
    const auto pixels = static_cast<std::size_t>(draw.pixels);
    const auto balanced =
        static_cast<std::size_t>(draw.balanced_share * static_cast<double>(draw.pixels) + 0.5);
    std::vector<std::size_t> chosen;
    draw_plain(label.size(), pixels - balanced, random, chosen);
    draw_balanced(label, balanced, random, chosen);
    out.xy.clear();
    out.scale.clear();
    out.label.clear();
    for (const std::size_t i : chosen) {
        out.xy.push_back(out.body.pixels().xy[i]);
        out.scale.push_back(out.body.scale(i));
        out.label.push_back(label[i]);
    }
    return {};
}

Result<void> TrainingSet::load(const TrainingImages& images, std::int64_t first, std::int64_t count,
                               const SampleDraw& draw, int threads) {
    const auto size = static_cast<std::size_t>(count);
    depth_.assign(size, {});
    walk_images_.assign(size, {});
    samples_.clear();
    std::vector<std::vector<TrainingSample>> drawn(size);
    std::vector<std::optional<Error>> errors(size);
    parallel_for(threads, size, [&](std::size_t i) {
        thread_local TrainingImage picture;
        thread_local DrawnPixels pixels;
        const std::int64_t index = (first + static_cast<std::int64_t>(i)) % images.count();
        if (auto done = draw_pixels(images, index, draw, picture, pixels); !done) {
            errors[i] = done.error();
            return;
        }
        walk_images_[i] = pixels.body.image();
        const auto padded = pixels.body.padded();
        depth_[i].assign(padded.begin(), padded.end());
        walk_images_[i].depth = depth_[i].data();
        drawn[i].reserve(pixels.xy.size());
        for (std::size_t p = 0; p < pixels.xy.size(); ++p)
            drawn[i].push_back(
                {pixels.xy[p], static_cast<std::uint32_t>(i), pixels.scale[p], pixels.label[p]});
    });
    for (const auto& error : errors)
        if (error) return tl::unexpected<Error>(*error);
    std::size_t all = 0;
    for (const auto& list : drawn) all += list.size();
    samples_.reserve(all);
    for (const auto& list : drawn) samples_.insert(samples_.end(), list.begin(), list.end());
    return {};
}

}  // namespace kino
