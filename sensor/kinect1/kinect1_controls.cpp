#include "sensor/kinect1/kinect1_controls.h"

#include <fmt/format.h>

#include <cmath>
#include <utility>

namespace kino::kinect1 {
namespace {

using usb::Outcome;

// libfreenect flags.c: bits of register 0x106 of the colour sensor, and register 0x15 of the
// camera.
constexpr std::uint16_t kColorFlags = 0x106;
constexpr std::uint16_t kAutoWhiteBalance = 1u << 1;
constexpr std::uint16_t kAutoExposure = 1u << 14;
constexpr std::uint16_t kIrBrightness = 0x15;
constexpr double kMaxIrBrightness = 50;

}  // namespace

Kinect1Controls::Kinect1Controls(CameraCommands& commands, Motor* motor, std::string no_motor,
                                 std::string where)
    : commands_(commands), no_motor_(std::move(no_motor)), where_(std::move(where)) {
    if (motor) add_motor(*motor);
    add_color_flag("white_balance_auto", "white balance by itself", kAutoWhiteBalance);
    add_color_flag("exposure_auto", "exposure by itself", kAutoExposure);
    add_ir_brightness();
}

void Kinect1Controls::add_motor(Motor& motor) {
    Control tilt{.id = "tilt",
                 .name = "tilt, degrees",
                 .kind = ControlKind::range,
                 .minimum = -Motor::kMaxTiltDeg,
                 .maximum = Motor::kMaxTiltDeg,
                 .step = 0.5};
    knobs_.push_back({tilt,
                      [this, &motor]() -> Outcome<double> {
                          const auto state = motor.state();
                          if (!state) return tl::unexpected(state.error());
                          if (state->tilt_deg) last_tilt_ = *state->tilt_deg;
                          return last_tilt_.load();
                      },
                      [this, &motor](double degrees) -> Outcome<void> {
                          auto done = motor.tilt(degrees);
                          if (done) last_tilt_ = degrees;
                          return done;
                      }});
    Control led{.id = "led",
                .name = "light",
                .kind = ControlKind::menu,
                .minimum = 0,
                .maximum = static_cast<double>(Motor::kLedNames.size() - 1),
                .fallback = 1,
                .menu = {Motor::kLedNames.begin(), Motor::kLedNames.end()}};
    knobs_.push_back({led, [this]() -> Outcome<double> { return led_.load(); },
                      [this, &motor](double value) -> Outcome<void> {
                          auto done = motor.led(static_cast<int>(std::lround(value)));
                          if (done) led_ = static_cast<int>(std::lround(value));
                          return done;
                      }});
}

void Kinect1Controls::add_color_flag(const char* id, const char* name, std::uint16_t flag) {
    const Control control{.id = id, .name = name, .kind = ControlKind::toggle, .fallback = 1};
    knobs_.push_back({control,
                      [this, flag]() -> Outcome<double> {
                          const auto flags = commands_.read_color_register(kColorFlags);
                          if (!flags) return tl::unexpected(flags.error());
                          return (*flags & flag) != 0 ? 1.0 : 0.0;
                      },
                      [this, flag](double on) -> Outcome<void> {
                          const auto flags = commands_.read_color_register(kColorFlags);
                          if (!flags) return tl::unexpected(flags.error());
                          const auto changed =
                              static_cast<std::uint16_t>(on != 0 ? *flags | flag : *flags & ~flag);
                          return commands_.write_color_register(kColorFlags, changed);
                      }});
}

void Kinect1Controls::add_ir_brightness() {
    const Control control{.id = "ir_brightness",
                          .name = "infrared brightness",
                          .kind = ControlKind::range,
                          .minimum = 1,
                          .maximum = kMaxIrBrightness,
                          .step = 1,
                          .fallback = 30};
    knobs_.push_back({control,
                      [this]() -> Outcome<double> {
                          const auto value = commands_.read_register(kIrBrightness);
                          if (!value) return tl::unexpected(value.error());
                          return static_cast<double>(*value);
                      },
                      [this](double value) -> Outcome<void> {
                          return commands_.write_register(
                              kIrBrightness, static_cast<std::uint16_t>(std::lround(value)));
                      }});
}

std::vector<Control> Kinect1Controls::list() const {
    std::vector<Control> out;
    for (const Knob& knob : knobs_) out.push_back(knob.control);
    return out;
}

Result<const Kinect1Controls::Knob*> Kinect1Controls::find(const std::string& id) const {
    for (const Knob& knob : knobs_) {
        if (knob.control.id == id) return &knob;
    }
    if (id == "tilt" || id == "led") return fail(no_motor_, where_);
    return fail(fmt::format("this sensor has no control \"{}\"", id), where_);
}

Result<double> Kinect1Controls::get(const std::string& id) {
    KINO_ASSIGN(const Knob* knob, find(id));
    const auto value = knob->get();
    if (!value) return tl::unexpected(usb::to_error(value.error(), where_));
    return *value;
}

Result<void> Kinect1Controls::set(const std::string& id, double value) {
    KINO_ASSIGN(const Knob* knob, find(id));
    const Control& c = knob->control;
    if (!(value >= c.minimum && value <= c.maximum)) {
        return fail(fmt::format("{} takes {} to {}, not {}", id, c.minimum, c.maximum, value),
                    where_);
    }
    const auto done = knob->set(value);
    if (!done) return tl::unexpected(usb::to_error(done.error(), where_));
    return {};
}

}  // namespace kino::kinect1
