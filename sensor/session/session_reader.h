#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "base/error.h"
#include "sensor/codec/image_codec.h"
#include "sensor/session/frame_note.h"
#include "sensor/session/session_index.h"
#include "sensor/session/session_text.h"

namespace kino {

/// Every frame of a session, one by one, exactly as it was recorded: for converters, and under the
/// Source of make_session_source(). Colour comes without padding at the ends of rows. Belongs to
/// one thread.
class SessionReader {
  public:
    [[nodiscard]] static Result<std::unique_ptr<SessionReader>> open(
        const std::filesystem::path& path);
    /// Over any bytes. `where` names them in errors.
    [[nodiscard]] static Result<std::unique_ptr<SessionReader>> open(
        std::unique_ptr<ByteSource> bytes, const std::string& where);

    [[nodiscard]] const SessionIndex& index() const { return index_; }
    /// Entries that are frames, in the order of the file: entries[i].id says of which stream.
    [[nodiscard]] const std::vector<SessionEntry>& frames() const { return frames_; }
    [[nodiscard]] const std::vector<SessionEvent>& events() const { return events_; }
    [[nodiscard]] const std::vector<SessionPose>& poses() const { return poses_; }

    /// Fails for a frame whose cluster or code is damaged; others stay readable.
    [[nodiscard]] Result<StreamFrame> read(const SessionEntry& frame);

  private:
    struct Loaded {
        std::size_t cluster = SIZE_MAX;
        std::vector<std::uint8_t> bytes;
    };
    struct Decoder {
        ImageFormat format;
        std::vector<std::uint8_t> private_data;
        std::unique_ptr<ImageDecoder> decoder;
    };

    SessionReader(std::unique_ptr<ByteSource> bytes, std::string where, SessionIndex index);
    void read_texts();
    [[nodiscard]] Result<std::span<const std::uint8_t>> load(std::size_t cluster);
    [[nodiscard]] Result<std::string> text_of(const SessionEntry& entry);
    [[nodiscard]] Result<StreamFrame> picture(const SessionEntry& entry, const SessionTrack& track);
    [[nodiscard]] Result<void> decode(const ImageFormat& format,
                                      std::span<const std::uint8_t> private_data,
                                      std::span<const std::uint8_t> data,
                                      std::span<std::uint8_t> pixels);

    std::unique_ptr<ByteSource> bytes_;
    std::string where_;
    SessionIndex index_;
    std::vector<SessionEntry> frames_;
    std::vector<SessionEvent> events_;
    std::vector<SessionPose> poses_;
    // Frames of one moment lie in one cluster or in two neighbours.
    std::array<Loaded, 2> loaded_;
    std::size_t next_slot_ = 0;
    std::vector<Decoder> decoders_;
};

}  // namespace kino
