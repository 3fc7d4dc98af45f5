#include "sensor/kinect1/motion_poll.h"

#include <chrono>

namespace kino::kinect1 {

MotionPoll::MotionPoll(Motor& motor, LossGate& gate, FrameIntake& intake)
    : thread_([this, &motor, &gate, &intake] { run(motor, gate, intake); }) {}

MotionPoll::~MotionPoll() {
    {
        const std::lock_guard lock(mutex_);
        stop_ = true;
    }
    wake_.notify_all();
    thread_.join();
}

void MotionPoll::run(Motor& motor, LossGate& gate, FrameIntake& intake) {
    const auto period = std::chrono::nanoseconds(from_seconds(1 / kHz));
    const TimeNs start = now_ns();
    std::int64_t sequence = 0;
    std::int64_t lost = 0;
    auto next = std::chrono::steady_clock::now();
    while (true) {
        const TimeNs asked = now_ns();
        const auto state = motor.state();
        if (state) {
            // The answer is of some moment between asking and now; the device has no stamp for it.
            const TimeNs host_time = asked + (now_ns() - asked) / 2;
            auto frame = std::make_shared<MotionFrame>();
            sequence += lost;
            frame->header = {host_time - start, host_time, sequence++, std::exchange(lost, 0)};
            frame->acceleration_m_s2 = state->acceleration_m_s2;
            frame->tilt_deg = state->tilt_deg;
            gate.put(intake, {0, StreamKind::motion}, std::move(frame));
        } else if (state.error().kind == usb::Failure::no_device) {
            gate.lose(intake, "the sensor was unplugged");
            return;
        } else {
            ++lost;
        }
        next += period;
        std::unique_lock lock(mutex_);
        if (wake_.wait_until(lock, next, [this] { return stop_; })) return;
        next = std::max(next, std::chrono::steady_clock::now() - period);
    }
}

}  // namespace kino::kinect1
