#include <fmt/format.h>
#include <libusb.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <fstream>
#include <mutex>
#include <thread>

#include "sensor/kinect1/libusb_stream.h"

namespace kino::usb {

Failure failure_of(int libusb_error) {
    switch (libusb_error) {
        case LIBUSB_ERROR_NO_DEVICE:
            return Failure::no_device;
        case LIBUSB_ERROR_ACCESS:
            return Failure::no_permission;
        case LIBUSB_ERROR_BUSY:
            return Failure::busy;
        case LIBUSB_ERROR_NOT_FOUND:
            return Failure::not_found;
        case LIBUSB_ERROR_TIMEOUT:
            return Failure::timeout;
        case LIBUSB_ERROR_PIPE:
            return Failure::stall;
        case LIBUSB_ERROR_OVERFLOW:
            return Failure::overflow;
        case LIBUSB_ERROR_INTERRUPTED:
            return Failure::interrupted;
        case LIBUSB_ERROR_NO_MEM:
            return Failure::no_memory;
        case LIBUSB_ERROR_NOT_SUPPORTED:
            return Failure::unsupported;
        default:
            return Failure::io;
    }
}

tl::unexpected<Fault> libusb_fault(int error, const std::string& what) {
    return fault(failure_of(error), fmt::format("{}: {} ({})", what, describe(failure_of(error)),
                                                libusb_error_name(error)));
}

namespace {

/// A libusb context and, while a device is open, the thread that handles its events.
class Context {
  public:
    Context() = default;
    Context(const Context&) = delete;
    Context& operator=(const Context&) = delete;
    ~Context() {
        if (context_) libusb_exit(context_);
    }

    Outcome<libusb_context*> get() {
        const std::lock_guard lock(mutex_);
        if (!context_) {
            if (const int error = libusb_init(&context_); error != 0) {
                context_ = nullptr;
                return libusb_fault(error, "USB cannot be used");
            }
        }
        return context_;
    }
    void device_opened() {
        const std::lock_guard lock(mutex_);
        if (open_devices_++ > 0) return;
        stop_ = false;
        events_ = std::thread([this] {
            while (!stop_) {
                timeval patience{1, 0};
                libusb_handle_events_timeout_completed(context_, &patience, nullptr);
            }
        });
    }
    void device_closed() {
        const std::lock_guard lock(mutex_);
        if (--open_devices_ > 0) return;
        stop_ = true;
        libusb_interrupt_event_handler(context_);
        events_.join();
    }

  private:
    std::mutex mutex_;
    libusb_context* context_ = nullptr;
    int open_devices_ = 0;
    std::atomic<bool> stop_ = false;
    std::thread events_;
};

class LibusbHandle : public Handle {
  public:
    LibusbHandle(std::shared_ptr<Context> context, libusb_device_handle* handle)
        : context_(std::move(context)), handle_(handle) {
        libusb_set_auto_detach_kernel_driver(handle_, 1);
        context_->device_opened();
    }
    ~LibusbHandle() override {
        for (const int interface : claimed_) libusb_release_interface(handle_, interface);
        libusb_close(handle_);
        context_->device_closed();
    }

    Outcome<void> claim(int interface) override {
        if (const int error = libusb_claim_interface(handle_, interface); error != 0) {
            return libusb_fault(error, "the sensor cannot be taken over");
        }
        claimed_.push_back(interface);
        return {};
    }
    Outcome<void> set_alternate(int interface, int setting) override {
        if (const int error = libusb_set_interface_alt_setting(handle_, interface, setting);
            error != 0) {
            return libusb_fault(error, "the sensor does not take its setting");
        }
        return {};
    }
    Outcome<void> control_out(const Request& request, std::span<const std::uint8_t> bytes,
                              std::chrono::milliseconds timeout) override {
        std::vector<std::uint8_t> copy(bytes.begin(), bytes.end());  // libusb's is not const
        const int sent = transfer(LIBUSB_ENDPOINT_OUT, request, copy, timeout);
        if (sent < 0) return libusb_fault(sent, "a request was not taken");
        if (sent != static_cast<int>(bytes.size())) {
            return fault(Failure::io, fmt::format("a request was cut short: {} of {} bytes", sent,
                                                  bytes.size()));
        }
        return {};
    }
    Outcome<std::size_t> control_in(const Request& request, std::span<std::uint8_t> bytes,
                                    std::chrono::milliseconds timeout) override {
        const int got = transfer(LIBUSB_ENDPOINT_IN, request, bytes, timeout);
        if (got < 0) return libusb_fault(got, "a request was not answered");
        return static_cast<std::size_t>(got);
    }
    Outcome<std::unique_ptr<IsoStream>> stream(const IsoParameters& parameters,
                                               PacketSink& sink) override {
        return start_libusb_stream(handle_, parameters, sink);
    }

