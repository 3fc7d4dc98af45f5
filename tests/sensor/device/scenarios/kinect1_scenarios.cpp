// Our own libusb source against the fake.

#include <cmath>
#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "sensor/kinect1/kinect1_driver.h"
#include "tests/sensor/device/fake_kinect/fake_kinect.h"
#include "tests/sensor/device/scenarios/gathered.h"
#include "tests/sensor/device/scenarios/modules.h"
#include "tests/sensor/device/scenarios/report.h"

namespace kino::guest {
namespace {

constexpr std::uint64_t kSeed = 7;  // as for libfreenect

/// The fake and our source of it.
struct Pair {
    std::unique_ptr<fake::Kinect> kinect;
    std::unique_ptr<Source> source;
};

std::unique_ptr<Pair> open_pair(const Report& report, const std::string& choices,
                                fake::KinectOptions options) {
    auto pair = std::make_unique<Pair>();
    const std::string serial = options.camera.serial;
    auto kinect = fake::Kinect::plug(fake::noise_feed(kSeed), std::move(options));
    if (!kinect) {
        report.failure(kinect.error().to_string());
        return nullptr;
    }
    pair->kinect = std::move(*kinect);
    auto source = kinect1_opener().open("kinect1:" + serial + choices);
    if (!source) {
        report.failure(source.error().to_string());
        return nullptr;
    }
    pair->source = std::move(*source);
    return pair;
}

void turn_knobs(const Report& report, Source& source, const fake::Motor& motor) {
    Controls* knobs = source.controls();
    if (knobs == nullptr) return report.failure("no controls");
    for (const auto& [id, value] : {std::pair{"tilt", -9.0}, std::pair{"led", 2.0}}) {
        const auto done = knobs->set(id, value);
        if (!done) report.failure(done.error().to_string());
    }
    report.value("refuses_too_much", knobs->set("tilt", 60) ? 0 : 1);
    report.value("tilt_set_deg", motor.tilt_deg());
    report.value("lamp", motor.lamp());
}

void depth_and_color(const Report& report) {
    auto pair = open_pair(report, "", {});
    if (!pair) return;
    Source& source = *pair->source;
    fake::Kinect& kinect = *pair->kinect;
    Gathered gathered(source);
    for (const StreamKind kind : {StreamKind::depth, StreamKind::color, StreamKind::motion}) {
        if (!subscribe(report, source, kind)) return;
    }
    gathered.wait_for(StreamKind::depth, 12);
    gathered.wait_for(StreamKind::color, 10);
    gathered.wait_for(StreamKind::motion, 3);
    turn_knobs(report, source, kinect.motor());
    gathered.stop();
    compare(report, "depth", gathered.depth(),
            depth_stream(kinect.feed(), kinect.camera().sent(0x82), 11));
    compare(report, "color", gathered.color(),
            byte_stream(kinect.camera().sent(0x81), 640,
                        [&](int n) { return kinect.feed().bayer(n, 640, 480); }));
    report.value("motion_frames", static_cast<double>(gathered.count(StreamKind::motion)));
    if (!gathered.motion().empty()) {
        const auto& a = gathered.motion().back()->acceleration_m_s2;
        report.value("acceleration", std::hypot(a[0], a[1], a[2]));
    }
    report.value("serial_known", source.info().serial == kinect.camera().identity().serial);
    report.value("bad_commands", kinect.camera().bad_commands());
    const auto rig = source.calibration();
    if (!rig) return report.failure(rig.error().to_string());
    const fake::FactoryTables tables = fake::plausible_tables();
    report.value("factory_constants",
                 rig->disparity == DisparityParameters{.const_shift = 1.0 * tables.const_shift,
                                                       .reference_pixel_size_mm = tables.pixel_mm,
                                                       .reference_distance_cm = tables.reference_cm,
                                                       .emitter_distance_cm = tables.emitter_cm});
}

void depth10_and_infrared(const Report& report) {
    auto pair = open_pair(report, "?depth=10", {});
    if (!pair) return;
    fake::Kinect& kinect = *pair->kinect;
    Gathered gathered(*pair->source);
    for (const StreamKind kind : {StreamKind::depth, StreamKind::infrared}) {
        if (!subscribe(report, *pair->source, kind)) return;
    }
    gathered.wait_for(StreamKind::depth, 5);
    gathered.wait_for(StreamKind::infrared, 5);
    gathered.stop();
    compare(report, "depth", gathered.depth(),
            depth_stream(kinect.feed(), kinect.camera().sent(0x82), 10));
    compare(report, "infrared", gathered.infrared(),
            infrared_stream(kinect.feed(), kinect.camera().sent(0x81)));
}

void other_color(const Report& report, const std::string& choice, int row_bytes,
                 const std::function<std::vector<std::uint8_t>(const fake::Feed&, int)>& truth) {
    auto pair = open_pair(report, choice, {});
    if (!pair) return;
    fake::Kinect& kinect = *pair->kinect;
    Gathered gathered(*pair->source);
    if (!subscribe(report, *pair->source, StreamKind::color)) return;
    gathered.wait_for(StreamKind::color, 2);
    gathered.stop();
    compare(report, "color", gathered.color(),
            byte_stream(kinect.camera().sent(0x81), row_bytes,
                        [&](int n) { return truth(kinect.feed(), n); }));
}

void depth_under(const Report& report, const fake::Faults& faults, std::size_t frames) {
    fake::KinectOptions options;
    options.camera.faults = faults;
    auto pair = open_pair(report, "", options);
    if (!pair) return;
    fake::Kinect& kinect = *pair->kinect;
    Gathered gathered(*pair->source);
    if (!subscribe(report, *pair->source, StreamKind::depth)) return;
    gathered.wait_for(StreamKind::depth, frames);
    gathered.stop();
    compare(report, "depth", gathered.depth(),
            depth_stream(kinect.feed(), kinect.camera().sent(0x82), 11));
}

// The kernel's driver has the camera when we ask for it: as on every machine with a desktop.
void kernel_driver_in_the_way(const Report& report) {
    if (const auto in = insert_module("gspca_kinect", ""); !in) {
        return report.failure(in.error().to_string());
    }
    depth_under(report, {}, 4);
}

}  // namespace

std::vector<Scenario> kinect1_scenarios() {
    const auto loss = [](double share) {
        return [share](const Report& r) { depth_under(r, {.seed = 11, .lost = share}, 20); };
    };
    return {{"kinect1_streams", depth_and_color},
            {"kinect1_10bit_infrared", depth10_and_infrared},
            {"kinect1_large_color",
             [](const Report& r) {
                 other_color(r, "?color=bayer-high", 1280, [](const fake::Feed& feed, int n) {
                     return feed.bayer(n, 1280, 1024);
                 });
             }},
            {"kinect1_yuv",
             [](const Report& r) {
                 other_color(r, "?color=yuv", 1280,
                             [](const fake::Feed& feed, int n) { return feed.uyvy(n); });
             }},
            {"kinect1_loss_0.2", loss(0.002)},
            {"kinect1_loss_1", loss(0.01)},
            {"kinect1_loss_5", loss(0.05)},
            {"kinect1_loss_10", loss(0.10)},
            {"kinect1_every_fault",
             [](const Report& r) {
                 depth_under(r,
                             {.seed = 3,
                              .lost = 0.005,
                              .wrong_magic = 0.005,
                              .shortened = 0.005,
                              .swapped = 0.005,
                              .failed = 0.005,
                              .stall_at = 4,
                              .stall_ms = 1500},
                             12);
             }},
            {"kinect1_over_kernel_driver", kernel_driver_in_the_way}};
}

}  // namespace kino::guest
