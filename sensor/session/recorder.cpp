#include "sensor/session/recorder.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <condition_variable>
#include <deque>
#include <mutex>
#include <optional>
#include <thread>
#include <type_traits>
#include <utility>

#include "base/check.h"
#include "sensor/session/recorder_parts.h"
#include "sensor/session/session_writer.h"

namespace kino {
namespace {

// Matroska counts from 2001-01-01.
std::int64_t date_now_ns() {
    constexpr std::int64_t kEpochSeconds = 978'307'200;
    const auto since_1970 = std::chrono::system_clock::now().time_since_epoch();
    return std::chrono::duration_cast<std::chrono::nanoseconds>(since_1970).count() -
           kEpochSeconds * kNsPerSecond;
}

struct Weight {
    std::size_t bytes = 0;
    TimeNs time = 0;
    std::int64_t sequence = 0;
    const void* address = nullptr;
};

Weight weigh(const StreamFrame& frame) {
    return std::visit(
        [](const auto& pointer) -> Weight {
            using Frame = std::remove_cvref_t<decltype(*pointer)>;
            if (!pointer) return {};
            if constexpr (std::is_same_v<Frame, BodyFrame>) {
                return {pointer->bodies.size() * sizeof(Body) + sizeof(Frame), pointer->time, 0,
                        pointer.get()};
            } else {
                std::size_t bytes = sizeof(Frame);
                if constexpr (std::is_same_v<Frame, ColorFrame>) {
                    bytes += pointer->bytes.size();
                } else if constexpr (!std::is_same_v<Frame, MotionFrame>) {
                    bytes += pointer->raw.size() * 2;
                }
                return {bytes, pointer->header.host_time, pointer->header.sequence, pointer.get()};
            }
        },
        frame);
}

bool fits(StreamKind kind, const StreamFrame& frame) {
    constexpr std::size_t kDepth = 0;
    switch (frame.index()) {
        case kDepth:
            return kind == StreamKind::depth;
        case 1:
            return kind == StreamKind::color;
        case 2:
            return kind == StreamKind::infrared;
        case 3:
            return kind == StreamKind::bodies;
        default:
            return kind == StreamKind::motion;
    }
}

class ThreadedRecorder final : public Recorder {
  public:
    ThreadedRecorder(std::unique_ptr<RecordingFile> file, const SourceInfo& source,
                     const RigParameters& rig, const RecorderOptions& options)
        : writer_(std::move(file), source, rig, options, date_now_ns()),
          capacity_(std::max<std::size_t>(options.queue_bytes, 1)),
          thread_([this] { run(); }) {}

    ~ThreadedRecorder() override { (void)ThreadedRecorder::close(); }

    void put(StreamId id, const StreamFrame& frame) override {
        KINO_CHECK(fits(id.kind, frame));
        const Weight weight = weigh(frame);
        if (weight.address == nullptr) return;
        {
            const std::lock_guard lock(mutex_);
            if (closing_) return;
            remember(id, weight);
            if (!status_.error.empty() || queued_bytes_ + weight.bytes > capacity_) {
                drop(id, weight);
                return;
            }
            queued_bytes_ += weight.bytes;
            queue_.push_back({id, frame, {}, {}, weight.bytes});
        }
        wake_.notify_one();
    }

    void put(const FrameSet& set) override {
        const auto put_new = [this](StreamId id, StreamFrame frame) {
            const Weight weight = weigh(frame);
            if (weight.address != nullptr && !seen(id, weight)) put(id, frame);
        };
        const bool new_depth =
            set.depth && !seen({0, StreamKind::depth}, weigh(StreamFrame(set.depth)));
        put_new({0, StreamKind::depth}, set.depth);
        if (new_depth && set.pose_origin == PoseOrigin::trajectory) {
            put_pose({set.depth->header.host_time, set.world_from_depth});
        }
        put_new({0, StreamKind::color}, set.color);
        put_new({0, StreamKind::infrared}, set.infrared);
        put_new({0, StreamKind::bodies}, set.bodies);
        put_new({0, StreamKind::motion}, set.motion);
    }

    void put_event(const Event& event) override {
        push_small({.event = {.kind = event_kind_name(event.kind),
                              .time = event.time,
                              .text = event.text,
                              .detail = event.detail}});
    }

    RecorderStatus status() const override {
        const std::lock_guard lock(mutex_);
        RecorderStatus status = status_;
        status.queue_fill = static_cast<double>(queued_bytes_) / static_cast<double>(capacity_);
        return status;
    }

    Result<RecorderStatus> close() override {
        const std::lock_guard once(close_mutex_);
        {
            const std::lock_guard lock(mutex_);
            closing_ = true;
        }
        wake_.notify_one();
        if (thread_.joinable()) thread_.join();
        if (failure_) return tl::unexpected<Error>(*failure_);
        return status();
    }

  private:
    struct Item {
        StreamId id;
        StreamFrame frame;
        SessionEvent event;               ///< if its kind is not empty, there is no frame
        std::optional<SessionPose> pose;  ///< if there is one, there is no frame
        std::size_t bytes = 0;

        [[nodiscard]] bool is_frame() const { return event.kind.empty() && !pose; }
    };
    struct Last {
        StreamId id;
        TimeNs time = 0;
        std::int64_t sequence = 0;
    };

    void put_pose(const SessionPose& pose) { push_small({.pose = pose}); }

