#include "test_driver.h"

#include <algorithm>
#include <atomic>
#include <chrono>
#include <condition_variable>
#include <cstring>
#include <map>
#include <memory>
#include <mutex>
#include <string>
#include <thread>
#include <vector>

#define XN_NEW(type, ...) new type(__VA_ARGS__)
#define XN_DELETE(p) delete (p)
#include <Driver/OniDriverAPI.h>

#include "test_frames.h"

namespace {

namespace camera = kino::test::camera;

struct Modes {
    OniVideoMode depth{};
    OniVideoMode color{};
    OniVideoMode infrared{};
};

/// What the outside may ask about a device, whether it is open or not.
struct Unit {
    OniDeviceInfo info{};
    std::string kind;
    std::string serial;
    std::mutex mutex;
    bool plugged = true;
    std::map<std::pair<int, int>, int> values;

    void set(int sensor, int property, int value) {
        const std::lock_guard lock(mutex);
        values[{sensor, property}] = value;
    }
};

std::atomic<int> open_count{0};
std::atomic<int> sync_count{0};

class TestDevice;

class TestStream final : public oni::driver::StreamBase {
  public:
    TestStream(TestDevice& device, int sensor, OniVideoMode mode)
        : device_(device), sensor_(sensor), mode_(mode) {}

    OniStatus start() override;
    void stop() override;
    OniStatus setProperty(int id, const void* data, int size) override;
    OniStatus getProperty(int id, void* data, int* size) override;
    OniBool isPropertySupported(int id) override;

    void make(int index);
    [[nodiscard]] bool running() const { return running_; }

  private:
    void fill(std::uint8_t* to, int index, int x_bytes) const;

    TestDevice& device_;
    int sensor_;
    OniVideoMode mode_;
    std::atomic<bool> running_{false};
    int mirrored_ = 1;  // as real ones are when they start
    int values_[4] = {1, 1, 100, 50};
};

class TestDevice final : public oni::driver::DeviceBase {
  public:
    explicit TestDevice(std::shared_ptr<Unit> unit) : unit_(std::move(unit)) {
        ++open_count;
        const auto mode = [](int format) {
            return OniVideoMode{static_cast<OniPixelFormat>(format), camera::kWidth,
                                camera::kHeight, 200};
        };
        const std::string& kind = unit_->kind;
        modes_[0] = mode(kind == "um"       ? ONI_PIXEL_FORMAT_DEPTH_100_UM
                         : kind == "shift2" ? ONI_PIXEL_FORMAT_SHIFT_9_2
                         : kind == "shift3" ? ONI_PIXEL_FORMAT_SHIFT_9_3
                                            : ONI_PIXEL_FORMAT_DEPTH_1_MM);
        modes_[1] = mode(kind == "yuv"    ? ONI_PIXEL_FORMAT_YUV422
                         : kind == "yuyv" ? ONI_PIXEL_FORMAT_YUYV
                         : kind == "gray" ? ONI_PIXEL_FORMAT_GRAY8
                         : kind == "jpeg" ? ONI_PIXEL_FORMAT_JPEG
                                          : ONI_PIXEL_FORMAT_RGB888);
        const bool small_infrared = kind == "yuv" || kind == "yuyv" || kind == "gray";
        modes_[2] = mode(small_infrared ? ONI_PIXEL_FORMAT_GRAY8 : ONI_PIXEL_FORMAT_GRAY16);
        const OniSensorType sensors[3] = {ONI_SENSOR_DEPTH, ONI_SENSOR_COLOR, ONI_SENSOR_IR};
        for (int i = 0; i < 3; ++i) infos_[i] = {sensors[i], 1, &modes_[i]};
        thread_ = std::thread([this] { run(); });
    }
    ~TestDevice() override {
        {
            const std::lock_guard lock(mutex_);
            quit_ = true;
        }
        thread_.join();
        --open_count;
    }

