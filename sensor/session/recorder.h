#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "base/error.h"
#include "sensor/source.h"

namespace kino {

enum class SessionCodec : std::uint8_t {
    ffv1,  ///< depth, infrared and colour by FFV1: every player decodes it
    fast,  ///< our own depth codec and the cheapest lossless colour: for slow machines
    rvl,   ///< depth and infrared by RVL and zstd, colour as it is
    raw    ///< nothing is coded
};

struct RecorderOptions {
    SessionCodec codec = SessionCodec::ffv1;
    /// Frames that may wait for the disk, as bytes of raw pixels.
    std::size_t queue_bytes = std::size_t{256} << 20;
    /// The picture streams that will come. The file's tracks are settled when one frame of each
    /// has come, 400 ms after the first frame at the latest; what comes later lies in the file as
    /// well, but only our reader finds it. Empty: all pictures that the source lists.
    std::vector<StreamId> streams;
};

struct RecorderStatus {
    std::int64_t frames = 0;  ///< written to the file, all streams
    std::int64_t dropped =
        0;  ///< not written: queue full, or not a sound frame; each is told in the file
    std::int64_t bytes = 0;  ///< of the file so far
    TimeNs duration = 0;     ///< from the first frame to the last
    double queue_fill = 0;   ///< 0 .. 1
    std::string error;       ///< why writing has ended early (disk full); empty while all is well
};

/// Writes a session (docs/session-format.md) on a thread of its own. put() and put_event() come
/// from any thread and never wait. Whatever happens, what was written stays readable.
class Recorder {
  public:
    /// Fails where the file cannot be made (it says why) or exists already.
    [[nodiscard]] static Result<std::unique_ptr<Recorder>> create(const std::filesystem::path& file,
                                                                  const SourceInfo& source,
                                                                  const RigParameters& rig,
                                                                  const RecorderOptions& options);
    virtual ~Recorder() = default;  ///< as close()

    virtual void put(StreamId id, const StreamFrame& frame) = 0;
    /// The frames of a set that were not put before: for sources without a tap.
    virtual void put(const FrameSet& set) = 0;
    virtual void put_event(const Event& event) = 0;

    [[nodiscard]] virtual RecorderStatus status() const = 0;
    /// Writes what waits, the index and the end. Idempotent.
    virtual Result<RecorderStatus> close() = 0;
};

}  // namespace kino
