#include "skeleton/people/person_tracker.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/matrix.hpp>

#include "skeleton/people/assignment.h"
#include "skeleton/people/blob_relations.h"

namespace kino {
namespace {

constexpr double kVelocityS = 0.3;  // time constant of the velocity
constexpr double kCoastS = 0.8;     // in which an unseen person's velocity fades
constexpr double kTypicalS = 1.0;   // of typical sizes
constexpr float kMaxSpeedMS = 4.0f;
constexpr float kPartial = 0.6f;  // of the typical area: the centroid is not to be trusted
constexpr float kMovedM = 0.15f;
constexpr float kStirred = 0.03f;  // of the cells: an arm is about 0.08
constexpr int kStirs = 3;
constexpr double kOtherSize = 0.8;  // ratio of areas, logarithm: not the same thing
constexpr double kRecentS = 1.5;
constexpr float kCoreM = 0.28f;
constexpr std::size_t kMaxTracks = 12;  // confirmed or not

}  // namespace

glm::vec3 PersonTrack::expected_m(TimeNs time) const {
    // Velocity fades: the path is v times the integral of exp(-t / T).
    const double dt = to_seconds(std::max<TimeNs>(time - seen, 0));
    return at_m + velocity_m_s * static_cast<float>(kCoastS * (1 - std::exp(-dt / kCoastS)));
}

glm::vec3 PersonTrack::expected_head_m(TimeNs time) const {
    return head_m + (expected_m(time) - at_m);
}

void PersonTracker::reset() {
    tracks_.clear();
    second_heads_.clear();
    doubted_m_.clear();
}

std::vector<glm::vec3> PersonTracker::expected_heads(TimeNs time) const {
    std::vector<glm::vec3> out;
    for (const PersonTrack& t : tracks_) {
        if (t.head_seen != 0 && to_seconds(time - t.seen) < kRecentS)
            out.push_back(upright_of(t.expected_head_m(time)));
    }
    return out;
}

glm::vec3 PersonTracker::upright_of(const glm::vec3& camera) const {
    return upright_ * camera + glm::vec3(0, height_m_, 0);
}

glm::vec3 PersonTracker::camera_of(const glm::vec3& upright) const {
    return glm::transpose(upright_) * (upright - glm::vec3(0, height_m_, 0));
}

void PersonTracker::note_second_heads(const std::vector<Blob>& blobs, TimeNs time) {
    std::erase_if(second_heads_,
                  [&](const SecondHead& h) { return to_seconds(time - h.last) > 0.5; });
    for (const Blob& blob : blobs) {
        for (const BlobHead& head : blob.heads) {
            if (head.score < kSureHead) continue;
            const bool someone =
                std::any_of(tracks_.begin(), tracks_.end(), [&](const PersonTrack& t) {
                    if (t.id == 0 || t.head_seen == 0) return false;
                    return level_distance(upright_of(t.expected_head_m(time)), head.upright_m) <
                           0.35f;
                });
            if (someone) continue;
            const auto known =
                std::find_if(second_heads_.begin(), second_heads_.end(), [&](const SecondHead& h) {
                    return glm::distance(h.upright_m, head.upright_m) < 0.2f;
                });
            if (known == second_heads_.end()) {
                second_heads_.push_back({head.upright_m, time, time, 1});
            } else {
                known->upright_m = head.upright_m;
                known->last = time;
                ++known->hits;
            }
        }
    }
}

std::vector<glm::vec3> PersonTracker::seeds_in(const Blob& blob, TimeNs time) const {
    std::vector<glm::vec3> seeds;
    const auto free = [&](const glm::vec3& at, float distance) {
        return std::all_of(seeds.begin(), seeds.end(),
                           [&](const glm::vec3& s) { return level_distance(s, at) > distance; });
    };
    std::vector<glm::vec3> others;
    for (const SecondHead& second : second_heads_) {
        if (second.last != time || second.hits < 4 || to_seconds(time - second.first) < 0.3)
            continue;
        const bool here = std::any_of(blob.heads.begin(), blob.heads.end(), [&](const BlobHead& h) {
            return h.upright_m == second.upright_m;
        });
        if (here) others.push_back(second.upright_m);
    }
    for (const PersonTrack& track : tracks_) {
        if (track.id == 0 || to_seconds(time - track.seen) > kRecentS) continue;
        glm::vec3 at = upright_of(track.expected_m(time));
        glm::vec3 off(0);
        if (track.head_seen != 0) {  // a head in view says better than the past where he is
            const glm::vec3 expected = upright_of(track.expected_head_m(time));
            for (const BlobHead& head : blob.heads) {
                off = head.upright_m - expected;
                if (std::hypot(off.x, off.z) < 0.2f && std::abs(off.y) < 0.25f) {
                    // Whoever counted as one with somebody has the middle of both for his place.
                    if (!others.empty()) at = glm::vec3(head.upright_m.x, at.y, head.upright_m.z);
                    break;
                }
                off = glm::vec3(0);
            }
        }
        if (!free(at, 0.2f) || area_around(blob, at, kCoreM) <= 0.4f * track.core_m2) continue;
        if (others.empty()) at += glm::vec3(off.x, 0, off.z);
        seeds.push_back(at);
    }
    for (const glm::vec3& other : others) {
        if (free(other, 0.35f)) seeds.push_back(other);
    }
    return seeds;
}

std::vector<Blob> PersonTracker::split_shared(std::vector<Blob> blobs, TimeNs time) const {
    std::vector<Blob> out;
    for (Blob& blob : blobs) {
        std::vector<glm::vec3> seeds;
        if (blob.area_m2 > 0.2f) seeds = seeds_in(blob, time);
        if (seeds.size() < 2) {
            out.push_back(std::move(blob));
            continue;
        }
        const auto nearest = [&](const glm::vec3& p) {
            std::size_t best = 0;
            for (std::size_t s = 1; s < seeds.size(); ++s) {
                if (level_distance(p, seeds[s]) < level_distance(p, seeds[best])) best = s;
            }
            return best;
        };
        std::vector<Blob> parts(seeds.size());
        for (const CellPoint& c : blob.cells) parts[nearest(c.upright_m)].cells.push_back(c);
        for (const BlobHead& h : blob.heads) parts[nearest(h.upright_m)].heads.push_back(h);
        for (Blob& part : parts) {
            if (part.cells.empty()) continue;
            part.measure();
            part.shared = true;
            out.push_back(std::move(part));
        }
    }
    return out;
}

std::vector<char> PersonTracker::held_by_tracks(const std::vector<Blob>& blobs, TimeNs time) const {
    struct Pair {
        float distance;
        std::size_t track, blob;
    };
    std::vector<Pair> pairs;
    for (std::size_t t = 0; t < tracks_.size(); ++t) {
        const PersonTrack& track = tracks_[t];
        const glm::vec3 expected = upright_of(track.expected_m(time));
        const glm::vec3 head = upright_of(track.expected_head_m(time));
        for (std::size_t b = 0; b < blobs.size(); ++b) {
            const Blob& blob = blobs[b];
            if (!test_.accepts_part(blob) && !test_.accepts(blob)) continue;
            const bool own_head =
                track.head_seen != 0 &&
                std::any_of(blob.heads.begin(), blob.heads.end(), [&](const BlobHead& h) {
                    return glm::distance(h.upright_m, head) < 0.3f;
                });
            const float distance = level_distance(expected, blob.centroid_m);
            if (!own_head && distance > options_.gate_m) continue;
            // Of several pieces the one with the head, then the largest.
            pairs.push_back({distance - (own_head ? 2.0f : 0.0f) -
                                 0.5f * std::min(blob.area_m2 / track.area_m2, 1.0f) +
                                 (track.id == 0 ? 3.0f : 0.0f),
                             t, b});
        }
    }
    std::stable_sort(pairs.begin(), pairs.end(),
                     [](const Pair& a, const Pair& b) { return a.distance < b.distance; });
    std::vector<char> used(tracks_.size(), 0), held(blobs.size(), 0);
    for (const Pair& p : pairs) {
        if (used[p.track] || held[p.blob]) continue;
        used[p.track] = 1;
        held[p.blob] = tracks_[p.track].id != 0 ? 2 : 1;
    }
    return held;
}

std::vector<Blob> PersonTracker::gather(std::vector<Blob> blobs, TimeNs time) const {
    // Large ones first; pieces join the nearest of them.
    std::stable_sort(blobs.begin(), blobs.end(),
                     [](const Blob& a, const Blob& b) { return a.area_m2 > b.area_m2; });
    const std::vector<char> held = held_by_tracks(blobs, time);
    std::vector<Blob> mains, pieces, owners;
    for (std::size_t b = 0; b < blobs.size(); ++b) {
        if (held[b] != 2) continue;
        Blob box;  // without its cells
        box.min_m = blobs[b].min_m;
        box.max_m = blobs[b].max_m;
        owners.push_back(std::move(box));
    }
    for (std::size_t b = 0; b < blobs.size(); ++b) {
        Blob& blob = blobs[b];
        // What touches somebody known and shows no head is his, or what he carries.
        const auto belongs = [&] {
            return std::any_of(owners.begin(), owners.end(), [&](const Blob& owner) {
                return apart(blob, owner, 0.15f, 0.35f) < 1;
            });
        };
        const bool main = held[b] == 2 || blob.shared || independent(blob) ||
                          ((held[b] != 0 || test_.accepts(blob)) && !belongs());
        (main ? mains : pieces).push_back(std::move(blob));
    }
    for (Blob& piece : pieces) {
        if (piece.area_m2 < 0.003f) continue;
        const bool loose = piece.known < 0.5f;
        Blob* best = nullptr;
        float least = 1;
        for (Blob& main : mains) {
            const float d = apart(piece, main, 0.15f, 0.35f);
            if (d < least && (!loose || trunk_of(main, piece) || limb_of(main, piece))) {
                least = d;
                best = &main;
            }
        }
        if (!best) continue;
        best->cells.insert(best->cells.end(), piece.cells.begin(), piece.cells.end());
        best->heads.insert(best->heads.end(), piece.heads.begin(), piece.heads.end());
    }
    for (Blob& main : mains) main.measure();
    return mains;
}

void PersonTracker::sight(PersonTrack& track, Blob blob, TimeNs time) {
    const double dt = std::max(to_seconds(time - track.seen), 1e-3);
    const glm::vec3 at = camera_of(blob.centroid_m);
    const bool whole = blob.area_m2 > kPartial * track.area_m2 && !blob.shared;
    if (whole) {
        const auto w = static_cast<float>(1 - std::exp(-dt / kVelocityS));
        const glm::vec3 measured = (at - track.at_m) / static_cast<float>(dt);
        track.velocity_m_s = glm::mix(track.velocity_m_s, measured, w);
        const float speed = glm::length(track.velocity_m_s);
        if (speed > kMaxSpeedMS) track.velocity_m_s *= kMaxSpeedMS / speed;
    } else {
        track.velocity_m_s *= static_cast<float>(std::exp(-dt / kCoastS));
    }
    // Sizes grow at once and shrink slowly: a hidden person is not a small one.
    const auto w = static_cast<float>(1 - std::exp(-dt / (whole ? kTypicalS : 10 * kTypicalS)));
    const auto follow = [&](float& typical, float now) { typical += w * (now - typical); };
    if (!blob.shared) {
        follow(track.area_m2, blob.area_m2);
        follow(track.core_m2, area_around(blob, blob.centroid_m, kCoreM));
        follow(track.top_m, blob.max_m.y);
    }
    if (blob.changed > kStirred) ++track.stirs;
    // What somebody else hides more and more moves its centroid as well.
    const bool away = glm::distance(at, track.born_at_m) > kMovedM && track.stirs > 0;
    track.moved = track.moved || track.stirs >= kStirs || away;
    if (!blob.heads.empty()) {
        // Of several the nearest to where it was; a new one's best.
        const glm::vec3 expected = upright_of(track.expected_head_m(time));
        const BlobHead* own = &blob.heads.front();
        for (const BlobHead& h : blob.heads) {
            const bool better = track.head_seen == 0 ? h.score > own->score
                                                     : glm::distance(h.upright_m, expected) <
                                                           glm::distance(own->upright_m, expected);
            if (better) own = &h;
        }
        track.head_m = camera_of(own->upright_m);
        track.head_seen = std::max<TimeNs>(time, 1);
        track.head_hits += weight(blob, *own);
        ++track.head_pictures;
    } else {
        track.head_m += at - track.at_m;
    }
    track.at_m = at;
    track.seen = time;
    ++track.sightings;
    track.blob = std::move(blob);
}

void PersonTracker::begin(Blob blob, TimeNs time) {
    PersonTrack track;
    track.at_m = camera_of(blob.centroid_m);
    track.born_at_m = track.at_m;
    track.area_m2 = blob.area_m2;
    track.core_m2 = area_around(blob, blob.centroid_m, kCoreM);
    track.top_m = blob.max_m.y;
    track.born = track.seen = time;
    track.sightings = 1;
    for (const BlobHead& head : blob.heads) {
        if (track.head_seen != 0 && head.score < blob.head_score()) continue;
        track.head_m = camera_of(head.upright_m);
        track.head_seen = std::max<TimeNs>(time, 1);
        track.head_hits = weight(blob, head);
        track.head_pictures = 1;
    }
    track.doubted = std::any_of(doubted_m_.begin(), doubted_m_.end(), [&](const glm::vec3& d) {
        return level_distance(d, blob.centroid_m) < 0.4f;
    });
    track.blob = std::move(blob);
    tracks_.push_back(std::move(track));
}

double PersonTracker::cost(const PersonTrack& track, const Blob& blob, TimeNs time) const {
    const double unseen = to_seconds(time - track.seen);
    const double gate = std::min(static_cast<double>(options_.gate_m + options_.speed_m_s * unseen),
                                 static_cast<double>(options_.max_gate_m));
    const glm::vec3 expected = upright_of(track.expected_m(time));
    double level = level_distance(expected, blob.centroid_m);
    double head_height = 0;
    if (track.head_seen != 0 && !blob.heads.empty()) {
        const glm::vec3 head = upright_of(track.expected_head_m(time));
        double nearest = 1e9;
        for (const BlobHead& h : blob.heads) {
            const double d = level_distance(head, h.upright_m);
            if (d >= nearest) continue;
            nearest = d;
            head_height = std::abs(upright_of(track.head_m).y - h.upright_m.y);
        }
        level = std::min(level, 0.5 * (level + nearest));
    }
    const double size = std::abs(std::log(blob.area_m2 / track.area_m2));
    if (level > gate || (track.id == 0 && size > kOtherSize)) return kNoPair;
    // Somebody else of another height came where he was lost.
    if (track.seen < last_ && unseen > 0.5 * kRecentS && head_height > 0.2) return kNoPair;
    const double up = std::abs(expected.y - blob.centroid_m.y);
    const double top = std::abs(track.top_m - blob.max_m.y);
    const double stranger = track.id == 0 ? 0.5 : 0.0;
    return level + 0.4 * up + 0.3 * std::min(top, 0.5) + 0.1 * std::min(size, 2.0) + stranger;
}

bool PersonTracker::beside_someone(const Blob& blob, TimeNs time) const {
    return std::any_of(tracks_.begin(), tracks_.end(), [&](const PersonTrack& t) {
        return t.id != 0 && t.seen == time && t.blob && apart(blob, *t.blob, 0.3f, 0.35f) < 1;
    });
}

void PersonTracker::update(std::vector<Blob> blobs, const glm::mat3& upright, float height_m,
                           TimeNs time) {
    upright_ = upright;
    height_m_ = height_m;
    for (PersonTrack& t : tracks_) t.blob.reset();
    note_second_heads(blobs, time);
    blobs = gather(split_shared(std::move(blobs), time), time);

    const int rows = static_cast<int>(tracks_.size()), columns = static_cast<int>(blobs.size());
    std::vector<double> costs;
    for (const PersonTrack& track : tracks_) {
        for (const Blob& blob : blobs) costs.push_back(cost(track, blob, time));
    }
    const std::vector<int> pairs = assign(costs, rows, columns);
    std::vector<char> used(blobs.size(), 0);
    for (std::size_t t = 0; t < pairs.size(); ++t) {
        if (pairs[t] < 0) continue;
        const auto b = static_cast<std::size_t>(pairs[t]);
        used[b] = 1;
        sight(tracks_[t], std::move(blobs[b]), time);
    }
    std::erase_if(tracks_, [&](const PersonTrack& t) {
        const double unseen = to_seconds(time - t.seen);
        return t.id == 0 ? unseen > 0 : unseen > options_.keep_s;
    });
    for (std::size_t b = 0; b < blobs.size(); ++b) {
        if (used[b] || tracks_.size() >= kMaxTracks || !test_.accepts(blobs[b])) continue;
        if (!independent(blobs[b]) && beside_someone(blobs[b], time)) continue;
        begin(std::move(blobs[b]), time);
    }
    confirm(time);
    drop_furniture(time);
    last_ = time;
}

}  // namespace kino
