#pragma once

#include <glm/vec3.hpp>
#include <span>

namespace kino {

/// Bounds that every way of choosing keeps: z goes up at once, and down by one when the picture at
/// z - 1 would have been in time for so many frames in a row. Steps of z are coarse (from 1 to 2
/// there are four times fewer pixels); without this a load between two of them makes z swing.
struct ZoomRules {
    double target_ms = 1000.0 / 30;
    int most = 4;  ///< z, at most kMaxZoom
    int release_frames = 8;
    double release_part = 0.85;  ///< of the target, that the picture at z - 1 may take
    /// Of the frame at z = 1, that coarser pictures must save: the whole zoom where it brings the
    /// frame within the target, else each step of it. Where polygons or the copy are the cost, none
    /// does, and z stays 1. 0: any zoom is taken.
    double least_saving = 0;
};

/// What a chosen zoom says of the target.
struct ZoomChoice {
    int z = 1;
    bool unreachable = false;  ///< no zoom brings the frame within the target
};

/// Goes down as the rules say, up at once.
class ZoomRelease {
  public:
    explicit ZoomRelease(const ZoomRules& rules) : rules_(rules) {}
    /// `wanted`: the zoom this frame asks for. `below_ms`: what a frame at z() - 1 is expected to
    /// take. Returns z().
    int follow(int wanted, double below_ms);
    /// follow() for frames that are expected to take `ms`, z = 1 first, `most` in all.
    ZoomChoice choose(std::span<const double> ms);
    [[nodiscard]] int z() const { return z_; }
    void reset() { z_ = 1, calm_frames_ = 0; }

  private:
    [[nodiscard]] ZoomChoice smallest(std::span<const double> ms) const;

    ZoomRules rules_;
    int z_ = 1;
    int calm_frames_ = 0;
};

/// Chooses by the last frame's time (Mazuryk et al., "Zoom Rendering", section 6): what a frame
/// takes apart from its pixels stays, its pixels go with 1/z^2.
class ReactiveZoom {
  public:
    explicit ReactiveZoom(const ZoomRules& rules) : rules_(rules), release_(rules) {}
    /// The last frame's time and the part of it that goes with pixels, at choice().z. `copy_ms`:
    /// what enlarging takes, or would. Times that are no numbers or below 0 change nothing.
    ZoomChoice frame_took(double frame_ms, double pixel_ms, double copy_ms = 0);
    [[nodiscard]] ZoomChoice choice() const { return choice_; }
    void reset();

  private:
    ZoomRules rules_;
    ZoomRelease release_;
    ZoomChoice choice_;
};

struct HeadSpeedOptions {
    double turn_deg_s = 60;  ///< another step of z for each
    double move_m_s = 0.4;
    int most = 4;
    double release_s = 0.15;  ///< time constant with which a speed is forgotten
};

/// Chooses by how fast the head moves: who looks around quickly sees latency, not pixels.
class HeadSpeedZoom {
  public:
    explicit HeadSpeedZoom(const HeadSpeedOptions& options = {}) : options_(options) {}
    /// Speeds at a moment `dt_s` after the last one. Those that are no numbers count as 0.
    int step(double dt_s, const glm::dvec3& velocity_m_s, double turn_deg_s = 0);
    [[nodiscard]] int z() const { return z_; }

  private:
    HeadSpeedOptions options_;
    double steps_ = 0;
    int z_ = 1;
};

/// How a finished picture reaches the screen.
enum class FrameSync : unsigned char { fifo, free_running };
/// Time from picture to picture where one takes `frame_ms`: fifo waits for the next retrace,
/// ceil(t f) / f.
[[nodiscard]] double frame_interval_ms(double frame_ms, double refresh_hz, FrameSync sync);

}  // namespace kino
