#pragma once

#include <filesystem>
#include <string>

#include "base/error.h"
#include "base/frame.h"
#include "sensor/convert/frame_sink.h"

namespace kino {

/// Writes a colour frame as a PNG; what that costs is added to `losses`.
[[nodiscard]] Result<void> write_color_png(const std::filesystem::path& file,
                                           const ColorFrame& frame, Losses& losses);

/// "infrared frames, which this format cannot hold" and the like.
void add_unheld(StreamKind kind, Losses& losses);

/// Fails unless the frame has the size of its camera, which readers insist on.
[[nodiscard]] Result<void> check_size(const char* stream, int width, int height,
                                      const CameraModel& camera);

/// Whether this is the frame that was written last: a slow stream's frames serve several moments.
class Repeats {
  public:
    [[nodiscard]] bool is_new(const FrameHeader& header) {
        const bool same =
            any_ && header.host_time == last_.host_time && header.sequence == last_.sequence;
        any_ = true;
        last_ = header;
        return !same;
    }

  private:
    bool any_ = false;
    FrameHeader last_;
};

/// Frames' times on the device's clock, but all streams on that of the first depth frame: files
/// with one clock for all need that.
class FileClock {
  public:
    void set_by(const FrameHeader& leading) {
        if (!set_) offset_ = leading.device_time - leading.host_time;
        set_ = true;
    }
    [[nodiscard]] bool is_set() const { return set_; }
    [[nodiscard]] TimeNs operator()(const FrameHeader& header) const {
        return header.host_time + offset_;
    }

  private:
    bool set_ = false;
    TimeNs offset_ = 0;
};

}  // namespace kino
