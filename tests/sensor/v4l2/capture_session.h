#pragma once

#include <memory>
#include <string>
#include <vector>

#include "collecting_intake.h"
#include "fake_video_system.h"
#include "sensor/v4l2/v4l2_driver.h"

namespace kino::test {

/// One life of a device: opened, streaming until the script is at its end, stopped and closed.
struct CaptureSession {
    std::string error;  ///< of open or start; empty if they went well
    CollectingIntake intake;

    void run(const std::shared_ptr<FakeVideoSystem>& system, const std::string& address = {}) {
        auto device = v4l2_driver(system).open(address);
        if (!device) {
            error = device.error().to_string();
            return;
        }
        const StreamId id = (*device)->info().streams.front().id;
        if (const auto started = (*device)->start(id, intake); !started) {
            error = started.error().to_string();
            return;
        }
        system->wait_idle([&] { return intake.is_lost(); });
        (*device)->stop(id);
    }
};

}  // namespace kino::test
