#pragma once

#include <string>
#include <vector>

#include "base/error.h"
#include "sensor/live/device.h"

namespace kino {

/// Makes the sources of higher rooms known to open_source().
void register_sources();

/// The drivers of live devices, the best for one device first.
[[nodiscard]] std::vector<DeviceDriver> device_drivers();

/// The URI of the first device that can be opened. Where there is none, the error names those that
/// are there but closed, and why.
[[nodiscard]] Result<std::string> first_device();

}  // namespace kino