    void push_small(Item item) {
        {
            const std::lock_guard lock(mutex_);
            // Few and small, but a source gone mad must not fill the memory.
            constexpr std::size_t kMostItems = 100'000;
            if (closing_ || !status_.error.empty() || queue_.size() >= kMostItems) return;
            queue_.push_back(std::move(item));
        }
        wake_.notify_one();
    }

    void remember(StreamId id, const Weight& weight) {
        for (Last& last : last_) {
            if (last.id == id) {
                last = {id, weight.time, weight.sequence};
                return;
            }
        }
        last_.push_back({id, weight.time, weight.sequence});
    }

    bool seen(StreamId id, const Weight& weight) const {
        const std::lock_guard lock(mutex_);
        return std::any_of(last_.begin(), last_.end(), [&](const Last& last) {
            return last.id == id && last.time == weight.time && last.sequence == weight.sequence;
        });
    }

    /// Tells of the frame at the end of the queue, together with those dropped just before.
    void drop(StreamId id, const Weight& weight) {
        ++not_queued_;
        ++status_.dropped;
        if (!status_.error.empty()) return;
        for (SessionEvent& event : drops_) {
            if (event.stream == id) {
                ++event.count;
                event.last_sequence = weight.sequence;
                return;
            }
        }
        drops_.push_back({.kind = "dropped",
                          .time = weight.time,
                          .text = "the disk or the processor was too slow",
                          .stream = id,
                          .count = 1,
                          .first_sequence = weight.sequence,
                          .last_sequence = weight.sequence});
    }

    void run() {
        bool last_round = false;
        while (!last_round) {
            std::deque<Item> batch;
            std::vector<SessionEvent> drops;
            {
                std::unique_lock lock(mutex_);
                const auto something = [&] {
                    return closing_ || !queue_.empty() || !drops_.empty();
                };
                if (const auto due = failure_ ? std::nullopt : writer_.due()) {
                    const TimeNs wait = std::max<TimeNs>(*due - now_ns(), 0);
                    wake_.wait_for(lock, std::chrono::nanoseconds(wait), something);
                } else {
                    wake_.wait(lock, something);
                }
                last_round = closing_;
                batch.swap(queue_);
                drops.swap(drops_);
            }
            for (Item& item : batch) {
                write([&] {
                    if (item.pose) return writer_.put_pose(*item.pose, now_ns());
                    return item.is_frame() ? writer_.put(item.id, item.frame, item.bytes, now_ns())
                                           : writer_.put_event(item.event, now_ns());
                });
                done(item);
                publish();
            }
            for (const SessionEvent& event : drops) {
                write([&] { return writer_.put_event(event, now_ns()); });
            }
            write([&] { return writer_.tick(now_ns()); });
            if (last_round && !finished_) finish();
            publish();
        }
    }

    template <class Step>
    void write(const Step& step) {
        if (failure_) return;
        if (auto written = step(); !written) {
            failure_ = std::move(written).error();
            // At once, not at close(): the user may take hours to see the message.
            finish();
        }
    }

    void finish() {
        finished_ = true;
        if (auto ended = writer_.finish(now_ns()); !ended && !failure_) {
            failure_ = std::move(ended).error();
        }
    }

    /// The frame's memory counts until it is in the file's hands.
    void done(Item& item) {
        const std::size_t bytes = item.bytes;
        const bool is_frame = item.is_frame();
        item.frame = {};
        const std::lock_guard lock(mutex_);
        queued_bytes_ -= bytes;
        if (is_frame) ++handled_;
    }

    void publish() {
        const std::lock_guard lock(mutex_);
        status_.frames = writer_.frames_written();
        status_.bytes = static_cast<std::int64_t>(writer_.file_size());
        status_.duration = writer_.duration();
        // In the end what is not in the file is lost, whatever the reason.
        const std::int64_t lost =
            finished_ ? handled_ - writer_.frames_written() : writer_.refused();
        status_.dropped = not_queued_ + lost;
        if (failure_ && status_.error.empty()) status_.error = failure_->to_string();
    }

    SessionWriter writer_;          // the thread's
    std::optional<Error> failure_;  // the thread's, until it is joined
    bool finished_ = false;         // the thread's
    const std::size_t capacity_;
    mutable std::mutex mutex_;
    std::condition_variable wake_;
    std::deque<Item> queue_;
    std::size_t queued_bytes_ = 0;
    std::int64_t handled_ = 0;     // frames that the thread has taken
    std::int64_t not_queued_ = 0;  // frames that found the queue full or the file closed
    std::vector<SessionEvent> drops_;
    std::vector<Last> last_;
    RecorderStatus status_;
    bool closing_ = false;
    std::mutex close_mutex_;
    std::thread thread_;  // last: it uses all the others
};

}  // namespace

std::unique_ptr<Recorder> make_recorder(std::unique_ptr<RecordingFile> file,
                                        const SourceInfo& source, const RigParameters& rig,
                                        const RecorderOptions& options) {
    return std::make_unique<ThreadedRecorder>(std::move(file), source, rig, options);
}

Result<std::unique_ptr<Recorder>> Recorder::create(const std::filesystem::path& file,
                                                   const SourceInfo& source,
                                                   const RigParameters& rig,
                                                   const RecorderOptions& options) {
    KINO_TRY(validate(rig));
    KINO_ASSIGN(auto opened, create_recording_file(file));
    return make_recorder(std::move(opened), source, rig, options);
}

}  // namespace kino
