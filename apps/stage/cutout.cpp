#include "apps/stage/cutout.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/geometric.hpp>
#include <limits>
#include <vector>

#include "apps/stage/outline.h"

namespace kino {
namespace {

constexpr int kBlock = 2;  ///< px
/// Above the floor, so that what is left of it between the feet does not look like a rug.
constexpr double kFloorSkinM = 0.03;
/// A camera sees the side of a limb that is towards it: at most its middle, and what joints are
/// off.
constexpr double kBehind = 0.6;  ///< of a ball's radius
/// Round a bone's middle, where what is seen is the limb whatever else is near: of a ball's radius.
constexpr float kCore = 0.35f;

struct Ball {
    glm::dvec3 center{0};
    double radius = 0;
    bool seen = true;  ///< else joints are guesses, and whatever is there may hide them
};

/// What flesh adds to the margin round a joint. Arms are thin, and near things on tables.
double girth_of(Joint joint) {
    switch (joint) {
        case Joint::hip_center:
        case Joint::spine:
        case Joint::shoulder_center:
            return 0.09;
        case Joint::hip_left:
        case Joint::hip_right:
        case Joint::shoulder_left:
        case Joint::shoulder_right:
            return 0.05;
        case Joint::head:
            return 0.06;
        case Joint::elbow_left:
        case Joint::elbow_right:
        case Joint::wrist_left:
        case Joint::wrist_right:
            return -0.04;
        default:
            return 0;
    }
}

bool is_there(const JointPosition& joint) {
    return joint.state != JointState::lost && joint.position_m.z > 0.1f &&
           glm::length(joint.position_m) < 50.0f;
}

/// Who sits has no bones below the shoulders; the trunk hangs from them.
void add_trunk(const Body& body, double margin_m, std::vector<Ball>& balls) {
    const JointPosition& shoulders = body[Joint::shoulder_center];
    if (!is_there(shoulders) || is_there(body[Joint::hip_center])) return;
    for (int k = -2; k <= 6; ++k) {
        // y goes down.
        const glm::dvec3 at = glm::dvec3(shoulders.position_m) + glm::dvec3(0, 0.08 * k, 0);
        balls.push_back({at, margin_m + (k < 0 ? 0.02 : 0.14), k <= 2});
    }
}

/// Spheres along every bone whose ends are known, close enough to overlap.
std::vector<Ball> balls_of(const BodyFrame& bodies, double margin_m) {
    std::vector<Ball> balls;
    for (const Body& body : bodies.bodies) {
        for (std::size_t i = 0; i < kJointCount; ++i) {
            const auto joint = static_cast<Joint>(i);
            const Joint parent = kJointParent[i];
            if (!is_there(body[joint])) continue;
            const glm::dvec3 to(body[joint].position_m);
            const double girth = margin_m + std::max(girth_of(joint), -0.25 * margin_m);
            const bool whole = is_there(body[parent]);
            const glm::dvec3 from = whole ? glm::dvec3(body[parent].position_m) : to;
            const double from_girth =
                whole ? margin_m + std::max(girth_of(parent), -0.25 * margin_m) : girth;
            const double length = glm::distance(from, to);
            if (length > 1.2) continue;
            const bool seen = body[joint].state == JointState::tracked;
            const int steps = std::max(1, static_cast<int>(std::ceil(length / (0.5 * margin_m))));
            for (int k = 0; k <= steps; ++k) {
                const double t = static_cast<double>(k) / steps;
                balls.push_back({glm::mix(from, to, t), glm::mix(from_girth, girth, t), seen});
            }
        }
        add_trunk(body, margin_m, balls);
    }
    return balls;
}

struct Span {
    float near = std::numeric_limits<float>::max();
    float far = 0;
    float core_near = std::numeric_limits<float>::max();
    float core_far = 0;
};

/// Rays of the picture's blocks, and between which rays a column or row of them lies.
class Blocks {
  public:
    Blocks(const Image<RayXy>& rays, int width, int height)
        : columns_((width + kBlock - 1) / kBlock),
          rows_((height + kBlock - 1) / kBlock),
          rays_(static_cast<std::size_t>(columns_) * static_cast<std::size_t>(rows_)),
          column_(static_cast<std::size_t>(columns_)),
          row_(static_cast<std::size_t>(rows_)) {
        for (int y = 0; y < rows_; ++y) {
            for (int x = 0; x < columns_; ++x) {
                const RayXy ray = rays.at(std::min(x * kBlock + kBlock / 2, width - 1),
                                          std::min(y * kBlock + kBlock / 2, height - 1));
                const bool good = std::isfinite(ray.x) && std::isfinite(ray.y);
                rays_[at(x, y)] =
                    good ? glm::vec2(ray.x, ray.y) : glm::vec2(std::numeric_limits<float>::max());
                if (!good) continue;
                column_[static_cast<std::size_t>(x)].take(ray.x);
                row_[static_cast<std::size_t>(y)].take(ray.y);
            }
        }
    }
    [[nodiscard]] std::size_t at(int x, int y) const {
        return static_cast<std::size_t>(y * columns_ + x);
    }
    [[nodiscard]] std::size_t count() const { return rays_.size(); }
    [[nodiscard]] std::size_t of_pixel(int x, int y) const { return at(x / kBlock, y / kBlock); }

