#pragma once

#include <memory>
#include <optional>
#include <vector>

#include "apps/avatar/avatar.h"
#include "apps/demo/act.h"
#include "apps/demo/aura.h"
#include "apps/demo/balls.h"
#include "apps/demo/coach.h"
#include "apps/demo/curtain.h"
#include "apps/demo/demo_play.h"
#include "apps/demo/mirrored.h"
#include "apps/demo/painter.h"
#include "apps/demo/players.h"
#include "apps/demo/throws.h"
#include "apps/demo/turntable.h"

namespace kino {

/// The parts of the demo, which know nothing of each other, and what leads them.
struct DemoPlay::State {
    DemoOptions options;
    std::vector<demo::Act> acts;
    std::size_t act = 0, next_act = 0;

    Cast cast;
    demo::Players players;
    std::array<demo::Colors, demo::Players::kMost> colors;
    demo::Painter painter;
    demo::Balls balls;
    demo::Aura aura;
    demo::Throws throws;
    demo::Turntable turntable;
    demo::Curtain curtain;
    std::array<demo::Coach, demo::Players::kMost> coaches;
    demo::Coach usher;  ///< of who has not waved yet
    std::uint32_t ushered = 0;
    demo::SurfaceMirror mirror;
    std::unique_ptr<AvatarTroupe> avatars;  ///< null: none were asked for

    DemoPhase phase = DemoPhase::attract;
    bool lost = false;
    TimeNs time = 0;
    double time_s = 0;   ///< of the demo: moments' lengths
    double empty_s = 0;  ///< nobody was seen for so long
    double flash = 0;    ///< 1 when everything was cleared, 0 a moment later
    BodyFrame bodies;    ///< of this moment, mirrored if asked for
    std::vector<std::uint32_t> leads;
    Pose world_from_depth;
    Pose stands, stands_to;  ///< world from stage
    bool placed = false, found_person = false;
    bool following = false;  ///< the stage goes to where a visitor went
    std::vector<DemoEvent> events;
    DemoGuidance no_guidance;

    std::shared_ptr<const DepthSurface> seen, cut;  ///< the last surface, and people of it
    std::optional<LiveDepth> live;

    Scene scene, warm;
    bool warm_ready = false;
    double undrawn_s = 0;
    std::size_t local_lights = 0;
    std::vector<glm::vec3> ball_colors;
    std::shared_ptr<const MeshAsset> ball_mesh;

    explicit State(DemoOptions chosen);
    void reset();
    void step(const DemoMoment& moment);

    // demo_rules.cpp: what gestures do
    void hear(const GestureEvent& event);
    void hear_continuous(const GestureEvent& event);
    void engage(std::uint32_t id, bool as_primary);
    void change_scene(int by, std::uint32_t id);
    void change_palette(int by, std::uint32_t id);
    void throw_ball(const GestureEvent& event);
    void clear(std::uint32_t id);
    void praise(const GestureEvent& event);
    void log(const char* what, std::string detail, std::uint32_t id);
    [[nodiscard]] const CastMember* member(std::uint32_t id) const;
    [[nodiscard]] Joint seen_hand(Hand hand) const;

    // demo_stage.cpp: what is to be seen
    void find_place(const DemoMoment& moment);
    void run_stage(double dt_s, const DemoMoment& moment);
    void swap_act();
    void cut_people(const DemoMoment& moment);
    void compose(Scene& out, double light);
    void add_balls(Scene& out, std::uint32_t glow);
    [[nodiscard]] const demo::Act& now() const { return acts[act]; }
    [[nodiscard]] const Pose& world_from_stage() const;

    void guide(double dt_s, const DemoMoment& moment);
    void find_phase(double dt_s);
};

}  // namespace kino
