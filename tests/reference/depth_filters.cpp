#include "tests/reference/depth_filters.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <optional>

namespace kino::reference {
namespace {

constexpr double kStep = 0.00307;

double reading(double z) {
    return std::isfinite(z) && z >= 0.001 && z <= 1000 ? z : 0;
}

double reading_at(const Image<float>& in, int x, int y) {
    return in.contains(x, y) ? reading(in.at(x, y)) : 0;
}

// Depth units: how far from z a surface may reach over `pixels`.
double jump_limit(double steps, double angle_deg, double focal_px, double z, double pixels) {
    return steps * kStep + std::tan(angle_deg * std::numbers::pi / 180) * pixels / (focal_px * z);
}

template <class Value>
Image<double> each(const Image<float>& in, Value value) {
    Image<double> out(in.width(), in.height());
    for (int y = 0; y < in.height(); ++y) {
        for (int x = 0; x < in.width(); ++x) out.at(x, y) = value(x, y);
    }
    return out;
}

struct Side {
    double z;
    int distance;
};

std::optional<Side> look(const Image<float>& in, int x, int y, int dx, int dy) {
    for (int i = 1; in.contains(x + i * dx, y + i * dy); ++i) {
        const double z = reading_at(in, x + i * dx, y + i * dy);
        if (z > 0) return Side{z, i};
    }
    return std::nullopt;
}

struct Crossing {
    double z;
    int gap;
};

}  // namespace

Image<double> flying_pixels(const Image<float>& in, double steps, double angle_deg, int support,
                            double focal_px) {
    return each(in, [&](int x, int y) -> double {
        const double z = reading_at(in, x, y);
        if (z == 0) return 0;
        const double limit = jump_limit(steps, angle_deg, focal_px, z, 1);
        // -1: nearer than a surface could be, 1: farther, 0: the same surface.
        const auto compare = [&](int dx, int dy) -> std::optional<int> {
            const double other = reading_at(in, x + dx, y + dy);
            if (other == 0) return std::nullopt;
            const double difference = 1 / z - 1 / other;
            return difference > limit ? 1 : difference < -limit ? -1 : 0;
        };
        int agreeing = 0;
        for (int dy = -1; dy <= 1; ++dy) {
            for (int dx = -1; dx <= 1; ++dx) {
                if (dx == 0 && dy == 0) continue;
                const auto one = compare(dx, dy);
                const auto opposite = compare(-dx, -dy);
                if (one == 0) ++agreeing;
                if (one && opposite && *one * *opposite == -1) return 0;
            }
        }
        return agreeing >= support ? z : 0;
    });
}

Image<double> spatial(const Image<float>& in, int radius, double sigmas, double noise) {
    const double threshold = sigmas * noise;
    return each(in, [&](int x, int y) -> double {
        const double z = reading_at(in, x, y);
        if (z == 0) return 0;
        double sum = 0;
        double weights = 0;
        for (int v = y - radius; v <= y + radius; ++v) {
            for (int u = x - radius; u <= x + radius; ++u) {
                const double other = reading_at(in, u, v);
                const double distance = std::hypot(u - x, v - y) / (radius + 1);
                if (other == 0 || distance >= 1) continue;
                const double difference = std::abs(1 / other - 1 / z) / threshold;
                if (difference >= 1) continue;
                const double weight = (1 - difference * difference) * (1 - distance * distance);
                sum += weight / other;
                weights += weight;
            }
        }
        return weights / sum;
    });
}

Image<double> fill_holes(const Image<float>& in, int gap, double steps, double angle_deg,
                         double focal_px, int edge, bool background) {
    const auto cross = [&](int x, int y, int dx, int dy) -> std::optional<Crossing> {
        const auto a = look(in, x, y, -dx, -dy);
        const auto b = look(in, x, y, dx, dy);
        if (!a || !b || a->distance + b->distance - 1 > gap) return std::nullopt;
        const int length = a->distance + b->distance;
        const double far = std::max(a->z, b->z);
        const double limit = jump_limit(steps, angle_deg, focal_px, far, length);
        if (std::abs(1 / a->z - 1 / b->z) <= limit) {
            const double inverse = (b->distance / a->z + a->distance / b->z) / length;
            return Crossing{1 / inverse, length};
        }
        if (!background) return std::nullopt;
        if (length - 1 <= edge && a->distance != b->distance) {
            return Crossing{a->distance < b->distance ? a->z : b->z, length};
        }
        return Crossing{far, length};
    };
    return each(in, [&](int x, int y) -> double {
        if (const double z = reading_at(in, x, y); z > 0) return z;
        const auto row = cross(x, y, 1, 0);
        const auto column = cross(x, y, 0, 1);
        if (row && column) {
            if (row->gap == column->gap) return std::max(row->z, column->z);
            return row->gap < column->gap ? row->z : column->z;
        }
        return row ? row->z : column ? column->z : 0;
    });
}

Image<double> decimate(const Image<float>& in, int factor, double steps, int readings) {
    Image<double> out((in.width() + factor - 1) / factor, (in.height() + factor - 1) / factor);
    for (int y = 0; y < out.height(); ++y) {
        for (int x = 0; x < out.width(); ++x) {
            std::vector<double> block;
            for (int i = 0; i < factor * factor; ++i) {
                const double z = reading_at(in, x * factor + i % factor, y * factor + i / factor);
                if (z > 0) block.push_back(z);
            }
            if (block.empty() || static_cast<int>(block.size()) < readings) continue;
            std::sort(block.begin(), block.end());
            const double median = block[(block.size() - 1) / 2];
            double sum = 0;
            int used = 0;
            for (const double z : block) {
                if (std::abs(1 / z - 1 / median) > steps * kStep) continue;
                sum += 1 / z;
                ++used;
            }
            out.at(x, y) = used / sum;
        }
    }
    return out;
}

Image<double> Temporal::next(const Image<float>& in) {
    frames_.push_back(in);
    const Parameters& p = parameters_;
    return each(in, [&](int x, int y) {
        double mean = 0;  // 1/m, 0 = nothing
        double weight = 0;
        int unseen = 0;
        for (const Image<float>& frame : frames_) {
            const double z = reading_at(frame, x, y);
            if (z == 0) {
                if (++unseen > p.persistence) mean = 0;
                continue;
            }
            unseen = 0;
            const double change = mean > 0 ? (1 / z - mean) / (p.sigmas * p.noise) : 1;
            if (std::abs(change) >= 1) {
                mean = 1 / z;
                weight = 1;
                continue;
            }
            const double novelty = p.soft ? std::pow(change, 4) : 0;
            const double usual = p.running ? std::max(1 / (weight + 1), p.alpha) : p.alpha;
            const double gain = usual * (1 - novelty) + novelty;
            mean = (1 - gain) * mean + gain / z;
            weight = weight * (1 - novelty) + 1;
            if (p.alpha > 0) weight = std::min(weight, 1 / p.alpha);
        }
        return mean > 0 ? 1 / mean : 0.0;
    });
}

namespace librealsense {
namespace {

// One pass over the values first, first + stride, ...: differences count between the values as they
// came, smoothing starts anew after every hole and every edge.
void pass(double* first, std::ptrdiff_t stride, int count, double alpha, double delta) {
    double state = 0;
    double before = 0;
    for (int i = 0; i < count; ++i) {
        double& value = first[i * stride];
        const double came = value;
        if (came > 0) {
            const bool joins = before > 0 && std::abs(before - came) < delta;
            state = joins ? alpha * came + (1 - alpha) * state : came;
            value = state;
        }
        before = came;
    }
}

}  // namespace

void spatial(Image<double>& values, double alpha, double delta, int magnitude) {
    const int w = values.width();
    const int h = values.height();
    for (int round = 0; round < magnitude; ++round) {
        for (int y = 0; y < h; ++y) {
            pass(values.row(y), 1, w, alpha, delta);
            pass(values.row(y) + (w - 1), -1, w, alpha, delta);
        }
        for (int x = 0; x < w; ++x) {
            pass(values.row(0) + x, w, h, alpha, delta);
            pass(values.row(h - 1) + x, -w, h, alpha, delta);
        }
    }
}

void Temporal::next(Image<double>& values) {
    if (last_.empty()) {
        last_ = Image<double>(values.width(), values.height());
        seen_ = Image<std::uint8_t>(values.width(), values.height());
    }
    for (std::size_t i = 0; i < values.size(); ++i) {
        double& value = values.pixels()[i];
        double& last = last_.pixels()[i];
        std::uint8_t& seen = seen_.pixels()[i];
        const int recently = (seen & 1) + (seen >> 1 & 1) + (seen >> 2 & 1) + (seen >> 3 & 1);
        const bool came = value > 0;
        if (came) {
            if (last > 0 && std::abs(value - last) < delta_) {
                value = alpha_ * value + (1 - alpha_) * last;
            }
            last = value;
        } else if (recently >= 2) {
            value = last;
        }
        seen = static_cast<std::uint8_t>(seen << 1 | (came ? 1 : 0));
    }
}

void fill_holes(Image<double>& metres) {
    for (int y = 1; y + 1 < metres.height(); ++y) {
        for (int x = 1; x < metres.width(); ++x) {
            if (metres.at(x, y) > 0) continue;
            metres.at(x, y) =
                std::max({metres.at(x, y - 1), metres.at(x - 1, y - 1), metres.at(x - 1, y),
                          metres.at(x - 1, y + 1), metres.at(x, y + 1)});
        }
    }
}

Image<double> decimate(const Image<double>& metres, int factor) {
    Image<double> out(metres.width() / factor, metres.height() / factor);
    for (int y = 0; y < out.height(); ++y) {
        for (int x = 0; x < out.width(); ++x) {
            std::vector<double> block;
            for (int i = 0; i < factor * factor; ++i) {
                const double z = metres.at(x * factor + i % factor, y * factor + i / factor);
                if (z > 0) block.push_back(z);
            }
            if (block.empty()) continue;
            std::sort(block.begin(), block.end());
            double sum = 0;
            for (const double z : block) sum += z;
            out.at(x, y) = factor <= 3 ? block[(block.size() - 1) / 2]
                                       : sum / static_cast<double>(block.size());
        }
    }
    return out;
}

}  // namespace librealsense
}  // namespace kino::reference
