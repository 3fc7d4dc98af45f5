#pragma once

#include <string>

#include "sensor/live/device.h"
#include "sensor/openni2/openni_session.h"

namespace kino {

/// What follows "openni2:" taken apart: "[uri or serial=number][?registration=on][&sync=off]".
struct OpenniAddress {
    std::string device;  ///< empty: the first there is
    OpenniOptions options;
};
[[nodiscard]] Result<OpenniAddress> parse_openni_address(const std::string& address);
[[nodiscard]] std::string to_string(const OpenniAddress& address);

/// Cameras from the fields of view that the driver states, centred; Kinect v1's where it states
/// none. Depth registered to colour stands where the colour camera stands.
[[nodiscard]] RigParameters openni_rig(const OpenniSession& session);

}  // namespace kino
