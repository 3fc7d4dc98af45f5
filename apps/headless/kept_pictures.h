#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <utility>

#include "base/error.h"
#include "base/image.h"
#include "base/time.h"
#include "viz/output/video_writer.h"

namespace kino {

/// Whether picture `i` of `frames` is kept as a file: first and last, the others evenly between,
/// `most` in all; all of them for a negative `most`.
[[nodiscard]] bool keeps_picture(std::int64_t i, std::int64_t frames, std::int64_t most);

/// frame-00000.png for 0.
[[nodiscard]] std::string picture_name(std::int64_t i);

/// FNV-1a, 64 bit (Fowler, Noll, Vo), going on from `hash`.
constexpr std::uint64_t kHashStart = 0xcbf29ce484222325ull;
[[nodiscard]] std::uint64_t hash_picture(const Image<Rgba8>& picture, std::uint64_t hash);

/// video.mp4 of a run, begun with its first picture. Pictures are worth having without a video:
/// where none can be made, standard error says why and add() does nothing.
class RunVideo {
  public:
    explicit RunVideo(std::filesystem::path folder) : folder_(std::move(folder)) {}

    [[nodiscard]] Result<void> add(const Image<Rgba8>& picture, TimeNs duration);
    [[nodiscard]] Result<void> finish();
    /// Of the encoder; empty: no video.
    [[nodiscard]] std::string codec() const { return video_ ? video_->codec() : std::string(); }

  private:
    std::filesystem::path folder_;
    std::optional<VideoWriter> video_;
    bool tried_ = false;
};

}  // namespace kino
