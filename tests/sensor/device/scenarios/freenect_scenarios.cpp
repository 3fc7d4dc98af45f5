// Debian's libfreenect against the fake: the witness that the fake speaks as a Kinect does, and the
// measure for what a library does with lost packets.

#include <fmt/format.h>
#include <libfreenect.h>
#include <sys/time.h>

#include <chrono>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "tests/sensor/device/fake_kinect/fake_kinect.h"
#include "tests/sensor/device/scenarios/report.h"
#include "tests/sensor/device/scenarios/truth.h"

namespace kino::guest {
namespace {

struct Caught {
    std::uint32_t ticks = 0;
    std::vector<std::uint8_t> bytes;
};

struct Catch {
    std::size_t depth_bytes = 0;
    std::size_t video_bytes = 0;
    std::vector<Caught> depth;
    std::vector<Caught> video;
};

void keep(std::vector<Caught>& frames, const void* data, std::size_t size, std::uint32_t ticks) {
    const auto* bytes = static_cast<const std::uint8_t*>(data);
    frames.push_back({.ticks = ticks, .bytes = {bytes, bytes + size}});
}

void on_depth(freenect_device* device, void* data, std::uint32_t ticks) {
    auto& caught = *static_cast<Catch*>(freenect_get_user(device));
    keep(caught.depth, data, caught.depth_bytes, ticks);
}

void on_video(freenect_device* device, void* data, std::uint32_t ticks) {
    auto& caught = *static_cast<Catch*>(freenect_get_user(device));
    keep(caught.video, data, caught.video_bytes, ticks);
}

/// Context and first device, closed at the end of the scope.
class Library {
  public:
    Library() {
        if (freenect_init(&context_, nullptr) < 0) return;
        freenect_set_log_level(context_, FREENECT_LOG_ERROR);
        freenect_select_subdevices(context_, static_cast<freenect_device_flags>(
                                                 FREENECT_DEVICE_MOTOR | FREENECT_DEVICE_CAMERA));
        if (freenect_open_device(context_, &device_, 0) < 0) device_ = nullptr;
        if (device_ == nullptr) return;
        freenect_set_user(device_, &caught);
        freenect_set_depth_callback(device_, on_depth);
        freenect_set_video_callback(device_, on_video);
    }
    ~Library() {
        if (device_ != nullptr) freenect_close_device(device_);
        if (context_ != nullptr) freenect_shutdown(context_);
    }
    Library(const Library&) = delete;
    Library& operator=(const Library&) = delete;

    [[nodiscard]] freenect_device* device() { return device_; }
    [[nodiscard]] freenect_context* context() { return context_; }

