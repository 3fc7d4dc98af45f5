#include "skeleton/actors/actor_images.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/gtc/quaternion.hpp>

#include "base/check.h"
#include "skeleton/actors/actor_canvas.h"
#include "skeleton/actors/actor_stage.h"
#include "skeleton/actors/mesh_raster.h"
#include "skeleton/actors/pose_draw.h"
#include "skeleton/forest/body_part.h"

namespace kino {
namespace {

using glm::dvec3;

// What is drawn for a picture: one body and what surrounds it, as data.
struct Shot {
    Pose view_from_world;
    ActorBody body;
    std::vector<glm::vec3> posed;  // world
    std::vector<Primitive> solids;
    std::vector<std::pair<ActorBody, std::vector<glm::vec3>>> others;
    double wall_m = 10;
    double floor_cut_m = 0;
};

// How the person stands to the camera.
enum class Framing : std::uint8_t {
    whole,   ///< most of the body in view
    close,   ///< head to hips or knees: the picture's border cuts the rest
    behind,  ///< a desk or the back of a couch hides the lower half
};

struct View {
    dvec3 place_m;
    double height_m, aim_y_m, aim_error_rad;
};

View random_view(ActorRandom& random, const CameraModel& camera, Framing framing, double stature) {
    double d = random.chance(0.72) ? random.in(1.5, 3.5) : random.in(0.9, 4.5);
    double edge = random.chance(0.12) ? 0.56 : 0.33;
    View view{{},
              random.chance(0.7) ? random.in(0.6, 1.6) : random.in(0.5, 2.2),
              0.5 * stature,
              random.normal(0, 0.10)};
    if (framing == Framing::close) {
        d = random.in(0.70, 1.8);
        edge = random.chance(0.15) ? 0.5 : 0.2;
        view.height_m = random.in(0.6, 0.95) * stature;
        view.aim_y_m = random.in(0.66, 0.85) * stature;
        view.aim_error_rad = random.normal(0, 0.07);
    } else if (framing == Framing::behind) {
        d = random.in(1.0, 2.8);
        view.height_m = random.in(0.6, 1.8);
        view.aim_y_m = random.in(0.55, 0.8) * stature;
    }
    view.place_m = {random.in(-edge, edge) * camera.width / camera.fx * d, 0, -d};
    return view;
}

// A desk, a couch seen from behind, a counter: wide.
void add_barrier(ActorRandom& random, const dvec3& person, double top_m,
                 std::vector<Primitive>& out) {
    const double near = random.in(0.22, 0.55), deep = random.in(0.02, 0.3);
    const dvec3 half(random.in(0.5, 1.6), top_m / 2, deep / 2);
    const dvec3 at(person.x + random.in(-0.4, 0.4), top_m / 2, person.z + near + deep / 2);
    out.push_back(box(at, half, kPartThing, Covering::wood,
                      glm::mat3_cast(glm::angleAxis(random.normal(0, 0.15), dvec3(0, 1, 0)))));
}

Shot draw_shot(ActorRandom& random, const CameraModel& camera) {
    Shot shot;
    const ActorLook look = random_look(random.bits());
    shot.body = make_actor_body(look);
    const double frame = random.unit();
    const Framing framing = frame < 0.62   ? Framing::whole
                            : frame < 0.84 ? Framing::close
                                           : Framing::behind;
    const DrawnPose drawn = draw_pose(random);
    const View view = random_view(random, camera, framing, look.stature_m);
    const dvec3 place = view.place_m;
    const double facing = random.chance(0.65) ? random.in(-1.05, 1.05) : random.in(-M_PI, M_PI);
    // Towards the camera, wherever one stands.
    const double yaw = facing + std::atan2(-place.x, -place.z);
    ActorPose pose = turned(drawn.pose, yaw);
    pose.place_m = {place.x, place.z};
    const PosedBones bones = pose_actor(shot.body, pose, shot.posed);
    const auto joint = [&](Joint j) { return bones.joint_m[static_cast<std::size_t>(j)]; };

    const dvec3 middle = joint(Joint::spine);
    // Who sits or lies is looked at lower.
    const double lower = middle.y - 0.64 * look.stature_m;
    const double aim =
        std::atan2(view.height_m - view.aim_y_m - lower, -place.z) + view.aim_error_rad;
    shot.view_from_world = inverse(camera_pose(view.height_m, std::clamp(aim, -0.52, 0.52)));

    const dvec3 forward = turned(ActorPose{}, yaw).pelvis[2];
    if (drawn.seated && random.chance(0.9)) {
        const double seat = seat_height(shot.body, shot.posed);
        if (seat > 0.15)
            add_chair(random, middle, forward, seat + random.in(0, 0.015), shot.solids);
    }
    if (framing == Framing::behind) {
        const double hips = joint(Joint::hip_center).y, chest = joint(Joint::shoulder_center).y;
        add_barrier(random, place, std::max(0.2, glm::mix(hips, chest, random.in(-0.2, 0.45))),
                    shot.solids);
    } else if (random.chance(drawn.seated ? 0.2 : 0.04)) {
        add_table(random, place * random.in(0.45, 0.85), random.normal(0, 0.3), shot.solids);
    }
    if (random.chance(0.07)) {
        const double t = random.in(0.4, 0.9);
        add_thing(random, {place.x * t + random.in(-0.5, 0.5), 0, place.z * t}, shot.solids);
    }
    if (random.chance(0.05)) {  // something large held or standing close before the body
        const dvec3 half(random.in(0.08, 0.28), random.in(0.08, 0.25), random.in(0.03, 0.15));
        const dvec3 at =
            middle + forward * random.in(0.25, 0.42) + dvec3(0, random.in(-0.1, 0.3), 0);
        shot.solids.push_back(box(at, half, kPartThing, Covering::wood));
    }
    if (random.chance(0.05)) {
        shot.others.emplace_back(make_actor_body(random_look(random.bits())),
                                 std::vector<glm::vec3>{});
        ActorPose other = turned(draw_pose(random).pose, random.in(-M_PI, M_PI));
        other.place_m = {place.x + random.in(-0.7, 0.7), place.z + random.in(-0.7, 0.9)};
        pose_actor(shot.others.back().first, other, shot.others.back().second);
    }
    shot.wall_m = -place.z + random.in(0.4, 3.5);
    constexpr double kFar = 20;
    shot.solids.push_back(box({0, -0.5, 0}, {kFar, 0.5, kFar}, kPartFloor, Covering::floor));
    // The floor's neighbourhood is cut off the body by who finds people, by more or less.
    shot.floor_cut_m = random.chance(0.5) ? random.in(0.0, 0.05) : 0;
    return shot;
}

// Dark cloth and shiny things give no reading: a few blots without one.
void drop_blots(ActorRandom& random, const raycast::Rect& rect, Image<float>& depth_m) {
    const int blots = random.chance(0.25) ? 1 + static_cast<int>(random.below(6)) : 0;
    for (int i = 0; i < blots; ++i) {
        const double cx = random.in(rect.x0, rect.x1), cy = random.in(rect.y0, rect.y1);
        const double rx = random.in(1, 7), ry = random.in(1, 7), solid = random.in(0.5, 1.0);
        const int x0 = std::max(rect.x0, static_cast<int>(cx - rx)),
                  x1 = std::min(rect.x1 - 1, static_cast<int>(cx + rx));
        const int y0 = std::max(rect.y0, static_cast<int>(cy - ry)),
                  y1 = std::min(rect.y1 - 1, static_cast<int>(cy + ry));
        for (int y = y0; y <= y1; ++y) {
            for (int x = x0; x <= x1; ++x) {
                const double u = (x - cx) / rx, v = (y - cy) / ry;
                if (u * u + v * v < 1 && random.unit() < solid) depth_m.at(x, y) = 0;
            }
        }
    }
}

struct Studio {
    explicit Studio(int width, int height)
        : canvas(default_kinect1_rig(width, height)), depth_m(width, height) {}
    ActorCanvas canvas;
    Image<float> depth_m;
};

// Building the rays of a camera takes longer than a picture.
Studio& studio(int width, int height) {
    thread_local std::unique_ptr<Studio> mine;
    if (!mine || mine->depth_m.width() != width || mine->depth_m.height() != height) {
        mine = std::make_unique<Studio>(width, height);
    }
    return *mine;
}

// Draws and measures; false if too little of the body is seen.
bool take_picture(Shot& shot, ActorRandom& random, Studio& s, TrainingImage& out) {
    constexpr int kMinPixels = 250;
    std::vector<glm::vec3> view = shot.posed;
    to_view(shot.view_from_world, view);
    const CameraModel& camera = s.canvas.camera();
    raycast::Rect rect = mesh_bounds(view, camera);
    if (!any_pixel(rect)) return false;
    // Room for the shadow of what stands at the right.
    rect = intersect({rect.x0 - 4, rect.y0 - 4, rect.x1 + 24, rect.y1 + 4}, s.canvas.whole());
    s.canvas.clear(rect, static_cast<float>(shot.wall_m));
    std::vector<Primitive> solids;
    for (const Primitive& solid : shot.solids) solids.push_back(moved(solid, shot.view_from_world));
    s.canvas.draw(solids, kSceneId);
    s.canvas.draw(shot.body, view, 1);
    for (auto& [body, posed] : shot.others) {
        to_view(shot.view_from_world, posed);
        s.canvas.draw(body, posed, 2);
    }
    CanvasNoise noise;
    noise.sigma_steps = random.in(0.35, 0.6);
    noise.ragged = random.in(0.1, 0.4);
    s.canvas.measure(&noise, static_cast<std::uint32_t>(random.bits()), s.depth_m);

    drop_blots(random, rect, s.depth_m);

    const Pose world_from_view = inverse(shot.view_from_world);
    const glm::dvec3 up = glm::conjugate(world_from_view.rotation) * dvec3(0, 1, 0);
    const auto is_body = [&](int x, int y) {
        const float z = s.depth_m.at(x, y);
        if (!(z > 0) || actor_of(s.canvas.id().at(x, y)) != 1) return false;
        if (shot.floor_cut_m <= 0) return true;
        const dvec3 p =
            dvec3((x - camera.cx) / camera.fx, (y - camera.cy) / camera.fy, 1) * double(z);
        return glm::dot(up, p) + world_from_view.translation.y > shot.floor_cut_m;
    };
    raycast::Rect tight{rect.x1, rect.y1, rect.x0, rect.y0};
    int pixels = 0;
    for (int y = rect.y0; y < rect.y1; ++y) {
        for (int x = rect.x0; x < rect.x1; ++x) {
            if (!is_body(x, y)) continue;
            ++pixels;
            tight = {std::min(tight.x0, x), std::min(tight.y0, y), std::max(tight.x1, x + 1),
                     std::max(tight.y1, y + 1)};
        }
    }
    if (pixels < kMinPixels) return false;
    out.focal_px = camera.fx;
    out.depth_mm.resize(tight.x1 - tight.x0, tight.y1 - tight.y0);
    out.label.resize(tight.x1 - tight.x0, tight.y1 - tight.y0);
    for (int y = tight.y0; y < tight.y1; ++y) {
        for (int x = tight.x0; x < tight.x1; ++x) {
            const bool body = is_body(x, y);
            out.depth_mm.at(x - tight.x0, y - tight.y0) =
                body ? static_cast<std::uint16_t>(std::lround(s.depth_m.at(x, y) * 1000)) : 0;
            out.label.at(x - tight.x0, y - tight.y0) =
                body ? static_cast<std::uint8_t>(part_of(s.canvas.id().at(x, y))) : kNotBody;
        }
    }
    return true;
}

}  // namespace

Result<std::unique_ptr<ActorImages>> ActorImages::create(const ActorImagesOptions& options) {
    if (options.count < 1) return fail("there must be at least one picture", "actor images");
    for (const int size : {options.width, options.height}) {
        if (size < 64 || size > 2048 || size % 8 != 0) {
            return fail("sizes of pictures are multiples of 8 from 64 to 2048", "actor images");
        }
    }
    return std::unique_ptr<ActorImages>(new ActorImages(options));
}

std::vector<std::string> ActorImages::labels() const {
    std::vector<std::string> names;
    for (int i = 0; i < kBodyPartCount; ++i) {
        names.emplace_back(body_part_name(static_cast<BodyPart>(i)));
    }
    return names;
}

Result<void> ActorImages::load(std::int64_t index, TrainingImage& out) const {
    KINO_CHECK(index >= 0 && index < options_.count);
    Studio& s = studio(options_.width, options_.height);
    for (std::uint64_t attempt = 0;; ++attempt) {
        ActorRandom random{options_.held_out ? 0xBEADu : 0x7EA1u, options_.seed,
                           static_cast<std::uint64_t>(index), attempt};
        Shot shot = draw_shot(random, s.canvas.camera());
        if (take_picture(shot, random, s, out)) return {};
    }
}

}  // namespace kino
