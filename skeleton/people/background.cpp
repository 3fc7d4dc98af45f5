#include "skeleton/people/background.h"

#include <algorithm>
#include <cmath>

namespace kino {
namespace {

constexpr int kMargin = 2;             // cells beside a person that learn nothing
constexpr std::int32_t kReadings = 3;  // needed beside the time, for slow sources
constexpr float kLargestDeviationM = 0.15f;

void widen(const Image<std::uint8_t>& from, Image<std::uint8_t>& to) {
    to.resize(from.width(), from.height());
    std::fill(to.pixels().begin(), to.pixels().end(), std::uint8_t{0});
    for (int y = 0; y < from.height(); ++y) {
        for (int x = 0; x < from.width(); ++x) {
            if (from.at(x, y) != Background::kPerson) continue;
            const int x0 = std::max(x - kMargin, 0), x1 = std::min(x + kMargin + 1, from.width());
            const int y1 = std::min(y + kMargin + 1, from.height());
            for (int v = std::max(y - kMargin, 0); v < y1; ++v) {
                std::fill(to.row(v) + x0, to.row(v) + x1, std::uint8_t{1});
            }
        }
    }
}

}  // namespace

void Background::reset(int width, int height) {
    width_ = width;
    const auto count = static_cast<std::size_t>(width) * static_cast<std::size_t>(height);
    cells_.assign(count, {});
    limit_.assign(count, 0.0f);
    beyond_.assign(count, 0.0f);
    first_ = true;
}

float Background::noise_m(float z) const {
    return std::max(options_.least_m, options_.sigmas * options_.noise_per_m * z * z);
}

float Background::threshold_m(const Cell& cell) const {
    return noise_m(cell.depth_m) + 3 * cell.deviation_m;
}

float Background::known_share() const {
    if (cells_.empty()) return 0;
    const auto known = std::count_if(limit_.begin(), limit_.end(), [](float l) { return l > 0; });
    return static_cast<float>(known) / static_cast<float>(limit_.size());
}

void Background::wait(Cell& cell, float z, TimeNs time) const {
    if (cell.waited > 0 && std::abs(z - cell.waiting_m) <= 2 * noise_m(cell.waiting_m)) {
        ++cell.waited;
        cell.waiting_m += (z - cell.waiting_m) / static_cast<float>(std::min(cell.waited, 16));
    } else {
        cell.waiting_m = z;
        cell.waited = 1;
        cell.since = time;
    }
}

void Background::learn(const Image<float>& z_m, const Image<std::uint8_t>& person, TimeNs time) {
    KINO_CHECK(z_m.size() == cells_.size() && person.size() == cells_.size());
    const double dt = first_ ? 0 : to_seconds(std::max<TimeNs>(time - last_, 0));
    first_ = false;
    last_ = time;
    const auto rate = static_cast<float>(1 - std::exp(-dt / options_.adapt_s));
    widen(person, kept_);
    for (std::size_t i = 0; i < cells_.size(); ++i) {
        const float z = z_m.data()[i];
        Cell& cell = cells_[i];
        if (z == 0) continue;
        if (kept_.data()[i]) {
            cell.waited = 0;
            continue;
        }
        const float limit = cell.depth_m == 0 ? 0 : threshold_m(cell);
        if (cell.depth_m != 0 && std::abs(z - cell.depth_m) <= limit) {
            const float away = std::abs(z - cell.depth_m);
            cell.deviation_m =
                std::min(cell.deviation_m + rate * (away - cell.deviation_m), kLargestDeviationM);
            cell.depth_m += rate * (z - cell.depth_m);
            // A single match does not end the wait: a slope's readings jump from cell to cell.
            if (cell.waited > 0) --cell.waited;
        } else {
            wait(cell, z, time);
            const bool nearer = cell.depth_m != 0 && z < cell.depth_m;
            const bool near = person.data()[i] == kNearPerson;
            const double needed = nearer ? options_.absorb_s
                                  : near ? options_.near_s
                                         : options_.learn_s;
            if (cell.waited >= kReadings && to_seconds(time - cell.since) >= needed) {
                cell.depth_m = cell.waiting_m;
                cell.deviation_m = 0;
                cell.waited = 0;
            }
        }
        beyond_[i] = cell.depth_m + 2 * threshold_m(cell);
        limit_[i] = cell.depth_m == 0 ? 0 : std::max(cell.depth_m - threshold_m(cell), 0.01f);
    }
}

}  // namespace kino
