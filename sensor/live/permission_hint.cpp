#include "sensor/live/permission_hint.h"

namespace kino {

std::string permission_hint() {
    return "install the udev rule udev/60-kinoscope.rules: "
           "sudo cp udev/60-kinoscope.rules /etc/udev/rules.d/ && "
           "sudo udevadm control --reload && sudo udevadm trigger, "
           "then plug the device in again; over ssh also: sudo adduser $USER plugdev";
}

}  // namespace kino
