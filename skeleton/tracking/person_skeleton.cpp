#include "skeleton/tracking/person_skeleton.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>

namespace kino {
namespace {

using glm::vec3;

constexpr double kFrameS = 1.0 / 30;
constexpr double kGapS = 0.4;  // after so long the last pose is only one guess among others

Bone bone_of(Segment s) {
    constexpr std::array<Bone, kSegmentCount> kOf = {
        Bone::head,       Bone::upper_arm_left,  Bone::forearm_left,
        Bone::hand_left,  Bone::upper_arm_right, Bone::forearm_right,
        Bone::hand_right, Bone::thigh_left,      Bone::shin_left,
        Bone::foot_left,  Bone::thigh_right,     Bone::shin_right,
        Bone::foot_right,
    };
    return kOf[static_cast<std::size_t>(s)];
}

// Which halves of which bones lie next to a joint.
struct Neighbour {
    Bone bone;
    bool low, high;
};
struct Neighbours {
    std::array<Neighbour, 4> bone;
    std::size_t count;
};

Neighbours neighbours(Joint joint) {
    const auto j = static_cast<int>(joint);
    if (joint == Joint::hip_center || joint == Joint::spine) {
        return {{{{Bone::belly_left, true, true}, {Bone::belly_right, true, true}}}, 2};
    }
    if (joint == Joint::shoulder_center) {
        return {{{{Bone::chest_left, true, false},
                  {Bone::chest_right, true, false},
                  {Bone::neck, true, true}}},
                3};
    }
    if (joint == Joint::head) return {{{{Bone::head, true, true}}}, 1};
    const int limb = (j - 4) / 4, k = (j - 4) % 4;
    const auto first = static_cast<Bone>(static_cast<int>(Bone::upper_arm_left) + 3 * limb);
    const auto bone = [first](int n) { return static_cast<Bone>(static_cast<int>(first) + n); };
    if (k == 0) return {{{{first, true, false}}}, 1};
    if (k == 3) return {{{{bone(2), true, true}}}, 1};
    return {{{{bone(k - 1), false, true}, {bone(k), true, false}}}, 2};
}

}  // namespace

JointedPose PersonSkeleton::predict(double dt_s) const {
    JointedPose pose = model_.pose;
    if (!moving_ || before_dt_s_ <= 0) return pose;
    const auto ahead = static_cast<float>(0.7 * std::min(dt_s / before_dt_s_, 2.0));
    pose.hips_m += (model_.pose.hips_m - before_.hips_m) * ahead;
    pose.pelvis =
        rotation_of(turn_of(model_.pose.pelvis * glm::transpose(before_.pelvis)) * ahead) *
        pose.pelvis;
    pose.chest = rotation_of(turn_of(model_.pose.chest * glm::transpose(before_.chest)) * ahead) *
                 pose.chest;
    for (std::size_t s = 0; s < kSegmentCount; ++s) {
        pose.direction[s] =
            unit_or(pose.direction[s] +
                        (model_.pose.direction[s] - before_.direction[s]) * (ahead * seen_[s]),
                    pose.direction[s]);
    }
    return pose;
}

FitPrior PersonSkeleton::prior_for(double dt_s) const {
    FitPrior prior;
    prior.known = true;
    prior.expected = predict(dt_s);
    const auto wider = static_cast<float>(std::clamp(std::sqrt(dt_s / kFrameS), 0.7, 5.0));
    prior.hips_sigma_m = 0.04f * wider;
    prior.turn_sigma = 0.12f * wider;
    for (std::size_t s = 0; s < kSegmentCount; ++s) {
        // Feet show few points and turn slowly, but tell front from back while that is open.
        const auto segment = static_cast<Segment>(s);
        const bool foot = segment == Segment::foot_left || segment == Segment::foot_right;
        const bool calm = foot && settled_s_ > 2;
        prior.direction_sigma[s] = (calm ? 0.1f : 0.12f + 0.3f * seen_[s]) * wider;
    }
    prior.shape_mean = mean_;
    prior.shape_information = information_;
    return prior;
}

bool PersonSkeleton::restart(const FitEvidence& evidence, bool compare) {
    FitOptions rough;
    rough.rounds = 4;
    rough.shape = false;
    rough.start_far_m = 0.2f;
    rough.mode_weight = 3;
    FitPrior none;
    none.shape_mean = mean_;
    none.shape_information = information_;
    JointedModel best;
    FitResult best_result;
    bool found = false;
    for (const float turn : {0.0f, 3.14159265f, 1.0f, -1.0f}) {
        const PoseGuess guess = guess_pose(*evidence.modes, model_.shape, evidence.floor.up, turn);
        if (!guess.usable) return false;
        JointedModel candidate;
        candidate.shape = model_.shape;
        candidate.pose = guess.pose;
        candidate.place();
        FitResult result;
        fit_.fit(evidence, none, rough, candidate, result);
        if (!found || result.total() < best_result.total()) {
            best = candidate;
            best_result = result;
            found = true;
        }
    }
    FitOptions fine;
    fine.rounds = options_.rounds + 2;
    fine.shape = !compare;
    fine.start_far_m = 0.15f;
    fit_.fit(evidence, none, fine, best, best_result);
    constexpr float kBetter = 0.75f;  // a pose that was carried here is worth something
    if (compare && best_result.total() > kBetter * result_.total()) return false;
    model_ = best;
    result_ = best_result;
    moving_ = false;
    settled_s_ = 0;
    ++restarts_;
    return true;
}

void PersonSkeleton::try_limbs(const FitEvidence& evidence) {
    // Only where the parts say that the limb is somewhere else.
    for (int limb = 0; limb < 4; ++limb) {
        JointedModel other = model_;
        if (!guess_limb(*evidence.modes, limb, other.pose)) continue;
        const int first = 1 + 3 * limb;
        float turned = 1;
        for (int k = 0; k < 2; ++k) {
            const auto s = static_cast<std::size_t>(first + k);
            turned = std::min(turned, glm::dot(other.pose.direction[s], model_.pose.direction[s]));
        }
        if (turned > 0.8f) continue;
        other.place();
        FitResult now, then;
        fit_.judge(evidence, model_, now);
        fit_.judge(evidence, other, then);
        if (then.total() < 0.97f * now.total()) model_ = other;
    }
}

void PersonSkeleton::learn(double dt_s) {
    if (result_.on_model < 0.6f || dt_s <= 0) return;
    // Errors of frames that follow each other are alike: a second of them counts once.
    const auto gain = static_cast<float>(std::min(dt_s, 0.2));
    for (int k = 0; k < kShapeCount; ++k) {
        const auto i = static_cast<std::size_t>(k);
        const double known = fit_.shape_information(k);
        const double news = known - static_cast<double>(information_[i]);
        if (news < 200) continue;  // worse than 7 %: it was hardly seen
        learned_s_[i] += dt_s;
        mean_[i] = model_.shape.factor[i];
        information_[i] += gain * static_cast<float>(std::min(news, 4000.0));
        if (k < kLengthCount && learned_s_[i] >= options_.learn_s && anchor_[i] == 0) {
            anchor_[i] = mean_[i];
        }
    }
}

bool PersonSkeleton::update(const PersonView& view, TimeNs time) {
    const double dt_s = known_ ? static_cast<double>(time - time_) * 1e-9 : 0;
    FitEvidence evidence;
    view.points->choose(options_.points_per_part, points_);
    evidence.points = points_;
    evidence.modes = view.modes;
    evidence.space = view.space;
    evidence.camera = view.camera;
    evidence.floor = view.floor;
    evidence.cell_tangent = view.cell_tangent;
    evidence.per_part = options_.points_per_part;
    ++frames_;
    if (!known_) {
        mean_.fill(1);
        if (!restart(evidence, false)) return false;
        restarts_ = 0;
        known_ = true;
        before_ = model_.pose;
        before_dt_s_ = 0;
    } else {
        const JointedPose last = model_.pose;
        const FitPrior prior = prior_for(dt_s);
        model_.pose = prior.expected;
        model_.place();
        try_limbs(evidence);
        FitOptions options;
        options.rounds = options_.rounds;
        fit_.fit(evidence, prior, options, model_, result_);
        before_ = last;
        before_dt_s_ = dt_s;
        moving_ = dt_s < kGapS;
        const bool bad = result_.on_model < 0.7f || result_.free > 0.12f || dt_s > kGapS;
        settled_s_ += dt_s;
        learn(dt_s);
        if (bad || frames_ % 16 == 0) static_cast<void>(restart(evidence, true));
    }
    for (std::size_t i = 0; i < kLengthCount; ++i) {
        if (anchor_[i] == 0) continue;
        model_.shape.factor[i] =
            std::clamp(model_.shape.factor[i], anchor_[i] * (1 - options_.hold),
                       anchor_[i] * (1 + options_.hold));
    }
    model_.place();
    time_ = time;
    describe(evidence, dt_s);
    return true;
}

void PersonSkeleton::describe(const FitEvidence& evidence, double dt_s) {
    const auto blend = static_cast<float>(std::clamp(dt_s / 0.15, 0.2, 1.0));
    const auto expected = [&](Bone bone) {
        return ModelFit::expected_points(evidence, model_, bone);
    };
    for (std::size_t s = 0; s < kSegmentCount; ++s) {
        const Bone bone = bone_of(static_cast<Segment>(s));
        const float share =
            static_cast<float>(result_.support[static_cast<std::size_t>(bone)].points) /
            (2 * expected(bone));
        seen_[s] = glm::mix(seen_[s], std::min(1.0f, 2 * share), blend);
    }
    for (std::size_t j = 0; j < kJointCount; ++j) {
        const Neighbours near = neighbours(static_cast<Joint>(j));
        float have = 0, want = 0;
        for (std::size_t k = 0; k < near.count; ++k) {
            const Neighbour& n = near.bone[k];
            const BoneSupport& support = result_.support[static_cast<std::size_t>(n.bone)];
            const float half = expected(n.bone);
            if (n.low) have += std::min(support.low, half);
            if (n.high) have += std::min(support.high, half);
            want += half * static_cast<float>((n.low ? 1 : 0) + (n.high ? 1 : 0));
        }
        const float share = std::min(1.0f, have / (0.5f * want));
        JointPosition& joint = joints_[j];
        joint.position_m = model_.node[j];
        // Hysteresis, so that states do not flicker.
        const bool was = joint.state == JointState::tracked;
        joint.state = share > (was ? 0.25f : 0.4f) ? JointState::tracked : JointState::inferred;
        const float fits = std::clamp(1.2f - 0.2f * result_.cost, 0.2f, 1.0f);
        if (joint.state == JointState::tracked) {
            trust_[j] = share * fits;
        } else {
            trust_[j] = std::min(trust_[j], 0.5f) * (1 - 0.1f * blend);
        }
        joint.confidence = std::clamp(trust_[j], 0.02f, 1.0f);
    }
}

}  // namespace kino
