#pragma once

#include <array>
#include <glm/vec3.hpp>
#include <initializer_list>
#include <span>

#include "skeleton/tracking/jointed_model.h"

namespace kino {

/// The normal equations of one Gauss-Newton step. Residuals on a bone depend on its two ends and
/// its girth alone, so they are summed in these seven numbers and meet the unknowns once for each
/// bone.
class FitSystem {
  public:
    void clear();

    /// Residual n . (p - q) - r of a point p, where q = from + t (to - from) on the bone and r the
    /// radius there before the girth's factor; `n` unit or a multiple. radius 0: a point on the
    /// axis.
    void add_on_bone(Bone bone, float t, const glm::vec3& n, float radius_m, float residual,
                     float weight);
    /// Residual whose derivatives by a few unknowns are given.
    struct Term {
        int unknown;
        double derivative;
    };
    void add(std::span<const Term> terms, double residual, double weight);
    void add(std::initializer_list<Term> terms, double residual, double weight) {
        add(std::span(terms.begin(), terms.size()), residual, weight);
    }

    /// Brings the bones' sums to the unknowns; the model must be linearized.
    void gather(const JointedModel& model);

    /// The step that Gauss-Newton takes, with `damping` added to the diagonal. Unknowns from `free`
    /// on stay. Zero where nothing is known.
    [[nodiscard]] std::span<const float> solve(int free, double damping);

    /// After solve(): information about an unknown, everything else being uncertain too.
    [[nodiscard]] double information(int unknown, int free);

    [[nodiscard]] double gradient(int unknown) const {
        return g_[static_cast<std::size_t>(unknown)];
    }
    [[nodiscard]] double curvature(int a, int b) const {
        return h_[static_cast<std::size_t>(a * kUnknowns + b)];
    }

  private:
    struct BoneSums {
        std::array<float, 28> h;  // upper triangle by rows
        std::array<float, 7> g;
        bool used;
    };
    std::array<BoneSums, kBoneCount> bones_;
    std::array<double, kUnknowns * kUnknowns> h_, factor_;
    std::array<double, kUnknowns> g_, x_;
    std::array<float, kUnknowns> step_;
};

}  // namespace kino
