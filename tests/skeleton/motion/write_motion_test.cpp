#include <gmock/gmock.h>

#include <cmath>
#include <glm/geometric.hpp>
#include <limits>

#include "tests/skeleton/motion/bvh_reader.h"
#include "tests/skeleton/motion/c3d_reader.h"
#include "tests/skeleton/motion/csv_reader.h"
#include "tests/skeleton/motion/glb_reader.h"
#include "tests/skeleton/motion/test_clips.h"
#include "tests/support/random.h"
#include "tests/support/temp_dir.h"

namespace kino::test {
namespace {

constexpr double kCm = 0.01;

BvhFile bvh_of(const MotionClip& clip, MotionSummary* summary = nullptr) {
    return read_bvh(written(clip, "a.bvh", summary));
}

void lose(MotionClip& clip, std::size_t first, std::size_t last, Joint joint) {
    for (std::size_t i = first; i <= last; ++i) {
        clip.moments[i].bodies.bodies[0][joint] = {};
    }
}

TEST(WriteMotion, BridgesALostJointByItsOffsetFromItsParent) {
    MotionClip clip = synthetic_clip(Motion::wave, 40);
    Places wanted = world_places(clip);
    // Elbow and hand: the wrist between them is seen all the time and must not move.
    lose(clip, 10, 19, Joint::elbow_right);
    lose(clip, 0, 4, Joint::hand_left);
    constexpr auto kShoulder = static_cast<std::size_t>(Joint::shoulder_right);
    constexpr auto kElbow = static_cast<std::size_t>(Joint::elbow_right);
    constexpr auto kWrist = static_cast<std::size_t>(Joint::wrist_left);
    constexpr auto kHand = static_cast<std::size_t>(Joint::hand_left);
    for (std::size_t i = 10; i <= 19; ++i) {
        const double w = (static_cast<double>(i) - 9) / 11;
        wanted[i][kElbow] = wanted[i][kShoulder] +
                            (1 - w) * (wanted[9][kElbow] - wanted[9][kShoulder]) +
                            w * (wanted[20][kElbow] - wanted[20][kShoulder]);
    }
    for (std::size_t i = 0; i < 5; ++i) {
        wanted[i][kHand] = wanted[i][kWrist] + wanted[5][kHand] - wanted[5][kWrist];
    }
    MotionSummary summary;
    const BvhFile file = bvh_of(clip, &summary);
    EXPECT_EQ(summary.joints_lost, 15U);
    const Places normal = normalized(wanted);
    for (std::size_t i = 0; i < 40; ++i) {
        EXPECT_LT(largest_error_m(file.positions(i), kCm, normal[i]), 1e-5) << i;
    }
}

TEST(WriteMotion, BonesThatStretchAreMadeConstantAndTheErrorIsTold) {
    MotionClip clip = synthetic_clip(Motion::idle, 31);
    Places places = world_places(clip);
    // The head bobs by 20 mm along the neck: constant bones cannot follow.
    for (std::size_t i = 0; i < places.size(); ++i) {
        const glm::dvec3 up = glm::normalize(places[i][3] - places[i][2]);
        places[i][3] += up * (i % 3 == 0 ? 0.02 : i % 3 == 1 ? -0.02 : 0.0);
    }
    clip = clip_of(places);
    MotionSummary summary;
    const BvhFile file = bvh_of(clip, &summary);
    EXPECT_NEAR(summary.max_error_mm, 20, 0.1);
    EXPECT_NEAR(summary.mean_error_mm, 20.0 * 21 / 31 / 20, 0.05);
    const Places normal = normalized(places);
    for (std::size_t i = 0; i < places.size(); ++i) {
        EXPECT_LT(largest_error_m(file.positions(i), kCm, normal[i]), 1e-5);
    }
}

TEST(WriteMotion, ResamplesToAConstantRateByStraightLines) {
    Random random(5);
    MotionClip clip = synthetic_clip(Motion::tpose, 60);
    const auto pose = standing();
    double t = 0;
    for (MotionMoment& m : clip.moments) {
        m.bodies.time = from_seconds(1e6 + t);
        Body& body = m.bodies.bodies[0];
        const Pose back = inverse(m.world_from_depth);
        for (std::size_t j = 0; j < kJointCount; ++j) {
            body.joints[j].position_m = glm::vec3(back * (pose[j] + glm::dvec3(0.5 * t, 0, -t)));
        }
        t += random.real(0.02, 0.05);
    }
    clip.rate_hz = 60;
    MotionSummary summary;
    const BvhFile file = bvh_of(clip, &summary);
    EXPECT_NEAR(file.frame_time_s, 1.0 / 60, 1e-9);
    EXPECT_EQ(summary.frames, file.frames.size());
    EXPECT_EQ(file.frames.size(), static_cast<std::size_t>(summary.duration_s * 60 + 1e-3) + 1);
    for (std::size_t k = 0; k < file.frames.size(); ++k) {
        const double at = static_cast<double>(k) / 60;
        const glm::dvec3 hips = file.positions(k).at("hip_center") * kCm;
        EXPECT_LT(glm::length(hips - (pose[0] + glm::dvec3(0.5 * at, 0, -at))), 1e-5);
    }
}

TEST(WriteMotion, TheCameraMayMove) {
    MotionClip clip = synthetic_clip(Motion::dance, 30);
    const Places still = world_places(clip);
    for (std::size_t i = 0; i < 30; ++i) {
        MotionMoment& m = clip.moments[i];
        const double a = 0.05 * static_cast<double>(i);
        const Pose moved{glm::angleAxis(a, glm::normalize(glm::dvec3(1, 2, 3))),
                         glm::dvec3(a, -a, 2 * a)};
        const Pose into = inverse(moved) * m.world_from_depth;
        m.world_from_depth = moved;
        for (JointPosition& p : m.bodies.bodies[0].joints) {
            p.position_m = glm::vec3(into * glm::dvec3(p.position_m));
        }
    }
    const BvhFile file = bvh_of(clip);
    const Places wanted = normalized(still);
    for (std::size_t i = 0; i < 30; ++i) {
        EXPECT_LT(largest_error_m(file.positions(i), kCm, wanted[i]), 1e-5);
    }
}

TEST(WriteMotion, APersonOfTenJointsHangsOnTheShoulders) {
    MotionClip clip = synthetic_clip(Motion::wave, 30);
    const Places places = world_places(clip);
    for (const Joint j : {Joint::hip_center, Joint::spine, Joint::hip_left, Joint::knee_left,
                          Joint::ankle_left, Joint::foot_left, Joint::hip_right, Joint::knee_right,
                          Joint::ankle_right, Joint::foot_right}) {
        lose(clip, 0, 29, j);
    }
    for (const char* name : {"a.bvh", "a.glb"}) {
        MotionSummary summary;
        const std::string bytes = written(clip, name, &summary);
        EXPECT_EQ(summary.never_seen.size(), 10U);
        EXPECT_EQ(summary.joints_lost, 300U);
        EXPECT_LT(summary.max_error_mm, 1e-3);
        const bool bvh = name[2] == 'b';
        for (std::size_t i = 0; i < 30; i += 9) {
            const auto found = bvh ? read_bvh(bytes).positions(i) : read_glb(bytes).positions(i);
            const double unit_m = bvh ? kCm : 1;
            for (std::size_t j = 2; j < 12; ++j) {
                const glm::dvec3 p = found.at(joint_name(static_cast<Joint>(j))) * unit_m;
                EXPECT_LT(glm::length(p - places[i][j]), 2e-5);
            }
            // The legs hang below, left stays left.
            const glm::dvec3 across = (found.at("hip_left") - found.at("hip_right")) * unit_m;
            EXPECT_GT(glm::dot(across, places[i][4] - places[i][8]), 0);
            EXPECT_LT(found.at("foot_left").y, found.at("hip_center").y);
        }
    }
}

TEST(WriteMotion, ChoosesThePersonSeenMost) {
    MotionClip clip = synthetic_clip(Motion::idle, 10);
    for (std::size_t i = 0; i < 10; ++i) {
        Body other = clip.moments[i].bodies.bodies[0];
        other.id = 3;
        for (JointPosition& p : other.joints) p.position_m.x += 1;
        if (i < 9)
            clip.moments[i].bodies.bodies.insert(clip.moments[i].bodies.bodies.begin(), other);
    }
    EXPECT_THAT(people_in(clip),
                testing::ElementsAre(MotionPerson{kPerson, 10}, MotionPerson{3, 9}));
    const TempDir folder;
    EXPECT_EQ(write_motion(folder / "a.csv", clip)->person, kPerson);
    EXPECT_EQ(write_motion(folder / "a.csv", clip, 3)->frames, 9U);
    const auto missing = write_motion(folder / "b.csv", clip, 4);
    ASSERT_FALSE(missing.has_value());
    EXPECT_THAT(missing.error().hint, testing::HasSubstr("7 (10 moments), 3 (9 moments)"));
    EXPECT_FALSE(std::filesystem::exists(folder / "b.csv"));
}

TEST(WriteMotion, RefusesWhatCannotBeWritten) {
    const TempDir folder;
    const MotionClip good = synthetic_clip(Motion::idle, 5);
    const auto what = [&](const MotionClip& clip, const char* name) {
        const auto result = write_motion(folder / name, clip);
        EXPECT_FALSE(std::filesystem::exists(folder / name));
        return result ? std::string("written") : result.error().what;
    };
    EXPECT_THAT(what(good, "a.fbx"), testing::HasSubstr("files of this kind"));
    EXPECT_THAT(what(good, "noextension"), testing::HasSubstr("files of this kind"));
    EXPECT_THAT(what({}, "a.bvh"), testing::HasSubstr("no moments"));
    MotionClip clip = good;
    clip.moments[3].bodies.time = clip.moments[2].bodies.time;
    for (const char* name : {"a.bvh", "a.glb", "a.csv", "a.c3d"}) {
        EXPECT_EQ(what(clip, name), "times do not rise");
    }
    for (const double rate : {-1.0, 1001.0, std::nan(""), HUGE_VAL}) {
        clip = good;
        clip.rate_hz = rate;
        EXPECT_THAT(what(clip, "a.c3d"), testing::HasSubstr("rate"));
    }
    clip = good;
    clip.moments[1].world_from_depth.rotation *= 2.0;
    EXPECT_THAT(what(clip, "a.glb"), testing::HasSubstr("pose"));
    clip = good;
    clip.moments[1].bodies.bodies.push_back(clip.moments[1].bodies.bodies[0]);
    EXPECT_THAT(what(clip, "a.csv"), testing::HasSubstr("twice"));
    clip = good;
    for (const Joint j : {Joint::hip_center, Joint::spine, Joint::shoulder_center}) {
        lose(clip, 0, 4, j);
    }
    EXPECT_THAT(what(clip, "a.bvh"), testing::HasSubstr("never seen"));
    for (std::size_t j = 0; j < kJointCount; ++j) lose(clip, 0, 4, static_cast<Joint>(j));
    EXPECT_THAT(what(clip, "a.csv"), testing::HasSubstr("no joint"));
    for (MotionMoment& m : clip.moments) m.bodies.bodies.clear();
    EXPECT_THAT(what(clip, "a.csv"), testing::HasSubstr("nobody"));
    clip = good;
    clip.moments[4].bodies.time += 66'000 * (kNsPerSecond / 30);
    EXPECT_THAT(what(clip, "a.c3d"), testing::HasSubstr("more than the 65535"));
    clip.moments[4].bodies.time = std::numeric_limits<TimeNs>::max();
    EXPECT_THAT(what(clip, "a.bvh"), testing::HasSubstr("more than the 250000"));
    EXPECT_FALSE(write_motion(folder / "nowhere" / "a.bvh", good).has_value());
}

/// Anything a tracker may do wrong, and more.
MotionClip garbage(std::uint64_t seed) {
    Random random(seed);
    MotionClip clip = random_clip(seed, random.integer(1, 12));
    clip.rate_hz = random.chance(0.5) ? 0 : random.real(1, 120);
    constexpr float kBad[] = {std::numeric_limits<float>::quiet_NaN(),
                              std::numeric_limits<float>::infinity(), 3e38F, -3e38F, 0};
    for (MotionMoment& m : clip.moments) {
        if (random.chance(0.2)) m.bodies.bodies.clear();
        for (Body& body : m.bodies.bodies) {
            for (JointPosition& p : body.joints) {
                p.state = static_cast<JointState>(random.integer(0, 2));
                if (random.chance(0.1))
                    p.position_m[random.integer(0, 2)] = kBad[random.integer(0, 4)];
                if (random.chance(0.1)) p.position_m = glm::vec3(1, 2, 3);  // bones of no length
                if (random.chance(0.05)) p.confidence = kBad[random.integer(0, 4)];
            }
        }
    }
    return clip;
}

TEST(WriteMotion, WhateverIsWrittenCanBeReadAndIsFinite) {
    const TempDir folder;
    int files = 0;
    for (std::uint64_t seed = 1; seed <= 200; ++seed) {
        const MotionClip clip = garbage(seed);
        for (const char* name : {"a.bvh", "a.glb", "a.csv", "a.c3d"}) {
            const auto result = write_motion(folder / name, clip);
            if (!result) continue;
            ++files;
            const std::string bytes = read_bytes(folder / name);
            const auto expect_finite = [&](const std::map<std::string, glm::dvec3>& found) {
                for (const auto& [joint, p] : found) {
                    EXPECT_TRUE(std::isfinite(p.x + p.y + p.z)) << joint << " of seed " << seed;
                }
            };
            switch (result->format) {
                case MotionFormat::bvh: {
                    const BvhFile file = read_bvh(bytes);
                    for (std::size_t i = 0; i < file.frames.size(); ++i) {
                        expect_finite(file.positions(i));
                    }
                    break;
                }
                case MotionFormat::glb:
                    expect_finite(read_glb(bytes).positions(0));
                    break;
                case MotionFormat::csv:
                    EXPECT_EQ(read_csv(bytes).size(), result->frames * 20);
                    break;
                case MotionFormat::c3d:
                    for (const auto& frame : read_c3d(bytes).frames) {
                        for (const C3dPoint& p : frame) EXPECT_TRUE(std::isfinite(p.x + p.y + p.z));
                    }
                    break;
            }
        }
    }
    EXPECT_GT(files, 600);
}

}  // namespace
}  // namespace kino::test
