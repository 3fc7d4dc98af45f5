#pragma once

#include <filesystem>
#include <memory>

#include "base/camera_model.h"
#include "base/error.h"
#include "base/frame.h"

namespace kino {

/// Writes an ONI file that OpenNI2's player, and so NiViewer2, opens and seeks in: depth in
/// millimetres (codec 16zT, without loss) and, where the rig has a colour camera, RGB 8:8:8 as it
/// is. ONI knows a camera only by its field of view: principal points, distortion and the place of
/// the cameras to each other are lost.
///
/// Times count from shortly before the first depth frame in whole microseconds, depth on even and
/// colour on odd ones: the player's seek goes wrong where two streams have frames of one time.
class OniWriter {
  public:
    /// Frame sizes and fields of view are the rig's. Fails where the file cannot be made, exists
    /// already, or a frame is larger than a player's buffers (1600 x 1200 in 24 bits).
    [[nodiscard]] static Result<std::unique_ptr<OniWriter>> create(
        const std::filesystem::path& file, const RigParameters& rig, double frames_per_second = 30);
    virtual ~OniWriter() = default;  ///< as close()
    OniWriter() = default;
    OniWriter(const OniWriter&) = delete;
    OniWriter& operator=(const OniWriter&) = delete;

    /// One depth frame (linear, 0.001 m a unit), later than the last one, and the colour frame that
    /// belongs to it: rgb8, or null. A colour frame not later than the last one is left out. Fails,
    /// and writes nothing, for other sizes, units or formats, and for more than 32,768 different
    /// depths in a frame; fails, and ends the file, where the disk refuses.
    virtual Result<void> write(const DepthFrame& depth, const ColorFrame* color) = 0;
    /// Writes the index and the end; without it no player takes the file. Idempotent.
    virtual Result<void> close() = 0;
};

}  // namespace kino
