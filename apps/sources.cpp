#include "apps/sources.h"

#include <fmt/format.h>

#include "sensor/convert/bag_import.h"
#include "sensor/convert/k4a_mkv.h"
#include "sensor/kinect1/kinect1_driver.h"
#include "sensor/live/composite.h"
#include "sensor/openni2/openni2.h"
#include "sensor/session/session_source.h"
#include "sensor/v4l2/v4l2_driver.h"
#include "skeleton/synthetic/synthetic_source.h"

namespace kino {

void register_sources() {
    register_synthetic_source();
    register_source(oni_opener());
    register_source(k4a_opener());
    register_source(bag_opener());
    register_source(session_folder_opener());
    register_source(session_opener());
    register_source(v4l2_opener());
    register_source(openni2_opener());
    register_source(kinect1_opener());
    // Asked first: what stands on both sides of its '+' is of the others.
    register_source(composite_opener());
}

std::vector<DeviceDriver> device_drivers() {
    return {kinect1_driver(), openni2_driver(), v4l2_driver()};
}

Result<std::string> first_device() {
    std::string closed;
    for (const DeviceDriver& driver : device_drivers()) {
        for (const DeviceEntry& entry : driver.list()) {
            if (entry.problem.empty()) return entry.uri;
            closed += fmt::format("{}{}: {}", closed.empty() ? "" : "; ", entry.uri, entry.problem);
        }
    }
    if (closed.empty()) {
        return fail("no sensor is plugged in", {},
                    "`kinoscope devices --watch` tells when one is; without one, try "
                    "`kinoscope live synthetic:` or `kinoscope replay recordings/person`");
    }
    return fail("no sensor can be opened: " + closed);
}

}  // namespace kino