    OniStatus getSensorInfoList(OniSensorInfo** infos, int* count) override {
        *infos = infos_;
        *count = 3;
        return ONI_STATUS_OK;
    }
    oni::driver::StreamBase* createStream(OniSensorType sensor) override {
        for (int i = 0; i < 3; ++i) {
            if (infos_[i].sensorType != sensor) continue;
            const std::lock_guard lock(mutex_);
            streams_.push_back(new TestStream(*this, sensor, modes_[i]));
            return streams_.back();
        }
        return nullptr;
    }
    void destroyStream(oni::driver::StreamBase* stream) override {
        const std::lock_guard lock(mutex_);
        streams_.erase(std::find(streams_.begin(), streams_.end(), stream));
        delete stream;
    }
    OniStatus setProperty(int id, const void* data, int size) override {
        if (id != ONI_DEVICE_PROPERTY_IMAGE_REGISTRATION || size != sizeof(int) || plain()) {
            return ONI_STATUS_NOT_SUPPORTED;
        }
        int value = 0;
        std::memcpy(&value, data, sizeof(value));
        unit_->set(0, id, value);
        return ONI_STATUS_OK;
    }
    OniStatus getProperty(int id, void* data, int* size) override {
        if (id != ONI_DEVICE_PROPERTY_SERIAL_NUMBER || plain()) return ONI_STATUS_NOT_SUPPORTED;
        const std::string& serial = unit_->serial;
        if (*size < static_cast<int>(serial.size()) + 1) return ONI_STATUS_BAD_PARAMETER;
        std::memcpy(data, serial.c_str(), serial.size() + 1);
        *size = static_cast<int>(serial.size()) + 1;
        return ONI_STATUS_OK;
    }
    OniBool isPropertySupported(int id) override {
        return !plain() && (id == ONI_DEVICE_PROPERTY_IMAGE_REGISTRATION ||
                            id == ONI_DEVICE_PROPERTY_SERIAL_NUMBER);
    }
    OniBool isImageRegistrationModeSupported(OniImageRegistrationMode mode) override {
        return mode == ONI_IMAGE_REGISTRATION_OFF || !plain();
    }

    [[nodiscard]] Unit& unit() { return *unit_; }
    [[nodiscard]] bool plain() const { return unit_->kind == "plain"; }
    /// Held while frames are made: with it, no frame is under way.
    [[nodiscard]] std::mutex& making() { return making_; }

  private:
    void run() {
        for (int index = 1;; ++index) {
            std::this_thread::sleep_for(std::chrono::microseconds(camera::kPeriodUs));
            std::vector<TestStream*> running;
            // making_ first: a stream that was stopped or destroyed makes nothing more.
            const std::lock_guard making(making_);
            {
                const std::lock_guard lock(mutex_);
                if (quit_) return;
                for (TestStream* stream : streams_) {
                    if (stream->running()) running.push_back(stream);
                }
            }
            {
                const std::lock_guard lock(unit_->mutex);
                if (!unit_->plugged) continue;
            }
            if (unit_->kind == "gaps" && index % 7 == 3) continue;
            for (TestStream* stream : running) stream->make(index);
        }
    }