    /// Calls `visit(block, squared distance)` for blocks nearer than `aside` to a ray.
    template <class Visit>
    void within(const glm::vec2& center, float aside, const Visit& visit) const {
        for (int y = 0; y < rows_; ++y) {
            if (!row_[static_cast<std::size_t>(y)].meets(center.y, aside)) continue;
            for (int x = 0; x < columns_; ++x) {
                if (!column_[static_cast<std::size_t>(x)].meets(center.x, aside)) continue;
                const glm::vec2 off = rays_[at(x, y)] - center;
                const float squared = glm::dot(off, off);
                if (squared < aside * aside) visit(at(x, y), squared);
            }
        }
    }

  private:
    struct Range {
        float least = std::numeric_limits<float>::max();
        float most = std::numeric_limits<float>::lowest();
        void take(float v) {
            least = std::min(least, v);
            most = std::max(most, v);
        }
        [[nodiscard]] bool meets(float center, float aside) const {
            return most > center - aside && least < center + aside;
        }
    };
    int columns_, rows_;
    std::vector<glm::vec2> rays_;
    std::vector<Range> column_, row_;
};

/// Which depths may be a person's along the ray of each block, and which surely are.
std::vector<Span> spans_of(const std::vector<Ball>& balls, const Blocks& blocks) {
    std::vector<Span> spans(blocks.count());
    for (const Ball& ball : balls) {
        const auto near = static_cast<float>(ball.center.z - ball.radius);
        const auto far = static_cast<float>(ball.center.z + kBehind * ball.radius);
        const glm::vec2 center(ball.center.x / ball.center.z, ball.center.y / ball.center.z);
        const auto aside = static_cast<float>(ball.radius / ball.center.z);
        const float core = ball.seen ? kCore * kCore * aside * aside : -1.0f;
        blocks.within(center, aside, [&](std::size_t i, float squared) {
            Span& span = spans[i];
            span.near = std::min(span.near, near);
            span.far = std::max(span.far, far);
            if (squared >= core) return;
            span.core_near = std::min(span.core_near, near);
            span.core_far = std::max(span.core_far, far);
        });
    }
    return spans;
}

/// Keeps what is connected with a bone, from pixel to pixel without a jump: what merely hovers near
/// it, like a chair's back, goes. `state`: 0 not a person's, 1 may be, 2 is.
void grow_from_bones(const Image<float>& depth_m, double focal_px, Image<std::uint8_t>& state) {
    const int width = depth_m.width(), height = depth_m.height();
    const auto per_metre = static_cast<float>(3.0 / std::max(focal_px, 1.0));
    std::vector<std::pair<int, int>> open;
    for (int y = 0; y < height; ++y) {
        for (int x = 0; x < width; ++x) {
            if (state.at(x, y) == 2) open.emplace_back(x, y);
        }
    }
    constexpr std::array<std::array<int, 2>, 4> kWays = {{{1, 0}, {-1, 0}, {0, 1}, {0, -1}}};
    while (!open.empty()) {
        const auto [x, y] = open.back();
        open.pop_back();
        const float z = depth_m.at(x, y);
        // Two steps of the sensor, and a surface that leans by 70 degrees.
        const float jump = 2 * 0.00307f * z * z + per_metre * z;
        for (const auto& way : kWays) {
            const int to_x = x + way[0], to_y = y + way[1];
            if (to_x < 0 || to_y < 0 || to_x >= width || to_y >= height) continue;
            if (state.at(to_x, to_y) != 1 || std::abs(depth_m.at(to_x, to_y) - z) > jump) continue;
            state.at(to_x, to_y) = 2;
            open.emplace_back(to_x, to_y);
        }
    }
}

}  // namespace

std::shared_ptr<const DepthSurface> cut_out_people(const DepthSurface& surface,
                                                   const BodyFrame& bodies, double margin_m,
                                                   const Pose& world_from_depth,
                                                   std::optional<double> floor_y_m,
                                                   int outline_px) {
    const int width = surface.depth_m.width(), height = surface.depth_m.height();
    const Image<RayXy>& rays = *surface.rays;
    const Blocks blocks(rays, width, height);
    const std::vector<Span> spans = spans_of(balls_of(bodies, margin_m), blocks);
    auto cut = std::make_shared<DepthSurface>(surface);
    // World height of a point is a plane of its depth-camera coordinates.
    const glm::dvec3 up = glm::conjugate(world_from_depth.rotation) * glm::dvec3(0, 1, 0);
    const double lowest = floor_y_m ? *floor_y_m + kFloorSkinM : -1e9;
    Image<std::uint8_t> state(width, height);
    for (int y = 0; y < height; ++y) {
        for (int x = 0; x < width; ++x) {
            const float z = surface.depth_m.at(x, y);
            const Span& span = spans[blocks.of_pixel(x, y)];
            std::uint8_t& s = state.at(x, y);
            s = 0;
            if (!(z > span.near && z < span.far)) continue;
            const RayXy ray = rays.at(x, y);
            const double height_m =
                world_from_depth.translation.y + z * (up.x * ray.x + up.y * ray.y + up.z);
            if (!(height_m > lowest)) continue;
            s = z > span.core_near && z < span.core_far ? 2 : 1;
        }
    }
    grow_from_bones(surface.depth_m, surface.focal_px, state);
    for (std::size_t i = 0; i < state.size(); ++i) {
        if (state.pixels()[i] != 2) cut->depth_m.pixels()[i] = 0;
    }
    smooth_outline(*cut, outline_px);
    return cut;
}

}  // namespace kino
