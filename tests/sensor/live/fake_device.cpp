#include "fake_device.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <utility>

namespace kino::test {

/// What the bus and the opened device share.
struct FakeBus::Core {
    std::mutex mutex;  ///< held while a frame is put: stop() waits for it
    bool plugged = true;
    bool told = false;
    std::vector<std::pair<StreamId, FrameIntake*>> running;
    std::map<std::string, double> settings;
};

class FakeBus::Device final : public LiveDevice, public Controls {
  public:
    Device(FakeBus& bus, std::string serial, std::shared_ptr<Core> core)
        : bus_(bus), serial_(std::move(serial)), core_(std::move(core)) {
        ++bus_.open_devices_;
        info_.uri = "fake:" + serial_;
        info_.name = "Fake " + serial_;
        info_.serial = serial_;
        for (const auto kind : {StreamKind::depth, StreamKind::color, StreamKind::infrared}) {
            info_.streams.push_back({{0, kind}, 2, 2, 30, "fake"});
        }
    }
    ~Device() override {
        const std::lock_guard lock(core_->mutex);
        core_->running.clear();
        --bus_.open_devices_;
    }

    const SourceInfo& info() const override { return info_; }
    Result<RigParameters> calibration() const override {
        RigParameters rig;
        rig.serial = serial_;
        rig.depth = {.width = 2, .height = 2, .fx = 2, .fy = 2, .cx = 0.5, .cy = 0.5};
        rig.color = rig.depth;
        return rig;
    }
    std::string address() const override { return serial_; }
    Controls* controls() override { return this; }

    Result<void> start(StreamId id, FrameIntake& intake) override {
        std::function<void(StreamId)> hook;
        bool refused = false;
        {
            const std::lock_guard lock(bus_.mutex_);
            hook = bus_.on_start_;
            refused = std::count(bus_.refused_.begin(), bus_.refused_.end(), id.kind) > 0;
        }
        if (refused) return fail("refused", info_.uri);
        if (hook) hook(id);
        const std::lock_guard lock(core_->mutex);
        if (!core_->plugged) return fail("no such device", info_.uri);
        core_->running.emplace_back(id, &intake);
        return {};
    }
    void stop(StreamId id) override {
        const std::lock_guard lock(core_->mutex);
        std::erase_if(core_->running, [&](const auto& r) { return r.first == id; });
    }

    std::vector<Control> list() const override {
        return {{.id = "tilt", .name = "tilt", .minimum = -27, .maximum = 27},
                {.id = "led", .name = "LED", .maximum = 6}};
    }
    Result<double> get(const std::string& id) override {
        const std::lock_guard lock(core_->mutex);
        if (!core_->plugged) return fail("no such device", info_.uri);
        return core_->settings[id];
    }
    Result<void> set(const std::string& id, double value) override {
        std::function<void()> hook;
        {
            const std::lock_guard lock(bus_.mutex_);
            hook = bus_.on_set_;
        }
        if (hook) hook();
        const std::lock_guard lock(core_->mutex);
        if (!core_->plugged) return fail("no such device", info_.uri);
        if (id != "tilt" && id != "led") return fail("no such control", info_.uri);
        core_->settings[id] = value;
        const std::lock_guard bus_lock(bus_.log_mutex_);
        bus_.settings_made_.push_back(fmt::format("{} {}", id, value));
        return {};
    }

  private:
    FakeBus& bus_;
    std::string serial_;
    std::shared_ptr<Core> core_;
    SourceInfo info_;
};

class FakeBus::Watch final : public HotplugWatch {
  public:
    Watch(FakeBus& bus, bool deaf) : bus_(bus), deaf_(deaf) { ++bus_.watches_; }
    ~Watch() override {
        const std::lock_guard lock(bus_.mutex_);
        std::erase(bus_.listening_, this);
        --bus_.watches_;
    }
    std::vector<HotplugEvent> wait(TimeNs timeout) override {
        std::unique_lock lock(mutex_);
        changed_.wait_for(lock, std::chrono::nanoseconds(std::max<TimeNs>(0, timeout)),
                          [&] { return interrupted_ || !events_.empty(); });
        interrupted_ = false;
        return std::exchange(events_, {});
    }
    void interrupt() override {
        const std::lock_guard lock(mutex_);
        interrupted_ = true;
        changed_.notify_all();
    }
    void tell(const HotplugEvent& event) {
        if (deaf_) return;
        const std::lock_guard lock(mutex_);
        events_.push_back(event);
        changed_.notify_all();
    }

