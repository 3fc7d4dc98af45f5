#include "sensor/openni2/openni_device.h"

#include <fmt/format.h>

#include <cmath>
#include <string_view>
#include <utility>

#include "sensor/live/live_source.h"
#include "sensor/openni2/openni2.h"
#include "sensor/openni2/openni_controls.h"
#include "sensor/openni2/openni_image.h"

namespace kino {
namespace {

constexpr std::string_view kSerialPrefix = "serial=";

CameraModel camera_from_view(const OpenniStream& stream, const CameraModel& fallback) {
    CameraModel camera;
    camera.width = stream.mode.width;
    camera.height = stream.mode.height;
    camera.cx = (camera.width - 1) / 2.0;
    camera.cy = (camera.height - 1) / 2.0;
    camera.fx = stream.horizontal_fov > 0 ? camera.width / (2 * std::tan(stream.horizontal_fov / 2))
                                          : fallback.fx * camera.width / fallback.width;
    // A stated vertical angle that gives oblong pixels belongs to another mode of the sensor.
    const double fy = stream.vertical_fov > 0
                          ? camera.height / (2 * std::tan(stream.vertical_fov / 2))
                          : camera.fx;
    camera.fy = std::abs(fy / camera.fx - 1) < 0.1 ? fy : camera.fx;
    return camera;
}

class OpenniDevice final : public LiveDevice {
  public:
    OpenniDevice(std::shared_ptr<OpenniSession> session, OpenniAddress address)
        : session_(std::move(session)), rig_(openni_rig(*session_)), controls_(session_) {
        const openni::DeviceInfo& device = session_->device();
        info_.name = fmt::format("{} {}", device.vendor, device.name);
        info_.serial = session_->serial();
        info_.note = rig_.note;
        address_ = std::move(address);
        address_.device = info_.serial.empty() ? std::string(device.uri)
                                               : std::string(kSerialPrefix) + info_.serial;
        info_.uri = "openni2:" + to_string(address_);
        for (const OpenniStream& stream : session_->streams()) {
            info_.streams.push_back({{0, stream.kind},
                                     stream.mode.width,
                                     stream.mode.height,
                                     static_cast<double>(stream.mode.fps),
                                     openni_format_name(stream.mode.pixel_format)});
        }
    }
    ~OpenniDevice() override { session_->close(); }

    const SourceInfo& info() const override { return info_; }
    Result<RigParameters> calibration() const override { return rig_; }
    Result<void> start(StreamId id, FrameIntake& intake) override {
        if (id.device != 0) return fail("there is only device 0", info_.uri);
        return session_->start(id.kind, intake);
    }
    void stop(StreamId id) override {
        if (id.device == 0) session_->stop(id.kind);
    }
    Controls* controls() override { return controls_.list().empty() ? nullptr : &controls_; }
    std::string address() const override { return to_string(address_); }