    std::shared_ptr<Unit> unit_;
    OniVideoMode modes_[3]{};
    OniSensorInfo infos_[3]{};
    std::mutex mutex_;
    std::mutex making_;
    std::vector<TestStream*> streams_;
    bool quit_ = false;
    std::thread thread_;
};

OniStatus TestStream::start() {
    running_ = true;
    return ONI_STATUS_OK;
}

void TestStream::stop() {
    running_ = false;
    const std::lock_guard wait(device_.making());
}

int control_index(int id) {
    switch (id) {
        case ONI_STREAM_PROPERTY_AUTO_WHITE_BALANCE:
            return 0;
        case ONI_STREAM_PROPERTY_AUTO_EXPOSURE:
            return 1;
        case ONI_STREAM_PROPERTY_EXPOSURE:
            return 2;
        case ONI_STREAM_PROPERTY_GAIN:
            return 3;
        default:
            return -1;
    }
}

OniBool TestStream::isPropertySupported(int id) {
    if (control_index(id) >= 0) return sensor_ == ONI_SENSOR_COLOR && !device_.plain();
    return id == ONI_STREAM_PROPERTY_VIDEO_MODE || id == ONI_STREAM_PROPERTY_MIRRORING ||
           id == ONI_STREAM_PROPERTY_HORIZONTAL_FOV || id == ONI_STREAM_PROPERTY_VERTICAL_FOV;
}

OniStatus TestStream::setProperty(int id, const void* data, int size) {
    if (id == ONI_STREAM_PROPERTY_VIDEO_MODE && size == sizeof(OniVideoMode)) {
        return std::memcmp(data, &mode_, sizeof(mode_)) == 0 ? ONI_STATUS_OK
                                                             : ONI_STATUS_NOT_SUPPORTED;
    }
    if (size != sizeof(int)) return ONI_STATUS_BAD_PARAMETER;
    int value = 0;
    std::memcpy(&value, data, sizeof(value));
    if (id == ONI_STREAM_PROPERTY_MIRRORING) {
        if (device_.unit().kind == "mirror" && sensor_ != ONI_SENSOR_IR) return ONI_STATUS_ERROR;
        mirrored_ = value;
    } else if (const int control = control_index(id); control >= 0 && isPropertySupported(id)) {
        // A limit that the interface cannot state.
        if (value > 1000) return ONI_STATUS_BAD_PARAMETER;
        values_[control] = value;
    } else {
        return ONI_STATUS_NOT_SUPPORTED;
    }
    device_.unit().set(sensor_, id, value);
    return ONI_STATUS_OK;
}

template <class T>
OniStatus give(const T& value, void* data, int* size) {
    if (*size < static_cast<int>(sizeof(T))) return ONI_STATUS_BAD_PARAMETER;
    std::memcpy(data, &value, sizeof(T));
    *size = sizeof(T);
    return ONI_STATUS_OK;
}

OniStatus TestStream::getProperty(int id, void* data, int* size) {
    switch (id) {
        case ONI_STREAM_PROPERTY_VIDEO_MODE:
            return give(mode_, data, size);
        case ONI_STREAM_PROPERTY_MIRRORING:
            return give(mirrored_, data, size);
        case ONI_STREAM_PROPERTY_HORIZONTAL_FOV:
            return give(1.02F, data, size);
        case ONI_STREAM_PROPERTY_VERTICAL_FOV:
            return give(0.73F, data, size);
        case ONI_STREAM_PROPERTY_MAX_VALUE:
            return give(10000, data, size);
        default:
            break;
    }
    const int control = control_index(id);
    if (control >= 0 && isPropertySupported(id)) return give(values_[control], data, size);
    return ONI_STATUS_NOT_SUPPORTED;
}

void TestStream::make(int index) {
    OniFrame* frame = getServices().acquireFrame();
    if (!frame) return;
    const int bytes =
        mode_.pixelFormat == ONI_PIXEL_FORMAT_RGB888 ? 3
        : mode_.pixelFormat == ONI_PIXEL_FORMAT_GRAY8 || mode_.pixelFormat == ONI_PIXEL_FORMAT_JPEG
            ? 1
            : 2;
    frame->sensorType = static_cast<OniSensorType>(sensor_);
    frame->frameIndex = index;
    frame->timestamp = camera::time_us(index);
    frame->videoMode = mode_;
    frame->width = camera::kWidth;
    frame->height = camera::kHeight;
    frame->croppingEnabled = FALSE;
    frame->cropOriginX = frame->cropOriginY = 0;
    frame->stride = bytes * camera::kWidth;
    frame->dataSize = frame->stride * camera::kHeight;
    fill(static_cast<std::uint8_t*>(frame->data), index, bytes);
    raiseNewFrame(frame);
    getServices().releaseFrame(frame);
}

void TestStream::fill(std::uint8_t* to, int index, int bytes) const {
    for (int y = 0; y < camera::kHeight; ++y) {
        for (int column = 0; column < camera::kWidth; ++column, to += bytes) {
            const int x = mirrored_ ? camera::kWidth - 1 - column : column;
            if (sensor_ == ONI_SENSOR_COLOR) {
                for (int b = 0; b < bytes; ++b) to[b] = camera::color_at(bytes * x + b, y, index);
            } else {
                const std::uint16_t value = sensor_ == ONI_SENSOR_DEPTH
                                                ? camera::depth_at(x, y, index)
                                                : camera::infrared_at(x, y, index);
                if (bytes == 2) {
                    std::memcpy(to, &value, 2);
                } else {
                    *to = static_cast<std::uint8_t>(value >> 2);
                }
            }
        }
    }
}

class TestDriver final : public oni::driver::DriverBase {
  public:
    explicit TestDriver(OniDriverServices* services) : DriverBase(services) { instance = this; }
    ~TestDriver() override { instance = nullptr; }

