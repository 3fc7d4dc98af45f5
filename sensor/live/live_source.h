#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <string>

#include "sensor/live/device.h"
#include "sensor/live/hotplug.h"
#include "sensor/live/set_builder.h"

namespace kino {

struct LiveOptions {
    SetBuilderOptions sets;
    /// What says that devices come and go; asked for each time the device is lost.
    std::function<std::unique_ptr<HotplugWatch>()> watch = make_hotplug_watch;
    /// A lost device is looked for when the watch says something, at once, after this long, twice
    /// this long and so on up to every `slowest_look`.
    TimeNs first_look = 100 * kNsPerMs;
    TimeNs slowest_look = 2 * kNsPerSecond;
    TimeNs control_timeout = kNsPerSecond;
};

struct LiveStats {
    std::int64_t frames = 0;     ///< of all streams, put by the device and passed on
    std::int64_t overtaken = 0;  ///< sets that gave way to newer ones before they were read
    std::int64_t losses = 0;     ///< how often the device has gone
    bool present = true;         ///< the device is there now
    std::string trouble;         ///< why it could not be opened again, or was not as before
};

/// A device, for good: when it goes, the source says `lost`, waits for the same unit
/// (LiveDevice::address()), opens it, starts the subscribed streams, sets the controls that had
/// been set and says `back`. No frame comes between the two; sequence, device time and host time
/// of every stream go on rising. There is never an `ended`.
///
/// One thread inside owns the device; subscribe() and unsubscribe() wait for it. While the device
/// is away a subscription is noted and succeeds, a control fails. The tap must not call back.
class LiveSource : public Source {
  public:
    [[nodiscard]] virtual LiveStats stats() const = 0;  ///< from any thread
};

/// Fails as `driver.open` does.
[[nodiscard]] Result<std::unique_ptr<LiveSource>> make_live_source(DeviceDriver driver,
                                                                   const std::string& address,
                                                                   LiveOptions options = {});

/// "scheme:address" with default options.
[[nodiscard]] SourceOpener live_opener(DeviceDriver driver);

}  // namespace kino
