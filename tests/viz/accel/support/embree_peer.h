#pragma once

#include <memory>
#include <span>

#include "viz/accel/traverse.h"

namespace kino::test {

/// Embree 3, by Intel: the independent witness of our rays, and the rival in the bench. Built
/// robust, which is its watertight mode; single rays. Ids are the triangles' places in the soup.
class EmbreePeer {
  public:
    /// `threads` that build; rays are traced by the caller.
    explicit EmbreePeer(std::span<const Triangle> triangles, int threads = 1);
    ~EmbreePeer();
    EmbreePeer(EmbreePeer&&) = delete;

    /// Of hits at equal t any one; v and w as ours.
    [[nodiscard]] RayHit closest_hit(const Ray& ray) const;
    [[nodiscard]] bool any_hit(const Ray& ray) const;

  private:
    struct State;
    std::unique_ptr<State> state_;
};

}  // namespace kino::test
