#include "calibration/registration_rays.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <limits>
#include <optional>

#include "calibration/projection.h"

namespace kino::registration {
namespace {

constexpr double kNoRay = std::numeric_limits<double>::quiet_NaN();

int node_count(int size, int step) {
    return (size - 1 + step - 1) / step + 1;
}

int node_position(int node, int size, int step) {
    return std::min(node * step, size - 1);
}

glm::dvec2 ray_of(const Projection& projection, double x, double y) {
    return projection.unproject({x, y}).value_or(glm::dvec2(kNoRay));
}

// Whether bilinear interpolation between four nodes (two above, then two below) gives the rays of
// the pixels between them; asked in their middle, and for larger cells around it as well, because
// the error may change its sign within the cell. NaN says no.
bool good_enough(const Projection& projection, const std::array<glm::dvec2, 4>& corner,
                 const glm::dvec2& first, const glm::dvec2& size) {
    const CameraModel& c = projection.camera();
    const auto good_at = [&](double x, double y) {
        const glm::dvec2 above = glm::mix(corner[0], corner[1], x);
        const glm::dvec2 below = glm::mix(corner[2], corner[3], x);
        const glm::dvec2 exact = ray_of(projection, first.x + x * size.x, first.y + y * size.y);
        const glm::dvec2 off = (glm::mix(above, below, y) - exact) * glm::dvec2(c.fx, c.fy);
        return glm::length(off) <= RayNodes::kWorstTablePx;
    };
    if (!good_at(0.5, 0.5)) return false;
    if (size.x <= 2 && size.y <= 2) return true;
    return good_at(0.5, 0) && good_at(0, 0.5) && good_at(1, 0.5) && good_at(0.5, 1) &&
           good_at(0.25, 0.25) && good_at(0.75, 0.25) && good_at(0.25, 0.75) && good_at(0.75, 0.75);
}

}  // namespace

RayNodes find_rays(const CameraModel& camera, int step) {
    const Projection projection(camera);
    RayNodes out{camera.width, camera.height, step, {}, {}};
    const int columns = node_count(camera.width, step);
    const int rows = node_count(camera.height, step);
    out.nodes = Image<glm::dvec2>(columns, rows);
    for (int j = 0; j < rows; ++j) {
        for (int i = 0; i < columns; ++i) {
            out.nodes.at(i, j) = ray_of(projection, node_position(i, camera.width, step),
                                        node_position(j, camera.height, step));
        }
    }
    if (step == 1) return out;
    for (int j = 0; j + 1 < rows; ++j) {
        for (int i = 0; i + 1 < columns; ++i) {
            const int left = i * step;
            const int top = j * step;
            const int right = node_position(i + 1, camera.width, step);
            const int bottom = node_position(j + 1, camera.height, step);
            if (good_enough(projection,
                            {out.nodes.at(i, j), out.nodes.at(i + 1, j), out.nodes.at(i, j + 1),
                             out.nodes.at(i + 1, j + 1)},
                            {left, top}, {right - left, bottom - top})) {
                continue;
            }
            // Its last column and row belong to it only where nobody follows.
            const int end_x = i + 2 < columns ? right : right + 1;
            const int end_y = j + 2 < rows ? bottom : bottom + 1;
            for (int y = top; y < end_y; ++y) {
                for (int x = left; x < end_x; ++x) {
                    out.exact.push_back(
                        {static_cast<std::size_t>(y) * static_cast<std::size_t>(camera.width) +
                             static_cast<std::size_t>(x),
                         ray_of(projection, x, y)});
                }
            }
        }
    }
    std::ranges::sort(out.exact, {}, &RayNodes::Exact::pixel);
    return out;
}

RayTable::RayTable(const RayNodes& nodes, const glm::dmat3& rotation)
    : width_(nodes.width),
      height_(nodes.height),
      step_(nodes.step),
      inverse_step_(1.0f / static_cast<float>(nodes.step)),
      columns_(nodes.nodes.width()) {
    const auto turn = [&](glm::dvec2 ray) {
        // Rounded as depth_rays() is, so that both tell the same point.
        const glm::dvec3 turned = rotation * glm::dvec3(glm::dvec2(glm::vec2(ray)), 1);
        return std::array{static_cast<float>(turned.x), static_cast<float>(turned.y),
                          static_cast<float>(turned.z)};
    };
    for (auto& channel : channel_) channel.resize(nodes.nodes.size());
    for (std::size_t i = 0; i < nodes.nodes.size(); ++i) {
        const std::array<float, 3> ray = turn(nodes.nodes.pixels()[i]);
        for (std::size_t k = 0; k < 3; ++k) channel_[k][i] = ray[k];
    }
    exact_.reserve(nodes.exact.size());
    for (const auto& [pixel, ray] : nodes.exact) exact_.push_back({pixel, turn(ray)});
}

std::size_t RayTable::bytes() const {
    return 3 * channel_[0].size() * sizeof(float) + exact_.size() * sizeof(Exact);
}

void RayTable::read_row(int y, int first, int n, const std::array<float*, 3>& out) const {
    const int above = std::min(y / step_, std::max((height_ - 1 + step_ - 1) / step_ - 1, 0));
    const int top = above * step_;
    const int bottom = node_position(above + 1, height_, step_);
    const float down =
        bottom > top ? static_cast<float>(y - top) / static_cast<float>(bottom - top) : 0.0f;
    const auto upper_row = static_cast<std::size_t>(above) * static_cast<std::size_t>(columns_);
    const auto lower_row =
        bottom > top ? upper_row + static_cast<std::size_t>(columns_) : upper_row;
    const int end = first + n;
    const int last_left = std::max(columns_ - 2, 0);
    for (std::size_t k = 0; k < 3; ++k) {
        const float* upper = channel_[k].data() + upper_row;
        const float* lower = channel_[k].data() + lower_row;
        const auto at = [&](int node) { return upper[node] + (lower[node] - upper[node]) * down; };
        float* to = out[k];
        int node = std::min(first / step_, last_left);
        float at_left = at(node);
        for (int x = first; x < end; ++node) {
            const int next = std::min(node + 1, columns_ - 1);
            const int left = node * step_;
            const int right = node_position(next, width_, step_);
            const float at_right = at(next);
            const float share = right - left == step_ ? inverse_step_
                                : right > left        ? 1.0f / static_cast<float>(right - left)
                                                      : 0.0f;
            const float slope = (at_right - at_left) * share;
            const int stop = node == last_left ? end : std::min(end, right);
            for (; x < stop; ++x) to[x - first] = at_left + slope * static_cast<float>(x - left);
            at_left = at_right;
        }
    }
}

void RayTable::read(std::size_t first, std::size_t n, float* x, float* y, float* z) const {
    if (n == 0) return;
    if (step_ == 1) {
        float* const out[] = {x, y, z};
        for (std::size_t k = 0; k < 3; ++k) {
            std::memcpy(out[k], channel_[k].data() + first, n * sizeof(float));
        }
        return;
    }
    const auto width = static_cast<std::size_t>(width_);
    for (std::size_t done = 0; done < n;) {
        const std::size_t row = (first + done) / width;
        const std::size_t column = (first + done) % width;
        const std::size_t count = std::min(n - done, width - column);
        read_row(static_cast<int>(row), static_cast<int>(column), static_cast<int>(count),
                 {x + done, y + done, z + done});
        done += count;
    }
    auto own = std::ranges::lower_bound(exact_, first, {}, &Exact::pixel);
    for (; own != exact_.end() && own->pixel < first + n; ++own) {
        const std::size_t at = own->pixel - first;
        x[at] = own->ray[0];
        y[at] = own->ray[1];
        z[at] = own->ray[2];
    }
}

}  // namespace kino::registration
