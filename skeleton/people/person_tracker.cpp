#include "skeleton/people/person_tracker.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/matrix.hpp>

#include "skeleton/people/assignment.h"

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
constexpr std::size_t kMaxTracks = 12;  // confirmed or not

float level_distance(const glm::vec3& a, const glm::vec3& b) {
    return std::hypot(a.x - b.x, a.z - b.z);
}

float core_area(const Blob& blob, const glm::vec3& middle) {
    float sum = 0;
    for (const CellPoint& c : blob.cells) {
        if (level_distance(c.upright_m, middle) < PersonTracker::kCoreM) sum += c.area_m2;
    }
    return sum;
}

float gap(float min_a, float max_a, float min_b, float max_b) {
    return std::max({0.0f, min_b - max_a, min_a - max_b});
}

}  // namespace

glm::vec3 PersonTrack::expected_m(TimeNs time) const {
    // Velocity fades: the path is v times the integral of exp(-t / T).
    const double dt = to_seconds(std::max<TimeNs>(time - seen, 0));
    return at_m + velocity_m_s * static_cast<float>(kCoastS * (1 - std::exp(-dt / kCoastS)));
}

void PersonTracker::reset() {
    tracks_.clear();
}

glm::vec3 PersonTracker::upright_of(const glm::vec3& camera) const {
    return upright_ * camera + glm::vec3(0, height_m_, 0);
}

std::vector<glm::vec3> PersonTracker::expectations(TimeNs time) const {
    std::vector<glm::vec3> out;
    for (const PersonTrack& t : tracks_) out.push_back(upright_of(t.expected_m(time)));
    return out;
}

std::vector<Blob> PersonTracker::split_shared(std::vector<Blob> blobs, TimeNs time) const {
    const std::vector<glm::vec3> expected = expectations(time);
    std::vector<Blob> out;
    for (Blob& blob : blobs) {
        std::vector<glm::vec3> seeds;
        for (std::size_t t = 0; t < tracks_.size() && blob.area_m2 > 0.2f; ++t) {
            const PersonTrack& track = tracks_[t];
            if (track.id == 0 || to_seconds(time - track.seen) > 1.5) continue;
            const bool apart = std::all_of(seeds.begin(), seeds.end(), [&](const glm::vec3& s) {
                return level_distance(s, expected[t]) > 0.2f;
            });
            if (apart && core_area(blob, expected[t]) > 0.4f * track.core_m2) {
                seeds.push_back(expected[t]);
            }
        }
        if (seeds.size() < 2) {
            out.push_back(std::move(blob));
            continue;
        }
        std::vector<Blob> parts(seeds.size());
        for (const CellPoint& c : blob.cells) {
            std::size_t nearest = 0;
            for (std::size_t s = 1; s < seeds.size(); ++s) {
                if (level_distance(c.upright_m, seeds[s]) <
                    level_distance(c.upright_m, seeds[nearest])) {
                    nearest = s;
                }
            }
            parts[nearest].cells.push_back(c);
        }
        for (Blob& part : parts) {
            if (part.cells.empty()) continue;
            part.measure();
            part.shared = true;
            out.push_back(std::move(part));
        }
    }
    return out;
}

std::vector<Blob> PersonTracker::gather(std::vector<Blob> blobs, TimeNs time) const {
    // Large ones first; small pieces of known foreground join the nearest of them.
    std::stable_sort(blobs.begin(), blobs.end(),
                     [](const Blob& a, const Blob& b) { return a.area_m2 > b.area_m2; });
    const std::vector<glm::vec3> expected = expectations(time);
    std::vector<Blob> mains, pieces;
    for (Blob& blob : blobs) {
        const bool expected_here =
            std::any_of(expected.begin(), expected.end(), [&](const glm::vec3& e) {
                return level_distance(e, blob.centroid_m) < options_.gate_m;
            });
        const bool taken = std::any_of(mains.begin(), mains.end(), [&](const Blob& m) {
            return level_distance(m.centroid_m, blob.centroid_m) < 0.3f;
        });
        const bool main = test_.accepts(blob) || blob.shared ||
                          (expected_here && !taken && test_.accepts_part(blob));
        (main ? mains : pieces).push_back(std::move(blob));
    }
    for (Blob& piece : pieces) {
        if (piece.known < 0.5f || piece.area_m2 < 0.003f) continue;
        Blob* best = nullptr;
        float least = 1;
        for (Blob& main : mains) {
            const float level =
                std::hypot(gap(piece.min_m.x, piece.max_m.x, main.min_m.x, main.max_m.x),
                           gap(piece.min_m.z, piece.max_m.z, main.min_m.z, main.max_m.z));
            const float up = gap(piece.min_m.y, piece.max_m.y, main.min_m.y, main.max_m.y);
            // Up and down further than sideways: a table hides a person's middle.
            const float d = std::hypot(level / 0.15f, up / 0.35f);
            if (d < least) {
                least = d;
                best = &main;
            }
        }
        if (best) best->cells.insert(best->cells.end(), piece.cells.begin(), piece.cells.end());
    }
    for (Blob& main : mains) main.measure();
    return mains;
}

