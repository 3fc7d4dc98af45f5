#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <set>

#include "apps/pipeline/stepper.h"
#include "skeleton/synthetic/synthetic_source.h"

/// From the depth of a computed sensor to gestures, through the shipped forest.
namespace kino {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;
using K = GestureKind;

struct Seen {
    std::vector<GestureEvent> gestures;
    std::set<std::uint32_t> ids;
    int frames_with_one = 0;
    int frames = 0;
    std::vector<double> hand_error_m;  ///< of the right hand, where it is tracked
};

Seen play(Motion motion, double seconds) {
    auto source = SyntheticSource::create(make_scene(motion, 320, 240));
    KINO_CHECK(source.has_value());
    SyntheticSource& synthetic = **source;
    auto opened = prepare_for_playing(std::move(*source),
                                      {.mode = LoopMode::once, .bodies = {.mode = BodyMode::on}});
    if (!opened) {
        ADD_FAILURE() << opened.error().to_string();
        return {};
    }
    Stepper stepper(std::move(*opened));
    Seen seen;
    const auto frames = static_cast<int>(seconds * SyntheticSource::kRateHz);
    for (int i = 0; i < frames; ++i) {
        const auto frame = stepper.next();
        KINO_CHECK(frame && *frame);
        ++seen.frames;
        const BodyFrame& bodies = *(*frame)->set.bodies;
        if (bodies.bodies.size() == 1) ++seen.frames_with_one;
        for (const Body& body : bodies.bodies) {
            seen.ids.insert(body.id);
            const auto truth = synthetic.scene().bodies_at(i / SyntheticSource::kRateHz);
            if (body[Joint::hand_right].state != JointState::tracked) continue;
            seen.hand_error_m.push_back(glm::distance(body[Joint::hand_right].position_m,
                                                      truth.at(0)[Joint::hand_right].position_m));
        }
        for (const GestureEvent& event : (*frame)->gestures) seen.gestures.push_back(event);
    }
    return seen;
}

std::vector<K> kinds(const Seen& seen) {
    std::vector<K> out;
    for (const GestureEvent& event : seen.gestures) {
        if (event.phase == GesturePhase::once || event.phase == GesturePhase::begin)
            out.push_back(event.kind);
    }
    return out;
}

TEST(TrackedGestures, AWaveEngages) {
    const Seen seen = play(Motion::wave, 4);
    EXPECT_THAT(kinds(seen), ElementsAre(K::wave, K::engaged));
    ASSERT_FALSE(seen.gestures.empty());
    EXPECT_EQ(seen.gestures[0].hand, Hand::right);
    EXPECT_EQ(seen.ids.size(), 1u);
    EXPECT_GE(seen.frames_with_one, seen.frames * 9 / 10);
    ASSERT_GT(seen.hand_error_m.size(), 60u);
    std::vector<double> errors = seen.hand_error_m;
    std::nth_element(errors.begin(),
                     errors.begin() + static_cast<std::ptrdiff_t>(errors.size() / 2), errors.end());
    EXPECT_LT(errors[errors.size() / 2], 0.12);
}

TEST(TrackedGestures, ASwipe) {
    EXPECT_THAT(kinds(play(Motion::swipe, 2.7)), ElementsAre(K::swipe_left));
}

TEST(TrackedGestures, APush) {
    EXPECT_THAT(kinds(play(Motion::push, 3)), ElementsAre(K::push));
}

TEST(TrackedGestures, BothHandsUp) {
    EXPECT_THAT(kinds(play(Motion::raise, 4)), ElementsAre(K::raise_both));
}

TEST(TrackedGestures, ATPose) {
    EXPECT_THAT(kinds(play(Motion::tpose, 2)), ElementsAre(K::t_pose));
}

TEST(TrackedGestures, WalkingIsNone) {
    const Seen seen = play(Motion::walk, 3);
    EXPECT_THAT(kinds(seen), IsEmpty());
    EXPECT_GE(seen.frames_with_one, seen.frames * 8 / 10);
}

}  // namespace
}  // namespace kino
