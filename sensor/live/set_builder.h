#pragma once

#include <array>
#include <condition_variable>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <mutex>
#include <optional>

#include "base/time.h"
#include "sensor/source.h"

namespace kino {

struct SetBuilderOptions {
    /// Sets that may wait for the reader; from there on the oldest gives way and is counted. 1:
    /// the newest wins.
    std::size_t waiting_sets = 1;
    /// Frames of each following stream that are kept for pairing, at least 2.
    std::size_t history = 16;
    /// How long a leading frame waits at most for a partner that is still to come.
    TimeNs patience = 20 * kNsPerMs;
    /// A set leaves at once where the partner still to come would be farther away than the one
    /// that is there, going by the stream's period; otherwise the partner is waited for.
    bool foresee = true;
};

/// Pairs the frames of live streams into sets by sensor/pairing.h. The leading stream is depth,
/// else colour, else infrared, else motion, else bodies, of those that are on; one stream of each
/// kind. Thread-safe; put() never waits for the reader.
class SetBuilder {
  public:
    explicit SetBuilder(const SetBuilderOptions& options);

    /// Turning a stream off forgets its frames. All are off at first.
    void turn(StreamKind kind, bool on);
    /// A frame of a stream that is off is ignored. Times of one stream rise strictly.
    void put(StreamKind kind, StreamFrame frame);
    /// The next set in order; waits up to `timeout`.
    [[nodiscard]] std::optional<FrameSet> next(TimeNs timeout);
    /// Sets that gave way to newer ones before they were read.
    [[nodiscard]] std::int64_t overtaken() const;

  private:
    static constexpr std::size_t kKinds = 5;
    struct Kept {
        TimeNs time = 0;
        StreamFrame frame;
    };
    struct Stream {
        bool on = false;
        std::deque<Kept> kept;
    };
    struct Leading {
        TimeNs time = 0;
        TimeNs deadline = 0;  ///< now_ns(): with what is there by then
        StreamFrame frame;
    };
    [[nodiscard]] Stream& stream(StreamKind kind) {
        return streams_[static_cast<std::size_t>(kind)];
    }
    [[nodiscard]] std::optional<StreamKind> leader() const;
    [[nodiscard]] bool awaits_partner(const Leading& leading) const;
    [[nodiscard]] bool ready(const Leading& leading, TimeNs now) const;
    [[nodiscard]] FrameSet build(const Leading& leading);

    const SetBuilderOptions options_;
    mutable std::mutex mutex_;
    std::condition_variable changed_;
    std::array<Stream, kKinds> streams_;
    std::optional<StreamKind> leader_;
    std::deque<Leading> waiting_;
    std::int64_t next_index_ = 0;
    std::int64_t overtaken_ = 0;
};

/// Host time of the frame.
[[nodiscard]] TimeNs host_time_of(const StreamFrame& frame);

}  // namespace kino