  private:
    FakeBus& bus_;
    const bool deaf_;
    std::mutex mutex_;
    std::condition_variable changed_;
    std::vector<HotplugEvent> events_;
    bool interrupted_ = false;
};

FakeBus::FakeBus() = default;
FakeBus::~FakeBus() = default;

DeviceDriver FakeBus::driver() {
    DeviceDriver driver;
    driver.scheme = "fake";
    driver.name = "Fake device";
    driver.uri_pattern = "fake:[serial]";
    driver.open = [this](const std::string& address) { return open(address); };
    driver.list = [this] {
        const std::lock_guard lock(mutex_);
        std::vector<DeviceEntry> entries;
        for (const auto& [serial, plugged] : plugged_) {
            if (plugged) entries.push_back({"fake:" + serial, "Fake", serial, {}});
        }
        return entries;
    };
    return driver;
}

Result<std::unique_ptr<LiveDevice>> FakeBus::open(const std::string& address) {
    const std::lock_guard lock(mutex_);
    for (const auto& [serial, plugged] : plugged_) {
        if (!plugged || (!address.empty() && address != serial)) continue;
        ++openings_;
        auto core = std::make_shared<Core>();
        cores_[serial] = core;
        return std::make_unique<Device>(*this, serial, std::move(core));
    }
    return fail("no such device", "fake:" + address);
}

std::unique_ptr<HotplugWatch> FakeBus::watch() {
    auto watch = std::make_unique<Watch>(*this, deaf_);
    const std::lock_guard lock(mutex_);
    listening_.push_back(watch.get());
    return watch;
}

std::shared_ptr<FakeBus::Core> FakeBus::core(const std::string& serial) const {
    const std::lock_guard lock(mutex_);
    const auto found = cores_.find(serial);
    return found == cores_.end() ? nullptr : found->second;
}

void FakeBus::tell(HotplugEvent::Change change, const std::string& serial) {
    const std::lock_guard lock(mutex_);
    for (Watch* watch : listening_) watch->tell({change, "usb", "045e", "02ae", serial, ""});
}

void FakeBus::plug(const std::string& serial) {
    {
        const std::lock_guard lock(mutex_);
        plugged_[serial] = true;
    }
    tell(HotplugEvent::Change::added, serial);
}

void FakeBus::unplug(const std::string& serial) {
    {
        const std::lock_guard lock(mutex_);
        plugged_[serial] = false;
    }
    if (const auto c = core(serial)) {
        const std::lock_guard lock(c->mutex);
        c->plugged = false;
        if (!c->running.empty() && !std::exchange(c->told, true)) {
            c->running.front().second->lost("pulled out");
        }
    }
    tell(HotplugEvent::Change::removed, serial);
}

bool FakeBus::put(const std::string& serial, StreamKind kind, StreamFrame frame) {
    const auto c = core(serial);
    if (!c) return false;
    const std::lock_guard lock(c->mutex);
    if (!c->plugged) return false;
    for (const auto& [id, intake] : c->running) {
        if (id.kind != kind) continue;
        intake->put(id, std::move(frame));
        return true;
    }
    return false;
}

void FakeBus::on_start(std::function<void(StreamId)> hook) {
    const std::lock_guard lock(mutex_);
    on_start_ = std::move(hook);
}

void FakeBus::on_set(std::function<void()> hook) {
    const std::lock_guard lock(mutex_);
    on_set_ = std::move(hook);
}

void FakeBus::refuse(StreamKind kind, bool refused) {
    const std::lock_guard lock(mutex_);
    std::erase(refused_, kind);
    if (refused) refused_.push_back(kind);
}

bool FakeBus::running(const std::string& serial, StreamKind kind) const {
    const auto c = core(serial);
    if (!c) return false;
    const std::lock_guard lock(c->mutex);
    return std::any_of(c->running.begin(), c->running.end(),
                       [&](const auto& r) { return r.first.kind == kind; });
}

double FakeBus::setting(const std::string& serial, const std::string& id) const {
    const auto c = core(serial);
    if (!c) return 0;
    const std::lock_guard lock(c->mutex);
    return c->settings[id];
}

std::vector<std::string> FakeBus::settings_made() const {
    const std::lock_guard lock(log_mutex_);
    return settings_made_;
}

void FakeBus::forget_settings() {
    const std::lock_guard lock(log_mutex_);
    settings_made_.clear();
}

StreamFrame fake_frame(StreamKind kind, std::int64_t sequence, TimeNs host_time,
                       TimeNs device_zero) {
    const FrameHeader header{host_time - device_zero, host_time, sequence, 0};
    if (kind == StreamKind::color) {
        auto frame = std::make_shared<ColorFrame>();
        frame->header = header;
        frame->width = frame->height = 2;
        frame->pitch = 8;
        frame->bytes.assign(16, 100);
        return std::shared_ptr<const ColorFrame>(std::move(frame));
    }
    if (kind == StreamKind::infrared) {
        auto frame = std::make_shared<InfraredFrame>();
        frame->header = header;
        frame->raw = Image<std::uint16_t>(2, 2);
        return std::shared_ptr<const InfraredFrame>(std::move(frame));
    }
    auto frame = std::make_shared<DepthFrame>();
    frame->header = header;
    frame->raw = Image<std::uint16_t>(2, 2);
    return std::shared_ptr<const DepthFrame>(std::move(frame));
}

FrameHeader header_of(const StreamFrame& frame) {
    return std::visit(
        [](const auto& f) {
            if constexpr (std::is_same_v<std::remove_cvref_t<decltype(*f)>, BodyFrame>) {
                return FrameHeader{f->time, f->time};
            } else {
                return f->header;
            }
        },
        frame);
}

}  // namespace kino::test
