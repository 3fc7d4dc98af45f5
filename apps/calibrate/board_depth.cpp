#include "apps/calibrate/board_depth.h"

#include <fmt/format.h>

#include <algorithm>

#include "calibration/disparity.h"
#include "calibration/solve/depth_fit.h"

namespace kino {
namespace {

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

}  // namespace

void use_board_depth(const Calibration& calibration, const Board& board,
                     const std::vector<ViewDepth>& depth, RigParameters& rig,
                     std::vector<std::string>& notes) {
    RigParameters alone = rig;
    alone.color.reset();
    const auto made = Rig::create(alone);
    if (!made) return notes.push_back(made.error().to_string());
    const Image<RayXy>& rays = made->depth_rays();
    const glm::dvec2 far = board.corner_m(board.corner_count() - 1);
    std::vector<DepthSample> metric;
    std::vector<DepthSample> raw;
    for (const ViewDepth& one : depth) {
        const auto at = std::find(calibration.views.begin(), calibration.views.end(), one.view);
        const bool fits =
            one.frame->raw.width() == rays.width() && one.frame->raw.height() == rays.height();
        if (at == calibration.views.end() || !fits) continue;
        const auto view = static_cast<std::size_t>(at - calibration.views.begin());
        const auto samples =
            samples_on_board(values_of(*one.frame), rays, calibration.first_from_board[view], far);
        auto& list = one.frame->unit == DepthUnit::linear ? metric : raw;
        list.insert(list.end(), samples.begin(), samples.end());
    }
    if (raw.size() > 0) {
        const Disparity device(rig.disparity);
        for (const DepthSample& sample : raw) {
            if (const auto metres = device.metres(sample.measured)) {
                metric.push_back({sample.x, sample.y, *metres, sample.true_m});
            }
        }
    }
    // Depth and board contradict each other: one must not correct the other.
    if (const auto complaint = scale_complaint(metric, board.square_m)) {
        return notes.push_back(*complaint);
    }
    if (raw.empty()) return;
    const auto fit = fit_disparity(raw, rig.disparity);
    if (!fit) return notes.push_back(fit.error().to_string());
    rig.disparity = fit->parameters;
    notes.push_back(fmt::format(
        "disparity from {} depth pixels between {:.2f} and {:.2f} m: const_shift {:.2f}, "
        "reference_distance_cm {:.2f}, RMS {:.2f} steps",
        fit->samples, fit->nearest_m, fit->farthest_m, fit->parameters.const_shift,
        fit->parameters.reference_distance_cm, fit->rms_steps));
}

}  // namespace kino
