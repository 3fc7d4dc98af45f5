#pragma once

#include <cstdint>
#include <vector>

#include "base/image.h"
#include "base/time.h"

namespace kino {

struct BackgroundOptions {
    float noise_per_m = 0.0017f;  ///< sigma(z) = this z^2; the Kinect v1's with rounding
    float sigmas = 5;             ///< how far before the background something must be
    float least_m = 0.03f;        ///< and at least this
    double learn_s = 0.5;         ///< an unknown or farther surface is learned after so long
    double near_s = 3;            ///< within a person's reach, where hands and sheets pause
    double absorb_s = 10;         ///< a nearer one that is nobody: a chair that was put there
    double adapt_s = 2;           ///< time constant of the slow adaptation
};

/// The still room, one depth a cell: the farthest that was stable. Cells in which a person is seen,
/// and their neighbours, learn nothing, so whoever stands still stays in front.
class Background {
  public:
    explicit Background(const BackgroundOptions& options) : options_(options) {}

    void reset(int width, int height);

    /// Readings nearer than this are in front. 0: nothing is known there.
    [[nodiscard]] float limit_m(std::size_t cell) const { return limit_[cell]; }
    /// Readings farther than this disprove what is known.
    [[nodiscard]] float beyond_m(std::size_t cell) const { return beyond_[cell]; }
    [[nodiscard]] float depth_m(std::size_t cell) const { return cells_[cell].depth_m; }
    [[nodiscard]] float known_share() const;

    static constexpr std::uint8_t kPerson = 1, kNearPerson = 2;

    /// Learns from one picture, 0 = no reading. `person`: kPerson where somebody is seen, or may
    /// be, kNearPerson within his reach, else 0. Both of the size given to reset(); times do not
    /// fall.
    void learn(const Image<float>& z_m, const Image<std::uint8_t>& person, TimeNs time);

  private:
    struct Cell {
        float depth_m = 0;        // 0: unknown
        float deviation_m = 0;    // mean distance of the readings that matched
        float waiting_m = 0;      // a surface that may become the background
        std::int32_t waited = 0;  // readings of it
        TimeNs since = 0;
    };
    [[nodiscard]] float noise_m(float z) const;
    [[nodiscard]] float threshold_m(const Cell& cell) const;
    void wait(Cell& cell, float z, TimeNs time) const;

    BackgroundOptions options_;
    int width_ = 0;
    std::vector<Cell> cells_;
    std::vector<float> limit_, beyond_;
    Image<std::uint8_t> kept_;  // the person and what is next to him
    TimeNs last_ = 0;
    bool first_ = true;
};

}  // namespace kino
