#include <algorithm>
#include <array>
#include <glm/geometric.hpp>
#include <utility>

#include "skeleton/people/blob_relations.h"
#include "skeleton/people/person_tracker.h"

// Who is somebody, and who is told of.

namespace kino {
namespace {

constexpr float kFarM = 0.5f;  // whoever came so far is no part of the room
constexpr int kManyStirs = 6;
constexpr float kTallM = 1.3f;  // higher than chairs
constexpr float kHeadHits = 2;
constexpr float kSteadyHead = 0.7f;   // of the pictures, where nothing moves
constexpr double kStillHeadS = 0.3;   // a head that shows for so long needs no motion
constexpr float kKnownAround = 0.8f;  // of a surface: all of it stands before the room

}  // namespace

float PersonTracker::weight(const Blob& blob, const BlobHead& head) const {
    if (!test_.above_floor(head)) return 0;
    return blob.known > 0.5f || test_.clear_head(blob, head) ? 1.0f : 0.4f;
}

bool PersonTracker::proven(const PersonTrack& track) const {
    if (!track.blob) return false;
    const Blob& blob = *track.blob;
    const bool headed = track.head_hits >= kHeadHits;
    const float high = blob.max_m.y - blob.min_m.y;
    const bool tall = high >= kTallM;
    if (!options_.ask_for_motion) return true;
    if (!track.in_front()) {
        const bool long_seen = to_seconds(track.seen - track.born) >= kStillHeadS;
        const bool steady = track.head_hits >= kSteadyHead * static_cast<float>(track.sightings);
        if (headed && steady && long_seen && !track.doubted) return true;
        // From the side, but nothing else around: somebody who stands alone.
        const bool alone = tall && !blob.cut && blob.free > 0.9f &&
                           static_cast<float>(track.head_pictures) >=
                               kSteadyHead * static_cast<float>(track.sightings);
        if (alone && headed && !track.doubted) return true;
        return track.moved && (headed || tall);
    }
    // Without a head: cut off by the upper edge of the picture, on the floor, or on the way.
    if (headed || (tall && track.head_hits >= 1) || blob.border || test_.lying(blob)) return true;
    const bool far = glm::distance(track.at_m, track.born_at_m) > kFarM;
    return (tall && track.moved) || ((far || test_.accepts(blob)) && track.stirs >= kManyStirs);
}

bool PersonTracker::protects(const PersonTrack& track, TimeNs time) const {
    if (track.id != 0) return true;
    if (track.doubted) return track.moved;
    const double patience = track.head_pictures > 0 ? options_.patience_s : options_.headless_s;
    return proven(track) || to_seconds(time - track.born) < patience;
}

void PersonTracker::drop_furniture(TimeNs time) {
    if (!options_.ask_for_motion) return;
    std::erase_if(tracks_, [&](const PersonTrack& t) {
        if (t.moved || !t.blob || t.in_front() || t.seen != time ||
            to_seconds(time - t.born) < options_.still_s) {
            return false;
        }
        doubted_m_.push_back(t.blob->centroid_m);
        return true;
    });
}

// A head on a body before a room that is known: waiting would tell nothing more.
bool PersonTracker::sure_at_once(const PersonTrack& track) const {
    if (!options_.ask_for_motion || !track.blob || track.head_hits < 1) return false;
    const Blob& blob = *track.blob;
    const bool tall = blob.max_m.y - blob.min_m.y >= kTallM;
    return blob.known > kKnownAround && !blob.cut && !blob.shared && test_.accepts(blob) &&
           (tall || blob.head_score() >= kSureHead);
}

void PersonTracker::confirm(TimeNs time) {
    for (PersonTrack& track : tracks_) {
        if (track.id != 0 || track.seen != time) continue;
        const bool waited =
            track.sightings >= 2 && to_seconds(time - track.born) >= options_.confirm_s;
        if (!(waited && proven(track)) && !sure_at_once(track)) continue;
        std::array<const PersonTrack*, kPersonSlots + 1> holder{};
        for (const PersonTrack& t : tracks_) holder[t.slot] = t.slot ? &t : nullptr;
        std::uint8_t slot = 0;
        for (std::uint8_t s = kPersonSlots; s >= 1; --s) {
            if (!holder[s]) slot = s;
        }
        if (slot == 0) {  // somebody present comes before somebody remembered
            const auto oldest = std::min_element(
                tracks_.begin(), tracks_.end(), [](const PersonTrack& a, const PersonTrack& b) {
                    return std::pair(a.slot == 0, a.seen) < std::pair(b.slot == 0, b.seen);
                });
            if (oldest->slot == 0 || oldest->seen == time) continue;
            slot = oldest->slot;
            oldest->slot = 0;  // forgotten below
            oldest->sightings = -1;
        }
        track.slot = slot;
        track.id = next_id_++;
    }
    std::erase_if(tracks_, [](const PersonTrack& t) { return t.sightings < 0; });
}

}  // namespace kino
