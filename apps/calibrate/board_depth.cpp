#include "apps/calibrate/board_depth.h"

#include <fmt/format.h>

#include <algorithm>

#include "calibration/disparity.h"

namespace kino {
namespace {

constexpr double kLeastSeen = 0.3;
constexpr double kWorthIt = 0.9;
constexpr int kRounds = 8;

// Raw numbers, or metres where the unit is linear; 0 for no reading.
Image<float> values_of(const DepthFrame& frame) {
    Image<float> out(frame.raw.width(), frame.raw.height(), 0);
    for (std::size_t i = 0; i < frame.raw.size(); ++i) {
        const std::uint16_t raw = frame.raw.pixels()[i];
        if (frame.unit == DepthUnit::linear) {
            if (raw != 65535) {
                out.pixels()[i] = static_cast<float>(raw * frame.metres_per_unit);
            }
        } else if (raw < Disparity::kNoReading) {
            out.pixels()[i] = static_cast<float>(raw);
        }
    }
    return out;
}

std::vector<DepthSample> with_metres(const std::vector<DepthSample>& linear,
                                     const std::vector<DepthSample>& raw,
                                     const DisparityParameters& parameters) {
    std::vector<DepthSample> out = linear;
    const Disparity device(parameters);
    for (const DepthSample& sample : raw) {
        if (const auto metres = device.metres(sample.measured)) {
            out.push_back({sample.x, sample.y, *metres, sample.true_m});
        }
    }
    return out;
}

}  // namespace

std::optional<BiasFit> use_board_depth(const Calibration& calibration, const Board& board,
                                       const std::vector<ViewDepth>& depth, RigParameters& rig,
                                       std::vector<std::string>& notes) {
    RigParameters alone = rig;
    alone.color.reset();
    const auto made = Rig::create(alone);
    if (!made) {
        notes.push_back(made.error().to_string());
        return std::nullopt;
    }
    const Image<RayXy>& rays = made->depth_rays();
    const glm::dvec2 far = board.corner_m(board.corner_count() - 1);
    std::vector<DepthSample> linear;
    std::vector<DepthSample> raw;
    for (const ViewDepth& one : depth) {
        const auto at = std::find(calibration.views.begin(), calibration.views.end(), one.view);
        const bool fits =
            one.frame->raw.width() == rays.width() && one.frame->raw.height() == rays.height();
        if (at == calibration.views.end() || !fits) continue;
        const auto view = static_cast<std::size_t>(at - calibration.views.begin());
        const auto samples =
            samples_on_board(values_of(*one.frame), rays, calibration.first_from_board[view], far);
        auto& list = one.frame->unit == DepthUnit::linear ? linear : raw;
        list.insert(list.end(), samples.begin(), samples.end());
    }
    std::vector<DepthSample> metric = with_metres(linear, raw, rig.disparity);
    if (metric.empty()) return std::nullopt;
    // Depth and board contradict each other: one must not correct the other.
    if (const auto complaint = scale_complaint(metric, board.square_m)) {
        notes.push_back(*complaint);
        return std::nullopt;
    }
    const DisparityParameters known = rig.disparity;
    auto fit = fit_bias(metric, rays.width(), rays.height());
    // Boards near and far lie in different parts of the picture, so that a bias bends the line of
    // the disparity: one is found with the other taken away, in turn.
    for (int round = 0; !raw.empty() && fit && round < kRounds; ++round) {
        std::vector<DepthSample> believed = raw;
        for (DepthSample& s : believed) {
            const double bias = round == 0 ? 0 : fit->bias.at(s.x, s.y);
            s.true_m = 1 / (1 / s.true_m + bias);
        }
        const auto line = fit_disparity(believed, known);
        if (!line) {
            notes.push_back(line.error().to_string());
            break;
        }
        rig.disparity = line->parameters;
        metric = with_metres(linear, raw, rig.disparity);
        fit = fit_bias(metric, rays.width(), rays.height());
        if (round + 1 < kRounds) continue;
        notes.push_back(fmt::format(
            "disparity from {} depth pixels between {:.2f} and {:.2f} m: const_shift {:.2f}, "
            "reference_distance_cm {:.2f}, RMS {:.2f} steps",
            line->samples, line->nearest_m, line->farthest_m, line->parameters.const_shift,
            line->parameters.reference_distance_cm, line->rms_steps));
    }
    if (!fit) {
        notes.push_back(fit.error().to_string());
        return std::nullopt;
    }
    const bool is_small = fit->seen_share < kLeastSeen;
    const bool is_idle = fit->rms_after_mm > kWorthIt * fit->rms_before_mm;
    notes.push_back(bias_text(*fit) + (is_small  ? ": too small a part, left out"
                                       : is_idle ? ": nothing to gain, left out"
                                                 : ""));
    if (is_small || is_idle) return std::nullopt;
    return std::move(*fit);
}

std::string bias_text(const BiasFit& fit) {
    return fmt::format(
        "depth bias from {} depth pixels in {:.0f} % of the picture: error at 1 m {:.1f} mm, "
        "corrected {:.1f} mm",
        fit.samples, 100 * fit.seen_share, fit.rms_before_mm, fit.rms_after_mm);
}

}  // namespace kino
