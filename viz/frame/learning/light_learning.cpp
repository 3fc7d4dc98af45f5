#include "viz/frame/learning/light_learning.h"

#include <algorithm>
#include <cmath>
#include <string_view>

#include "base/check.h"
#include "viz/quality/lod_learning.h"

namespace kino {
namespace {

constexpr std::array<std::uint32_t, 3> kLearnedParts = {kShadowedLights, kPlainLights,
                                                        kBouncedLights};

double group_ms(const graph::FrameReport& report, std::initializer_list<std::string_view> groups) {
    double sum = 0;
    for (const graph::GroupTime& time : report.groups) {
        if (std::find(groups.begin(), groups.end(), time.group) == groups.end()) continue;
        sum += std::max(time.ms, 0.0);
    }
    return sum;
}

PartRates only(std::uint32_t part, double r) {
    return {.shadowed = part == kShadowedLights ? r : 1,
            .plain = part == kPlainLights ? r : 1,
            .bounced = part == kBouncedLights ? r : 1};
}

double mean_square(const Image<Rgba8>& a, const Image<Rgba8>& b) {
    double sum = 0;
    for (std::size_t i = 0; i < a.size(); ++i) {
        const Rgba8 p = a.pixels()[i];
        const Rgba8 q = b.pixels()[i];
        sum += std::pow(p.r - q.r, 2) + std::pow(p.g - q.g, 2) + std::pow(p.b - q.b, 2);
    }
    return sum / (3.0 * static_cast<double>(std::max<std::size_t>(a.size(), 1)));
}

double median_of(std::vector<double> values) {
    if (values.empty()) return 0;
    const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
    std::nth_element(values.begin(), middle, values.end());
    return *middle;
}

}  // namespace

Result<void> LightLearning::add(Renderer& renderer, const Scene& scene, const View& view,
                                FrameOptions frame) {
    if (!wants_stage(scene)) return fail("has no light to learn from", "the scene");
    frame.lod.reset();
    frame.regions.reset();
    frame.samples = 1;
    frame.zoom = {};
    frame.part_rates = {};
    frame.timing = graph::Timing::every_group;
    const FrameOptions plain = frame;
    const auto draw = [&](const Scene& shown, const FrameOptions& options) {
        return renderer.render_to_image(shown, view, options);
    };
    const std::uint32_t present = light_parts(scene);
    KINO_ASSIGN(const FrameResult truth, draw(scene, plain));
    for (std::size_t p = 0; p < kLearnedParts.size(); ++p) {
        const std::uint32_t kind = kLearnedParts[p];
        if ((present & kind) == 0) continue;
        Part& part = parts_[p];
        Scene dimmed = scene;
        FrameOptions without = plain;
        if (kind == kBouncedLights) {
            for (Light& light : dimmed.lights) light.indirect = false;
        } else {
            without.light_lists.parts &= ~kind;
        }
        KINO_TRY(draw(dimmed, without));  // what it calls for is made now
        for (int i = 0; i < options_.repeats; ++i) {
            KINO_ASSIGN(const FrameResult with, draw(scene, plain));
            KINO_ASSIGN(const FrameResult gone, draw(dimmed, without));
            part.ms_with.push_back(group_ms(with.report, {"light", "shadows"}));
            part.ms_without.push_back(group_ms(gone.report, {"light", "shadows"}));
            other_ms_.push_back(with.ms - part.ms_with.back());
        }
        part.squares.resize(options_.r.size());
        for (std::size_t i = 0; i < options_.r.size(); ++i) {
            frame.part_rates = only(kind, options_.r[i]);
            KINO_ASSIGN(const FrameResult resized, draw(scene, frame));
            part.squares[i] += mean_square(resized.picture, truth.picture);
            chain_ms_.push_back(group_ms(resized.report, {"lod"}));
        }
        ++part.poses;
    }
    width_ = view.width;
    height_ = view.height;
    ++poses_;
    return {};
}

LightTable LightLearning::table() const {
    LightTable table{.width = width_, .height = height_, .poses = poses_};
    const double pixels = static_cast<double>(width_) * height_;
    if (poses_ == 0) return table;
    for (std::size_t p = 0; p < kLearnedParts.size(); ++p) {
        const Part& part = parts_[p];
        if (part.poses == 0) continue;
        std::vector<double> mse;
        // A pose without the part has no error of it.
        for (const double square : part.squares) mse.push_back(square / poses_);
        table.parts.push_back(learn_lod_component({.name = light_part_name(kLearnedParts[p]),
                                                   .ms_with = part.ms_with,
                                                   .ms_without = part.ms_without,
                                                   .pixels = pixels,
                                                   .r = options_.r,
                                                   .mse = mse}));
    }
    table.reconstruction_ns = median_of(chain_ms_) * 1e6 / pixels;
    table.other_ns = std::max(0.0, median_of(other_ms_)) * 1e6 / pixels;
    return table;
}

}  // namespace kino
