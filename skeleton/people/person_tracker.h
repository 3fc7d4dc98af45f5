#pragma once

#include <array>
#include <cstdint>
#include <glm/mat3x3.hpp>
#include <glm/vec3.hpp>
#include <optional>
#include <vector>

#include "base/time.h"
#include "skeleton/people/blob.h"
#include "skeleton/people/person.h"

namespace kino {

struct TrackerOptions {
    double keep_s = 3;  ///< an identity is kept so long without being seen
    /// Somebody new is told of after this long and in two pictures; at once if a head on a body
    /// stands before a room that is known.
    double confirm_s = 0.1;
    /// Where no background is known, what shows no head must move to be told of, and is taken for
    /// furniture after `headless_s`; what showed a head now and then, after `patience_s`; what has
    /// a clear and steady one is told of and doubted after `still_s`. Not for a moving sensor,
    /// which sees everything move.
    bool ask_for_motion = true;
    double headless_s = 2;
    double patience_s = 5;
    double still_s = 120;
    float gate_m = 0.45f;    ///< how far from the expected place, at least
    float speed_m_s = 2.5f;  ///< by which the gate grows with the time since last seen
    float max_gate_m = 2.2f;
};

/// One person through time. Places are in depth-camera space.
struct PersonTrack {
    std::uint32_t id = 0;  ///< 0: not confirmed yet
    std::uint8_t slot = 0;
    glm::vec3 at_m{0}, velocity_m_s{0};
    float area_m2 = 0;  ///< typical visible area
    float core_m2 = 0;  ///< typical area within 0.28 m of the centroid, seen from above
    float top_m = 0;    ///< typical highest point, upright
    TimeNs born = 0, seen = 0;
    int sightings = 0;
    glm::vec3 born_at_m{0};
    glm::vec3 head_m{0};       ///< as last seen
    TimeNs head_seen = 0;      ///< 0: never
    int head_pictures = 0;     ///< with a head
    float head_hits = 0;       ///< pictures with a head; an unsure one counts less
    int stirs = 0;             ///< pictures in which part of it had changed
    bool moved = false;        ///< has stirred, or has left the place of birth
    bool doubted = false;      ///< where something was that turned out to be furniture
    std::optional<Blob> blob;  ///< in the present picture
    [[nodiscard]] bool in_front() const { return blob && blob->known > 0.5f; }
    [[nodiscard]] glm::vec3 expected_m(TimeNs time) const;
    [[nodiscard]] glm::vec3 expected_head_m(TimeNs time) const;
};

/// Gives blobs to people: constant-velocity prediction, best assignment by distance and size.
class PersonTracker {
  public:
    PersonTracker(const TrackerOptions& options, const PersonTest& test)
        : options_(options), test_(test) {}

    void reset();
    void set_test(const PersonTest& test) { test_ = test; }

    /// Takes the blobs of one picture; times rise. `upright`: upright from camera axes;
    /// `height_m`: the camera's above the floor.
    void update(std::vector<Blob> blobs, const glm::mat3& upright, float height_m, TimeNs time);

    [[nodiscard]] const std::vector<PersonTrack>& tracks() const { return tracks_; }

    /// False for what may be furniture and has had its time: it may become background.
    [[nodiscard]] bool protects(const PersonTrack& track, TimeNs time) const;

    /// Upright places of the heads of those who were seen lately, where they should be now.
    [[nodiscard]] std::vector<glm::vec3> expected_heads(TimeNs time) const;

  private:
    /// A head on somebody who already has one: perhaps two people came in as one surface.
    struct SecondHead {
        glm::vec3 upright_m{0};
        TimeNs first = 0, last = 0;
        int hits = 0;
    };
    void note_second_heads(const std::vector<Blob>& blobs, TimeNs time);
    [[nodiscard]] std::vector<glm::vec3> seeds_in(const Blob& blob, TimeNs time) const;
    [[nodiscard]] std::vector<char> held_by_tracks(const std::vector<Blob>& blobs,
                                                   TimeNs time) const;
    [[nodiscard]] double cost(const PersonTrack& track, const Blob& blob, TimeNs time) const;
    [[nodiscard]] bool beside_someone(const Blob& blob, TimeNs time) const;
    void drop_furniture(TimeNs time);
    [[nodiscard]] std::vector<Blob> split_shared(std::vector<Blob> blobs, TimeNs time) const;
    [[nodiscard]] std::vector<Blob> gather(std::vector<Blob> blobs, TimeNs time) const;
    void sight(PersonTrack& track, Blob blob, TimeNs time);
    void begin(Blob blob, TimeNs time);
    [[nodiscard]] bool sure_at_once(const PersonTrack& track) const;
    void confirm(TimeNs time);
    [[nodiscard]] float weight(const Blob& blob, const BlobHead& head) const;
    [[nodiscard]] bool proven(const PersonTrack& track) const;
    [[nodiscard]] glm::vec3 upright_of(const glm::vec3& camera) const;
    [[nodiscard]] glm::vec3 camera_of(const glm::vec3& upright) const;

    TrackerOptions options_;
    PersonTest test_;
    std::vector<PersonTrack> tracks_;
    std::vector<SecondHead> second_heads_;
    std::vector<glm::vec3> doubted_m_;  // upright
    TimeNs last_ = 0;                   // the picture before
    glm::mat3 upright_{1};
    float height_m_ = 0;
    std::uint32_t next_id_ = 1;
};

}  // namespace kino
