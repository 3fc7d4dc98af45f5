#include "apps/calibrate/session_check.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "apps/interrupt.h"
#include "calibration/boards/grey_picture.h"
#include "calibration/solve/edge_alignment.h"
#include "calibration/solve/mutual_alignment.h"
#include "sensor/source.h"

namespace kino {
namespace {

constexpr double kStandsOut = 3;  // sharpness of a place that can be believed
// Depth contours themselves are good to a pixel or two; who calibrates again wants to gain more.
constexpr double kGoodPx = 3;
constexpr int kVerdictFrames = 3;
constexpr int kMutualEvery = 10;
constexpr double kMutualReachPx = 12;

double median(std::vector<double> values) {
    if (values.empty()) return 0;
    const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
    std::nth_element(values.begin(), middle, values.end());
    return *middle;
}

bool ended(Source& source) {
    const auto events = source.take_events();
    return std::any_of(events.begin(), events.end(),
                       [](const Event& e) { return e.kind == EventKind::ended; });
}

}  // namespace

Result<SessionCheck> check_session(const std::string& uri, int frames) {
    KINO_ASSIGN(const auto source, open_source(uri));
    for (const StreamInfo& stream : source->info().streams) {
        const StreamKind kind = stream.id.kind;
        if (kind == StreamKind::depth || kind == StreamKind::color) {
            KINO_TRY(source->subscribe(stream.id));
        }
    }
    KINO_ASSIGN(RigParameters parameters, source->calibration());
    SessionCheck out;
    out.has_color = parameters.color.has_value();
    // Contours hide behind themselves: the test would take them away.
    KINO_ASSIGN(Rig rig, Rig::create(std::move(parameters), {.occlusion_test = false}));
    std::vector<FlatPart> parts;
    std::vector<double> dx;
    std::vector<double> dy;
    std::vector<double> mutual_dx;
    std::vector<double> mutual_dy;
    std::vector<double> bits;
    std::vector<double> best_bits;
    RegisteredDepth registered;
    while (out.frames < frames && !interrupted()) {
        KINO_ASSIGN(const auto set, source->next(kNsPerSecond));
        if (!set) {
            if (ended(*source)) break;
            continue;
        }
        if (!set->depth) continue;
        KINO_TRY(rig.register_depth(*set->depth, registered));
        ++out.frames;
        const auto more = flat_parts(registered.depth_m, rig.depth_rays());
        parts.insert(parts.end(), more.begin(), more.end());
        if (!out.has_color || !set->color || !set->color_paired) continue;
        KINO_ASSIGN(const GreyPicture grey, grey_of(*set->color));
        // Dear, and the frames of a second are much alike.
        if (out.frames % kMutualEvery == 1) {
            if (const auto mutual = mutual_alignment(registered.depth_m, registered.uv, grey)) {
                mutual_dx.push_back(mutual->dx_px);
                mutual_dy.push_back(mutual->dy_px);
                bits.push_back(mutual->bits);
                best_bits.push_back(mutual->best_bits);
            }
        }
        const auto place = edge_alignment(registered.depth_m, registered.uv, grey);
        if (!place || place->sharpness < kStandsOut) continue;
        dx.push_back(place->dx_px);
        dy.push_back(place->dy_px);
    }
    if (out.frames == 0) return fail("no depth is in this source", uri);
    out.planes = by_distance(parts);
    out.aligned_frames = static_cast<int>(dx.size());
    out.mutual_frames = static_cast<int>(bits.size());
    out.mutual_dx_px = median(mutual_dx);
    out.mutual_dy_px = median(mutual_dy);
    out.bits = median(bits);
    out.best_bits = median(best_bits);
    out.dx_px = median(dx);
    out.dy_px = median(dy);
    std::vector<double> off;
    for (std::size_t i = 0; i < dx.size(); ++i) {
        off.push_back(std::hypot(dx[i] - out.dx_px, dy[i] - out.dy_px));
    }
    out.spread_px = median(off);
    return out;
}

std::string check_text(const SessionCheck& check) {
    std::string out;
    for (const PlaneBand& band : check.planes) {
        out += fmt::format("flat parts at {:.2f} m: {:.2f} mm RMS ({} parts)\n", band.distance_m,
                           band.rms_mm, band.planes);
    }
    if (check.planes.empty()) out += "nothing flat was seen\n";
    if (!check.has_color) return out + "no colour camera: contours cannot be compared\n";
    if (check.mutual_frames > 0) {
        // At the border of the search there is no best place, only a slope.
        const bool found =
            std::max(std::abs(check.mutual_dx_px), std::abs(check.mutual_dy_px)) < kMutualReachPx;
        out += fmt::format("depth and colour share {:.3f} bits, ", check.bits);
        out += found ? fmt::format("at most {:.3f}, moved by {:+.1f}, {:+.1f} px\n",
                                   check.best_bits, check.mutual_dx_px, check.mutual_dy_px)
                     : fmt::format("and no clear best place within {:.0f} px\n", kMutualReachPx);
    }
    if (check.aligned_frames == 0) {
        return out + "no frame has contours clear enough to compare depth with colour\n";
    }
    const bool good = std::hypot(check.dx_px, check.dy_px) <= kGoodPx;
    const char* verdict = check.aligned_frames < kVerdictFrames ? "too few frames for a verdict"
                          : good                                ? "the calibration still holds"
                                 : "the calibration has slid, make a new one";
    return out + fmt::format(
                     "colour contours lie {:+.1f}, {:+.1f} px from depth contours ({} frames, "
                     "spread {:.1f} px): {}\n",
                     check.dx_px, check.dy_px, check.aligned_frames, check.spread_px, verdict);
}

}  // namespace kino
