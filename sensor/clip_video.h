#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>

#include "base/error.h"
#include "base/image.h"
#include "base/time.h"

namespace kino {

/// One decoded picture: 4:2:0, chroma at half size each way (rounded up).
struct YuvPicture {
    Image<std::uint8_t> y;
    Image<std::uint8_t> u;
    Image<std::uint8_t> v;
};

/// Exact random access to a VP8 video in WebM. The packets (at most 32 MB) stay in memory and the
/// pictures decoded last (at most 40 MB, never fewer than one) are kept, so stepping backwards
/// inside a group decodes it once. Any order of calls gives the same pixels: a group is always
/// decoded from its key frame.
class ClipVideo {
  public:
    /// Reads the packets and no picture. Fails on anything but VP8 in WebM, on pictures wider or
    /// higher than 4096, on times that do not rise.
    [[nodiscard]] static Result<ClipVideo> open(const std::filesystem::path& path);
    ~ClipVideo();
    ClipVideo(ClipVideo&&) noexcept;
    ClipVideo& operator=(ClipVideo&&) noexcept;

    [[nodiscard]] int width() const;
    [[nodiscard]] int height() const;
    [[nodiscard]] std::int64_t frame_count() const;  ///< >= 1
    /// As the container states it (WebM: whole milliseconds). Index within the range.
    [[nodiscard]] TimeNs time_of(std::int64_t index) const;

    /// A damaged packet makes its own picture and the rest of its group errors.
    [[nodiscard]] Result<std::shared_ptr<const YuvPicture>> picture(std::int64_t index);

  private:
    struct State;
    explicit ClipVideo(std::unique_ptr<State> state);
    std::unique_ptr<State> state_;
};

}  // namespace kino
