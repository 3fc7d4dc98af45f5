#include "skeleton/tracking/body_tracker.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <map>
#include <utility>
#include <vector>

#include "base/check.h"
#include "skeleton/filters/filter_bank.h"
#include "skeleton/forest/body_depth.h"
#include "skeleton/forest/body_part.h"
#include "skeleton/forest/part_labeller.h"
#include "skeleton/forest/tree_pruning.h"
#include "skeleton/tracking/person_skeleton.h"
#include "skeleton/tracking/stage_clock.h"

namespace kino {
namespace {

constexpr double kPointsAimed = 1800;  // labelled pixels of one person
constexpr TimeNs kBridgedNs = 1'000'000'000;

bool is_seated_joint(std::size_t j) {
    return j >= static_cast<std::size_t>(Joint::shoulder_center) &&
           j <= static_cast<std::size_t>(Joint::hand_right);
}

// Bones as long as the model has them: a filter makes those that turn fast too short.
void restore_lengths(const Body& raw, Body& filtered) {
    for (std::size_t j = 1; j < kJointCount; ++j) {
        const auto parent = static_cast<std::size_t>(kJointParent[j]);
        if (filtered.joints[j].state == JointState::lost ||
            filtered.joints[parent].state == JointState::lost ||
            raw.joints[j].state == JointState::lost ||
            raw.joints[parent].state == JointState::lost) {
            continue;
        }
        const float length = glm::length(raw.joints[j].position_m - raw.joints[parent].position_m);
        glm::vec3& at = filtered.joints[j].position_m;
        const glm::vec3 way = at - filtered.joints[parent].position_m;
        const float now = glm::length(way);
        if (now > 1e-4f) at = filtered.joints[parent].position_m + way * (length / now);
    }
}

}  // namespace

struct BodyTracker::State {
    State(PeopleFinder people_finder, FilterBank filter_bank, const Forest& f,
          const BodyTrackerOptions& o, Image<RayXy> r)
        : finder(std::move(people_finder)),
          filters(std::move(filter_bank)),
          labeller(f),
          options(o),
          rays(std::move(r)),
          camera(PinholeFit::of(rays)) {}

    PeopleFinder finder;
    FilterBank filters;
    PartLabeller labeller;
    BodyTrackerOptions options;
    Image<RayXy> rays;
    PinholeFit camera;
    SkeletonOptions skeleton_options;

    PeopleFrame people;
    BodyFrame raw;
    TrackingTimes times;
    std::map<std::uint32_t, PersonSkeleton> skeletons;

    Image<std::uint16_t> depth_mm;
    BodyDepth body_depth;
    PartLabels labels;
    PartPoints points;
    PartModes modes;
    FreeSpace space;

