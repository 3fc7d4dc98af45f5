#include "sensor/live/live_source.h"

#include <fmt/format.h>

#include <algorithm>
#include <mutex>
#include <utility>

#include "sensor/live/device_keeper.h"
#include "sensor/live/rising_frames.h"

namespace kino {
namespace {

/// Where frames and news go; the DeviceKeeper behind it brings devices to it.
class LiveSourceOnKeeper final : public LiveSource, public Controls, private KeeperClient {
  public:
    explicit LiveSourceOnKeeper(LiveOptions options) : options_(options), sets_(options.sets) {}
    ~LiveSourceOnKeeper() override { keeper_.reset(); }

    Result<void> open(DeviceDriver driver, const std::string& address) {
        KINO_ASSIGN(keeper_, DeviceKeeper::open(std::move(driver), address, options_, *this));
        return {};
    }

    const SourceInfo& info() const override { return info_; }
    Result<RigParameters> calibration() const override { return keeper_->calibration(); }
    Controls* controls() override { return keeper_->has_controls() ? this : nullptr; }

    Result<void> subscribe(StreamId id) override {
        const auto& streams = info_.streams;
        if (std::none_of(streams.begin(), streams.end(),
                         [&](const StreamInfo& s) { return s.id == id; })) {
            return fail(
                fmt::format("this device has no {} stream {}", stream_name(id.kind), id.device),
                info_.uri);
        }
        return keeper_->turn(id, true);
    }
    void unsubscribe(StreamId id) override { (void)keeper_->turn(id, false); }

    Result<std::optional<FrameSet>> next(TimeNs timeout) override { return sets_.next(timeout); }

    std::vector<Event> take_events() override {
        const std::lock_guard lock(mutex_);
        return std::exchange(events_, {});
    }

    bool set_tap(FrameTap tap) override {
        const std::lock_guard lock(put_mutex_);
        tap_.swap(tap);
        return true;
    }

    LiveStats stats() const override {
        LiveStats stats = keeper_->stats();
        stats.overtaken = sets_.overtaken();
        const std::lock_guard lock(mutex_);
        stats.frames = frames_;
        return stats;
    }

    std::vector<Control> list() const override { return keeper_->control_list(); }
    Result<double> get(const std::string& id) override { return keeper_->get_control(id); }
    Result<void> set(const std::string& id, double value) override {
        return keeper_->set_control(id, value);
    }

  private:
    void device_opened(const SourceInfo& first) override {
        info_ = first;
        add_event(EventKind::started, info_.name);
    }

    void stream_turned(StreamId id, bool on) override {
        const std::lock_guard lock(put_mutex_);
        std::erase(on_, id);
        if (on) on_.push_back(id);
        if (in_sets(id)) sets_.turn(id.kind, on);
    }

    void device_came() override {
        const std::lock_guard lock(put_mutex_);
        accepting_ = true;
        rising_.begin_epoch();
    }

    /// Said by the first frame if that is earlier: nobody sees one between `lost` and `back`.
    void device_works() override {
        const std::lock_guard lock(put_mutex_);
        say_back();
    }

    void put(StreamId id, StreamFrame frame) override {
        const std::lock_guard lock(put_mutex_);
        if (!accepting_ || std::find(on_.begin(), on_.end(), id) == on_.end()) return;
        say_back();
        frame = rising_.pass(id, std::move(frame));
        {
            const std::lock_guard state(mutex_);
            ++frames_;
        }
        if (tap_) tap_(id, frame);
        if (in_sets(id)) sets_.put(id.kind, std::move(frame));
    }

    void device_went(const std::string& why) override {
        const std::lock_guard lock(put_mutex_);
        accepting_ = false;
        if (!std::exchange(said_present_, false)) return;
        add_event(EventKind::lost, why);
    }

    void say_back() {
        if (!accepting_ || std::exchange(said_present_, true)) return;
        add_event(EventKind::back, info_.name);
    }

    void add_event(EventKind kind, const std::string& text) {
        const std::lock_guard lock(mutex_);
        events_.push_back({kind, now_ns(), text});
    }

    /// A set has one frame of each kind: that of the kind's first stream.
    bool in_sets(StreamId id) const {
        const auto& streams = info_.streams;
        const auto first = std::find_if(streams.begin(), streams.end(),
                                        [&](const StreamInfo& s) { return s.id.kind == id.kind; });
        return first != streams.end() && first->id == id;
    }

    const LiveOptions options_;
    SetBuilder sets_;
    SourceInfo info_;  ///< fixed once open

    /// Held while a frame goes through, so that the tap sees one at a time. Before mutex_.
    std::mutex put_mutex_;
    RisingFrames rising_;
    FrameTap tap_;
    std::vector<StreamId> on_;
    bool accepting_ = true;
    bool said_present_ = true;

    mutable std::mutex mutex_;
    std::vector<Event> events_;
    std::int64_t frames_ = 0;

    std::unique_ptr<DeviceKeeper> keeper_;
};

}  // namespace

Result<std::unique_ptr<LiveSource>> make_live_source(DeviceDriver driver,
                                                     const std::string& address,
                                                     LiveOptions options) {
    auto source = std::make_unique<LiveSourceOnKeeper>(std::move(options));
    KINO_TRY(source->open(std::move(driver), address));
    return source;
}

}  // namespace kino
