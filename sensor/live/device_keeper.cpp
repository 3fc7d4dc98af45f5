#include "sensor/live/device_keeper.h"

#include <algorithm>
#include <atomic>
#include <chrono>

namespace kino {

/// One for each opening: what a device says after it has gone goes nowhere.
class DeviceKeeper::Intake final : public FrameIntake {
  public:
    explicit Intake(DeviceKeeper& keeper) : keeper_(keeper) {}

    void put(StreamId id, StreamFrame frame) override {
        if (!closed_) keeper_.client_.put(id, std::move(frame));
    }

    void lost(std::string why) override {
        if (closed_.exchange(true)) return;
        keeper_.client_.device_went(why);
        {
            const std::lock_guard lock(keeper_.mutex_);
            keeper_.gone_ = true;
        }
        keeper_.wake();
    }

  private:
    DeviceKeeper& keeper_;
    std::atomic<bool> closed_{false};
};

DeviceKeeper::DeviceKeeper(DeviceDriver driver, const LiveOptions& options, KeeperClient& client)
    : driver_(std::move(driver)), options_(options), client_(client) {}

Result<std::unique_ptr<DeviceKeeper>> DeviceKeeper::open(DeviceDriver driver,
                                                         const std::string& address,
                                                         const LiveOptions& options,
                                                         KeeperClient& client) {
    std::unique_ptr<DeviceKeeper> keeper(new DeviceKeeper(std::move(driver), options, client));
    keeper->thread_ = std::thread([&k = *keeper, address] { k.run(address); });
    std::unique_lock lock(keeper->mutex_);
    keeper->answered_.wait(lock, [&] { return keeper->opened_.has_value(); });
    Result<void> opened = *keeper->opened_;
    lock.unlock();
    KINO_TRY(opened);
    return keeper;
}

DeviceKeeper::~DeviceKeeper() {
    {
        const std::lock_guard lock(mutex_);
        stopping_ = true;
    }
    wake();
    thread_.join();
}

void DeviceKeeper::wake() {
    std::shared_ptr<HotplugWatch> watch;
    {
        const std::lock_guard lock(mutex_);
        watch = watch_;
    }
    work_.notify_all();
    if (watch) watch->interrupt();
}

bool DeviceKeeper::gone() const {
    const std::lock_guard lock(mutex_);
    return gone_;
}

void DeviceKeeper::run(const std::string& address) {
    auto result = open_first(address);
    const bool ok = result.has_value();
    {
        const std::lock_guard lock(mutex_);
        opened_ = std::move(result);
        answered_.notify_all();
    }
    if (ok) keep();
    device_.reset();
}

Result<void> DeviceKeeper::open_first(const std::string& address) {
    KINO_ASSIGN(device_, driver_.open(address));
    intake_ = std::make_unique<Intake>(*this);
    info_ = device_->info();
    address_ = device_->address();
    if (info_.uri.empty()) info_.uri = driver_.scheme + ":" + address_;
    has_controls_ = device_->controls() != nullptr;
    present_since_ = now_ns();
    read_properties();
    client_.device_opened(info_);
    return {};
}

void DeviceKeeper::read_properties() {
    auto calibration = device_->calibration();
    std::vector<Control> list;
    if (Controls* controls = device_->controls()) list = controls->list();
    const std::lock_guard lock(mutex_);
    calibration_ = std::move(calibration);
    controls_ = std::move(list);
}

void DeviceKeeper::keep() {
    std::unique_lock lock(mutex_);
    while (true) {
        if (device_) work_.wait(lock, [&] { return stopping_ || gone_ || !orders_.empty(); });
        if (stopping_) break;
        if (device_ && gone_) {
            lock.unlock();
            let_go();
            lock.lock();
        } else if (!orders_.empty()) {
            const std::shared_ptr<Order> order = orders_.front();
            orders_.pop_front();
            if (order->called_off) continue;
            lock.unlock();
            order->run();
            lock.lock();
            order->done = true;
            answered_.notify_all();
        } else if (!device_) {
            lock.unlock();
            look_for_it();
            lock.lock();
        }
    }
}

void DeviceKeeper::let_go() {
    device_.reset();
    intake_.reset();
    // From here on nothing that is plugged in goes unnoticed.
    std::shared_ptr<HotplugWatch> watch = options_.watch();
    const std::lock_guard lock(mutex_);
    if (!watch_) watch_ = std::move(watch);
    gone_ = false;
    ++stats_.losses;
    stats_.present = false;
    // One that comes and goes by itself must not keep this thread busy.
    const TimeNs now = now_ns();
    if (now - present_since_ > options_.slowest_look) {
        next_look_ = 0;
        look_distance_ = options_.first_look;
    } else {
        postpone_look(now);
    }
}

void DeviceKeeper::postpone_look(TimeNs now) {
    look_distance_ = std::max(look_distance_, options_.first_look);
    next_look_ = now + look_distance_;
    look_distance_ = std::min(look_distance_ * 2, options_.slowest_look);
}

void DeviceKeeper::look_for_it() {
    if (const TimeNs now = now_ns(); now < next_look_) return wait_for_news(next_look_);
    auto result = take_up_again();
    const std::lock_guard lock(mutex_);
    if (result) {
        present_since_ = now_ns();
        stats_.present = true;
        watch_.reset();
        return;
    }
    stats_.trouble = result.error().to_string();
    postpone_look(now_ns());
}

void DeviceKeeper::wait_for_news(TimeNs until) {
    const auto events = watch_->wait(until - now_ns());
    if (std::none_of(events.begin(), events.end(), [](const HotplugEvent& event) {
            return event.change == HotplugEvent::Change::added;
        })) {
        return;
    }
    next_look_ = 0;
    // It may take a moment until its permissions are set.
    look_distance_ = options_.first_look;
}

Result<void> DeviceKeeper::take_up_again() {
    KINO_ASSIGN(std::unique_ptr<LiveDevice> device, driver_.open(address_));
    if (device->address() != address_ || device->info().serial != info_.serial) {
        return fail("another unit answers", device->info().uri);
    }
    intake_ = std::make_unique<Intake>(*this);
    device_ = std::move(device);
    client_.device_came();
    for (const StreamId id : subscribed_) {
        auto started = device_->start(id, *intake_);
        if (started || gone()) continue;
        intake_->lost(started.error().to_string());
        device_.reset();
        intake_.reset();
        const std::lock_guard lock(mutex_);
        gone_ = false;
        return fail(std::move(started).error(), info_.uri);
    }
    std::string trouble;
    for (const auto& [id, value] : settings_) {
        Controls* controls = device_->controls();
        if (!controls || gone()) break;
        if (auto set = controls->set(id, value); !set) trouble = set.error().to_string();
    }
    read_properties();
    client_.device_works();
    const std::lock_guard lock(mutex_);
    stats_.trouble = trouble;
    return {};
}

bool DeviceKeeper::order(std::function<void()> work, std::optional<TimeNs> timeout) {
    const auto order = std::make_shared<Order>();
    order->run = std::move(work);
    {
        const std::lock_guard lock(mutex_);
        orders_.push_back(order);
    }
    wake();
    std::unique_lock lock(mutex_);
    const auto done = [&] { return order->done; };
    if (!timeout) {
        answered_.wait(lock, done);
        return true;
    }
    if (answered_.wait_for(lock, std::chrono::nanoseconds(*timeout), done)) return true;
    order->called_off = true;
    return false;
}

Result<void> DeviceKeeper::turn(StreamId id, bool on) {
    Result<void> result;
    const auto work = [&] {
        const bool was_on =
            std::find(subscribed_.begin(), subscribed_.end(), id) != subscribed_.end();
        if (was_on == on) return;
        if (on) {
            client_.stream_turned(id, true);
            if (device_) result = device_->start(id, *intake_);
            // One that pushes no frames cannot say that it has gone.
            if (!result && !gone() && subscribed_.empty()) result = start_afresh(id);
            if (!result && gone()) result = {};
            if (result) {
                subscribed_.push_back(id);
            } else {
                client_.stream_turned(id, false);
            }
        } else {
            std::erase(subscribed_, id);
            if (device_) device_->stop(id);
            client_.stream_turned(id, false);
        }
    };
    order(work, std::nullopt);
    return result;
}

Result<void> DeviceKeeper::start_afresh(StreamId id) {
    device_.reset();
    auto device = driver_.open(address_);
    if (!device) {
        client_.device_went(device.error().to_string());
        let_go();
        return {};
    }
    device_ = std::move(*device);
    intake_ = std::make_unique<Intake>(*this);
    client_.device_came();
    return device_->start(id, *intake_);
}

Result<RigParameters> DeviceKeeper::calibration() {
    order(
        [this] {
            if (device_) read_properties();
        },
        options_.control_timeout);
    const std::lock_guard lock(mutex_);
    return calibration_;
}

std::vector<Control> DeviceKeeper::control_list() const {
    const std::lock_guard lock(mutex_);
    return controls_;
}

Result<double> DeviceKeeper::control_call(const std::string& id,
                                          std::function<Result<double>(Controls&)> call) {
    // Shared with an order that may outlive the wait for it.
    const auto answer = std::make_shared<Result<double>>(0.0);
    const bool done = order(
        [this, id, answer, call = std::move(call)] {
            Controls* controls = device_ ? device_->controls() : nullptr;
            *answer = controls ? call(*controls)
                               : fail("the device is not there", info_.uri, "plug it in again");
        },
        options_.control_timeout);
    if (!done) return fail("the device does not answer", info_.uri);
    return *answer;
}

Result<double> DeviceKeeper::get_control(const std::string& id) {
    return control_call(id, [id](Controls& controls) { return controls.get(id); });
}

Result<void> DeviceKeeper::set_control(const std::string& id, double value) {
    const auto call = [this, id, value](Controls& controls) -> Result<double> {
        KINO_TRY(controls.set(id, value));
        std::erase_if(settings_, [&](const auto& setting) { return setting.first == id; });
        settings_.emplace_back(id, value);
        return value;
    };
    KINO_TRY(control_call(id, call));
    return {};
}

LiveStats DeviceKeeper::stats() const {
    const std::lock_guard lock(mutex_);
    return stats_;
}

}  // namespace kino
