#pragma once

#include "base/time.h"

namespace kino {

/// An eventfd: wakes a thread that waits on file descriptors. signal() from any thread.
class WakeDescriptor {
  public:
    WakeDescriptor();
    ~WakeDescriptor();
    WakeDescriptor(const WakeDescriptor&) = delete;
    WakeDescriptor& operator=(const WakeDescriptor&) = delete;

    void signal();
    /// Waits up to `timeout` for a signal, or for `other` (-1: none) to become readable. True if
    /// it was signalled, which is forgotten by that.
    [[nodiscard]] bool wait(TimeNs timeout, int other = -1);

  private:
    int descriptor_;
};

}  // namespace kino
