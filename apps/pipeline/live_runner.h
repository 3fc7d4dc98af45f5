#pragma once

#include <condition_variable>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "apps/pipeline/opened_source.h"
#include "base/mailbox.h"
#include "sensor/live/live_source.h"
#include "sensor/session/recorder.h"
#include "skeleton/gestures/gesture_event.h"

namespace kino {

struct LiveRunnerOptions {
    double speed = 1;
    /// The host clock; tests bring their own. Called from both threads.
    std::function<TimeNs()> clock = now_ns;
};

/// What the runner is about at one moment.
struct LiveStatus {
    std::int64_t frame_count = 0;  ///< 0: no timeline
    std::int64_t position = 0;     ///< frame that is due
    bool paused = false;
    bool finished = false;  ///< mode `once` is through, or the source ended
    double speed = 1;
    LoopMode mode = LoopMode::loop;
    std::int64_t processed = 0;  ///< frames made ready
    /// Frames that were due and never shown: overtaken on the way or never read for lack of time.
    std::int64_t dropped = 0;
    std::int64_t errors = 0;  ///< frames that could not be read or processed
    std::string last_error;
    std::int64_t overtaken = 0;  ///< of `dropped`: within the source
    bool present = true;         ///< the device is there; it goes with `lost` and comes with `back`
    std::string last_event;      ///< what the source last said, for a person
    std::int64_t events = 0;
    std::optional<RecorderStatus> recording;  ///< while one is under way, and its end afterwards
    bool is_recording = false;
    bool bodies = false;       ///< a BodyStage is at work
    std::string bodies_error;  ///< why bodies could not be switched on; empty: they could
};

/// Plays a source by the clock on a thread of its own: reads the frame that is due, registers it,
/// and lays it into a mailbox, where the newest wins. The caller's thread takes it and never waits.
/// A frame that cannot be read is counted and told, and playing goes on.
class LiveRunner {
  public:
    explicit LiveRunner(OpenedSource opened, LiveRunnerOptions options = {});
    ~LiveRunner();  ///< as stop()
    LiveRunner(const LiveRunner&) = delete;
    LiveRunner& operator=(const LiveRunner&) = delete;

    /// The newest frame made since the last call.
    [[nodiscard]] std::optional<ProcessedFrame> take() { return mailbox_.take(); }
    /// The same, waiting for one.
    [[nodiscard]] std::optional<ProcessedFrame> wait(TimeNs timeout) {
        return mailbox_.wait(timeout);
    }

    [[nodiscard]] LiveStatus status() const;

    // What a viewer's keys do; see sensor/playback.h. Without effect on a source without timeline,
    // except pause and resume, which then hold back what the device brings.
    void pause();
    void resume();
    void step(int direction);
    void seek(std::int64_t index);
    void set_speed(double speed);
    void set_mode(LoopMode mode);

    /// Switches the search for bodies on (as `body_options` of the source says; BodyMode::on where
    /// they say off) or off. It happens on the runner's thread before the next frame.
    void set_bodies(bool on);
    /// Gestures since the last call, of frames that were overtaken as well; at most the last 1000.
    [[nodiscard]] std::vector<GestureEvent> take_gestures();

    /// From the next frame on everything the source brings goes into a new session at `file`: of
    /// devices all frames of all streams, of recordings what is played. Fails where
    /// Recorder::create does, and while a recording is under way.
    [[nodiscard]] Result<void> start_recording(const std::filesystem::path& file,
                                               SessionCodec codec);
    /// The file is ended on the runner's thread soon after; status().is_recording tells.
    void stop_recording();

    /// The device's knobs, as long as the runner lives; null for sources that have none. Callable
    /// from any thread.
    [[nodiscard]] Controls* controls() const { return controls_; }

    /// Ends the thread; at most one frame's reading time later it has joined. Idempotent.
    void stop();

  private:
    void run();
    void run_timeline();
    void run_device();
    void deliver(Result<std::optional<ProcessedFrame>> frame);
    void count_skipped(std::int64_t from, std::int64_t to);
    void hear_events();
    void follow_recording();
    void follow_bodies();
    void keep(const Result<std::optional<ProcessedFrame>>& frame);
    void tell(const std::vector<GestureEvent>& gestures);
    std::function<void(const FrameSet&)> to_recorder();
    void end_recording(const std::shared_ptr<Recorder>& recorder);
    template <class Change>
    void change(Change&& apply);

    OpenedSource opened_;
    std::function<TimeNs()> clock_;
    Mailbox<ProcessedFrame> mailbox_;

    mutable std::mutex mutex_;
    std::condition_variable changed_;
    std::optional<Playback> playback_;
    LiveStatus status_;
    bool device_paused_ = false;
    bool wanted_bodies_ = false;
    std::vector<GestureEvent> gestures_;
    bool jumped_ = true;  ///< the due frame moved by command, not by time: nothing was skipped
    bool stopping_ = false;
    std::shared_ptr<Recorder> wanted_recorder_;
    std::shared_ptr<Recorder>
        left_recorder_;  ///< no longer wanted, and not yet ended for all we know
    // Of the runner's thread:
    std::shared_ptr<Recorder> recorder_;
    bool recorder_is_tapped_ = false;
    TimeNs recorded_bodies_ = INT64_MIN;  ///< time of the last

    SourceInfo info_;
    std::vector<StreamId> pictures_;
    const LiveSource* live_source_ = nullptr;  ///< `opened_`'s, if it is a device
    RigParameters rig_;                        ///< as the source says, before any filter
    Controls* controls_ = nullptr;
    std::thread thread_;
};

}  // namespace kino
