#include "skeleton/tracking/model_fit.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>

#include "skeleton/tracking/body_limits.h"
#include "skeleton/tracking/surface.h"

namespace kino {
namespace {

using glm::vec3;

constexpr float kSurfaceSigmaM = 0.02f;  // clothes and cones instead of flesh
constexpr float kChoiceSigmaM = 0.04f;   // when a point chooses its bone
constexpr float kGapCost = 6;            // no gap counts more
constexpr float kLabelCost = 1.0f;
constexpr float kPointsPerBone = 25;  // more do not know more: their errors are alike
constexpr float kModeSigmaM = 0.06f;
constexpr float kSureModeM2 = 0.004f;  // half a hand
// What is not seen of a limb. Tried on furnished takes of training motions.
constexpr float kHiddenLegSigma = 0.15f, kHiddenArmSigma = 0.6f;
constexpr float kMirrorLeg = 1.0f, kMirrorArm = 0.5f;  // as the other side is, or as at rest
constexpr float kLegsApart = 0.8f;                     // in sums of their radii

struct Choice {
    SurfaceGap gap;
    float cost = 1e9f;
    float gap_cost = 0;
    int candidate = 0;
    Bone bone = Bone::head;
};

Choice choose(const JointedModel& model, const PartPoint& point) {
    Choice best;
    for (int k = 0; k < point.count; ++k) {
        const PartCandidate& candidate = point.candidate[static_cast<std::size_t>(k)];
        const float label = kLabelCost * candidate.cost;
        if (label >= best.cost) continue;
        const PartPlace& place = part_place(static_cast<BodyPart>(candidate.part));
        const SurfaceGap gap = surface_gap(model, place.bone, place.from, place.to, point.at_m);
        const float relative = gap.gap_m / kChoiceSigmaM;
        const float gap_cost = std::min(0.5f * relative * relative, kGapCost);
        if (label + gap_cost < best.cost) {
            best = {gap, label + gap_cost, gap_cost, k, place.bone};
        }
    }
    return best;
}

// Places of the model that must not be where the picture shows nothing.
struct Probe {
    Bone bone;
    float t;
};
constexpr std::array<Probe, 41> kProbes = [] {
    std::array<Probe, 41> probes{};
    std::size_t n = 0;
    for (int b = static_cast<int>(Bone::upper_arm_left); b < kBoneCount; ++b) {
        for (int k = 1; k <= 3; ++k) {
            probes[n++] = {static_cast<Bone>(b), static_cast<float>(k) / 3};
        }
    }
    probes[n++] = {Bone::head, 0};
    for (int s = 0; s < 2; ++s) {
        probes[n++] = {s == 0 ? Bone::upper_arm_left : Bone::upper_arm_right, 0.0f};
        probes[n++] = {s == 0 ? Bone::thigh_left : Bone::thigh_right, 0.0f};
    }
    return probes;
}();

struct ProbeGap {
    float gap_m = 0;
    vec3 normal{0};
};

ProbeGap probe_gap(const FitEvidence& evidence, const JointedModel& model, const Probe& probe) {
    const BoneShape& shape = bone_shape(probe.bone);
    const vec3 q = glm::mix(model.node[shape.from], model.node[shape.to], probe.t);
    if (!(q.z > 0.2f)) return {};
    const SpaceView view = evidence.space->at(evidence.camera.pixel(q));
    if (view.kind == SpaceView::free && view.depth_m > q.z - 0.10f) {
        const vec3 way(view.to_own_px.x / evidence.camera.fx * q.z,
                       view.to_own_px.y / evidence.camera.fy * q.z, 0);
        const float length = glm::length(way);
        if (length > 1e-6f) return {length, way / length};
    }
    if (view.kind == SpaceView::own) {
        const float least = view.depth_m + 0.3f * model.radius_m(probe.bone, probe.t);
        if (q.z < least - 0.04f) return {least - q.z, vec3(0, 0, 1)};
    }
    return {};
}

}  // namespace

void ModelFit::add_points(const FitEvidence& evidence, const JointedModel& model, float far_m) {
    const std::size_t n = evidence.points.size();
    chosen_.resize(n);
    // The last round's counts serve: they change little.
    std::array<int, kBoneCount> count{};
    const float far2 = 1 / (far_m * far_m);
    for (std::size_t i = 0; i < n; ++i) {
        const PartPoint& point = evidence.points[i];
        const Choice choice = choose(model, point);
        const auto bone = static_cast<std::size_t>(choice.bone);
        ++count[bone];
        const float robust = 1 / (1 + choice.gap.gap_m * choice.gap.gap_m * far2);
        const float alike =
            std::min(1.0f, kPointsPerBone / static_cast<float>(std::max(on_bone_[bone], 1)));
        const float weight = robust * robust * alike / (kSurfaceSigmaM * kSurfaceSigmaM);
        const BoneShape& shape = bone_shape(choice.bone);
        const float radius =
            shape.radius_from_m + (shape.radius_to_m - shape.radius_from_m) * choice.gap.t;
        system_.add_on_bone(choice.bone, choice.gap.t, choice.gap.normal, radius, choice.gap.gap_m,
                            weight);
    }
    on_bone_ = count;
    for (std::size_t k = 1; k < kSegmentCount; ++k) {
        const std::size_t b = static_cast<std::size_t>(Bone::upper_arm_left) + k - 1;
        seen_[k] = std::min(1.0f, static_cast<float>(count[b]) /
                                      expected_points(evidence, model, static_cast<Bone>(b)));
    }
}

void ModelFit::add_modes(const FitEvidence& evidence, const JointedModel& model, float weight) {
    for (std::size_t p = 0; p < kBodyPartCount; ++p) {
        const auto& modes = evidence.modes->of(static_cast<BodyPart>(p));
        if (modes.empty()) continue;
        const PartPlace& place = part_place(static_cast<BodyPart>(p));
        const BoneShape& shape = bone_shape(place.bone);
        const vec3 q = glm::mix(model.node[shape.from], model.node[shape.to], place.middle);
        // The nearest of the modes that are not much weaker than the best.
        const PartMode* nearest = nullptr;
        float least = 0;
        for (const PartMode& mode : modes) {
            if (mode.weight_m2 < 0.4f * modes[0].weight_m2) break;
            const float d = glm::length(mode.center_m - q);
            if (!nearest || d < least) {
                nearest = &mode;
                least = d;
            }
        }
        const float sure = std::min(1.0f, modes[0].weight_m2 / kSureModeM2);
        const float robust = 1 / (1 + least * least / (0.25f * 0.25f));
        const float w = weight * sure * robust * robust / (kModeSigmaM * kModeSigmaM);
        const vec3 away = nearest->center_m - q;
        for (int k = 0; k < 3; ++k) {
            vec3 n(0);
            n[k] = 1;
            system_.add_on_bone(place.bone, place.middle, n, 0, away[k], w);
        }
    }
}

void ModelFit::add_space(const FitEvidence& evidence, const JointedModel& model) {
    constexpr float kSpaceSigmaM = 0.02f;
    for (const Probe& probe : kProbes) {
        const ProbeGap gap = probe_gap(evidence, model, probe);
        if (gap.gap_m <= 0) continue;
        const float robust = 1 / (1 + gap.gap_m * gap.gap_m / (0.15f * 0.15f));
        system_.add_on_bone(probe.bone, probe.t, gap.normal, 0, gap.gap_m,
                            robust / (kSpaceSigmaM * kSpaceSigmaM));
    }
    if (!evidence.floor.known()) return;
    for (const Bone foot : {Bone::foot_left, Bone::foot_right}) {
        const BoneShape& shape = bone_shape(foot);
        for (const float t : {0.0f, 1.0f}) {
            const vec3 q = model.node[t > 0 ? shape.to : shape.from];
            const float height = glm::dot(evidence.floor.up, q) + evidence.floor.height_m;
            const float low = 0.03f - height;
            if (low > 0) {
                system_.add_on_bone(foot, t, evidence.floor.up, 0, std::min(low, 0.2f),
                                    evidence.floor.confidence / (0.02f * 0.02f));
            }
        }
    }
}

void ModelFit::pull_direction(const JointedModel& model, Segment segment, const vec3& target,
                              int frame_unknown, double weight) {
    const auto s = static_cast<std::size_t>(segment);
    const vec3 away = model.pose.direction[s] - target;
    const int first = kDirectionUnknown + 2 * static_cast<int>(segment);
    for (int k = 0; k < 3; ++k) {
        vec3 e(0);
        e[k] = 1;
        const vec3 turned = glm::cross(target, e);  // row k of d(-turn x target)/d turn
        const auto t0 = static_cast<double>(model.tangent[2 * s][k]);
        const auto t1 = static_cast<double>(model.tangent[2 * s + 1][k]);
        if (frame_unknown >= 0) {
            system_.add({{first, t0},
                         {first + 1, t1},
                         {frame_unknown, -static_cast<double>(turned.x)},
                         {frame_unknown + 1, -static_cast<double>(turned.y)},
                         {frame_unknown + 2, -static_cast<double>(turned.z)}},
                        static_cast<double>(away[k]), weight);
        } else {
            system_.add({{first, t0}, {first + 1, t1}}, static_cast<double>(away[k]), weight);
        }
    }
}

// The less of a limb is seen, the more it is where limbs tend to be: as the other side is, if that
// is seen, or hanging.
void ModelFit::pull_to_rest(const JointedModel& model, const RestDirection& rest) {
    const auto s = static_cast<std::size_t>(rest.segment);
    vec3 target = rest.target;
    int frame_unknown = rest.frame_unknown;
    float weight = 1 / (rest.sigma * rest.sigma);
    if (s > 0 && (s - 1) % 3 < 2) {  // hands and feet follow what they hang on
        const bool leg = rest.segment >= Segment::thigh_left;
        const std::size_t other = (s - 1) % 6 < 3 ? s + 3 : s - 3;
        const float hidden = (1 - seen_[s]) / (leg ? kHiddenLegSigma : kHiddenArmSigma);
        weight += hidden * hidden;
        const float mirror = (leg ? kMirrorLeg : kMirrorArm) * (1 - seen_[s]) * seen_[other];
        if (mirror > 0) {
            const glm::mat3& frame = leg ? model.pose.pelvis : model.pose.chest;
            vec3 across = glm::transpose(frame) * model.pose.direction[other];
            across.x = -across.x;
            target = unit_or(glm::mix(target, frame * across, mirror), target);
            frame_unknown = leg ? kPelvisUnknown : kChestUnknown;
        }
    }
    pull_direction(model, rest.segment, target, frame_unknown, static_cast<double>(weight));
}

void ModelFit::keep_legs_apart(const JointedModel& model) {
    constexpr float kSigmaM = 0.03f;
    for (int k = 0; k < 2; ++k) {
        const auto left = static_cast<Bone>(static_cast<int>(Bone::thigh_left) + k);
        const auto right = static_cast<Bone>(static_cast<int>(Bone::thigh_right) + k);
        const BoneShape &a = bone_shape(left), &b = bone_shape(right);
        for (const float t : {0.5f, 1.0f}) {
            const vec3 away = glm::mix(model.node[a.from], model.node[a.to], t) -
                              glm::mix(model.node[b.from], model.node[b.to], t);
            const float distance = glm::length(away);
            const float least = kLegsApart * (model.radius_m(left, t) + model.radius_m(right, t));
            if (distance >= least || distance < 1e-4f) continue;
            const vec3 n = away / distance;
            const float half = 0.5f * (least - distance);
            system_.add_on_bone(left, t, n, 0, half, 1 / (kSigmaM * kSigmaM));
            system_.add_on_bone(right, t, -n, 0, half, 1 / (kSigmaM * kSigmaM));
        }
    }
}

void ModelFit::add_body_knowledge(const FitEvidence& evidence, const JointedModel& model) {
    const JointedPose& pose = model.pose;
    // The spine bends, but not much.
    const vec3 bend = turn_of(pose.chest * glm::transpose(pose.pelvis));
    for (int k = 0; k < 3; ++k) {
        system_.add({{kChestUnknown + k, 1.0}, {kPelvisUnknown + k, -1.0}},
                    static_cast<double>(bend[k]), 1 / (0.25 * 0.25));
    }
    // Most people are upright.
    const vec3 lean = glm::cross(evidence.floor.up, pose.pelvis[1]);
    for (int k = 0; k < 3; ++k) {
        system_.add({{kPelvisUnknown + k, 1.0}}, static_cast<double>(lean[k]), 1 / (1.0 * 1.0));
    }
    for (const RestDirection& rest : rest_directions(pose)) pull_to_rest(model, rest);
    keep_legs_apart(model);
    constexpr double kLimitWeight = 1 / (0.1 * 0.1);
    for (const DirectionLimit& limit : direction_limits(pose)) {
        const auto s = static_cast<std::size_t>(limit.segment);
        const float over = glm::dot(limit.outward, pose.direction[s]) - limit.most;
        if (over <= 0) continue;
        const int first = kDirectionUnknown + 2 * static_cast<int>(limit.segment);
        system_.add(
            {{first, static_cast<double>(glm::dot(limit.outward, model.tangent[2 * s]))},
             {first + 1, static_cast<double>(glm::dot(limit.outward, model.tangent[2 * s + 1]))}},
            static_cast<double>(over), kLimitWeight);
    }
    // Arms do not go through the trunk.
    for (int side = 0; side < 2; ++side) {
        const auto fore = static_cast<Bone>(static_cast<int>(Bone::forearm_left) + 3 * side);
        const auto hand = static_cast<Bone>(static_cast<int>(Bone::hand_left) + 3 * side);
        for (const Probe& probe :
             {Probe{fore, 0.0f}, Probe{fore, 0.5f}, Probe{fore, 1.0f}, Probe{hand, 0.6f}}) {
            const BoneShape& shape = bone_shape(probe.bone);
            const vec3 q = glm::mix(model.node[shape.from], model.node[shape.to], probe.t);
            for (const Bone trunk :
                 {Bone::chest_left, Bone::belly_left, Bone::chest_right, Bone::belly_right}) {
                const BoneShape& flesh = bone_shape(trunk);
                const vec3 a = model.node[flesh.from], along = model.node[flesh.to] - a;
                const float t =
                    std::clamp(glm::dot(q - a, along) / glm::dot(along, along), 0.0f, 1.0f);
                const vec3 away = q - (a + along * t);
                const float distance = glm::length(away);
                const float least =
                    model.radius_m(trunk, t) + 0.7f * model.radius_m(probe.bone, probe.t);
                if (distance >= least || distance < 1e-4f) continue;
                const float deep = least - distance;
                system_.add_on_bone(probe.bone, probe.t, away / distance, 0, deep,
                                    1 / (0.03f * 0.03f));
            }
        }
    }
}

void ModelFit::add_prior(const FitPrior& prior, const JointedModel& model, bool shape) {
    if (shape) {
        // All of a person is larger or smaller together, and each part a little on its own.
        constexpr double kTogether = 0.09 * 0.09, kAlone = 0.03 * 0.03, kGirthAlone = 0.07 * 0.07;
        const auto block = [&](int first, int count, double together, double alone) {
            const double shared = together / (alone + count * together);
            for (int a = 0; a < count; ++a) {
                const auto ia = static_cast<std::size_t>(first + a);
                const double da = static_cast<double>(model.shape.factor[ia]) - 1;
                system_.add({{kShapeUnknown + first + a, 1.0}}, da, 1 / alone);
            }
            double sum = 0;
            std::array<FitSystem::Term, kLengthCount> terms{};
            for (int a = 0; a < count; ++a) {
                sum +=
                    static_cast<double>(model.shape.factor[static_cast<std::size_t>(first + a)]) -
                    1;
                terms[static_cast<std::size_t>(a)] = {kShapeUnknown + first + a, 1.0};
            }
            system_.add(
                std::span<const FitSystem::Term>(terms).first(static_cast<std::size_t>(count)), sum,
                -shared / alone);
        };
        block(0, kLengthCount, kTogether, kAlone);
        block(kLengthCount, kGirthCount, kTogether, kGirthAlone);
        for (int k = 0; k < kShapeCount; ++k) {
            const auto i = static_cast<std::size_t>(k);
            system_.add({{kShapeUnknown + k, 1.0}},
                        static_cast<double>(model.shape.factor[i] - prior.shape_mean[i]),
                        static_cast<double>(prior.shape_information[i]));
        }
    }
    if (!prior.known) return;
    const JointedPose &pose = model.pose, &expected = prior.expected;
    const vec3 moved = pose.hips_m - expected.hips_m;
    const vec3 pelvis = turn_of(pose.pelvis * glm::transpose(expected.pelvis));
    const vec3 chest = turn_of(pose.chest * glm::transpose(expected.chest));
    const auto weight = [](float sigma) { return 1 / static_cast<double>(sigma * sigma); };
    for (int k = 0; k < 3; ++k) {
        system_.add({{k, 1.0}}, static_cast<double>(moved[k]), weight(prior.hips_sigma_m));
        system_.add({{kPelvisUnknown + k, 1.0}}, static_cast<double>(pelvis[k]),
                    weight(prior.turn_sigma));
        system_.add({{kChestUnknown + k, 1.0}}, static_cast<double>(chest[k]),
                    weight(prior.turn_sigma));
    }
    for (std::size_t s = 0; s < kSegmentCount; ++s) {
        const bool leg = s >= static_cast<std::size_t>(Segment::thigh_left);
        const glm::mat3& frame = leg ? pose.pelvis : pose.chest;
        const glm::mat3& before = leg ? expected.pelvis : expected.chest;
        pull_direction(model, static_cast<Segment>(s),
                       frame * (glm::transpose(before) * expected.direction[s]),
                       leg ? kPelvisUnknown : kChestUnknown, weight(prior.direction_sigma[s]));
    }
}

void ModelFit::fit(const FitEvidence& evidence, const FitPrior& prior, const FitOptions& options,
                   JointedModel& model, FitResult& result) {
    free_ = options.shape ? kUnknowns : kPoseUnknowns;
    on_bone_.fill(static_cast<int>(kPointsPerBone));
    for (int round = 0; round < options.rounds; ++round) {
        const float done = options.rounds > 1
                               ? static_cast<float>(round) / static_cast<float>(options.rounds - 1)
                               : 1.0f;
        model.linearize();
        system_.clear();
        add_points(evidence, model, glm::mix(options.start_far_m, options.far_m, done));
        if (evidence.modes) add_modes(evidence, model, options.mode_weight * (1 - 0.8f * done));
        if (evidence.space) add_space(evidence, model);
        add_body_knowledge(evidence, model);
        add_prior(prior, model, options.shape);
        system_.gather(model);
        model.move(system_.solve(free_, 1.0));
        for (float& factor : model.shape.factor) factor = std::clamp(factor, 0.55f, 1.6f);
    }
    model.place();
    judge(evidence, model, result);
}

double ModelFit::shape_information(int factor) {
    return free_ == kUnknowns ? system_.information(kShapeUnknown + factor, free_) : 0;
}

void ModelFit::judge(const FitEvidence& evidence, const JointedModel& model, FitResult& result) {
    result = {};
    float sum = 0, side = 0;
    int on = 0, sided = 0;
    for (const PartPoint& point : evidence.points) {
        const Choice choice = choose(model, point);
        sum += choice.cost;
        const auto chosen =
            static_cast<BodyPart>(point.candidate[static_cast<std::size_t>(choice.candidate)].part);
        if (choice.gap_cost < 2) {
            ++on;
            BoneSupport& support = result.support[static_cast<std::size_t>(choice.bone)];
            ++support.points;
            (choice.gap.t < 0.5f ? support.low : support.high) += 1;
        }
        const BodyPart other = mirrored(chosen);
        if (other == chosen) continue;
        for (int k = 0; k < point.count; ++k) {
            const PartCandidate& c = point.candidate[static_cast<std::size_t>(k)];
            if (static_cast<BodyPart>(c.part) != other) continue;
            side += c.cost - point.candidate[static_cast<std::size_t>(choice.candidate)].cost;
        }
        ++sided;
    }
    const auto n = static_cast<float>(std::max<std::size_t>(evidence.points.size(), 1));
    result.cost = sum / n;
    result.on_model = static_cast<float>(on) / n;
    result.side = sided > 0 ? side / static_cast<float>(sided) : 0;
    if (!evidence.space) return;
    int wrong = 0;
    for (const Probe& probe : kProbes) {
        wrong += probe_gap(evidence, model, probe).gap_m > 0.05f ? 1 : 0;
    }
    result.free = static_cast<float>(wrong) / static_cast<float>(kProbes.size());
}

float ModelFit::expected_points(const FitEvidence& evidence, const JointedModel& model, Bone bone) {
    const BoneShape& shape = bone_shape(bone);
    const vec3 a = model.node[shape.from], b = model.node[shape.to];
    const float cell = std::max(0.3f, 0.5f * (a.z + b.z)) * evidence.cell_tangent;
    const float across = std::hypot(b.x - a.x, b.y - a.y), radius = model.radius_m(bone, 0.5f);
    return std::clamp((across + radius) * radius / (cell * cell), 1.0f,
                      static_cast<float>(evidence.per_part));
}

}  // namespace kino
