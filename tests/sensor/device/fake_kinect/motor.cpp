#include "tests/sensor/device/fake_kinect/motor.h"

#include <algorithm>
#include <utility>

namespace kino::fake {

Motor::Motor(std::string serial)
    : identity_{.product = 0x02b0,
                .release = 0x0105,
                .speed = 2,
                .maker = "Microsoft",
                .name = "Xbox NUI Motor",
                .serial = std::move(serial),
                .iso_endpoints = {}} {}

Answer Motor::vendor_request(const Setup& setup, std::span<const std::uint8_t>) {
    const std::scoped_lock lock(mutex_);
    Answer answer;
    if (setup.type == 0xc0 && setup.request == 0x10) {
        answer.bytes = {0x22};
    } else if (setup.type == 0x40 && setup.request == 0x31) {
        half_degrees_ = static_cast<std::int16_t>(setup.value);
    } else if (setup.type == 0x40 && setup.request == 0x06) {
        lamp_ = setup.value;
    } else if (setup.type == 0xc0 && setup.request == 0x32) {
        answer.bytes = {0, 0};
        for (const int count : kAcceleration) {
            answer.bytes.push_back(static_cast<std::uint8_t>(count >> 8));
            answer.bytes.push_back(static_cast<std::uint8_t>(count));
        }
        answer.bytes.push_back(static_cast<std::uint8_t>(half_degrees_));
        answer.bytes.push_back(0);
    } else {
        return stalled();
    }
    answer.bytes.resize(std::min<std::size_t>(answer.bytes.size(), setup.length));
    return answer;
}

int Motor::lamp() const {
    const std::scoped_lock lock(mutex_);
    return lamp_;
}

double Motor::tilt_deg() const {
    const std::scoped_lock lock(mutex_);
    return half_degrees_ / 2.0;
}

}  // namespace kino::fake
