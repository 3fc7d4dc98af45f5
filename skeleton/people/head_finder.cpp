#include "skeleton/people/head_finder.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/geometric.hpp>
#include <limits>
#include <utility>

namespace kino {
namespace {

constexpr float kApartM = 0.25f;
constexpr float kNoisePerM = 0.0017f;
constexpr float kFarthestM = 5.0f;  // beyond, noise is as large as a head is deep
constexpr float kTopToFaceM = 0.12f;
constexpr float kThinnestM = 0.07f;
constexpr float kGoodScore = 0.9f, kSameFaceM = 0.1f;  // no better guess is looked for beside it
constexpr float kWalkM = 0.55f;                        // to each side of the middle

enum class Reading : std::uint8_t { nearer, on, free, outside };

/// What lies beside a face, metres to the right and up of it.
class Surroundings {
  public:
    Surroundings(const DepthGrid& grid, const glm::vec3& face, const glm::vec3& up)
        : grid_(grid), face_(face), up_(up), right_(glm::normalize(glm::cross(face, up))) {
        noise_m_ = 3 * kNoisePerM * face.z * face.z;
        cell_m_ = grid.cell_tangent() * face.z;
    }
    [[nodiscard]] float cell_m() const { return cell_m_; }
    [[nodiscard]] float noise_m() const { return noise_m_; }
    [[nodiscard]] const glm::vec3& right() const { return right_; }

    /// `within`: how far before or behind the face is still on it.
    [[nodiscard]] Reading at(float right, float up, float within) const {
        float away = 0;
        const Reading r = depth(right, up, away);
        if (r != Reading::on) return r;
        const float limit = within + noise_m_;
        if (away > limit) return Reading::free;
        return away < -limit ? Reading::nearer : Reading::on;
    }
    [[nodiscard]] int free(float right, float up) const {
        return at(right, up, 0.1f) == Reading::free ? 1 : 0;
    }
    /// Free, or above the picture: heads often reach its edge.
    [[nodiscard]] int open(float right, float up) const {
        const Reading r = at(right, up, 0.1f);
        return r == Reading::free || r == Reading::outside ? 1 : 0;
    }
    [[nodiscard]] int on(float right, float up, float within) const {
        return at(right, up, within) == Reading::on ? 1 : 0;
    }
    /// How far behind the upright plane through the face; on: there is a reading.
    [[nodiscard]] Reading depth(float right, float up, float& away) const {
        const glm::vec3 p = face_ + right * right_ + up * up_;
        const std::int32_t cell = grid_.cell_of(p);
        if (cell < 0) return Reading::outside;
        const float z = grid_.z_m().data()[cell];
        if (z == 0) return Reading::free;
        away = z - p.z;
        return Reading::on;
    }

