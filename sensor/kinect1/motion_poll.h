#pragma once

#include <condition_variable>
#include <mutex>
#include <thread>

#include "sensor/kinect1/loss_gate.h"
#include "sensor/kinect1/motor.h"

namespace kino::kinect1 {

/// Asks the motor ten times a second how it stands, on a thread of its own, from its making to its
/// end. Answers that fail are counted as lost; a motor that has gone ends it.
class MotionPoll {
  public:
    static constexpr double kHz = 10;
    /// All outlive it.
    MotionPoll(Motor& motor, LossGate& gate, FrameIntake& intake);
    ~MotionPoll();
    MotionPoll(const MotionPoll&) = delete;
    MotionPoll& operator=(const MotionPoll&) = delete;

  private:
    void run(Motor& motor, LossGate& gate, FrameIntake& intake);

    std::mutex mutex_;
    std::condition_variable wake_;
    bool stop_ = false;
    std::thread thread_;
};

}  // namespace kino::kinect1
