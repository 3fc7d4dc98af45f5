#pragma once

#include <array>
#include <cstdint>
#include <glm/vec3.hpp>
#include <span>
#include <vector>

#include "skeleton/forest/body_part.h"
#include "skeleton/tracking/jointed_model.h"

namespace kino {

/// Where on the model a part's surface lies.
struct PartPlace {
    Bone bone;
    float from, to;  ///< along the bone, 0..1
    float middle;    ///< along the bone: where the surface seen has its middle
    float inward_m;  ///< from there to the bone, along the view
};
[[nodiscard]] const PartPlace& part_place(BodyPart part);

/// A part that a point may belong to.
struct PartCandidate {
    std::uint8_t part = 0;
    float cost = 0;  ///< -log of its share
};

/// A labelled point of the surface, depth-camera space.
struct PartPoint {
    static constexpr int kCandidates = 5;
    glm::vec3 at_m{0};
    int count = 0;
    std::array<PartCandidate, kCandidates> candidate;  ///< the likeliest first
};

/// One person's labelled points. Reuses its memory.
class PartPoints {
  public:
    void clear();
    /// `share`: of each BodyPart, sums to about 1. Points nearer than 0.1 m are ignored.
    void add(const glm::vec3& at_m, std::span<const float> share);

    [[nodiscard]] std::size_t size() const { return at_.size(); }
    [[nodiscard]] const glm::vec3& at_m(std::size_t i) const { return at_[i]; }
    [[nodiscard]] std::span<const float> share(std::size_t i) const {
        return {share_.data() + i * kBodyPartCount, kBodyPartCount};
    }

    /// A thinned copy for the fit: at most about `per_part` points of each likeliest part.
    void choose(int per_part, std::vector<PartPoint>& out) const;

  private:
    std::vector<glm::vec3> at_;
    std::vector<float> share_;
    std::vector<std::uint8_t> best_;
    std::array<int, kBodyPartCount> count_{};
};

}  // namespace kino
