#pragma once

#include <cstdint>
#include <glm/vec3.hpp>
#include <optional>
#include <vector>

#include "apps/stage/cast.h"
#include "apps/stage/stage.h"
#include "apps/stage/swarm.h"
#include "apps/stage/trail.h"
#include "base/pose.h"

namespace kino {

/// What a director is told of one moment.
struct StageMoment {
    double dt_s = 0;                    ///< since the last one; brought into 0 to 0.1
    const BodyFrame* bodies = nullptr;  ///< depth-camera space; null: nobody
    Pose world_from_depth;
    glm::dvec3 middle_m{0};  ///< world: where people are to be expected while nobody was seen
    /// Where the stage is to stand; empty: it finds out. Not for scenes with a place of their own.
    std::optional<Pose> world_from_stage;
    const std::vector<std::uint32_t>* leads = nullptr;  ///< bodies that have roles; null: all
    std::size_t other_lights = 0;  ///< that somebody else adds: swarms that fill up count them
};

/// Leads a stage: where it stands, what burns, what moves. The same moments give the same bits; no
/// clock is asked. Nothing that it puts into a scene is not finite, whatever joints are.
class Director {
  public:
    explicit Director(StageSet stage);

    /// A new source: everybody leaves, and the stage stands nowhere yet.
    void reset();
    void step(const StageMoment& moment);
    /// Linear colours that swarms and lights with a palette take instead of their own, in turn;
    /// empty: their own again. They change over within half a second of steps.
    void set_tint(std::vector<glm::vec3> colors);
    /// Meshes, materials, lights, colours. The live node and the bodies are left as they are,
    /// except that bodies are taken out where the scene shows no skeleton.
    void fill(Scene& scene);

    [[nodiscard]] const SceneFile& file() const { return stage_.file; }
    [[nodiscard]] const Cast& cast() const { return cast_; }
    /// A person was found, and the stage stands under them for good.
    [[nodiscard]] bool found_person() const { return found_person_; }
    /// Empty before the first step.
    [[nodiscard]] const std::optional<Pose>& world_from_stage() const { return world_from_stage_; }
    /// World; where the scene's view begins. Only once the stage stands.
    [[nodiscard]] glm::dvec3 eye_m() const;
    [[nodiscard]] glm::dvec3 target_m() const;
    /// That burn now, without directional ones.
    [[nodiscard]] std::size_t local_lights() const { return local_lights_; }

  private:
    struct Led {  ///< what one joint of one person leads by one role
        double presence = 0;
        std::optional<Trail> trail;
    };

    void place(const StageMoment& moment);
    void tint(double dt_s);
    void light_standing();
    void follow(std::size_t role, double dt_s, const std::vector<std::uint32_t>* leads);
    void follow_trail(std::size_t role, Led& led, std::uint32_t first_id);
    void follow_prop(std::size_t role, const Led& led, const glm::dvec3& at_m,
                     std::uint32_t first_id);
    void let_swarm(std::size_t swarm, double dt_s, std::uint32_t first_id);
    void add_node(std::uint32_t id, const StandingMesh& mesh, const glm::dmat4& world_from_object,
                  std::uint32_t material);
    void add_light(const SceneLight& file, const glm::dvec3& world_m, const glm::dvec3& direction,
                   const glm::vec3& color, double weight);
    [[nodiscard]] glm::dvec3 turned(const glm::dvec3& stage_direction) const;

    StageSet stage_;
    std::vector<Swarm> swarms_;
    std::vector<std::vector<double>> swarm_presence_;
    std::vector<std::vector<glm::vec3>> swarm_colors_, role_colors_;  ///< linear, as they are now
    std::optional<std::vector<glm::vec3>> tint_;                      ///< once one was asked for
    std::vector<std::vector<Led>> led_;  ///< by role; by place and joint
    Cast cast_;
    std::optional<Pose> world_from_stage_;
    bool found_person_ = false;
    double time_s_ = 0;
    std::size_t local_lights_ = 0;
    std::vector<Light> lights_;
    std::vector<MeshNode> nodes_;
    bool shown_ = true;                                    ///< the last step's scene was asked for
    std::vector<std::optional<glm::dmat4>> before_, now_;  ///< world_from_object by id
};

}  // namespace kino