  private:
    int transfer(std::uint8_t direction, const Request& request, std::span<std::uint8_t> bytes,
                 std::chrono::milliseconds timeout) {
        return libusb_control_transfer(
            handle_, static_cast<std::uint8_t>(direction | LIBUSB_REQUEST_TYPE_VENDOR),
            request.request, request.value, request.index, bytes.data(),
            static_cast<std::uint16_t>(bytes.size()), static_cast<unsigned>(timeout.count()));
    }

    std::shared_ptr<Context> context_;
    libusb_device_handle* handle_;
    std::vector<int> claimed_;
};

std::string port_of(libusb_device* device, bool parent) {
    constexpr int kDeepest = 7;
    std::array<std::uint8_t, kDeepest> ports{};
    const int depth = libusb_get_port_numbers(device, ports.data(), kDeepest) - (parent ? 1 : 0);
    std::string text = std::to_string(libusb_get_bus_number(device));
    for (int i = 0; i < depth; ++i) {
        text += (i == 0 ? '-' : '.') + std::to_string(ports[static_cast<std::size_t>(i)]);
    }
    return text;
}

std::string serial_of(libusb_device* device, std::uint8_t string_index, const std::string& port) {
    // The kernel has read it when the device was plugged in, and tells anybody.
    std::string serial;
    std::ifstream file("/sys/bus/usb/devices/" + port + "/serial");
    if (std::getline(file, serial)) return serial;
    libusb_device_handle* handle = nullptr;
    if (string_index == 0 || libusb_open(device, &handle) != 0) return {};
    std::array<unsigned char, 256> text{};
    const int length = libusb_get_string_descriptor_ascii(handle, string_index, text.data(),
                                                          static_cast<int>(text.size()));
    libusb_close(handle);
    return length > 0 ? std::string(text.begin(), text.begin() + length) : std::string{};
}

int interfaces_of(libusb_device* device) {
    libusb_config_descriptor* config = nullptr;
    if (libusb_get_active_config_descriptor(device, &config) != 0) return 0;
    const int count = config->bNumInterfaces;
    libusb_free_config_descriptor(config);
    return count;
}

class DeviceList {
  public:
    explicit DeviceList(libusb_context* context)
        : count_(libusb_get_device_list(context, &devices_)) {}
    ~DeviceList() {
        if (count_ >= 0) libusb_free_device_list(devices_, 1);
    }
    DeviceList(const DeviceList&) = delete;
    DeviceList& operator=(const DeviceList&) = delete;
    [[nodiscard]] int error() const { return count_ < 0 ? static_cast<int>(count_) : 0; }
    [[nodiscard]] std::span<libusb_device*> devices() const {
        return {devices_, static_cast<std::size_t>(std::max<ssize_t>(count_, 0))};
    }

  private:
    libusb_device** devices_ = nullptr;
    ssize_t count_;
};

class LibusbBus : public Bus {
  public:
    Outcome<std::vector<DeviceId>> list(std::uint16_t vendor) override {
        const auto context = context_->get();
        if (!context) return tl::unexpected(context.error());
        const DeviceList all(*context);
        if (all.error() != 0) return libusb_fault(all.error(), "USB devices cannot be listed");
        std::vector<DeviceId> out;
        for (libusb_device* device : all.devices()) {
            libusb_device_descriptor descriptor{};
            if (libusb_get_device_descriptor(device, &descriptor) != 0) continue;
            if (descriptor.idVendor != vendor) continue;
            DeviceId id{descriptor.idVendor,
                        descriptor.idProduct,
                        descriptor.bcdDevice,
                        port_of(device, false),
                        port_of(device, true),
                        libusb_get_device_address(device),
                        {},
                        interfaces_of(device)};
            id.serial = serial_of(device, descriptor.iSerialNumber, id.port);
            out.push_back(std::move(id));
        }
        std::ranges::sort(out, {}, &DeviceId::port);
        return out;
    }

    Outcome<std::unique_ptr<Handle>> open(const DeviceId& id) override {
        const auto context = context_->get();
        if (!context) return tl::unexpected(context.error());
        const DeviceList all(*context);
        for (libusb_device* device : all.devices()) {
            if (libusb_get_device_address(device) != id.address ||
                port_of(device, false) != id.port) {
                continue;
            }
            libusb_device_handle* handle = nullptr;
            if (const int error = libusb_open(device, &handle); error != 0) {
                return libusb_fault(error, "the sensor cannot be opened");
            }
            return std::make_unique<LibusbHandle>(context_, handle);
        }
        return fault(Failure::no_device, "the sensor is not plugged in any more");
    }

  private:
    std::shared_ptr<Context> context_ = std::make_shared<Context>();
};

}  // namespace

std::shared_ptr<Bus> libusb_bus() {
    static const auto bus = std::make_shared<LibusbBus>();
    return bus;
}

}  // namespace kino::usb
