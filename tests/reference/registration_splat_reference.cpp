#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/mat2x2.hpp>
#include <glm/matrix.hpp>
#include <numbers>
#include <optional>

#include "tests/reference/camera_reference.h"
#include "tests/reference/registration_reference.h"

namespace kino::reference {
namespace {

constexpr double kThreeSteps = 3 * 0.00307;
constexpr double kReach = 0.5 + 1.0 / 16;

double tilt(double degrees) {
    return std::tan(degrees * std::numbers::pi / 180);
}

// Place and 1/z in the colour picture; NaN = none.
struct Spot {
    glm::dvec2 uv{std::nan(""), std::nan("")};
    double w = std::nan("");
    [[nodiscard]] bool there() const { return !std::isnan(w); }
};

class SplatPainter {
  public:
    SplatPainter(const RigParameters& rig, const Image<glm::dvec2>& rays, const Registration& exact)
        : rig_(rig), rays_(rays), exact_(exact), fold_(fold_radius(*rig.color)) {
        focal_ = (rig.depth.fx + rig.depth.fy) / 2;
        const double ratio = std::max(rig.color->fx / rig.depth.fx, rig.color->fy / rig.depth.fy);
        longest_ = 8 * std::max(ratio, 1.0);
    }

    SplatPicture paint(double margin) {
        SplatPicture out{Image<double>(rig_.color->width, rig_.color->height, 0),
                         Image<std::uint8_t>(rays_.width(), rays_.height(), 0)};
        Image<double> own(rays_.width(), rays_.height(), 0);
        for (int y = 0; y < rays_.height(); ++y) {
            for (int x = 0; x < rays_.width(); ++x) {
                if (exact_.place_z.at(x, y) > 0) paint_piece(x, y, out, own.at(x, y));
            }
        }
        for (int y = 0; y < rays_.height(); ++y) {
            for (int x = 0; x < rays_.width(); ++x) {
                const double z = own.at(x, y);
                if (z == 0) continue;
                const glm::dvec2 uv = exact_.uv.at(x, y);
                const double nearest = out.depth_in_color_m.at(
                    static_cast<int>(std::nearbyint(uv.x)), static_cast<int>(std::nearbyint(uv.y)));
                if (z > nearest + margin + 2 * 0.00307 * z * z) out.hidden.at(x, y) = 1;
            }
        }
        return out;
    }

  private:
    [[nodiscard]] Spot spot(int x, int y) const {
        if (!exact_.place_z.contains(x, y) || exact_.place_z.at(x, y) == 0) return {};
        return {exact_.place.at(x, y), 1 / exact_.place_z.at(x, y)};
    }

    // Where the pixel (x, y) would be seen if it measured `depth`.
    [[nodiscard]] Spot spot_at(int x, int y, double depth) const {
        if (!rays_.contains(x, y)) return {};
        const glm::dvec3 p =
            rig_.color_from_depth.rotation * (depth * glm::dvec3(rays_.at(x, y), 1)) +
            rig_.color_from_depth.translation;
        const auto uv = project(*rig_.color, fold_, p);
        if (!uv) return {};
        return {*uv, 1 / p.z};
    }

    [[nodiscard]] double depth(int x, int y) const {
        return exact_.depth_m.contains(x, y) ? exact_.depth_m.at(x, y) : 0;
    }

    // The pixel (x, y) and the one (dx, dy) further, in either direction.
    [[nodiscard]] bool one_surface(int x, int y, int dx, int dy) const {
        if (!spot(x, y).there() || !spot(x + dx, y + dy).there()) return false;
        const double a = depth(x, y);
        const double b = depth(x + dx, y + dy);
        const double near = std::min(a, b);
        const double apart = std::abs(a - b);
        if (apart <= kThreeSteps * near * near + tilt(80) / focal_ * near) return true;
        if (apart > kThreeSteps * near * near + tilt(88) / focal_ * near) return false;
        const double before = depth(x - dx, y - dy);
        const double after = depth(x + 2 * dx, y + 2 * dy);
        return (before > 0 && std::abs(1 / before - 2 / a + 1 / b) <= kThreeSteps) ||
               (after > 0 && std::abs(1 / a - 2 / b + 1 / after) <= kThreeSteps);
    }

