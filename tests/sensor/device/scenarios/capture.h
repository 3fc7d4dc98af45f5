#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "base/error.h"

namespace kino::guest {

struct CapturedFrame {
    std::vector<std::uint8_t> bytes;
    std::uint32_t sequence = 0;
    bool marked_bad = false;  ///< V4L2_BUF_FLAG_ERROR
    bool full_size = false;   ///< as many bytes as the format has
};

/// The plainest V4L2 reader: four mapped buffers of one node. A second opinion beside sensor/v4l2,
/// of which it uses nothing.
class Capture {
  public:
    /// Sets the format, which the driver must take as it is, and starts.
    [[nodiscard]] static Result<std::unique_ptr<Capture>> start(const std::string& node,
                                                                std::uint32_t fourcc, int width,
                                                                int height);
    ~Capture();
    Capture(const Capture&) = delete;
    Capture& operator=(const Capture&) = delete;

    /// The error's `what` is that of errno; "timeout" after ten seconds without a frame.
    [[nodiscard]] Result<CapturedFrame> next();
    [[nodiscard]] std::uint32_t frame_bytes() const { return frame_bytes_; }
    [[nodiscard]] std::uint32_t row_bytes() const { return row_bytes_; }

  private:
    struct Buffer {
        void* begin = nullptr;
        std::size_t size = 0;
    };
    Capture() = default;
    Result<void> start_streaming(std::uint32_t fourcc, int width, int height);

    std::string node_;
    int fd_ = -1;
    std::uint32_t frame_bytes_ = 0;
    std::uint32_t row_bytes_ = 0;
    std::vector<Buffer> buffers_;
};

/// Formats the node lists for capture, in its order.
[[nodiscard]] std::vector<std::uint32_t> formats_of(const std::string& node);

/// Sets the control of that name (buttons: any value); fails if there is none.
Result<void> set_control(const std::string& node, const std::string& name, int value);

}  // namespace kino::guest
