#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "sensor/session/session_layout.h"

namespace kino {

/// What the elements beside the clusters say, as far as it makes sense. Fed with the contents of
/// the elements in any order; every content is safe.
class SessionMeta {
  public:
    void add_info(std::span<const std::uint8_t> content);
    void add_tracks(std::span<const std::uint8_t> content);
    void add_attachments(std::span<const std::uint8_t> content);
    void add_tags(std::span<const std::uint8_t> content);

    [[nodiscard]] bool is_session() const { return is_session_; }
    [[nodiscard]] std::int64_t ns_per_tick() const { return ns_per_tick_; }
    [[nodiscard]] TimeNs origin() const { return origin_; }
    [[nodiscard]] const std::optional<std::string>& calibration() const { return calibration_; }
    [[nodiscard]] const std::optional<std::string>& source() const { return source_; }
    /// The tracks that both Tracks and Tags know; complaints about the others go to `findings`.
    [[nodiscard]] std::vector<SessionTrack> tracks(std::vector<std::string>& findings) const;

  private:
    struct RawTrack {
        std::uint64_t number = 0;
        std::uint64_t uid = 0;
        std::uint64_t default_duration = 0;
        std::string codec;
        std::vector<std::uint8_t> private_data;
        bool encoded = false;  ///< by a ContentEncoding
    };
    struct TrackText {
        std::uint64_t uid = 0;
        std::string format;
    };
    void add_track(std::span<const std::uint8_t> content);
    void add_tag(std::span<const std::uint8_t> content);

    bool is_session_ = false;
    std::int64_t ns_per_tick_ = 1'000'000;  // Matroska's default
    TimeNs origin_ = 0;
    std::optional<std::string> calibration_;
    std::optional<std::string> source_;
    std::vector<RawTrack> raw_;
    std::vector<TrackText> texts_;
};

}  // namespace kino
