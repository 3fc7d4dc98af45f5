#pragma once

#include <atomic>
#include <functional>
#include <string>
#include <vector>

#include "sensor/kinect1/camera_commands.h"
#include "sensor/kinect1/motor.h"
#include "sensor/source.h"

namespace kino::kinect1 {

/// tilt and led (with a motor), white_balance_auto, exposure_auto, ir_brightness. Asking for tilt
/// or led where there is no motor fails with the reason.
class Kinect1Controls : public Controls {
  public:
    /// `motor` may be null; `no_motor` then says why. Both and `commands` outlive it.
    Kinect1Controls(CameraCommands& commands, Motor* motor, std::string no_motor,
                    std::string where);

    [[nodiscard]] std::vector<Control> list() const override;
    [[nodiscard]] Result<double> get(const std::string& id) override;
    Result<void> set(const std::string& id, double value) override;

  private:
    struct Knob {
        Control control;
        std::function<usb::Outcome<double>()> get;
        std::function<usb::Outcome<void>(double)> set;
    };
    [[nodiscard]] Result<const Knob*> find(const std::string& id) const;
    void add_motor(Motor& motor);
    void add_color_flag(const char* id, const char* name, std::uint16_t flag);
    void add_ir_brightness();

    CameraCommands& commands_;
    std::string no_motor_;
    std::string where_;
    std::vector<Knob> knobs_;
    std::atomic<int> led_{1};           // the device cannot be asked
    std::atomic<double> last_tilt_{0};  // while the motor moves there is no reading
};

}  // namespace kino::kinect1
