#include "sensor/kinect1/usb.h"

#include "sensor/live/permission_hint.h"

namespace kino::usb {

const char* describe(Failure failure) {
    switch (failure) {
        case Failure::no_device:
            return "the device has gone";
        case Failure::no_permission:
            return "permission denied";
        case Failure::busy:
            return "it is in use by another program or driver";
        case Failure::not_found:
            return "there is no such thing";
        case Failure::timeout:
            return "no answer in time";
        case Failure::stall:
            return "the device refused";
        case Failure::overflow:
            return "the device sent too much";
        case Failure::interrupted:
            return "interrupted by a signal";
        case Failure::no_memory:
            return "the system has no memory for it";
        case Failure::unsupported:
            return "not supported by this system";
        case Failure::io:
            return "input/output error";
    }
    return "unknown failure";
}

Error to_error(const Fault& fault, const std::string& where) {
    std::string hint;
    switch (fault.kind) {
        case Failure::no_permission:
            hint = permission_hint();
            break;
        case Failure::busy:
            hint = "close the other program that uses the sensor; one program at a time can";
            break;
        case Failure::no_device:
        case Failure::not_found:
            hint = "plug the sensor in again, and check its power supply";
            break;
        case Failure::timeout:
        case Failure::stall:
        case Failure::overflow:
        case Failure::io:
            hint = "if it happens again, unplug the sensor and its power supply for a moment";
            break;
        case Failure::no_memory:
            hint = "raise /sys/module/usbcore/parameters/usbfs_memory_mb";
            break;
        case Failure::interrupted:
        case Failure::unsupported:
            break;
    }
    return {fault.what, where, hint};
}

}  // namespace kino::usb