    oni::driver::DeviceBase* deviceOpen(const char* uri, const char*) override {
        const std::shared_ptr<Unit> unit = find(uri);
        return unit ? new TestDevice(unit) : nullptr;
    }
    void deviceClose(oni::driver::DeviceBase* device) override { delete device; }
    void shutdown() override {}
    void* enableFrameSync(oni::driver::StreamBase**, int count) override {
        if (count > 1) ++sync_count;
        return this;
    }

    void plug(const char* uri) {
        auto unit = std::make_shared<Unit>();
        std::strncpy(unit->info.uri, uri, ONI_MAX_STR - 1);
        std::strncpy(unit->info.vendor, "Kino", ONI_MAX_STR - 1);
        std::strncpy(unit->info.name, "test camera", ONI_MAX_STR - 1);
        const std::string text = uri;
        const std::size_t kind = text.find('/') + 1;
        const std::size_t serial = text.find('/', kind) + 1;
        unit->kind = text.substr(kind, serial - 1 - kind);
        unit->serial = text.substr(serial, text.find('/', serial) - serial);
        {
            const std::lock_guard lock(mutex_);
            units_[uri] = unit;
        }
        deviceConnected(&unit->info);
    }
    void unplug(const char* uri) {
        const std::shared_ptr<Unit> unit = find(uri);
        if (!unit) return;
        {
            const std::lock_guard lock(unit->mutex);
            unit->plugged = false;
        }
        {
            const std::lock_guard lock(mutex_);
            units_.erase(uri);
            gone_[uri] = unit;
        }
        deviceDisconnected(&unit->info);
    }
    std::shared_ptr<Unit> find(const char* uri) {
        const std::lock_guard lock(mutex_);
        const auto found = units_.find(uri);
        return found == units_.end() ? nullptr : found->second;
    }

    static TestDriver* instance;

  private:
    std::mutex mutex_;
    std::map<std::string, std::shared_ptr<Unit>> units_;
    std::map<std::string, std::shared_ptr<Unit>> gone_;
};
TestDriver* TestDriver::instance = nullptr;

}  // namespace

ONI_EXPORT_DRIVER(TestDriver)

extern "C" __attribute__((visibility("default"))) KinoTestDriver kino_test_driver() {
    KinoTestDriver driver;
    driver.plug = [](const char* uri) { TestDriver::instance->plug(uri); };
    driver.unplug = [](const char* uri) { TestDriver::instance->unplug(uri); };
    driver.value = [](const char* uri, int sensor, int property) {
        const std::shared_ptr<Unit> unit = TestDriver::instance->find(uri);
        if (!unit) return -1;
        const std::lock_guard lock(unit->mutex);
        const auto found = unit->values.find({sensor, property});
        return found == unit->values.end() ? -1 : found->second;
    };
    driver.open_devices = [] { return open_count.load(); };
    driver.syncs = [] { return sync_count.load(); };
    return driver;
}
