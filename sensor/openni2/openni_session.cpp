#include "sensor/openni2/openni_session.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstdlib>
#include <cstring>
#include <tuple>
#include <utility>

#include "sensor/openni2/openni_image.h"

namespace kino {
namespace {

constexpr std::chrono::seconds kOpenLimit{20};
constexpr std::chrono::seconds kStartLimit{5};
constexpr std::chrono::seconds kCloseLimit{3};
constexpr int kReadWaitMs = 20;

/// The rank of a format for a sensor, larger is liked more; 0 is not understood.
int rank(StreamKind kind, int format) {
    const auto place = [&](std::initializer_list<int> liked) {
        int rank = static_cast<int>(liked.size());
        for (const int f : liked) {
            if (f == format) return rank;
            --rank;
        }
        return 0;
    };
    switch (kind) {
        case StreamKind::depth:
            return place(
                {openni::kDepth1Mm, openni::kDepth100Um, openni::kShift92, openni::kShift93});
        case StreamKind::color:
            return place(
                {openni::kRgb888, openni::kYuv422, openni::kYuyv, openni::kJpeg, openni::kGray8});
        default:
            return place({openni::kGray16, openni::kGray8, openni::kRgb888});
    }
}

std::optional<openni::VideoMode> best_mode(StreamKind kind, const openni::SensorInfo& info) {
    std::optional<openni::VideoMode> best;
    const auto order = [&](const openni::VideoMode& mode) {
        return std::tuple(-std::abs(mode.width * mode.height - 640 * 480),
                          rank(kind, mode.pixel_format), -std::abs(mode.fps - 30));
    };
    for (int i = 0; i < info.mode_count; ++i) {
        const openni::VideoMode& mode = info.modes[i];
        if (rank(kind, mode.pixel_format) == 0 || mode.width <= 0 || mode.height <= 0 ||
            mode.width > 8192 || mode.height > 8192) {
            continue;
        }
        if (!best || order(mode) > order(*best)) best = mode;
    }
    return best;
}

}  // namespace

OpenniSession::OpenniSession(OpenniLibrary& library, std::string uri, OpenniOptions options)
    : library_(library), uri_(std::move(uri)), options_(options) {}

std::string OpenniSession::describe(const std::string& what) const {
    return fmt::format("{}: {}", what, library_.last_error());
}

Result<void> OpenniSession::open() {
    auto result = std::make_shared<Result<void>>();
    auto self = shared_from_this();
    if (!run_bounded([self, result] { *result = self->open_now(); }, kOpenLimit)) {
        return fail("OpenNI2 does not come back from opening the device", uri_, "plug it in again");
    }
    if (!*result) {
        (void)run_bounded([self] { self->close_now(); }, kCloseLimit);
        return tl::unexpected<Error>(result->error());
    }
    watch_ = library_.watch(uri_, [this](const std::string& why) { device_gone(why); });
    reader_ended_ = false;
    run_kept([self] { self->read_loop(); });
    return {};
}

Result<void> OpenniSession::open_now() {
    const openni::Api& api = library_.api();
    const std::lock_guard lock(library_.calls());
    if (api.DeviceOpen(uri_.c_str(), &device_) != openni::kOk) {
        device_ = nullptr;
        return fail(describe("the device cannot be opened"), uri_,
                    "is another program using it, and may you (udev rules)?");
    }
    if (api.DeviceGetInfo(device_, &device_info_) != openni::kOk) device_info_ = {};
    for (char* text : {device_info_.uri, device_info_.vendor, device_info_.name}) {
        text[openni::kMaxText - 1] = '\0';
    }
    if (api.DeviceIsPropertySupported(device_, openni::kDeviceSerialNumber)) {
        std::array<char, 1024> text{};
        int size = static_cast<int>(text.size()) - 1;
        if (api.DeviceGetProperty(device_, openni::kDeviceSerialNumber, text.data(), &size) ==
            openni::kOk) {
            serial_ = text.data();
        }
    }
    const int registration =
        options_.registration ? openni::kRegistrationDepthToColor : openni::kRegistrationOff;
    if (options_.registration &&
        !api.DeviceIsImageRegistrationModeSupported(device_, registration)) {
        return fail("the device does not register depth to colour", uri_,
                    "open it without ?registration=on");
    }
    if (options_.registration ||
        api.DeviceIsPropertySupported(device_, openni::kDeviceImageRegistration)) {
        const openni::Status set = api.DeviceSetProperty(device_, openni::kDeviceImageRegistration,
                                                         &registration, sizeof(registration));
        if (set != openni::kOk && options_.registration) {
            return fail(describe("registration cannot be switched on"), uri_);
        }
    }
    KINO_TRY(add_stream(openni::kSensorDepth, StreamKind::depth));
    KINO_TRY(add_stream(openni::kSensorColor, StreamKind::color));
    KINO_TRY(add_stream(openni::kSensorInfrared, StreamKind::infrared));
    if (streams_.empty()) return fail("the device has no picture that can be read", uri_);
    return {};
}

Result<void> OpenniSession::add_stream(int sensor, StreamKind kind) {
    const openni::Api& api = library_.api();
    const openni::SensorInfo* info = api.DeviceGetSensorInfo(device_, sensor);
    if (!info) return {};
    const std::optional<openni::VideoMode> mode = best_mode(kind, *info);
    if (!mode) return {};
    OpenniStream stream;
    stream.kind = kind;
    stream.mode = *mode;
    if (api.DeviceCreateStream(device_, sensor, &stream.handle) != openni::kOk) {
        return fail(describe(fmt::format("no {} stream", stream_name(kind))), uri_);
    }
    streams_.push_back(stream);
    OpenniStream& made = streams_.back();
    if (api.StreamSetProperty(made.handle, openni::kStreamVideoMode, &*mode, sizeof(*mode)) !=
        openni::kOk) {
        int size = sizeof(made.mode);
        if (api.StreamGetProperty(made.handle, openni::kStreamVideoMode, &made.mode, &size) !=
                openni::kOk ||
            rank(kind, made.mode.pixel_format) == 0) {
            return fail(describe(fmt::format("no mode for {}", stream_name(kind))), uri_);
        }
    }
    if (api.StreamIsPropertySupported(made.handle, openni::kStreamCropping)) {
        const openni::Cropping none{};
        (void)api.StreamSetProperty(made.handle, openni::kStreamCropping, &none, sizeof(none));
    }
    if (api.StreamIsPropertySupported(made.handle, openni::kStreamMirroring)) {
        int mirrored = 0;
        int size = sizeof(mirrored);
        (void)api.StreamSetProperty(made.handle, openni::kStreamMirroring, &mirrored, size);
        if (api.StreamGetProperty(made.handle, openni::kStreamMirroring, &mirrored, &size) ==
            openni::kOk) {
            made.mirrored = mirrored != 0;
        }
    }
    const auto angle = [&](int property) {
        float value = 0;
        int size = sizeof(value);
        const bool known =
            api.StreamGetProperty(made.handle, property, &value, &size) == openni::kOk &&
            value > 0.01F && value < 3.1F;
        return known ? static_cast<double>(value) : 0.0;
    };
    made.horizontal_fov = angle(openni::kStreamHorizontalFov);
    made.vertical_fov = angle(openni::kStreamVerticalFov);
    return {};
}

void OpenniSession::close() {
    library_.unwatch(watch_);
    {
        const std::lock_guard lock(mutex_);
        quit_ = true;
        changed_.notify_all();
    }
    auto self = shared_from_this();
    // The reading thread ends within its wait, unless the library keeps it.
    (void)run_bounded(
        [self] {
            std::unique_lock lock(self->mutex_);
            self->changed_.wait(lock, [&] { return self->reader_ended_; });
            lock.unlock();
            self->close_now();
        },
        kCloseLimit);
}

void OpenniSession::close_now() {
    const openni::Api& api = library_.api();
    const std::lock_guard lock(library_.calls());
    if (std::exchange(synced_, false)) api.DeviceDisableDepthColorSync(device_);
    for (const OpenniStream& stream : streams_) {
        if (stream.handle) api.StreamDestroy(stream.handle);
    }
    streams_.clear();
    if (device_) (void)api.DeviceClose(std::exchange(device_, nullptr));
}

const OpenniStream* OpenniSession::find(StreamKind kind) const {
    const auto found = std::find_if(streams_.begin(), streams_.end(),
                                    [&](const OpenniStream& s) { return s.kind == kind; });
    return found == streams_.end() ? nullptr : &*found;
}

bool OpenniSession::gone() const {
    const std::lock_guard lock(hand_over_);
    return gone_;
}

Result<void> OpenniSession::start(StreamKind kind, FrameIntake& intake) {
    auto* stream = const_cast<OpenniStream*>(find(kind));
    if (!stream) return fail(fmt::format("the device has no {}", stream_name(kind)), uri_);
    if (gone()) return fail("the device has gone", uri_);
    std::unique_lock lock(mutex_);
    if (stream->intake) return {};
    halt_reading(lock);
    auto result = std::make_shared<Result<void>>();
    const bool returned = run_bounded(
        [self = shared_from_this(), stream, result] { *result = self->start_now(*stream); },
        kStartLimit);
    go_on_reading();
    if (!returned) {
        quit_ = true;
        return fail("OpenNI2 does not come back from starting the stream", uri_);
    }
    KINO_TRY(*result);
    stream->intake = &intake;
    stream->last_index = -1;
    {
        const std::lock_guard hand(hand_over_);
        any_intake_ = &intake;
    }
    changed_.notify_all();
    return {};
}

/// Streams to be synchronised are started afresh, so that the first frames are some time away: the
/// library exchanges a stream's frame holder without asking whether the driver is filling it.
Result<void> OpenniSession::start_now(OpenniStream& stream) {
    const openni::Api& api = library_.api();
    const std::lock_guard lock(library_.calls());
    const auto pair = [](StreamKind kind) {
        return kind == StreamKind::depth || kind == StreamKind::color;
    };
    OpenniStream* partner = nullptr;
    for (OpenniStream& other : streams_) {
        if (&other != &stream && other.intake && pair(other.kind)) partner = &other;
    }
    const bool both = options_.sync && partner && pair(stream.kind);
    if (both) {
        api.StreamStop(partner->handle);
        partner->last_index = -1;
        if (api.StreamStart(partner->handle) != openni::kOk) {
            return fail(describe("a stream does not start again"), uri_);
        }
    }
    if (api.StreamStart(stream.handle) != openni::kOk) {
        return fail(describe(fmt::format("{} does not start", stream_name(stream.kind))), uri_,
                    "not every device gives all its streams at once");
    }
    if (both) synced_ = api.DeviceEnableDepthColorSync(device_) == openni::kOk;
    return {};
}

void OpenniSession::stop(StreamKind kind) {
    auto* stream = const_cast<OpenniStream*>(find(kind));
    if (!stream) return;
    std::unique_lock lock(mutex_);
    if (!stream->intake) return;
    stream->intake = nullptr;
    halt_reading(lock);
    const bool returned = run_bounded(
        [self = shared_from_this(), stream] {
            const openni::Api& api = self->library_.api();
            const std::lock_guard calls(self->library_.calls());
            api.StreamStop(stream->handle);
            if (stream->kind == StreamKind::infrared || !std::exchange(self->synced_, false))
                return;
            for (OpenniStream& other : self->streams_) {
                if (other.intake && other.kind != StreamKind::infrared) {
                    api.StreamStop(other.handle);
                    api.DeviceDisableDepthColorSync(self->device_);
                    other.last_index = -1;
                    (void)api.StreamStart(other.handle);
                }
            }
        },
        kStartLimit);
    go_on_reading();
    if (!returned) quit_ = true;
    const std::lock_guard hand(hand_over_);
    any_intake_ = nullptr;
    for (const OpenniStream& other : streams_) {
        if (other.intake) any_intake_ = other.intake;
    }
}

/// On return the reading thread is not in the library and stays out until go_on_reading(); without
/// the count it would be back before the waiting thread has the lock. mutex_ is held for both.
void OpenniSession::halt_reading(std::unique_lock<std::mutex>& lock) {
    ++visitors_;
    changed_.wait(lock, [&] { return !reading_; });
}

void OpenniSession::go_on_reading() {
    --visitors_;
    changed_.notify_all();
}

void OpenniSession::read_loop() {
    const openni::Api& api = library_.api();
    std::vector<openni::Stream*> handles;
    std::vector<OpenniStream*> running;
    std::unique_lock lock(mutex_);
    while (!quit_) {
        handles.clear();
        running.clear();
        for (OpenniStream& stream : streams_) {
            if (!stream.intake) continue;
            handles.push_back(stream.handle);
            running.push_back(&stream);
        }
        if (running.empty() || visitors_ > 0) {
            changed_.wait(lock);
            continue;
        }
        reading_ = true;
        lock.unlock();
        int index = -1;
        const openni::Status status = api.WaitForAnyStream(
            handles.data(), static_cast<int>(handles.size()), &index, kReadWaitMs);
        lock.lock();
        reading_ = false;
        changed_.notify_all();
        if (status != openni::kOk || index < 0 || index >= static_cast<int>(running.size())) {
            if (status != openni::kOk && status != openni::kTimedOut) {
                // Never spin on a library that fails at once.
                changed_.wait_for(lock, std::chrono::milliseconds(kReadWaitMs));
            }
            continue;
        }
        if (running[static_cast<std::size_t>(index)]->intake) {
            read(*running[static_cast<std::size_t>(index)]);
        }
    }
    reader_ended_ = true;
    changed_.notify_all();
}

void OpenniSession::read(OpenniStream& stream) {
    const openni::Api& api = library_.api();
    openni::Frame* raw = nullptr;
    if (api.StreamReadFrame(stream.handle, &raw) != openni::kOk || !raw) return;
    const TimeNs arrival = now_ns();
    const openni::Frame& given = *raw;
    const OpenniPixels pixels{
        given.mode.pixel_format,
        given.width,
        given.height,
        given.stride,
        stream.mirrored,
        {static_cast<const std::uint8_t*>(given.data),
         given.data && given.bytes > 0 ? static_cast<std::size_t>(given.bytes) : 0}};

    FrameHeader header;
    const DeviceClock::Moment moment = clock_.at(given.timestamp_us, arrival);
    header.device_time = moment.device_time;
    header.host_time = moment.host_time;
    header.sequence = given.index;
    // A number that goes back is a driver that has started to count anew.
    if (stream.last_index >= 0 && given.index > stream.last_index) {
        header.lost_before = given.index - stream.last_index - 1;
    }
    stream.last_index = given.index;

    std::optional<StreamFrame> frame;
    const auto take = [&](auto result) {
        // Frames of a size or format never announced come and go at a change of mode.
        if (!result) return;
        result->header = header;
        frame = std::make_shared<const typename decltype(result)::value_type>(std::move(*result));
    };
    switch (stream.kind) {
        case StreamKind::depth:
            take(depth_from_openni(pixels));
            break;
        case StreamKind::color:
            take(color_from_openni(pixels));
            break;
        default:
            take(infrared_from_openni(pixels));
            break;
    }
    api.FrameRelease(raw);
    if (!frame) return;
    const std::lock_guard hand(hand_over_);
    if (!gone_) stream.intake->put({0, stream.kind}, std::move(*frame));
}

void OpenniSession::device_gone(const std::string& why) {
    const std::lock_guard hand(hand_over_);
    if (std::exchange(gone_, true)) return;
    if (any_intake_) any_intake_->lost(why);
}

}  // namespace kino
