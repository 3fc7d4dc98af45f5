#pragma once

#include <memory>

#include "apps/pipeline/processed_frame.h"
#include "apps/pipeline/recycling_pool.h"
#include "calibration/rig.h"

namespace kino {

/// Colour that belongs to an earlier moment is drawn at this brightness, so that nobody takes it
/// for the present.
constexpr double kUnpairedBrightness = 0.5;

/// Turns frame sets into surfaces: colour decoded, depth in metres, colour in the depth grid. One
/// thread at a time. The surfaces' memory is used again once nobody holds them, so after the first
/// few frames nothing big is allocated.
class Processor {
  public:
    /// Fails where Rig::create does.
    [[nodiscard]] static Result<Processor> create(const RigParameters& parameters,
                                                  const RigOptions& options = {});

    /// Fails for a set without depth and where Rig::register_depth or to_rgba8 do; the next frame
    /// is not touched by that. `times.read` is left 0.
    [[nodiscard]] Result<ProcessedFrame> process(FrameSet set);

    /// What the last frame left behind (the last colour) is forgotten: after a seek.
    void forget() { last_color_.reset(); }

    [[nodiscard]] const Rig& rig() const { return rig_; }

  private:
    explicit Processor(Rig rig);

    Result<void> take_color(const FrameSet& set);

    Rig rig_;
    std::shared_ptr<const Image<RayXy>> rays_;
    RegisteredDepth registered_;
    RecyclingPool<DepthSurface> surfaces_;
    RecyclingPool<Image<Rgba8>> colors_;
    std::shared_ptr<const Image<Rgba8>> last_color_;
    std::uint64_t version_ = 0;
};

}  // namespace kino
