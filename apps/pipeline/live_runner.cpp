#include "apps/pipeline/live_runner.h"

#include <chrono>
#include <cstdlib>
#include <utility>

#include "skeleton/gestures/gesture_json.h"

namespace kino {
namespace {
/// The process thread looks this often whether another frame is due: a small part of a frame time.
constexpr auto kLook = std::chrono::milliseconds(2);
constexpr TimeNs kDeviceWait = 50 * kNsPerMs;

bool is_picture(StreamKind kind) {
    return kind == StreamKind::depth || kind == StreamKind::color || kind == StreamKind::infrared;
}
}  // namespace

LiveRunner::LiveRunner(OpenedSource opened, LiveRunnerOptions options)
    : opened_(std::move(opened)), clock_(std::move(options.clock)) {
    if (const Timeline* timeline = opened_.source->timeline()) {
        const TimeNs now = clock_();
        playback_.emplace(*timeline, opened_.mode, now);
        playback_->set_speed(options.speed, now);
    }
    info_ = opened_.source->info();
    rig_ = opened_.calibration.rig;
    for (const StreamId id : opened_.streams) {
        if (is_picture(id.kind)) pictures_.push_back(id);
    }
    live_source_ = dynamic_cast<LiveSource*>(opened_.source.get());
    controls_ = opened_.source->controls();
    wanted_bodies_ = status_.bodies = opened_.bodies != nullptr;
    thread_ = std::thread([this] { run(); });
}

LiveRunner::~LiveRunner() {
    stop();
}

void LiveRunner::stop() {
    {
        const std::lock_guard lock(mutex_);
        stopping_ = true;
    }
    changed_.notify_all();
    if (thread_.joinable()) thread_.join();
    mailbox_.close();
}

LiveStatus LiveRunner::status() const {
    const std::lock_guard lock(mutex_);
    LiveStatus status = status_;
    status.dropped += mailbox_.dropped() + status.overtaken;
    if (playback_) {
        const TimeNs now = clock_();
        status.frame_count = playback_->frame_count();
        status.position = playback_->due(now);
        status.paused = playback_->paused();
        status.finished = playback_->finished(now);
        status.speed = playback_->speed();
        status.mode = playback_->mode();
    } else {
        status.paused = device_paused_;
    }
    return status;
}

template <class Change>
void LiveRunner::change(Change&& apply) {
    {
        const std::lock_guard lock(mutex_);
        if (playback_) {
            apply(*playback_, clock_());
            jumped_ = true;
        }
    }
    changed_.notify_all();
}

void LiveRunner::pause() {
    change([](Playback& playback, TimeNs now) { playback.pause(now); });
    const std::lock_guard lock(mutex_);
    device_paused_ = true;
}

void LiveRunner::resume() {
    change([](Playback& playback, TimeNs now) { playback.resume(now); });
    const std::lock_guard lock(mutex_);
    device_paused_ = false;
}

void LiveRunner::step(int direction) {
    change([&](Playback& playback, TimeNs now) { (void)playback.step(direction, now); });
}

void LiveRunner::seek(std::int64_t index) {
    change([&](Playback& playback, TimeNs now) { playback.seek(index, now); });
}

void LiveRunner::set_speed(double speed) {
    change([&](Playback& playback, TimeNs now) { playback.set_speed(speed, now); });
}

void LiveRunner::set_mode(LoopMode mode) {
    change([&](Playback& playback, TimeNs now) { playback.set_mode(mode, now); });
}

void LiveRunner::set_bodies(bool on) {
    {
        const std::lock_guard lock(mutex_);
        wanted_bodies_ = on;
    }
    changed_.notify_all();
}

std::vector<GestureEvent> LiveRunner::take_gestures() {
    const std::lock_guard lock(mutex_);
    return std::exchange(gestures_, {});
}

/// Makes and drops the body stage as set_bodies() said.
void LiveRunner::follow_bodies() {
    {
        const std::lock_guard lock(mutex_);
        if (wanted_bodies_ == (opened_.bodies != nullptr)) return;
        if (!wanted_bodies_) {
            opened_.bodies.reset();
            status_.bodies = false;
            return;
        }
    }
    BodyOptions options = opened_.body_options;
    if (options.mode == BodyMode::off) options.mode = BodyMode::on;
    auto made = BodyStage::create(options, opened_.processor.rig());
    const std::lock_guard lock(mutex_);
    if (made) {
        opened_.bodies = std::move(*made);
        status_.bodies = true;
        status_.bodies_error.clear();
    } else {
        wanted_bodies_ = false;
        status_.bodies_error = made.error().to_string();
    }
}

Result<void> LiveRunner::start_recording(const std::filesystem::path& file, SessionCodec codec) {
    const std::lock_guard lock(mutex_);
    if (status_.is_recording) return fail("a recording is under way already", file.string());
    KINO_ASSIGN(std::shared_ptr<Recorder> recorder,
                Recorder::create(file, info_, rig_, {.codec = codec, .streams = pictures_}));
    wanted_recorder_ = std::move(recorder);
    status_.is_recording = true;
    status_.recording = wanted_recorder_->status();
    return {};
}

void LiveRunner::stop_recording() {
    {
        const std::lock_guard lock(mutex_);
        if (wanted_recorder_) left_recorder_ = std::exchange(wanted_recorder_, nullptr);
    }
    changed_.notify_all();
}

/// Takes up and lays down recorders as start_recording() and stop_recording() said.
void LiveRunner::follow_recording() {
    std::shared_ptr<Recorder> wanted;
    std::shared_ptr<Recorder> left;
    {
        const std::lock_guard lock(mutex_);
        wanted = wanted_recorder_;
        left = std::exchange(left_recorder_, nullptr);
        if (recorder_ && recorder_ == wanted) status_.recording = recorder_->status();
    }
    // Ended before this thread had seen it begin.
    if (left && left != recorder_) end_recording(left);
    if (wanted == recorder_) return;
    if (recorder_) end_recording(std::exchange(recorder_, nullptr));
    if (!wanted) return;
    recorder_is_tapped_ = opened_.source->set_tap(
        [wanted](StreamId id, const StreamFrame& frame) { wanted->put(id, frame); });
    recorder_ = std::move(wanted);
}

/// Sees each set of a source without a tap while a recording is under way.
std::function<void(const FrameSet&)> LiveRunner::to_recorder() {
    if (!recorder_ || recorder_is_tapped_) return {};
    return [this](const FrameSet& set) {
        if (!opened_.bodies) return recorder_->put(set);
        // Those that are computed go into the file instead.
        FrameSet pictures = set;
        pictures.bodies.reset();
        recorder_->put(pictures);
    };
}

/// Tells the gestures of a frame, and records them and its bodies.
void LiveRunner::keep(const Result<std::optional<ProcessedFrame>>& frame) {
    if (!opened_.bodies || !frame || !*frame) return;
    const ProcessedFrame& made = **frame;
    tell(made.gestures);
    if (!recorder_ || !made.set.bodies || !made.bodies_are_new) return;
    if (std::exchange(recorded_bodies_, made.set.time) == made.set.time) return;
    int device = 0;
    if (recorder_is_tapped_ && !info_.streams.empty()) device = info_.streams.front().id.device;
    recorder_->put({device, StreamKind::bodies}, made.set.bodies);
    for (const GestureEvent& gesture : made.gestures) recorder_->put_event(event_of(gesture));
}

void LiveRunner::tell(const std::vector<GestureEvent>& gestures) {
    constexpr std::size_t kMost = 1000;
    if (gestures.empty()) return;
    const std::lock_guard lock(mutex_);
    gestures_.insert(gestures_.end(), gestures.begin(), gestures.end());
    if (gestures_.size() > kMost) {
        gestures_.erase(gestures_.begin(), gestures_.end() - static_cast<std::ptrdiff_t>(kMost));
    }
}

void LiveRunner::end_recording(const std::shared_ptr<Recorder>& recorder) {
    if (recorder_is_tapped_) (void)opened_.source->set_tap({});
    const auto closed = recorder->close();
    const std::lock_guard lock(mutex_);
    status_.recording = recorder->status();
    if (!closed && status_.recording->error.empty()) {
        status_.recording->error = closed.error().to_string();
    }
    status_.is_recording = wanted_recorder_ != nullptr;
}

void LiveRunner::hear_events() {
    std::vector<Event> events = opened_.source->take_events();
    // Gestures of the recording, unless they are recognised anew.
    if (!opened_.bodies) tell(gestures_in(events));
    std::erase_if(events, [this](const Event& event) {
        return event.kind == EventKind::gesture && opened_.bodies != nullptr;
    });
    if (recorder_) {
        for (const Event& event : events) recorder_->put_event(event);
    }
    const std::int64_t overtaken = live_source_ != nullptr ? live_source_->stats().overtaken : 0;
    const std::lock_guard lock(mutex_);
    status_.overtaken = overtaken;
    for (const Event& event : events) {
        if (event.kind == EventKind::gesture) continue;
        ++status_.events;
        status_.last_event = event.text;
        if (event.kind == EventKind::lost) status_.present = false;
        if (event.kind == EventKind::back) status_.present = true;
        // A timeline's end is a matter of the loop mode.
        if (event.kind == EventKind::ended && !playback_) status_.finished = true;
    }
}

void LiveRunner::run() {
    if (playback_) {
        run_timeline();
    } else {
        run_device();
    }
    stop_recording();
    follow_recording();
}

void LiveRunner::count_skipped(std::int64_t from, std::int64_t to) {
    std::int64_t passed = to - from;
    const std::int64_t n = playback_->frame_count();
    // A round of ping-pong may go either way; the short way is the one that was played.
    if (playback_->mode() == LoopMode::ping_pong) passed = std::abs(passed);
    if (playback_->mode() == LoopMode::loop) passed = (passed + n) % n;
    if (passed > 1) status_.dropped += passed - 1;
}

void LiveRunner::deliver(Result<std::optional<ProcessedFrame>> frame) {
    if (frame && *frame) mailbox_.put(std::move(**frame));
    const std::lock_guard lock(mutex_);
    if (frame) {
        ++status_.processed;
    } else {
        ++status_.errors;
        status_.last_error = frame.error().to_string();
    }
}

void LiveRunner::run_timeline() {
    // A pair, as g++ 12 takes the value of an optional for uninitialized in sanitized builds.
    std::int64_t last = 0;
    bool read_before = false;
    std::unique_lock lock(mutex_);
    while (!stopping_) {
        const std::int64_t due = playback_->due(clock_());
        if (read_before && due == last) {
            // Bodies that come or go are seen in a pause, too.
            if (wanted_bodies_ != (opened_.bodies != nullptr)) read_before = false;
            if (recorder_ != wanted_recorder_ || left_recorder_) {
                lock.unlock();
                follow_recording();
                lock.lock();
            }
            changed_.wait_for(lock, kLook);
            continue;
        }
        if (read_before && !std::exchange(jumped_, false)) count_skipped(last, due);
        jumped_ = false;
        last = due;
        read_before = true;
        lock.unlock();
        follow_recording();
        follow_bodies();
        auto frame = read_frame(opened_, due, kNsPerSecond, to_recorder());
        keep(frame);
        deliver(std::move(frame));
        hear_events();
        lock.lock();
    }
}

void LiveRunner::run_device() {
    std::unique_lock lock(mutex_);
    while (!stopping_ && !status_.finished) {
        const bool paused = device_paused_;
        lock.unlock();
        follow_recording();
        follow_bodies();
        Result<std::optional<ProcessedFrame>> frame =
            read_frame(opened_, {}, kDeviceWait, to_recorder());
        keep(frame);
        hear_events();
        const bool failed = !frame;
        const bool nothing = frame && !*frame;
        if (!nothing && (!paused || failed)) deliver(std::move(frame));
        lock.lock();
        // A source that fails at once and for ever must not burn a processor.
        if (failed) changed_.wait_for(lock, kLook);
    }
}

}  // namespace kino
