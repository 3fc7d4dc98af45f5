#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "sensor/session/session_reader.h"
#include "sensor/session/session_writer.h"
#include "tests/support/temp_dir.h"

namespace kino::test {

/// A frame and whose it is, as recorders are given them.
struct PutFrame {
    StreamId id;
    StreamFrame frame;
};

struct FrameStyle {
    int width = 48;
    int height = 36;
    PixelFormat color = PixelFormat::bayer_grbg8;
    bool infrared = true;
    bool texts = true;  ///< motion and bodies
};

/// What all streams give at moment `i` of a 30 Hz recording: the same numbers from the same `i`.
/// Values are smooth with noise and holes, times odd to the nanosecond, some frames damaged.
[[nodiscard]] std::vector<PutFrame> frames_at(int i, const FrameStyle& style = {});
[[nodiscard]] std::vector<PutFrame> frames_between(int from, int to, const FrameStyle& style = {});

[[nodiscard]] std::shared_ptr<const ColorFrame> color_at(int i, PixelFormat format, int width,
                                                         int height);

/// A source that lists the streams of `style`.
[[nodiscard]] SourceInfo source_of(const FrameStyle& style = {});
[[nodiscard]] RigParameters rig_of(const FrameStyle& style = {});

/// Bit by bit, headers and damaged rows as well; the colour's padding does not count.
[[nodiscard]] bool equal(const StreamFrame& a, const StreamFrame& b);
[[nodiscard]] bool same_place(const PutFrame& put, const SessionEntry& entry);

/// The bytes of a session with these frames, written on this thread at the frames' own pace.
[[nodiscard]] std::vector<std::uint8_t> session_of(const std::vector<PutFrame>& frames,
                                                   const RecorderOptions& options = {},
                                                   const FrameStyle& style = {});

/// Feeds the frames to a writer, the host's clock being that of the frames.
Result<void> write_all(SessionWriter& writer, const std::vector<PutFrame>& frames);

/// Opens bytes that must be a session.
[[nodiscard]] std::unique_ptr<SessionReader> reader_of(const std::vector<std::uint8_t>& bytes);

/// Every frame that `reader` has equals one of `put` and is there once; returns how many there
/// are, or -1 (and a test failure).
[[nodiscard]] int count_exact(SessionReader& reader, const std::vector<PutFrame>& put);

}  // namespace kino::test
