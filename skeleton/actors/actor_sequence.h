#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "base/body.h"
#include "base/camera_model.h"
#include "base/error.h"
#include "base/image.h"
#include "skeleton/forest/body_part.h"
#include "skeleton/forest/training_images.h"

namespace kino {

class ActorMotion;  // actor_motion.h

/// One picture of a synthetic take with its truth.
struct ActorFrame {
    TimeNs time = 0;
    Image<float> depth_m;       ///< as a Kinect v1 would read it; 0: no reading
    Image<std::uint8_t> part;   ///< BodyPart of whoever is seen, kNotBody elsewhere
    Image<std::uint8_t> actor;  ///< 1, 2, ... for the people; 0 nobody
    BodyFrame truth;            ///< depth-camera space; ids 1, 2, ...; tracked: the joint's flesh
                                ///< is seen; inferred: hidden or outside the picture. People
                                ///< of whom nothing is in view are left out
};

/// Varied people in varied rooms before a computed Kinect v1. Every frame depends on the options
/// and its index alone.
struct ActorTake {
    std::uint64_t seed = 1;  ///< shape, clothing, furniture, place: all that is not set below
    std::string motion;      ///< a name from actor_motions(); empty: drawn from the seed
    int actors = 1;
    bool furniture = true;
    bool noise = true;
    int width = 320, height = 240;
    std::optional<double> distance_m;  ///< of the first actor at the start
    double lead_in_s = 0;              ///< so long the empty room is shown first
    /// Instead of a named motion, e.g. posed_motion() of a test's own script.
    std::shared_ptr<const ActorMotion> script = nullptr;
};

class ActorSequence {
  public:
    virtual ~ActorSequence() = default;
    [[nodiscard]] static Result<std::unique_ptr<ActorSequence>> create(const ActorTake& take);

    [[nodiscard]] virtual int frames() const = 0;
    [[nodiscard]] virtual double rate_hz() const = 0;
    [[nodiscard]] virtual const RigParameters& rig() const = 0;
    /// `index` in [0, frames()); reuses the memory of `out`.
    virtual void render(int index, ActorFrame& out) = 0;
};

/// Names of all motions that takes may ask for.
[[nodiscard]] std::vector<std::string> actor_motions();

}  // namespace kino