  private:
    const DepthGrid& grid_;
    glm::vec3 face_, up_, right_;
    float noise_m_ = 0, cell_m_ = 0;
};

/// The stretch of one surface at one height.
struct Run {
    float left = 0, right = 0;  ///< metres from the middle, both outwards
    float middle_away = 0;      ///< depth behind the face
    float edge_away = 0;        ///< mean depth near both ends
    int free_ends = 0;          ///< ends beyond which it is farther, not nearer
    bool open = false;          ///< an end left the picture
    [[nodiscard]] float width() const { return left + right; }
};

/// One way from the middle until the surface ends.
void walk(const Surroundings& s, float from, float up, float away, int side, Run& run) {
    const float jump = 0.07f + s.noise_m();
    const float step = s.cell_m();
    float last = away, reached = 0, near_end = away, before = away;
    const float sign = static_cast<float>(side);
    bool hole = false;
    for (float x = step; x <= kWalkM; x += step) {
        float here = 0;
        const Reading r = s.depth(from + sign * x, up, here);
        if (r == Reading::outside) {
            run.open = true;
            break;
        }
        const bool none = r == Reading::free;
        if (none && !hole) {  // one cell may lack its reading
            hole = true;
            continue;
        }
        if (none || std::abs(here - last) > jump) {
            if (none || here > last) ++run.free_ends;
            break;
        }
        hole = false;
        before = near_end;
        near_end = last;
        last = here;
        reached = x;
    }
    (side < 0 ? run.left : run.right) = reached + 0.5f * step;
    run.edge_away += 0.5f * before;
}

bool run_at(const Surroundings& s, float middle, float up, float within, Run& run) {
    run = {};
    if (s.depth(middle, up, run.middle_away) != Reading::on) return false;
    if (std::abs(run.middle_away) > within + s.noise_m()) return false;
    walk(s, middle, up, run.middle_away, -1, run);
    walk(s, middle, up, run.middle_away, 1, run);
    return true;
}

float ramp(float value, float none, float full) {
    return std::clamp((value - none) / (full - none), 0.0f, 1.0f);
}

struct Outline {
    float score = 0;          ///< 0 unless it is that of a head on a trunk
    float axis = 0, top = 0;  ///< metres to the right of and above the first guess
};

/// Row by row from the top down.
Outline outline(const Surroundings& s) {
    const float step = std::max(s.cell_m(), 0.012f);
    Run run;
    // The middle of the face's rows is the axis.
    if (!run_at(s, 0, 0, 0.1f, run)) return {};
    const float axis = std::clamp(0.5f * (run.right - run.left), -0.08f, 0.08f);
    float top = 0;
    while (top < 0.3f && run_at(s, axis, top + step, 0.16f, run) && run.width() < 0.4f) top += step;
    if (top < 0.04f || top > 0.24f) return {};

    std::array<float, 64> widths{};
    std::size_t rows = 0;
    float bulge = 0, free_ends = 0;
    for (float h = top - 0.05f; h > top - 0.17f; h -= step) {
        if (!run_at(s, axis, h, 0.12f, run)) return {};
        bulge += run.edge_away - run.middle_away;
        free_ends += 0.5f * static_cast<float>(run.free_ends);
        widths[rows++] = run.width();
    }
    if (rows < 2) return {};
    const auto count = static_cast<float>(rows);
    bulge /= count;
    free_ends /= count;
    std::sort(widths.begin(), widths.begin() + static_cast<std::ptrdiff_t>(rows));
    const float head = widths[rows / 2];
    if (head < 0.1f || head > 0.3f) return {};

    // Down the trunk: where it becomes wider than the head, and how wide.
    float onset = 0, wide_left = 0, wide_right = 0, lowest = top, trunk = 0;
    float neck = head, below_neck = 0;
    int trunk_rows = 0, missing = 0, thin = 0;
    for (float h = top - 0.17f; h > top - 0.62f; h -= step) {
        // From the side the neck is not below the middle of the head.
        if (!run_at(s, axis, h, 0.28f, run) && !run_at(s, axis - 0.06f, h, 0.28f, run) &&
            !run_at(s, axis + 0.06f, h, 0.28f, run)) {
            if (++missing > 2) break;
            continue;
        }
        lowest = h;
        if (top - h < 0.36f && run.width() < neck) {
            neck = run.width();
            below_neck = 0;
        }
        below_neck = std::max(below_neck, run.width());
        if (run.width() < kThinnestM) ++thin;
        if (onset == 0 && run.width() > 1.3f * head) onset = top - h;
        if (onset > 0 && top - h < onset + 0.2f) {
            wide_left = std::max(wide_left, run.left);
            wide_right = std::max(wide_right, run.right);
        }
        if (top - h > 0.36f) {
            trunk += run.width();
            ++trunk_rows;
        }
    }
    // A lamp's stand is no neck.
    if (trunk_rows == 0 || thin > 1) return {};
    trunk /= static_cast<float>(trunk_rows);
    const bool shouldered = onset > 0 && onset <= 0.42f && trunk >= 0.2f;
    const bool from_the_side =
        neck < 0.88f * head && below_neck > 1.4f * neck && trunk > 0.16f && trunk < 0.45f;
    if (top - lowest < 0.42f || !(shouldered || from_the_side)) return {};
    const float shoulders = std::min(wide_left, wide_right);
    const float size = ramp(head, 0.1f, 0.13f) * ramp(head, 0.3f, 0.24f);
    const float wide = ramp(shoulders / head, 0.55f, 0.95f);
    const float bounded = ramp(free_ends, 0.4f, 0.9f);
    const float round = s.noise_m() > 0.06f ? 1.0f : ramp(bulge, -0.005f, 0.015f);
    const float slim = ramp(trunk, 1.1f, 0.8f);
    const float length = ramp(top - lowest, 0.4f, 0.55f);
    const float rest = 0.25f * size + 0.2f * bounded + 0.15f * round + 0.1f * slim + 0.1f * length;
    // A bottle looks like this as well: never sure.
    if (!shouldered) return {std::min(rest, 0.75f), axis, top};
    return {rest + 0.2f * wide, axis, top};
}

bool promising(const Surroundings& s) {
    const int above = s.open(0, 0.23f) + s.open(-0.09f, 0.21f) + s.open(0.09f, 0.21f);
    if (above < 2) return false;
    const int left = s.free(-0.15f, 0.02f) + s.free(-0.16f, 0.08f);
    const int right = s.free(0.15f, 0.02f) + s.free(0.16f, 0.08f);
    if (left + right < 2) return false;
    const int face = s.on(-0.03f, 0, 0.09f) + s.on(0.03f, 0, 0.09f) + s.on(0, 0.04f, 0.09f) +
                     s.on(0, -0.05f, 0.09f);
    if (face < 3) return false;
    return s.on(0, -0.28f, 0.25f) + s.on(0, -0.36f, 0.28f) > 0;
}

}  // namespace

void HeadFinder::find(const DepthGrid& grid, const Image<std::uint8_t>& mask, const glm::vec3& up) {
    KINO_CHECK(mask.width() == grid.width() && mask.height() == grid.height());
    candidates_.clear();
    const int width = grid.width();
    for (int y = 0; y < grid.height(); ++y) {
        for (int x = 0; x < width; ++x) {
            const std::int32_t cell = y * width + x;
            if (!mask.data()[cell]) continue;
            const float z = grid.z_m().data()[cell];
            if (z > kFarthestM) continue;
            // Near faces are many cells wide: every other one will do.
            if (z < 3 && ((x | y) & 1)) continue;
            const glm::vec3 face = grid.point(static_cast<std::size_t>(cell));
            const bool done =
                std::any_of(candidates_.begin(), candidates_.end(), [&](const Head& h) {
                    return h.score >= kGoodScore && glm::distance(h.place_m, face) < kSameFaceM;
                });
            if (done) continue;
            const Surroundings around(grid, face, up);
            if (!promising(around)) continue;
            const Outline found = outline(around);
            if (found.score < kLeastHeadScore) continue;
            const glm::vec3 middle =
                face + found.axis * around.right() + (found.top - kTopToFaceM) * up;
            const std::int32_t at = grid.cell_of(middle);
            if (at >= 0 && mask.data()[at]) candidates_.push_back({at, middle, found.score});
        }
    }
    std::stable_sort(candidates_.begin(), candidates_.end(),
                     [](const Head& a, const Head& b) { return a.score > b.score; });
    heads_.clear();
    for (const Head& c : candidates_) {
        const bool apart = std::all_of(heads_.begin(), heads_.end(), [&](const Head& h) {
            return glm::distance(h.place_m, c.place_m) > kApartM;
        });
        if (apart) heads_.push_back(c);
    }
}

}  // namespace kino
