#include "sensor/live/wake_descriptor.h"

#include <poll.h>
#include <sys/eventfd.h>
#include <unistd.h>

#include <algorithm>
#include <cstdint>

#include "base/check.h"

namespace kino {

WakeDescriptor::WakeDescriptor() : descriptor_(eventfd(0, EFD_NONBLOCK | EFD_CLOEXEC)) {
    KINO_CHECK_LE(0, descriptor_);
}

WakeDescriptor::~WakeDescriptor() {
    close(descriptor_);
}

void WakeDescriptor::signal() {
    const std::uint64_t one = 1;
    // It can only fail for a counter that is full, and then the signal stands already.
    [[maybe_unused]] const auto written = write(descriptor_, &one, sizeof one);
}

bool WakeDescriptor::wait(TimeNs timeout, int other) {
    timeout = std::max<TimeNs>(0, timeout);
    const timespec time{timeout / kNsPerSecond, timeout % kNsPerSecond};
    pollfd polled[2] = {{descriptor_, POLLIN, 0}, {other, POLLIN, 0}};
    if (ppoll(polled, 2, &time, nullptr) <= 0) return false;
    std::uint64_t signals = 0;
    return read(descriptor_, &signals, sizeof signals) == sizeof signals;
}

}  // namespace kino
