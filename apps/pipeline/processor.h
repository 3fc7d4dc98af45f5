#pragma once

#include <memory>
#include <optional>

#include "apps/pipeline/processed_frame.h"
#include "apps/pipeline/recycling_pool.h"
#include "calibration/depth_bias.h"
#include "calibration/rig.h"
#include "sensor/filters/depth_filter_chain.h"

namespace kino {

/// Colour that belongs to an earlier moment is drawn at this brightness, so that nobody takes it
/// for the present.
constexpr double kUnpairedBrightness = 0.5;

/// Turns frame sets into surfaces: colour decoded, depth in metres, colour in the depth grid. One
/// thread at a time. The surfaces' memory is used again once nobody holds them, so after the first
/// few frames nothing big is allocated.
class Processor {
  public:
    /// Fails where Rig::create does. `filters` work on the depth before it is registered; with
    /// decimation, rig() is that of the smaller picture. `bias`: what the device's depth is off by,
    /// taken away before anything else.
    [[nodiscard]] static Result<Processor> create(const RigParameters& parameters,
                                                  const RigOptions& options = {},
                                                  DepthFilterChain filters = {},
                                                  const std::optional<DepthBias>& bias = {});

    /// Fails for a set without any picture and where Rig::register_depth or to_rgba8 do; the next
    /// frame is not touched by that. `times.read` is left 0.
    [[nodiscard]] Result<ProcessedFrame> process(FrameSet set);

    /// What the last frames left behind (the last colour, what filters hold) is forgotten: after a
    /// seek.
    void forget() {
        last_color_.reset();
        filters_.reset();
    }

    [[nodiscard]] const Rig& rig() const { return rig_; }
    [[nodiscard]] const DepthFilterChain& filters() const { return filters_; }

  private:
    explicit Processor(Rig rig);

    Result<void> take_color(const FrameSet& set);
    Result<void> make_surface(const FrameSet& set, ProcessedFrame& out);
    /// The set's depth: corrected if there is a bias, filtered if there are filters.
    Result<const DepthFrame*> filtered(const FrameSet& set);

    Rig rig_;
    DepthFilterChain filters_;
    std::optional<BiasTable> bias_;
    std::optional<Rig> metres_;  ///< to metres only, for bias and filters
    RegisteredDepth unfiltered_;
    Image<float> filtered_m_;
    DepthFrame filtered_;
    std::shared_ptr<const Image<RayXy>> rays_;
    RegisteredDepth registered_;
    RecyclingPool<DepthSurface> surfaces_;
    RecyclingPool<Image<Rgba8>> colors_;
    std::shared_ptr<const Image<Rgba8>> last_color_;
    std::uint64_t version_ = 0;
};

}  // namespace kino