    [[nodiscard]] std::vector<std::uint32_t> chosen() const;
    void forget();
    void fit_person(const Image<float>& depth_m, const Person& person, TimeNs time, Body& body);
    int label_person(const Image<float>& depth_m, const Person& person);
};

// Whoever has a skeleton keeps it; free places go to the largest.
std::vector<std::uint32_t> BodyTracker::State::chosen() const {
    std::vector<std::uint32_t> ids;
    const auto room = static_cast<std::size_t>(std::max(options.tracked_in_full, 0));
    for (const Person& person : people.people) {
        if (ids.size() < room && skeletons.contains(person.id)) ids.push_back(person.id);
    }
    while (ids.size() < room) {
        const Person* largest = nullptr;
        for (const Person& person : people.people) {
            if (std::ranges::find(ids, person.id) != ids.end()) continue;
            if (!largest || person.area_m2 > largest->area_m2) largest = &person;
        }
        if (!largest) break;
        ids.push_back(largest->id);
    }
    return ids;
}

void BodyTracker::State::forget() {
    std::erase_if(skeletons, [this](const auto& entry) {
        const std::uint32_t id = entry.first;
        return std::ranges::none_of(people.people, [id](const Person& p) { return p.id == id; }) &&
               std::ranges::none_of(people.lost, [id](const LostPerson& p) { return p.id == id; });
    });
}

int BodyTracker::State::label_person(const Image<float>& depth_m, const Person& person) {
    const PixelBox& box = person.box;
    const int width = box.x1 - box.x0, height = box.y1 - box.y0;
    depth_mm.resize(width, height);
    for (int y = 0; y < height; ++y) {
        const float* from = depth_m.row(box.y0 + y) + box.x0;
        std::uint16_t* to = depth_mm.row(y);
        for (int x = 0; x < width; ++x) {
            const float mm = from[x] * 1000;
            to[x] = mm > 0 && mm < 32000 ? static_cast<std::uint16_t>(mm + 0.5f) : 0;
        }
    }
    int step = options.step_px;
    if (step <= 0) {
        step = std::clamp(static_cast<int>(std::lround(std::sqrt(person.pixels / kPointsAimed))), 1,
                          8);
    }
    const ImageView<const std::uint8_t> mask{people.labels.row(box.y0) + box.x0, width, height,
                                             people.labels.width()};
    const Image<std::uint16_t>& depth = depth_mm;
    body_depth.set(depth.view(), mask, person.slot,
                   static_cast<double>(0.5f * (camera.fx + camera.fy)), step);
    labeller.label(body_depth, labels);
    points.clear();
    std::array<float, kForestMaxLabels> share{};
    for (std::size_t i = 0; i < body_depth.count(); ++i) {
        const int x = box.x0 + body_depth.x(i), y = box.y0 + body_depth.y(i);
        const RayXy& ray = rays.at(x, y);
        const float z = depth_m.at(x, y);
        labeller.shares(labels, i,
                        std::span(share).first(static_cast<std::size_t>(labeller.label_count())));
        points.add({ray.x * z, ray.y * z, z}, share);
    }
    return step;
}

void BodyTracker::State::fit_person(const Image<float>& depth_m, const Person& person, TimeNs time,
                                    Body& body) {
    StageClock clock;
    const int step = label_person(depth_m, person);
    times.parts += clock.lap();
    const float cell_tangent = static_cast<float>(step) / (0.5f * (camera.fx + camera.fy));
    modes.find(points, cell_tangent);
    times.proposals += clock.lap();
    space.set(depth_m, people.labels, person.slot, person.box, std::max(2, step),
              person.centroid_m.z);
    PersonView view;
    view.points = &points;
    view.modes = &modes;
    view.space = &space;
    view.camera = camera;
    view.floor = people.floor;
    view.cell_tangent = cell_tangent;
    view.cut_off = person.touches_border;
    auto& skeleton = skeletons.try_emplace(person.id, skeleton_options).first->second;
    if (skeleton.update(view, time)) {
        body.joints = skeleton.joints();
        if (options.mode == TrackingMode::seated) {
            for (std::size_t j = 0; j < kJointCount; ++j) {
                if (is_seated_joint(j)) continue;
                body.joints[j].state = JointState::lost;
                body.joints[j].confidence = 0;
            }
        }
    }
    times.fit += clock.lap();
}

BodyTracker::BodyTracker(std::unique_ptr<State> state) : state_(std::move(state)) {}
BodyTracker::~BodyTracker() = default;
BodyTracker::BodyTracker(BodyTracker&&) noexcept = default;
BodyTracker& BodyTracker::operator=(BodyTracker&&) noexcept = default;

Result<BodyTracker> BodyTracker::create(Image<RayXy> rays, std::shared_ptr<const Forest> forest,
                                        const BodyTrackerOptions& options) {
    KINO_CHECK(forest != nullptr);
    bool ours = forest->labels.size() == kBodyPartCount;
    for (std::size_t i = 0; ours && i < kBodyPartCount; ++i) {
        ours = forest->labels[i] == body_part_name(static_cast<BodyPart>(i));
    }
    if (!ours) {
        return fail("the forest's labels are not Kinoscope's body parts", "body tracker",
                    "use the forest that comes with Kinoscope, or train one with kinoscope-train");
    }
    Forest pruned;
    const Forest* used = forest.get();
    if (options.trees > 0 && options.trees < static_cast<int>(forest->trees.size())) {
        pruned = *forest;
        pruned.trees.resize(static_cast<std::size_t>(options.trees));
        used = &pruned;
    }
    if (options.max_depth > 0) {
        pruned = shallower(*used, options.max_depth);
        used = &pruned;
    }
    Image<RayXy> copy = rays;
    KINO_ASSIGN(PeopleFinder finder, PeopleFinder::create(std::move(rays), options.people));
    KINO_ASSIGN(FilterBank filters, FilterBank::create(options.filter));
    auto state = std::make_unique<State>(std::move(finder), std::move(filters), *used, options,
                                         std::move(copy));
    if (options.fit_rounds > 0) state->skeleton_options.rounds = options.fit_rounds;
    return BodyTracker(std::move(state));
}

void BodyTracker::track(const Image<float>& depth_m, TimeNs time,
                        const std::optional<glm::vec3>& specific_force, BodyFrame& out) {
    State& s = *state_;
    s.times = {};
    StageClock clock;
    if (time <= s.raw.time) {
        s.skeletons.clear();
    }
    s.finder.find(depth_m, time, specific_force, s.people);
    s.times.people = clock.lap();
    s.forget();
    s.raw.time = time;
    s.raw.bodies.clear();
    const std::vector<std::uint32_t> ids = s.chosen();
    std::erase_if(s.skeletons, [&](const auto& entry) {
        return ids.size() >= static_cast<std::size_t>(std::max(s.options.tracked_in_full, 0)) &&
               std::ranges::find(ids, entry.first) == ids.end();
    });
    for (const Person& person : s.people.people) {
        Body body;
        body.id = person.id;
        for (JointPosition& joint : body.joints) joint.position_m = person.centroid_m;
        if (std::ranges::find(ids, person.id) != ids.end()) {
            s.fit_person(depth_m, person, time, body);
        }
        JointPosition& center = body[Joint::hip_center];
        if (center.state == JointState::lost && s.options.mode == TrackingMode::full) {
            center = {person.centroid_m, JointState::inferred, 0.2f * person.confidence};
        }
        s.raw.bodies.push_back(body);
    }
    // Somebody who is hidden for a moment is still there.
    for (const LostPerson& lost : s.people.lost) {
        const auto found = s.skeletons.find(lost.id);
        if (found == s.skeletons.end() || time - lost.last_seen > kBridgedNs) continue;
        Body body;
        body.id = lost.id;
        body.joints = found->second.joints();
        for (JointPosition& joint : body.joints) {
            joint.state = JointState::inferred;
            joint.confidence = std::min(joint.confidence, 0.2f);
        }
        s.raw.bodies.push_back(body);
    }
    clock.lap();
    out = s.filters.update(s.raw);
    for (std::size_t i = 0; i < out.bodies.size(); ++i) {
        restore_lengths(s.raw.bodies[i], out.bodies[i]);
    }
    s.times.filter = clock.lap();
}

const PeopleFrame& BodyTracker::people() const {
    return state_->people;
}
const BodyFrame& BodyTracker::unfiltered() const {
    return state_->raw;
}
const TrackingTimes& BodyTracker::times() const {
    return state_->times;
}

void BodyTracker::reset() {
    state_->finder.reset();
    state_->skeletons.clear();
    state_->raw = {};
    // The name was good at creation.
    if (auto filters = FilterBank::create(state_->options.filter)) {
        state_->filters = std::move(*filters);
    }
}

}  // namespace kino
