#include "skeleton/gestures/primary_user.h"

namespace kino {

bool PrimaryUser::update(TimeNs time, bool seen, double distance_m, const PrimaryDefinition& d) {
    if (id_ == 0) return false;
    if (seen) seen_ = time;
    // Out of view is not yet gone away: lost_s decides about that alone.
    if (!seen || distance_m <= d.max_distance_m) near_ = time;
    if (to_seconds(time - seen_) <= d.lost_s && to_seconds(time - near_) <= d.leave_s) return false;
    id_ = 0;
    return true;
}

bool PrimaryUser::wave(std::uint32_t id, TimeNs time, double distance_m,
                       const PrimaryDefinition& d) {
    if (id == 0 || distance_m > d.max_distance_m) return false;
    if (id == id_) {
        offer_until_ = time + from_seconds(d.offer_s);
        return false;
    }
    if (id_ != 0 && time > offer_until_) return false;
    hand_over(id, time);
    return true;
}

void PrimaryUser::hand_over(std::uint32_t id, TimeNs time) {
    id_ = id;
    seen_ = near_ = time;
    offer_until_ = time - 1;
}

}  // namespace kino
