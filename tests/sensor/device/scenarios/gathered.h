#pragma once

#include <condition_variable>
#include <functional>
#include <memory>
#include <mutex>
#include <string>
#include <vector>

#include "sensor/source.h"
#include "tests/sensor/device/fake_kinect/feed.h"
#include "tests/sensor/device/fake_kinect/packet_stream.h"
#include "tests/sensor/device/scenarios/report.h"

namespace kino::guest {

/// Every frame of a source under test, through its tap, and its events.
class Gathered {
  public:
    /// Takes the tap; `also` sees every frame as well.
    explicit Gathered(Source& source, FrameTap also = nullptr);
    ~Gathered();
    Gathered(const Gathered&) = delete;
    Gathered& operator=(const Gathered&) = delete;

    /// True once so many frames of the stream have come in all; false if none comes any more. Not
    /// by the clock alone: the whole guest may have been held up.
    bool wait_for(StreamKind kind, std::size_t count);
    /// True once the source has said that; false after half a minute.
    bool wait_for(EventKind kind);

    [[nodiscard]] std::vector<std::shared_ptr<const DepthFrame>> depth() const;
    [[nodiscard]] std::vector<std::shared_ptr<const ColorFrame>> color() const;
    [[nodiscard]] std::vector<std::shared_ptr<const InfraredFrame>> infrared() const;
    [[nodiscard]] std::vector<std::shared_ptr<const MotionFrame>> motion() const;
    [[nodiscard]] std::size_t count(StreamKind kind) const;
    [[nodiscard]] const std::vector<Event>& events() const { return events_; }
    /// Ends it; frames stay. To be called before the source goes.
    void stop();

  private:
    template <class Frame>
    [[nodiscard]] std::vector<std::shared_ptr<const Frame>> all_of() const;

    Source& source_;
    bool stopped_ = false;
    mutable std::mutex mutex_;
    std::condition_variable came_;
    std::vector<std::pair<StreamKind, StreamFrame>> frames_;
    std::vector<Event> events_;
};

/// Depth as the source gives it for 10 or 11 bits.
[[nodiscard]] std::vector<std::uint16_t> depth_truth(const fake::Feed& feed, int number, int bits);

/// What is reported of a stream under `prefix`:
///   _frames, _equal (bit by bit, no row marked), _marked (frames with damaged rows),
///   _wrong_rows (frames whose marked rows are not exactly those with bytes that did not arrive),
///   _stale_pixels (pixels of rows not marked, or of marked ones but not "no reading", that are not
///   what was sent), _unknown (frames that are none of those sent), _order (frames not after the
///   one before), _lost (of those sent between first and last, told in lost_before),
///   _missing (the same, untold), _clock_us (median error of device time between frames).
struct StreamTruth {
    std::vector<fake::SentFrame> sent;
    int row_bytes = 0;
    int no_reading = 0;  ///< what a lost pixel holds
    std::function<std::vector<std::uint16_t>(int number)> pixels;
};
void compare(const Report& report, const std::string& prefix,
             const std::vector<std::shared_ptr<const DepthFrame>>& frames,
             const StreamTruth& truth);
void compare(const Report& report, const std::string& prefix,
             const std::vector<std::shared_ptr<const InfraredFrame>>& frames,
             const StreamTruth& truth);
void compare(const Report& report, const std::string& prefix,
             const std::vector<std::shared_ptr<const ColorFrame>>& frames,
             const StreamTruth& truth);

/// Depth of 10 or 11 bits as the camera sent it.
[[nodiscard]] StreamTruth depth_stream(const fake::Feed& feed, std::vector<fake::SentFrame> sent,
                                       int bits);
/// A picture of bytes.
[[nodiscard]] StreamTruth byte_stream(std::vector<fake::SentFrame> sent, int row_bytes,
                                      std::function<std::vector<std::uint8_t>(int)> bytes);
[[nodiscard]] StreamTruth infrared_stream(const fake::Feed& feed,
                                          std::vector<fake::SentFrame> sent);

/// Device 0's stream; a failure is reported.
bool subscribe(const Report& report, Source& source, StreamKind kind);

}  // namespace kino::guest
