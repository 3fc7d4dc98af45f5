#include "apps/viewer/latency.h"

#include <fmt/format.h>

#include <algorithm>

namespace kino {

Latency latency_of(const ProcessedFrame& frame, bool from_device, TimeNs draw_began,
                   TimeNs presented) {
    // A clock model may place a frame slightly after its arrival.
    const TimeNs seen = std::max<TimeNs>(0, frame.arrived - frame.set.time);
    return {.arrive = from_device ? seen : frame.times.read,
            .process = frame.ready - frame.arrived,
            .wait = std::max<TimeNs>(0, draw_began - frame.ready),
            .draw = presented - draw_began};
}

void LatencyLog::add(const Latency& latency) {
    arrive_.add(latency.arrive);
    process_.add(latency.process);
    wait_.add(latency.wait);
    draw_.add(latency.draw);
    total_.add(latency.total());
}

std::string LatencyLog::to_text() const {
    return fmt::format(
        "latency ms: median {:.1f} (arrive {:.1f}, process {:.1f}, wait {:.1f}, draw {:.1f}), "
        "95 % {:.1f}",
        total_.median_ms(), arrive_.median_ms(), process_.median_ms(), wait_.median_ms(),
        draw_.median_ms(), total_.p95_ms());
}

std::string LatencyLog::to_json_members() const {
    return fmt::format(
        "\"latency_ms_median\": {:.2f}, \"latency_ms_p95\": {:.2f}, \"arrive_ms_median\": {:.2f}, "
        "\"process_ms_median\": {:.2f}, \"wait_ms_median\": {:.2f}, \"draw_ms_median\": {:.2f}",
        total_.median_ms(), total_.p95_ms(), arrive_.median_ms(), process_.median_ms(),
        wait_.median_ms(), draw_.median_ms());
}

}  // namespace kino
