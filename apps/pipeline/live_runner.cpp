#include "apps/pipeline/live_runner.h"

#include <chrono>
#include <cstdlib>
#include <utility>

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
    if (auto rig = opened_.source->calibration()) rig_ = std::move(*rig);
    for (const StreamId id : opened_.streams) {
        if (is_picture(id.kind)) pictures_.push_back(id);
    }
    live_source_ = dynamic_cast<LiveSource*>(opened_.source.get());
    controls_ = opened_.source->controls();
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
    return [this](const FrameSet& set) { recorder_->put(set); };
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
    const std::vector<Event> events = opened_.source->take_events();
    if (recorder_) {
        for (const Event& event : events) recorder_->put_event(event);
    }
    const std::int64_t overtaken = live_source_ != nullptr ? live_source_->stats().overtaken : 0;
    const std::lock_guard lock(mutex_);
    status_.overtaken = overtaken;
    for (const Event& event : events) {
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
    std::optional<std::int64_t> last;
    std::unique_lock lock(mutex_);
    while (!stopping_) {
        const std::int64_t due = playback_->due(clock_());
        if (last && due == *last) {
            if (recorder_ != wanted_recorder_ || left_recorder_) {
                lock.unlock();
                follow_recording();
                lock.lock();
            }
            changed_.wait_for(lock, kLook);
            continue;
        }
        if (last && !std::exchange(jumped_, false)) count_skipped(*last, due);
        jumped_ = false;
        last = due;
        lock.unlock();
        follow_recording();
        deliver(read_frame(opened_, due, kNsPerSecond, to_recorder()));
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
        Result<std::optional<ProcessedFrame>> frame =
            read_frame(opened_, {}, kDeviceWait, to_recorder());
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
