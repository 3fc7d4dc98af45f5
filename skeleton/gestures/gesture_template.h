#pragma once

#include <array>
#include <glm/vec3.hpp>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "base/error.h"
#include "skeleton/gestures/gesture_event.h"

namespace kino {

/// A movement of the hands in body space (body_space.h), in order of time. Hands that a gesture
/// does not use may hold anything.
struct HandPath {
    struct Sample {
        double time_s = 0;
        std::array<glm::dvec3, 2> hand{};  ///< left, right
    };
    std::vector<Sample> samples;
};

/// A gesture learned from examples. Each example is resampled to 32 samples at even times; a
/// movement is as far from it as dynamic time warping says (Sakoe & Chiba 1978, symmetric steps,
/// band of 6 samples): the mean distance of the hands along the best warp, arm lengths.
class GestureTemplate {
  public:
    static constexpr std::size_t kSamples = 32;
    static constexpr std::size_t kMaxExamples = 16;
    using Example = std::vector<std::array<glm::dvec3, 2>>;  // kSamples of them

    /// Learns from three or more examples (at most 16). The rejection threshold is 1.6 times the
    /// largest distance between two of them, at least 0.12. Errors: too few examples, one of less
    /// than 0.2 s or more than 5 s or with a hand that travels less than 0.5 in all, examples that
    /// are further than 0.35 from each other.
    [[nodiscard]] static Result<GestureTemplate> learn(std::string name, Hand hand,
                                                       std::span<const HandPath> examples);

    /// What learn() made and a file kept. Checks the ranges, and that all is finite.
    [[nodiscard]] static Result<GestureTemplate> restore(std::string name, Hand hand,
                                                         double least_s, double most_s,
                                                         double threshold,
                                                         std::vector<Example> examples);

    /// Of the nearest example; infinite for a path of fewer than two samples.
    [[nodiscard]] double distance(const HandPath& path) const;

    [[nodiscard]] const std::string& name() const { return name_; }
    [[nodiscard]] Hand hand() const { return hand_; }
    [[nodiscard]] double threshold() const { return threshold_; }
    /// Durations that are tried: from 0.6 of the shortest example to 1.6 of the longest.
    [[nodiscard]] double least_s() const { return least_s_; }
    [[nodiscard]] double most_s() const { return most_s_; }
    [[nodiscard]] const std::vector<Example>& examples() const { return examples_; }

    friend bool operator==(const GestureTemplate&, const GestureTemplate&) = default;

  private:
    [[nodiscard]] double distance(const Example& a, const Example& b) const;

    std::string name_;
    Hand hand_ = Hand::right;
    double least_s_ = 0, most_s_ = 0, threshold_ = 0;
    std::vector<Example> examples_;
};

}  // namespace kino
