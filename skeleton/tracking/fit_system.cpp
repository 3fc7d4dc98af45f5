#include "skeleton/tracking/fit_system.h"

#include <algorithm>
#include <cmath>

#include "skeleton/tracking/small_solver.h"

namespace kino {

void FitSystem::clear() {
    for (BoneSums& bone : bones_) {
        bone.h.fill(0);
        bone.g.fill(0);
        bone.used = false;
    }
    h_.fill(0);
    g_.fill(0);
}

void FitSystem::add_on_bone(Bone bone, float t, const glm::vec3& n, float radius_m, float residual,
                            float weight) {
    BoneSums& sums = bones_[static_cast<std::size_t>(bone)];
    sums.used = true;
    const float a = t - 1, b = -t;
    const std::array<float, 7> v = {a * n.x, a * n.y, a * n.z,  b * n.x,
                                    b * n.y, b * n.z, -radius_m};
    std::size_t k = 0;
    for (std::size_t i = 0; i < 7; ++i) {
        const float wv = weight * v[i];
        sums.g[i] += wv * residual;
        for (std::size_t j = i; j < 7; ++j) sums.h[k++] += wv * v[j];
    }
}

void FitSystem::add(std::span<const Term> terms, double residual, double weight) {
    for (const Term& a : terms) {
        const auto i = static_cast<std::size_t>(a.unknown);
        g_[i] += weight * a.derivative * residual;
        for (const Term& b : terms) {
            h_[i * kUnknowns + static_cast<std::size_t>(b.unknown)] +=
                weight * a.derivative * b.derivative;
        }
    }
}

void FitSystem::gather(const JointedModel& model) {
    constexpr std::size_t kMax = 2 * NodeJacobian::kMax + 1;
    for (std::size_t index = 0; index < kBoneCount; ++index) {
        const BoneSums& sums = bones_[index];
        if (!sums.used) continue;
        const BoneShape& shape = bone_shape(static_cast<Bone>(index));
        // Columns: derivative of (from, to, girth) by each unknown that moves them.
        std::array<int, kUnknowns> place;
        place.fill(-1);
        std::array<std::size_t, kMax> unknown;
        std::array<std::array<double, 7>, kMax> column;
        std::size_t count = 0;
        const auto column_of = [&](std::size_t u) -> std::array<double, 7>& {
            if (place[u] < 0) {
                place[u] = static_cast<int>(count);
                unknown[count] = u;
                column[count++].fill(0);
            }
            return column[static_cast<std::size_t>(place[u])];
        };
        for (std::size_t end = 0; end < 2; ++end) {
            const NodeJacobian& j = model.jacobian[end == 0 ? shape.from : shape.to];
            for (std::size_t e = 0; e < static_cast<std::size_t>(j.count); ++e) {
                std::array<double, 7>& c = column_of(j.unknown[e]);
                for (int k = 0; k < 3; ++k) {
                    c[3 * end + static_cast<std::size_t>(k)] +=
                        static_cast<double>(j.derivative[e][k]);
                }
            }
        }
        column_of(static_cast<std::size_t>(kShapeUnknown + kLengthCount) +
                  static_cast<std::size_t>(shape.girth))[6] = 1;
        std::array<std::array<double, 7>, 7> full;
        std::size_t k = 0;
        for (std::size_t i = 0; i < 7; ++i) {
            for (std::size_t j = i; j < 7; ++j) {
                full[i][j] = full[j][i] = static_cast<double>(sums.h[k++]);
            }
        }
        for (std::size_t a = 0; a < count; ++a) {
            std::array<double, 7> hc{};
            double g = 0;
            for (std::size_t i = 0; i < 7; ++i) {
                const double c = column[a][i];
                if (c == 0) continue;
                g += c * static_cast<double>(sums.g[i]);
                for (std::size_t j = 0; j < 7; ++j) hc[j] += c * full[i][j];
            }
            g_[unknown[a]] += g;
            for (std::size_t b = 0; b <= a; ++b) {
                double sum = 0;
                for (std::size_t j = 0; j < 7; ++j) sum += hc[j] * column[b][j];
                h_[unknown[a] * kUnknowns + unknown[b]] += sum;
                if (a != b) h_[unknown[b] * kUnknowns + unknown[a]] += sum;
            }
        }
    }
}

std::span<const float> FitSystem::solve(int free, double damping) {
    const auto n = static_cast<std::size_t>(free);
    for (std::size_t i = 0; i < n; ++i) {
        for (std::size_t j = 0; j <= i; ++j) factor_[i * n + j] = h_[i * kUnknowns + j];
        factor_[i * n + i] += damping;
        x_[i] = -g_[i];
    }
    solve_symmetric(std::span(factor_).first(n * n), std::span(x_).first(n), free);
    step_.fill(0);
    const bool finite =
        std::all_of(x_.begin(), x_.begin() + free, [](double x) { return std::isfinite(x); });
    if (finite) {
        for (std::size_t i = 0; i < n; ++i) step_[i] = static_cast<float>(x_[i]);
    }
    return step_;
}

double FitSystem::information(int unknown, int free) {
    const auto n = static_cast<std::size_t>(free);
    const double variance =
        inverse_diagonal(std::span<const double>(factor_).first(n * n), free, unknown, x_);
    return variance > 0 && std::isfinite(variance) ? 1 / variance : 0;
}

}  // namespace kino