void PersonTracker::sight(PersonTrack& track, Blob blob, TimeNs time) {
    const double dt = std::max(to_seconds(time - track.seen), 1e-3);
    const glm::vec3 at = glm::transpose(upright_) * (blob.centroid_m - glm::vec3(0, height_m_, 0));
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
    track.at_m = at;
    // Sizes grow at once and shrink slowly: a hidden person is not a small one.
    const auto w = static_cast<float>(1 - std::exp(-dt / (whole ? kTypicalS : 10 * kTypicalS)));
    const auto follow = [&](float& typical, float now) { typical += w * (now - typical); };
    if (!blob.shared) {
        follow(track.area_m2, blob.area_m2);
        follow(track.core_m2, core_area(blob, blob.centroid_m));
        follow(track.top_m, blob.max_m.y);
    }
    if (blob.changed > kStirred) ++track.stirs;
    track.moved =
        track.moved || track.stirs >= kStirs || glm::distance(at, track.born_at_m) > kMovedM;
    track.seen = time;
    ++track.sightings;
    track.blob = std::move(blob);
}

void PersonTracker::begin(Blob blob, TimeNs time) {
    PersonTrack track;
    track.at_m = glm::transpose(upright_) * (blob.centroid_m - glm::vec3(0, height_m_, 0));
    track.born_at_m = track.at_m;
    track.area_m2 = blob.area_m2;
    track.core_m2 = core_area(blob, blob.centroid_m);
    track.top_m = blob.max_m.y;
    track.born = track.seen = time;
    track.sightings = 1;
    track.blob = std::move(blob);
    tracks_.push_back(std::move(track));
}

bool PersonTracker::proven(const PersonTrack& track) const {
    return !options_.ask_for_motion || track.moved || track.in_front();
}

bool PersonTracker::protects(const PersonTrack& track, TimeNs time) const {
    return track.id != 0 || proven(track) || to_seconds(time - track.born) < options_.patience_s;
}

void PersonTracker::confirm(TimeNs time) {
    for (PersonTrack& track : tracks_) {
        if (track.id != 0 || track.seen != time || track.sightings < 2 ||
            to_seconds(time - track.born) < options_.confirm_s || !proven(track)) {
            continue;
        }
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

void PersonTracker::update(std::vector<Blob> blobs, const glm::mat3& upright, float height_m,
                           TimeNs time) {
    upright_ = upright;
    height_m_ = height_m;
    for (PersonTrack& t : tracks_) t.blob.reset();
    blobs = gather(split_shared(std::move(blobs), time), time);

    const std::vector<glm::vec3> expected = expectations(time);
    const int rows = static_cast<int>(tracks_.size()), columns = static_cast<int>(blobs.size());
    std::vector<double> cost;
    for (std::size_t t = 0; t < tracks_.size(); ++t) {
        const PersonTrack& track = tracks_[t];
        const double unseen = to_seconds(time - track.seen);
        const double gate =
            std::min(static_cast<double>(options_.gate_m + options_.speed_m_s * unseen),
                     static_cast<double>(options_.max_gate_m));
        for (const Blob& blob : blobs) {
            const double level = level_distance(expected[t], blob.centroid_m);
            const double up = std::abs(expected[t].y - blob.centroid_m.y);
            const double top = std::abs(track.top_m - blob.max_m.y);
            const double size = std::abs(std::log(blob.area_m2 / track.area_m2));
            const double stranger = track.id == 0 ? 0.5 : 0.0;
            const double sum =
                level + 0.4 * up + 0.3 * std::min(top, 0.5) + 0.1 * std::min(size, 2.0) + stranger;
            cost.push_back(level <= gate ? sum : kNoPair);
        }
    }
    const std::vector<int> pairs = assign(cost, rows, columns);
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
        if (!used[b] && tracks_.size() < kMaxTracks && test_.accepts(blobs[b])) {
            begin(std::move(blobs[b]), time);
        }
    }
    confirm(time);
}

}  // namespace kino
