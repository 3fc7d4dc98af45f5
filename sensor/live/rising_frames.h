#pragma once

#include <utility>
#include <vector>

#include "sensor/source.h"

namespace kino {

/// Sees to it that sequence, device time and host time of every stream go on rising when the
/// device behind it comes back and counts from 0 again. A frame that rises by itself passes as it
/// is; of any other a copy with a new header is made. Not thread-safe.
class RisingFrames {
  public:
    /// What follows comes from a device opened anew: its device time goes on from the last one by
    /// as much as host time has.
    void begin_epoch() { shift_known_ = false; }
    [[nodiscard]] StreamFrame pass(StreamId id, StreamFrame frame);

  private:
    struct Stream {
        StreamId id;
        FrameHeader last;
        std::int64_t sequence_shift = 0;
    };
    [[nodiscard]] FrameHeader raise(StreamId id, FrameHeader header);
    [[nodiscard]] Stream* find(StreamId id);

    std::vector<Stream> streams_;
    bool any_ = false;
    FrameHeader newest_;  ///< largest times of all streams
    bool shift_known_ = false;
    TimeNs device_shift_ = 0;
};

}  // namespace kino
