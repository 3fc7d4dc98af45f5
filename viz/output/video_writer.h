#pragma once

#include <filesystem>
#include <memory>
#include <string>

#include "base/error.h"
#include "base/image.h"
#include "base/time.h"

namespace kino {

/// Writes pictures as a video, MP4 with yuv420p (BT.709 matrix, limited range): H.264 where an
/// encoder is there, else MPEG-4 part 2. An odd last row or column is left out.
class VideoWriter {
  public:
    /// Fails where the file cannot be made, no encoder is there, or the size is below 16x16.
    [[nodiscard]] static Result<VideoWriter> create(const std::filesystem::path& path, int width,
                                                    int height);
    ~VideoWriter();  ///< finishes the file if finish() was not called; errors are lost then
    VideoWriter(VideoWriter&&) noexcept;
    VideoWriter& operator=(VideoWriter&&) noexcept;

    /// Appends a picture that is shown for `duration` (at least a millisecond). The size must be
    /// that of create().
    [[nodiscard]] Result<void> add(ImageView<const Rgba8> picture, TimeNs duration);

    /// Writes what is still on its way and the index. No add() afterwards.
    [[nodiscard]] Result<void> finish();

    /// Of the encoder: "libx264", "mpeg4".
    [[nodiscard]] std::string codec() const;

  private:
    struct State;
    explicit VideoWriter(std::unique_ptr<State> state);
    std::unique_ptr<State> state_;
};

}  // namespace kino
