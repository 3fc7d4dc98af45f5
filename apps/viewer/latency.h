#pragma once

#include <string>

#include "apps/pipeline/processed_frame.h"
#include "apps/pipeline/time_series.h"

namespace kino {

/// How long a frame took from the sensor to the screen, stage by stage, on the host's clock.
struct Latency {
    /// Of a device: from the moment the frame was seen (its host time) to its arrival here. Of a
    /// recording, which is seen when it is read: the reading.
    TimeNs arrive = 0;
    TimeNs process = 0;  ///< colour, filters, registration
    TimeNs wait = 0;     ///< for the picture before it
    TimeNs draw = 0;     ///< until the window system has the picture
    [[nodiscard]] TimeNs total() const { return arrive + process + wait + draw; }
};

[[nodiscard]] Latency latency_of(const ProcessedFrame& frame, bool from_device, TimeNs draw_began,
                                 TimeNs presented);

/// All frames' latencies, for the summary.
class LatencyLog {
  public:
    void add(const Latency& latency);
    [[nodiscard]] std::size_t count() const { return total_.count(); }
    /// "latency ms: median 41.0 (arrive ..., process ..., wait ..., draw ...), 95 % 55.1"
    [[nodiscard]] std::string to_text() const;
    /// The same as members of a JSON object, without its braces.
    [[nodiscard]] std::string to_json_members() const;

  private:
    TimeSeries arrive_, process_, wait_, draw_, total_;
};

}  // namespace kino
