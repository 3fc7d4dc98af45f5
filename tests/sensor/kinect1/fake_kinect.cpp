#include "fake_kinect.h"

#include <algorithm>

namespace kino::test {
namespace {

using usb::Failure;
using usb::fault;

constexpr const char* kCameraPort = "1-4.1";
constexpr const char* kMotorPort = "1-4.2";

}  // namespace

std::shared_ptr<FakeKinect> FakeKinect::make(Unit unit) {
    return std::shared_ptr<FakeKinect>(new FakeKinect(std::move(unit)));
}

class FakeKinect::Stream : public usb::IsoStream {
  public:
    Stream(std::shared_ptr<FakeKinect> device, std::uint8_t address)
        : device_(std::move(device)), address_(address) {}
    ~Stream() override {
        const std::lock_guard lock(device_->mutex_);
        device_->endpoint(address_).sink = nullptr;
    }

  private:
    std::shared_ptr<FakeKinect> device_;
    std::uint8_t address_;
};

class FakeKinect::CameraHandle : public usb::Handle {
  public:
    explicit CameraHandle(std::shared_ptr<FakeKinect> device)
        : device_(std::move(device)), opened_at_(device_->address_) {
        ++device_->open_handles_;
    }
    ~CameraHandle() override { --device_->open_handles_; }

    usb::Outcome<void> claim(int) override {
        if (const auto failure = device_->failures().claim) {
            return fault(*failure, std::string("claim: ") + usb::describe(*failure));
        }
        return {};
    }
    usb::Outcome<void> set_alternate(int, int setting) override {
        if (const auto failure = device_->failures().alternate) {
            return fault(*failure, std::string("setting: ") + usb::describe(*failure));
        }
        device_->alternate_ = setting;
        return {};
    }
    usb::Outcome<void> control_out(const usb::Request& request, std::span<const std::uint8_t> bytes,
                                   std::chrono::milliseconds) override {
        if (gone()) return fault(Failure::no_device, "gone");
        if (request.request != 0) return fault(Failure::stall, "no such request");
        return device_->camera.take(bytes);
    }
    usb::Outcome<std::size_t> control_in(const usb::Request& request, std::span<std::uint8_t> bytes,
                                         std::chrono::milliseconds) override {
        if (gone()) return fault(Failure::no_device, "gone");
        if (request.request != 0) return fault(Failure::stall, "no such request");
        return device_->camera.answer(bytes);
    }
    usb::Outcome<std::unique_ptr<usb::IsoStream>> stream(const usb::IsoParameters& parameters,
                                                         usb::PacketSink& sink) override {
        if (gone()) return fault(Failure::no_device, "gone");
        if (const auto failure = device_->failures().stream) {
            return fault(*failure, std::string("stream: ") + usb::describe(*failure));
        }
        const std::lock_guard lock(device_->mutex_);
        Endpoint& endpoint = device_->endpoint(parameters.endpoint);
        endpoint.sink = &sink;
        endpoint.ended = false;
        return std::make_unique<Stream>(device_, parameters.endpoint);
    }

  private:
    [[nodiscard]] bool gone() const {
        return !device_->plugged_ || device_->address_ != opened_at_;
    }
    std::shared_ptr<FakeKinect> device_;
    int opened_at_;
};

class FakeKinect::MotorHandle : public usb::Handle {
  public:
    explicit MotorHandle(std::shared_ptr<FakeKinect> device) : device_(std::move(device)) {
        ++device_->open_handles_;
    }
    ~MotorHandle() override { --device_->open_handles_; }
    usb::Outcome<void> claim(int) override { return {}; }
    usb::Outcome<void> set_alternate(int, int) override { return {}; }
    usb::Outcome<void> control_out(const usb::Request& request, std::span<const std::uint8_t>,
                                   std::chrono::milliseconds) override {
        if (auto bad = failure()) return fault(*bad, usb::describe(*bad));
        if (request.request == 0x31) {
            device_->motor_angle_halves = static_cast<std::int16_t>(request.value);
        } else if (request.request == 0x06) {
            device_->led = request.value;
        } else {
            return fault(Failure::stall, "no such request");
        }
        return {};
    }
    usb::Outcome<std::size_t> control_in(const usb::Request& request, std::span<std::uint8_t> bytes,
                                         std::chrono::milliseconds) override {
        if (auto bad = failure()) return fault(*bad, usb::describe(*bad));
        if (request.request != 0x32 || bytes.size() < 10) return fault(Failure::stall, "no");
        bytes[0] = bytes[1] = 0;
        for (std::size_t i = 0; i < 3; ++i) {
            bytes[2 + 2 * i] = static_cast<std::uint8_t>(device_->counts[i] >> 8);
            bytes[3 + 2 * i] = static_cast<std::uint8_t>(device_->counts[i] & 0xFF);
        }
        bytes[8] = static_cast<std::uint8_t>(device_->motor_angle_halves.load());
        bytes[9] = static_cast<std::uint8_t>(device_->motor_status.load());
        return std::size_t{10};
    }
    usb::Outcome<std::unique_ptr<usb::IsoStream>> stream(const usb::IsoParameters&,
                                                         usb::PacketSink&) override {
        return fault(Failure::not_found, "no endpoints");
    }

