#pragma once

#include "base/time.h"

namespace kino {

/// Shows pictures at a constant rate: one that is ready early waits for its turn. Turns come every
/// period and do not drift. Pictures after a late one come up to a tenth of a period sooner until
/// the turns are caught up with, never in a burst; turns that were missed altogether are left out.
/// Keeps no clock and does not sleep: who draws does.
class FramePacer {
  public:
    explicit FramePacer(TimeNs period);

    /// When to begin a picture that takes about `expected`, so that it is ready in its turn: what
    /// it shows is then as new as can be. Not before `now`, nor a period after.
    [[nodiscard]] TimeNs begin_at(TimeNs now, TimeNs expected) const;
    /// When to show a picture that is ready now; at most one period later.
    [[nodiscard]] TimeNs show_at(TimeNs now) const;
    /// A picture was shown.
    void shown(TimeNs at);

    /// Periods below a millisecond are taken for one.
    void set_period(TimeNs period);
    [[nodiscard]] TimeNs period() const { return period_; }
    /// The next picture is shown when it is ready, and turns count from it.
    void restart() { begun_ = false; }

  private:
    [[nodiscard]] TimeNs turn() const;

    TimeNs period_ = 0;
    TimeNs turn_ = 0;   ///< of the next picture, were none late
    TimeNs shown_ = 0;  ///< the last one
    bool begun_ = false;
};

}  // namespace kino
