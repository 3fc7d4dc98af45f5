#pragma once

#include <vector>

#include "tests/skeleton/gestures/stage.h"

/// Scripted motion: each fixed gesture, and everyday arms that make none.
namespace kino::test {

using K = GestureKind;

inline const ArmPose kHangL = arm(0, {0.15, -1, 0}, {0.05, -1, 0.2});
inline const ArmPose kHangR = arm(1, {0.15, -1, 0}, {0.05, -1, 0.2});
inline const ArmPose kReadyL = arm(0, {0.3, -0.8, 0.5}, {0, 0.1, 1});
inline const ArmPose kReadyR = arm(1, {0.3, -0.8, 0.5}, {0, 0.1, 1});
inline const ArmPose kOutR = arm(1, {0.6, -0.45, 0.65}, {0.75, 0.1, 0.7});
inline const ArmPose kAcrossR = arm(1, {0.0, -0.5, 0.85}, {-0.7, 0.1, 0.7});
inline const ArmPose kHighR = arm(1, {0.2, 0.1, 1}, {0.0, 0.9, 0.6});
inline const ArmPose kLowR = arm(1, {0.2, -0.55, 0.8}, {0.0, -0.3, 0.95});

inline std::vector<Key> stroke(const ArmPose& from, const ArmPose& to, double seconds) {
    return {{0, kHangL, kHangR},
            {0.5, kHangL, kHangR},
            {1.3, kHangL, from},
            {1.8, kHangL, from},
            {1.8 + seconds, kHangL, to},
            {2.4 + seconds, kHangL, to},
            {3.2 + seconds, kHangL, kHangR},
            {5, kHangL, kHangR}};
}

/// A script and exactly what it shall give.
struct Script {
    const char* name;
    PoseAt pose;
    std::vector<GestureKind> expected;
    double seconds = 10;
};

inline std::vector<Script> scripts() {
    const auto spread = [](double s) {  // two hands from near to far
        return std::vector<Key>{{0, kHangL, kHangR},
                                {0.5, kHangL, kHangR},
                                {1.3, arm(0, {0.1, -0.7, 0.7}, {-0.2, 0.1, 1}),
                                 arm(1, {0.1, -0.7, 0.7}, {-0.2, 0.1, 1})},
                                {2.0, arm(0, {0.1, -0.7, 0.7}, {-0.2, 0.1, 1}),
                                 arm(1, {0.1, -0.7, 0.7}, {-0.2, 0.1, 1})},
                                {2.0 + s, arm(0, {0.5, -0.6, 0.6}, {0.7, 0.1, 0.8}),
                                 arm(1, {0.5, -0.6, 0.6}, {0.7, 0.1, 0.8})},
                                {2.6 + s, arm(0, {0.5, -0.6, 0.6}, {0.7, 0.1, 0.8}),
                                 arm(1, {0.5, -0.6, 0.6}, {0.7, 0.1, 0.8})},
                                {3.4 + s, kHangL, kHangR},
                                {6, kHangL, kHangR}};
    };
    return {
        {"wave", scripted(Motion::wave), {K::wave}},
        {"swipe twice", scripted(Motion::swipe), {K::swipe_left, K::swipe_left}},
        {"raise both", scripted(Motion::raise), {K::raise_both}},
        {"push three times", scripted(Motion::push), {K::push, K::push, K::push}},
        {"t-pose", scripted(Motion::tpose), {K::t_pose}},
        {"swipe left", keyed(stroke(kOutR, kAcrossR, 0.5)), {K::swipe_left}, 5},
        {"swipe right", keyed(stroke(kAcrossR, kOutR, 0.5)), {K::swipe_right}, 5},
        {"swipe up", keyed(stroke(kLowR, kHighR, 0.5)), {K::swipe_up}, 5},
        {"swipe down", keyed(stroke(kHighR, kLowR, 0.5)), {K::swipe_down}, 5},
        {"raise right",
         keyed({{0, kHangL, kHangR},
                {1, kHangL, kHangR},
                {2, kHangL, arm(1, {0.3, 1, 0.1}, {0, 1, 0.1})},
                {3.5, kHangL, arm(1, {0.3, 1, 0.1}, {0, 1, 0.1})},
                {4.5, kHangL, kHangR}}),
         {K::raise},
         6},
        {"zoom", keyed(spread(1.0)), {K::zoom}, 6},
        {"dwell",
         keyed({{0, kHangL, kHangR},
                {1, kHangL, kHangR},
                {1.8, kHangL, arm(1, {0.2, -0.3, 1}, {0, 0.1, 1})},
                {4.5, kHangL, arm(1, {0.2, -0.3, 1}, {0, 0.1, 1})},
                {5.3, kHangL, kHangR}}),
         {K::dwell},
         6.5},
        {"idle", scripted(Motion::idle), {}},
        {"walk", scripted(Motion::walk), {}},
        {"turn", scripted(Motion::turn), {}},
    };
}

/// Random everyday arms: scratching, carrying, folding, hands in the hips, pockets, looking at a
/// watch, a hand at the chin, rubbing, with pauses; standing or stepping about.
inline PoseAt everyday(std::uint64_t seed, double seconds) {
    Random random(seed);
    const auto pose = [&](std::size_t side) {
        const double j = random.real(-0.12, 0.12), k = random.real(-0.12, 0.12);
        switch (random.integer(0, 9)) {
            case 0:  // scratching the head
                return arm(side, {0.7 + j, 0.1 + k, 0.6}, {-0.6, 0.9, 0.1 + j});
            case 1:  // the chin
                return arm(side, {0.2 + j, -0.8, 0.5 + k}, {-0.5, 0.8, 0.35});
            case 2:  // on the hip
                return arm(side, {0.75 + j, -0.8, -0.25}, {-0.7, -0.6 + k, 0.3});
            case 3:  // carrying before the belly
                return arm(side, {0.15 + j, -1, 0.1}, {-0.2, -0.1 + k, 1});
            case 4:  // folded
                return arm(side, {0.2 + j, -0.9, 0.35}, {-0.95, 0.1 + k, 0.35});
            case 5:  // a pocket
                return arm(side, {0.35 + j, -1, -0.15}, {-0.1, -1, 0.3 + k});
            case 6:  // the other elbow
                return arm(side, {0.1 + j, -0.8, 0.5}, {-0.9, -0.15 + k, 0.5});
            default:
                return arm(side, {0.15 + j, -1, k}, {0.05, -1, 0.2 + j});
        }
    };
    std::vector<Key> keys;
    for (double t = 0; t < seconds;) {
        Key key{t, pose(0), pose(1)};
        if (!keys.empty() && random.chance(0.5))
            (random.chance(0.5) ? key.left : key.right) =
                random.chance(0.5) ? keys.back().left : keys.back().right;
        keys.push_back(key);
        t += random.real(0.45, 1.2);
        if (random.chance(0.7)) {
            key.time_s = t;
            keys.push_back(key);
            t += random.real(0.3, 3);
        }
    }
    const double phase = random.real(0, 6);
    const auto arms = keyed(keys);
    return [=](double t) {
        BodyPose out = arms(t);
        const BodyPose walk = pose_at(Motion::walk, t + phase);
        if (std::fmod(t, 20) > 13) {
            const auto carried = out.arm;
            out = walk;
            if (std::fmod(t, 40) > 20) out.arm = carried;
        }
        return out;
    };
}

}  // namespace kino::test