    struct Slope {
        glm::dvec2 uv{0, 0};
        double w = 0;
        bool measured = false;
    };

    [[nodiscard]] Slope slope(int x, int y, int dx, int dy) const {
        const Spot here = spot(x, y);
        Spot before = one_surface(x, y, -dx, -dy) ? spot(x - dx, y - dy) : Spot{};
        Spot after = one_surface(x, y, dx, dy) ? spot(x + dx, y + dy) : Spot{};
        const bool measured = before.there() || after.there();
        if (!measured) {
            before = spot_at(x - dx, y - dy, depth(x, y));
            after = spot_at(x + dx, y + dy, depth(x, y));
        }
        const double share = before.there() && after.there() ? 0.5 : 1;
        if (!before.there()) before = here;
        if (!after.there()) after = here;
        return {(after.uv - before.uv) * share, (after.w - before.w) * share, measured};
    }

    void paint_piece(int x, int y, SplatPicture& out, double& own) const {
        const Spot here = spot(x, y);
        const Slope along_x = slope(x, y, 1, 0);
        const Slope along_y = slope(x, y, 0, 1);
        double w_x = along_x.w;
        double w_y = along_y.w;
        if (kReach * (std::abs(w_x) + std::abs(w_y)) >= 0.5 * here.w) w_x = w_y = 0;
        const glm::dmat2 sides(along_x.uv, along_y.uv);
        const bool drawable = std::abs(glm::determinant(sides)) > 1e-6;
        const glm::dmat2 back = drawable ? glm::inverse(sides) : glm::dmat2(0);
        const auto paint = [&](int u, int v, glm::dvec2 ab) {
            const double z = 1 / (here.w + ab.x * w_x + ab.y * w_y);
            double& place = out.depth_in_color_m.at(u, v);
            place = place == 0 ? z : std::min(place, z);
            return z;
        };
        const glm::dvec2 box =
            glm::min(kReach * (glm::abs(along_x.uv) + glm::abs(along_y.uv)), longest_);
        for (int v = 0; drawable && v < rig_.color->height; ++v) {
            if (std::abs(v - here.uv.y) > box.y) continue;
            const int first = std::max(static_cast<int>(std::ceil(here.uv.x - box.x)), 0);
            for (int u = first; u < rig_.color->width && u <= here.uv.x + box.x; ++u) {
                const glm::dvec2 ab = back * (glm::dvec2(u, v) - here.uv);
                if (std::abs(ab.x) <= kReach && std::abs(ab.y) <= kReach) paint(u, v, ab);
            }
        }
        if (std::isnan(exact_.uv.at(x, y).x)) return;
        const glm::dvec2 pixel(std::nearbyint(here.uv.x), std::nearbyint(here.uv.y));
        own = paint(static_cast<int>(pixel.x), static_cast<int>(pixel.y),
                    glm::clamp(back * (pixel - here.uv), -kReach, kReach));
        if (along_x.measured && along_y.measured && glm::determinant(sides) < 0) {
            out.hidden.at(x, y) = 1;
        }
    }

    const RigParameters& rig_;
    const Image<glm::dvec2>& rays_;
    const Registration& exact_;
    double fold_;
    double focal_;
    double longest_;
};

}  // namespace

SplatPicture splat_depth(const RigParameters& rig, const Image<glm::dvec2>& depth_rays,
                         const Registration& exact, double occlusion_margin_m) {
    return SplatPainter(rig, depth_rays, exact).paint(occlusion_margin_m);
}

}  // namespace kino::reference