  private:
    [[nodiscard]] std::optional<Failure> failure() const {
        if (!device_->plugged_) return Failure::no_device;
        return device_->failures().motor;
    }
    std::shared_ptr<FakeKinect> device_;
};

usb::Outcome<std::vector<usb::DeviceId>> FakeKinect::list(std::uint16_t vendor) {
    if (const auto failure = failures().list) return fault(*failure, "list failed");
    std::vector<usb::DeviceId> out;
    if (vendor != 0x045e || !plugged_) return out;
    const int address = address_;
    if (unit_.has_camera) {
        out.push_back({vendor, unit_.camera_product, unit_.release, kCameraPort, "1-4", address,
                       unit_.camera_serial, 1});
    }
    if (unit_.has_motor) {
        out.push_back({vendor, 0x02b0, 0x0105, kMotorPort, "1-4", address + 1, "", 1});
    }
    if (unit_.audio_serial) {
        out.push_back(
            {vendor, 0x02ad, 0x0100, "1-4.3", "1-4", address + 2, *unit_.audio_serial, 1});
    }
    return out;
}

usb::Outcome<std::unique_ptr<usb::Handle>> FakeKinect::open(const usb::DeviceId& device) {
    if (!plugged_ || device.address < address_) return fault(Failure::no_device, "not plugged in");
    const Failures f = failures();
    const bool is_motor = device.port == kMotorPort;
    if (const auto failure = is_motor ? f.open_motor : f.open_camera) {
        return fault(*failure,
                     std::string("the sensor cannot be opened: ") + usb::describe(*failure));
    }
    if (is_motor) return std::make_unique<MotorHandle>(shared_from_this());
    return std::make_unique<CameraHandle>(shared_from_this());
}

FakeKinect::Failures FakeKinect::failures() const {
    const std::lock_guard lock(failures_mutex_);
    return failures_;
}
void FakeKinect::set_failures(const Failures& failures) {
    const std::lock_guard lock(failures_mutex_);
    failures_ = failures;
}

bool FakeKinect::send(std::uint8_t address, const std::vector<Bytes>& packets) {
    constexpr std::size_t kBatch = 16;
    for (std::size_t at = 0; at < packets.size(); at += kBatch) {
        const std::lock_guard lock(mutex_);
        Endpoint& e = endpoint(address);
        if (!e.sink || e.ended || !plugged_) return false;
        std::vector<usb::Packet> batch;
        bool last = false;
        for (std::size_t i = at; i < std::min(at + kBatch, packets.size()) && !last; ++i) {
            std::size_t size = packets[i].size();
            if (bytes_left_ >= 0) {
                last = bytes_left_ <= static_cast<std::int64_t>(size);
                if (last) size = static_cast<std::size_t>(bytes_left_);
                bytes_left_ -= static_cast<std::int64_t>(size);
            }
            batch.push_back({{packets[i].data(), size}, true});
        }
        e.sink->packets(batch, now_ns());
        if (last) {
            bytes_left_ = -1;
            unplug();
            return false;
        }
    }
    return true;
}

bool FakeKinect::send_frame(kinect1::CameraMode mode, std::span<const std::uint8_t> frame) {
    const std::uint8_t address = kinect1::traits(mode).endpoint;
    std::vector<Bytes> packets;
    {
        const std::lock_guard lock(mutex_);
        Endpoint& e = endpoint(address);
        packets = packets_of(mode, frame, e.sequence, e.ticks);
        e.ticks +=
            static_cast<std::uint32_t>(kinect1::kTicksPerSecond / kinect1::traits(mode).nominal_hz);
    }
    return send(address, packets);
}

bool FakeKinect::running(std::uint8_t address) const {
    const std::lock_guard lock(mutex_);
    return endpoints_[address & 1u].sink != nullptr;
}

void FakeKinect::end_stream(std::uint8_t address, Failure why) {
    const std::lock_guard lock(mutex_);
    Endpoint& e = endpoint(address);
    if (!e.sink || e.ended) return;
    e.ended = true;
    e.sink->ended({why, std::string("the stream ended: ") + usb::describe(why)});
}

void FakeKinect::end_all(Failure why) {
    end_stream(0x81, why);
    end_stream(0x82, why);
}

void FakeKinect::unplug() {
    plugged_ = false;
    end_all(Failure::no_device);
}
void FakeKinect::unplug_after(std::int64_t bytes) {
    const std::lock_guard lock(mutex_);
    bytes_left_ = bytes;
}
void FakeKinect::plug_in() {
    address_ += 10;
    plugged_ = true;
}

}  // namespace kino::test