  private:
    std::shared_ptr<OpenniSession> session_;
    RigParameters rig_;
    SourceInfo info_;
    OpenniAddress address_;
    OpenniControls controls_;
};

Result<std::shared_ptr<OpenniSession>> open_session(OpenniLibrary& library, const std::string& uri,
                                                    const OpenniOptions& options) {
    auto session = std::make_shared<OpenniSession>(library, uri, options);
    KINO_TRY(session->open());
    return session;
}

Result<std::unique_ptr<LiveDevice>> open_device(const std::string& text) {
    KINO_ASSIGN(const OpenniAddress address, parse_openni_address(text));
    KINO_ASSIGN(OpenniLibrary * library, OpenniLibrary::get());
    const std::string where = "openni2:" + text;
    std::shared_ptr<OpenniSession> session;
    if (address.device.starts_with(kSerialPrefix)) {
        const std::string serial = address.device.substr(kSerialPrefix.size());
        for (const openni::DeviceInfo& device : library->devices()) {
            auto tried = open_session(*library, device.uri, address.options);
            if (!tried) continue;
            if ((*tried)->serial() == serial) {
                session = *tried;
                break;
            }
            (*tried)->close();
        }
        if (!session) return fail("no OpenNI2 device of that serial number", where, "plug it in");
    } else {
        std::string uri = address.device;
        if (uri.empty()) {
            const std::vector<openni::DeviceInfo> devices = library->devices();
            if (devices.empty()) {
                return fail("no OpenNI2 device is there", where,
                            "plug one in; Debian's OpenNI2 knows PrimeSense and Orbbec ones, not "
                            "the Kinect: for that take kinect1:");
            }
            uri = devices.front().uri;
        }
        KINO_ASSIGN(session, open_session(*library, uri, address.options));
    }
    return std::make_unique<OpenniDevice>(std::move(session), address);
}

std::vector<DeviceEntry> list_devices() {
    const auto library = OpenniLibrary::get();
    if (!library) return {};
    std::vector<DeviceEntry> entries;
    for (const openni::DeviceInfo& device : (*library)->devices()) {
        entries.push_back({fmt::format("openni2:{}", device.uri),
                           fmt::format("{} {}", device.vendor, device.name),
                           {},
                           {}});
    }
    return entries;
}

}  // namespace

Result<OpenniAddress> parse_openni_address(const std::string& text) {
    OpenniAddress address;
    const std::size_t mark = text.rfind('?');
    address.device = text.substr(0, mark);
    std::string_view rest =
        mark == std::string::npos ? std::string_view{} : std::string_view(text).substr(mark + 1);
    while (!rest.empty()) {
        const std::size_t end = rest.find('&');
        const std::string_view option = rest.substr(0, end);
        rest = end == std::string_view::npos ? std::string_view{} : rest.substr(end + 1);
        if (option == "registration=on" || option == "registration=off") {
            address.options.registration = option.ends_with("on");
        } else if (option == "sync=on" || option == "sync=off") {
            address.options.sync = option.ends_with("on");
        } else {
            return fail(fmt::format("unknown option \"{}\"", option), "openni2:" + text,
                        "there are registration=on and sync=off");
        }
    }
    return address;
}

std::string to_string(const OpenniAddress& address) {
    std::string options;
    if (address.options.registration) options += "registration=on";
    if (!address.options.sync) options += options.empty() ? "sync=off" : "&sync=off";
    return options.empty() ? address.device : address.device + "?" + options;
}

RigParameters openni_rig(const OpenniSession& session) {
    RigParameters rig = default_kinect1_rig();
    const CameraModel default_depth = rig.depth;
    const CameraModel default_color = *rig.color;
    const OpenniStream* depth = session.find(StreamKind::depth);
    const OpenniStream* color = session.find(StreamKind::color);
    if (!depth) depth = session.find(StreamKind::infrared);
    if (depth) rig.depth = camera_from_view(*depth, default_depth);
    rig.color.reset();
    if (color) {
        rig.color = camera_from_view(*color, default_color);
        if (!depth) rig.depth = *rig.color;
    }
    rig.serial = session.serial();
    rig.note = "cameras from the field of view that the OpenNI2 driver states, not calibrated";
    if (session.options().registration && rig.color) {
        const double scale = static_cast<double>(rig.depth.width) / rig.color->width;
        rig.depth.fx = rig.color->fx * scale;
        rig.depth.fy = rig.color->fy * scale;
        rig.color_from_depth = Pose{};
        rig.note += "; depth registered to colour by the device";
    } else if (rig.color) {
        rig.note += ", 25 mm apart as in the Kinect";
    }
    return rig;
}

DeviceDriver openni2_driver() {
    return {"openni2", "OpenNI2", "openni2:[uri][?registration=on]", list_devices, open_device};
}

SourceOpener openni2_opener() {
    return live_opener(openni2_driver());
}

}  // namespace kino