    bool start_depth(freenect_depth_format format) {
        const auto mode = freenect_find_depth_mode(FREENECT_RESOLUTION_MEDIUM, format);
        caught.depth_bytes = static_cast<std::size_t>(mode.bytes);
        return freenect_set_depth_mode(device_, mode) >= 0 && freenect_start_depth(device_) >= 0;
    }
    bool start_video(freenect_video_format format) {
        const auto mode = freenect_find_video_mode(FREENECT_RESOLUTION_MEDIUM, format);
        caught.video_bytes = static_cast<std::size_t>(mode.bytes);
        return freenect_set_video_mode(device_, mode) >= 0 && freenect_start_video(device_) >= 0;
    }
    void stop() {
        freenect_stop_depth(device_);
        freenect_stop_video(device_);
    }
    /// Until so many frames have come, none comes any more, or the library gives up (false). Not
    /// by the clock alone: the whole guest may have been held up.
    bool pump(std::size_t depth_frames, std::size_t video_frames) {
        int idle_rounds = 0;
        auto last_frame = std::chrono::steady_clock::now();
        while ((caught.depth.size() < depth_frames || caught.video.size() < video_frames) &&
               (idle_rounds < 200 ||
                std::chrono::steady_clock::now() < last_frame + std::chrono::seconds(10))) {
            const std::size_t before = caught.depth.size() + caught.video.size();
            timeval wait{.tv_sec = 0, .tv_usec = 200'000};
            if (freenect_process_events_timeout(context_, &wait) < 0) return false;
            ++idle_rounds;
            if (caught.depth.size() + caught.video.size() == before) continue;
            idle_rounds = 0;
            last_frame = std::chrono::steady_clock::now();
        }
        return true;
    }

    Catch caught;

  private:
    freenect_context* context_ = nullptr;
    freenect_device* device_ = nullptr;
};

std::unique_ptr<fake::Kinect> plug(const Report& report, fake::KinectOptions options) {
    auto kinect = fake::Kinect::plug(fake::noise_feed(7), std::move(options));
    if (kinect) return std::move(*kinect);
    report.failure(kinect.error().to_string());
    return nullptr;
}

template <class Pixel>
std::span<const Pixel> pixels_of(const Caught& frame) {
    return {reinterpret_cast<const Pixel*>(frame.bytes.data()), frame.bytes.size() / sizeof(Pixel)};
}

/// Counts of frames, of those equal to what was sent, and of pixels that are not what was sent.
template <class Pixel, class Truth>
void compare(const Report& report, const std::string& stream, const std::vector<Caught>& frames,
             const std::vector<fake::SentFrame>& sent, Truth truth) {
    std::int64_t equal = 0;
    std::int64_t wrong_pixels = 0;
    std::int64_t unknown = 0;
    for (const Caught& frame : frames) {
        const auto origin = find_sent(sent, frame.ticks);
        if (!origin) {
            ++unknown;
            continue;
        }
        const std::vector<Pixel> expected = truth(origin->number);
        const auto wrong =
            count_different(pixels_of<Pixel>(frame), std::span<const Pixel>(expected));
        wrong_pixels += wrong;
        equal += wrong == 0 ? 1 : 0;
    }
    report.value(stream + "_frames", static_cast<double>(frames.size()));
    report.value(stream + "_equal", static_cast<double>(equal));
    report.value(stream + "_unknown", static_cast<double>(unknown));
    report.value(stream + "_stale_pixels", static_cast<double>(wrong_pixels));
}

void compare_depth(const Report& report, Library& library, fake::Kinect& kinect, int shift) {
    compare<std::uint16_t>(report, "depth", library.caught.depth, kinect.camera().sent(0x82),
                           [&](int n) {
                               auto depth = kinect.feed().depth(n);
                               for (auto& value : depth) {
                                   value = static_cast<std::uint16_t>(value >> shift);
                               }
                               return depth;
                           });
}

void depth_and_bayer(const Report& report) {
    auto kinect = plug(report, {});
    if (!kinect) return;
    Library library;
    if (library.device() == nullptr) return report.failure("cannot open the device");
    if (!library.start_depth(FREENECT_DEPTH_11BIT) || !library.start_video(FREENECT_VIDEO_BAYER)) {
        return report.failure("cannot start");
    }
    if (!library.pump(10, 10)) report.failure("process_events fails");
    library.stop();
    compare_depth(report, library, *kinect, 0);
    compare<std::uint8_t>(report, "color", library.caught.video, kinect->camera().sent(0x81),
                          [&](int n) { return kinect->feed().bayer(n, 640, 480); });
    report.value("bad_commands", kinect->camera().bad_commands());
}

void freenect_depth10_and_infrared(const Report& report) {
    auto kinect = plug(report, {});
    if (!kinect) return;
    Library library;
    if (library.device() == nullptr) return report.failure("cannot open the device");
    if (!library.start_depth(FREENECT_DEPTH_10BIT) ||
        !library.start_video(FREENECT_VIDEO_IR_10BIT)) {
        return report.failure("cannot start");
    }
    if (!library.pump(4, 4)) report.failure("process_events fails");
    library.stop();
    compare_depth(report, library, *kinect, 1);
    compare<std::uint16_t>(report, "infrared", library.caught.video, kinect->camera().sent(0x81),
                           [&](int n) { return kinect->feed().infrared(n, 640, 488); });
}

void motor(const Report& report) {
    auto kinect = plug(report, {});
    if (!kinect) return;
    Library library;
    if (library.device() == nullptr) return report.failure("cannot open the device");
    if (freenect_set_tilt_degs(library.device(), 12) < 0) report.failure("cannot tilt");
    if (freenect_set_led(library.device(), LED_BLINK_RED_YELLOW) < 0) report.failure("no lamp");
    if (freenect_update_tilt_state(library.device()) < 0) report.failure("no state");
    freenect_raw_tilt_state* state = freenect_get_tilt_state(library.device());
    double x = 0;
    double y = 0;
    double z = 0;
    freenect_get_mks_accel(state, &x, &y, &z);
    report.value("tilt_deg", freenect_get_tilt_degs(state));
    report.value("tilt_set_deg", kinect->motor().tilt_deg());
    report.value("lamp", kinect->motor().lamp());
    report.value("acceleration_y", y);
}

void depth_under_loss(const Report& report, double share) {
    fake::KinectOptions options;
    options.camera.faults = {.seed = 11, .lost = share};
    auto kinect = plug(report, options);
    if (!kinect) return;
    Library library;
    if (library.device() == nullptr) return report.failure("cannot open the device");
    if (!library.start_depth(FREENECT_DEPTH_11BIT)) return report.failure("cannot start");
    if (!library.pump(20, 0)) report.failure("process_events fails");
    library.stop();
    compare_depth(report, library, *kinect, 0);
}

void unplug(const Report& report) {
    fake::KinectOptions options;
    options.cut_after = 1'000'003;
    auto kinect = plug(report, options);
    if (!kinect) return;
    Library library;
    if (library.device() == nullptr) return report.failure("cannot open the device");
    if (!library.start_depth(FREENECT_DEPTH_11BIT)) return report.failure("cannot start");
    report.value("noticed", library.pump(1000, 0) ? 0 : 1);
    report.value("frames", static_cast<double>(library.caught.depth.size()));
    library.stop();
}

}  // namespace

std::vector<Scenario> freenect_scenarios() {
    return {{"freenect_streams", depth_and_bayer},
            {"freenect_10bit_infrared", freenect_depth10_and_infrared},
            {"freenect_motor", motor},
            {"freenect_loss_0.2", [](const Report& r) { depth_under_loss(r, 0.002); }},
            {"freenect_loss_1", [](const Report& r) { depth_under_loss(r, 0.01); }},
            {"freenect_loss_5", [](const Report& r) { depth_under_loss(r, 0.05); }},
            {"freenect_loss_10", [](const Report& r) { depth_under_loss(r, 0.10); }},
            {"freenect_unplug", unplug}};
}

}  // namespace kino::guest
