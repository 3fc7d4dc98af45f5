#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

#include "base/camera_model.h"
#include "base/error.h"
#include "base/frame.h"
#include "sensor/convert/losses.h"
#include "sensor/source.h"

namespace kino {

/// A point of a cloud: metres, world (y up); colour grey where it is not known.
struct CloudPoint {
    float x = 0, y = 0, z = 0;
    Rgba8 color;
};

/// What writers need of calibration/, which lies a floor above: the caller brings it along.
class ConvertGeometry {
  public:
    virtual ~ConvertGeometry() = default;
    /// Metres along the optical axis, 0 = no reading.
    virtual Result<void> metres(const DepthFrame& frame, Image<float>& out) = 0;
    virtual Result<void> points(const FrameSet& set, std::vector<CloudPoint>& out) = 0;
};

/// Everything that stays the same through a conversion. `geometry` outlives the sink.
struct ConvertInput {
    SourceInfo source;
    RigParameters rig;
    ConvertGeometry* geometry = nullptr;
};

/// Writes one recording in one format. What it writes gets its name in finish(); a sink that goes
/// before that takes everything away again.
class FrameSink {
  public:
    virtual ~FrameSink() = default;
    FrameSink() = default;
    FrameSink(const FrameSink&) = delete;
    FrameSink& operator=(const FrameSink&) = delete;

    /// Whether it wants what belongs to one moment together: then put(set) is called, else
    /// put(id, frame) for every frame.
    [[nodiscard]] virtual bool takes_sets() const = 0;
    virtual Result<void> put(const FrameSet&) { return {}; }
    /// `pose`: world_from_depth of a depth frame, if the recording knows it.
    virtual Result<void> put(StreamId, const StreamFrame&, const std::optional<Pose>& /*pose*/) {
        return {};
    }
    virtual void put_event(const Event&) {}
    virtual Result<void> finish() = 0;

    [[nodiscard]] const Losses& losses() const { return losses_; }
    [[nodiscard]] std::int64_t written(StreamKind kind) const {
        return written_[static_cast<std::size_t>(kind)];
    }

  protected:
    void count(StreamKind kind) { ++written_[static_cast<std::size_t>(kind)]; }
    Losses losses_;

  private:
    std::array<std::int64_t, 5> written_{};
};

}  // namespace kino
