#include "skeleton/forest/training_block.h"

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

Result<void> draw_samples(const TrainingImage& picture, const BodyDepth& body, std::size_t labels,
                          const SampleDraw& draw, std::uint64_t index, std::uint16_t image,
                          std::vector<TrainingSample>& out) {
    std::vector<std::uint8_t> label(body.count());
    for (std::size_t i = 0; i < label.size(); ++i) {
        label[i] = picture.label.at(body.x(i), body.y(i));
        if (label[i] >= labels)
            return fail(fmt::format("picture {} has a pixel with label {}", index, label[i]));
    }
    TrainingRandom random{draw.seed, draw.stream, index};
    const auto pixels = static_cast<std::size_t>(draw.pixels);
    const auto balanced =
        static_cast<std::size_t>(draw.balanced_share * static_cast<double>(draw.pixels) + 0.5);
    std::vector<std::size_t> chosen;
    draw_plain(label.size(), pixels - balanced, random, chosen);
    draw_balanced(label, balanced, random, chosen);
    out.clear();
    for (const std::size_t i : chosen)
        out.push_back({body.pixels().xy[i], body.scale(i), label[i], image, 0});
    return {};
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

Result<void> TrainingBlock::load(const TrainingImages& images, std::int64_t first, int count,
                                 const SampleDraw& draw, int threads) {
    KINO_CHECK(count > 0 && count <= 65536);
    const auto size = static_cast<std::size_t>(count);
    pictures_.resize(size);
    masks_.resize(size);
    bodies_.resize(size);
    walk_images_.resize(size);
    samples_.resize(size);
    const std::size_t labels = images.labels().size();
    std::vector<std::optional<Error>> errors(size);
    parallel_for(threads, size, [&](std::size_t i) {
        const std::int64_t index = (first + static_cast<std::int64_t>(i)) % images.count();
        TrainingImage& picture = pictures_[i];
        if (auto loaded = images.load(index, picture); !loaded) {
            errors[i] = loaded.error();
            return;
        }
        if (picture.depth_mm.width() != picture.label.width() ||
            picture.depth_mm.height() != picture.label.height() || !(picture.focal_px > 0)) {
            errors[i] = Error{fmt::format("picture {} is not sound", index), {}, {}};
            return;
        }
        masks_[i].resize(picture.label.width(), picture.label.height());
        std::transform(picture.label.pixels().begin(), picture.label.pixels().end(),
                       masks_[i].pixels().begin(),
                       [](std::uint8_t l) { return static_cast<std::uint8_t>(l != kNotBody); });
        bodies_[i].set(std::as_const(picture.depth_mm).view(), std::as_const(masks_[i]).view(), 1,
                       picture.focal_px);
        walk_images_[i] = bodies_[i].image();
        if (auto drawn =
                draw_samples(picture, bodies_[i], labels, draw, static_cast<std::uint64_t>(index),
                             static_cast<std::uint16_t>(i), samples_[i]);
            !drawn)
            errors[i] = drawn.error();
    });
    for (const auto& error : errors)
        if (error) return tl::unexpected<Error>(*error);
    return {};
}

void TrainingBlock::walk(const std::vector<ForestNode>& nodes, int threads) {
    parallel_for(threads, samples_.size(), [&](std::size_t i) {
        for (TrainingSample& s : samples_[i]) {
            std::int32_t at = 0;
            while (!nodes[static_cast<std::size_t>(at)].is_leaf()) {
                const ForestNode& n = nodes[static_cast<std::size_t>(at)];
                const std::int32_t response =
                    feature_response(walk_images_[i], s.xy, s.scale, n.feature);
                at = n.child + (response > n.threshold_mm ? 1 : 0);
            }
            s.node = at;
        }
    });
}

}  // namespace kino
