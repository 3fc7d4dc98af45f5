#include "sensor/kinect1/frame_clock.h"

#include <algorithm>
#include <cmath>

namespace kino::kinect1 {

DeviceClock::Moment FrameClock::at(int endpoint, std::uint32_t ticks, TimeNs arrival_host) {
    constexpr double kMostApartS = 0.25;
    const std::lock_guard lock(mutex_);
    Endpoint& mine = endpoints_[static_cast<std::size_t>(endpoint)];
    const Endpoint& other = endpoints_[static_cast<std::size_t>(1 - endpoint)];
    if (!mine.checked && other.last) {
        const auto ahead = static_cast<std::int32_t>(ticks - other.last->ticks);
        const double host_s = to_seconds(arrival_host - other.last->arrival);
        if (std::abs(ahead / kTicksPerSecond - host_s) > kMostApartS) {
            mine.own.emplace(kTicksPerSecond, 32);
        }
        mine.checked = true;
    }
    if (!other.last) mine.checked = true;
    mine.last = Stamp{ticks, arrival_host};
    DeviceClock::Moment moment = (mine.own ? *mine.own : shared_).at(ticks, arrival_host);
    if (mine.any) {
        moment.device_time = std::max(moment.device_time, mine.newest.device_time + 1);
        moment.host_time = std::max(moment.host_time, mine.newest.host_time + 1);
    }
    mine.any = true;
    mine.newest = moment;
    return moment;
}

}  // namespace kino::kinect1
