#include "apps/viewer/zoom_chooser.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <memory>
#include <string>
#include <vector>

#include "apps/viewer/frame_budget.h"
#include "tests/support/random.h"
#include "viz/surface/mesh_shapes.h"

namespace kino {
namespace {

View front() {
    return {.width = 1280,
            .height = 720,
            .projection = perspective(0.9, 1280, 720),
            .world_from_view = look_at({0, 0, 0}, {0, 0, -1})};
}

/// A wall at `share` of the picture's width, lit by so many lights that reach all of it.
Scene wall(double share, int lights, std::shared_ptr<const MeshAsset> finer = nullptr) {
    Scene scene;
    scene.materials.resize(1);
    const double half = share * 1280 / front().projection.fx * 4 / 2;
    MeshNode node{.mesh = make_box({static_cast<float>(2 * half), 40, 0.1f}), .material = 1};
    node.world_from_object[3] = {0, 0, -4.05, 1};
    if (finer) node.mesh = std::move(finer);
    scene.meshes.push_back(std::move(node));
    for (int i = 0; i < lights; ++i) {
        scene.lights.push_back({.kind = LightKind::point, .position = {0, 0, -1}, .radius_m = 90});
    }
    return scene;
}

/// A renderer whose passes take what their work costs; it knows the work from the scene's making.
struct FakeMachine {
    double frame_ms = 2, ui_ms = 1, polygons_ms = 0, copy_ms = 0.5;
    double ns_a_pixel = 6, ns_a_covered = 10, ns_a_light = 1.2;
    double noise = 0.02;
    test::Random random{5};

    FrameResult draw(double share, int lights, const FrameOptions& options) {
        const double pixels = 1280 * 720 * 1e-6 / (options.zoom.z * options.zoom.z);
        const double factor = 1 + random.real(-noise, noise);
        FrameResult result;
        const auto add = [&](const char* group, double ms) {
            ms *= factor;
            const bool told = options.timing == graph::Timing::every_group ||
                              (options.timing == graph::Timing::one_group && random.chance(0.25));
            result.report.groups.push_back({group, told ? ms : -1});
            result.ms += ms;
        };
        add("meshes", polygons_ms + ns_a_covered * pixels * share);
        add("light", ns_a_light * pixels * share * lights);
        add("final", ns_a_pixel * pixels);
        if (options.zoom.z > 1) add("zoom", copy_ms);
        add("ui", ui_ms);
        result.ms += frame_ms * factor;
        return result;
    }
};

struct Moment {
    double share = 1;
    int lights = 10;
};

struct PlayedZoom {
    std::vector<double> ms;
    std::vector<int> z;
    [[nodiscard]] int changes() const {
        int count = 0;
        for (std::size_t i = 1; i < z.size(); ++i) count += z[i] != z[i - 1] ? 1 : 0;
        return count;
    }
    /// By how much the worst frame from `first` on misses, as a share of the target.
    [[nodiscard]] double worst(double target_ms, std::size_t first = 0) const {
        return *std::max_element(ms.begin() + static_cast<std::ptrdiff_t>(first), ms.end()) /
                   target_ms -
               1;
    }
};

PlayedZoom play(SceneZoomBy by, double target_ms, FakeMachine machine, int frames,
                const std::function<Moment(int)>& at, std::size_t triangles = 12) {
    ZoomChooser chooser({.by = by, .target_ms = target_ms, .most = 4});
    PlayedZoom played;
    // The same box made of more triangles.
    std::shared_ptr<const MeshAsset> finer;
    if (triangles > 12) {
        const Scene plain = wall(at(0).share, 0);
        auto made = std::make_shared<MeshAsset>(*plain.meshes[0].mesh);
        made->indices.resize(3 * triangles, 0);
        finer = made;
    }
    for (int i = 0; i < frames; ++i) {
        const Moment moment = at(i);
        FrameOptions options;
        chooser.begin_frame(wall(moment.share, moment.lights, finer), front(),
                            i * kNsPerSecond / 30, {}, options);
        const FrameResult result = machine.draw(moment.share, moment.lights, options);
        chooser.frame_took(result, result.ms);
        played.ms.push_back(result.ms);
        played.z.push_back(options.zoom.z);
    }
    return played;
}

constexpr SceneZoomBy kBoth[] = {SceneZoomBy::reactive, SceneZoomBy::predictive};

// Card: a heavy object, four times the load, appears at frame 100.
TEST(ZoomChooser, PredictionMeetsWhatReactionMisses) {
    const auto load = [](int i) {
        return i < 100 ? Moment{.share = 0.25, .lights = 40} : Moment{.share = 1, .lights = 64};
    };
    constexpr double kTargetMs = 33;
    const PlayedZoom light = play(SceneZoomBy::fixed, kTargetMs, {}, 200, load);
    EXPECT_GT(light.ms[150], 3.9 * light.ms[50]);
    EXPECT_LT(light.ms[50], kTargetMs);
    const PlayedZoom reactive = play(SceneZoomBy::reactive, kTargetMs, {}, 200, load);
    EXPECT_GT(reactive.worst(kTargetMs), 0.5);
    EXPECT_LE(reactive.worst(kTargetMs, 102), 0.15);  // it sees trouble a frame late, no more
    const PlayedZoom predictive = play(SceneZoomBy::predictive, kTargetMs, {}, 200, load);
    EXPECT_LE(predictive.worst(kTargetMs), 0.15);
    EXPECT_EQ(predictive.z[99], 1);
    EXPECT_EQ(predictive.z[100], 2);
}

TEST(ZoomChooser, ConstantLoadChangesTheZoomOnce) {
    for (const SceneZoomBy by : kBoth) {
        for (const double load : {1.2, 1.05, 2.0, 3.5}) {
            const Moment moment{.share = 0.8, .lights = 40};
            FakeMachine machine{.noise = 0};
            const double at_one = machine.draw(moment.share, moment.lights, {}).ms;
            const double target_ms = at_one / load;
            machine.noise = 0.03;
            const PlayedZoom played =
                play(by, target_ms, machine, 200, [&](int) { return moment; });
            // From far above the first step may be one too many: what meshes' pixels and the copy
            // take is a guess until then.
            EXPECT_LE(played.changes(), load < 3 ? 1 : 2) << zoom_by_name(by) << " " << load;
            EXPECT_GT(played.z.back(), 1) << zoom_by_name(by) << " " << load;
            EXPECT_LE(played.ms.back(), 1.05 * target_ms) << zoom_by_name(by) << " " << load;
        }
    }
}

TEST(ZoomChooser, DoesNotZoomWherePolygonsOrTheCopyDominate) {
    const auto load = [](int) { return Moment{.share = 0.1, .lights = 5}; };
    for (const SceneZoomBy by : kBoth) {
        const PlayedZoom polygons =
            play(by, 33, {.polygons_ms = 60, .ns_a_pixel = 3}, 200, load, 300'000);
        EXPECT_EQ(polygons.z.back(), 1) << zoom_by_name(by);
        EXPECT_LE(polygons.changes(), 2) << zoom_by_name(by);
        const PlayedZoom copy =
            play(by, 10, {.copy_ms = 40}, 200, [](int) { return Moment{.lights = 6}; });
        EXPECT_EQ(copy.z.back(), 1) << zoom_by_name(by);
        EXPECT_LE(copy.changes(), 2) << zoom_by_name(by);
    }
}

TEST(ZoomChooser, ComesBackWhenTheLoadGoes) {
    for (const SceneZoomBy by : kBoth) {
        const PlayedZoom played = play(by, 33, {}, 300, [](int i) {
            return Moment{.share = 1, .lights = i >= 100 && i < 200 ? 80 : 5};
        });
        EXPECT_EQ(played.z[99], 1) << zoom_by_name(by);
        EXPECT_GE(played.z[150], 2) << zoom_by_name(by);
        EXPECT_EQ(played.z[299], 1) << zoom_by_name(by);
        // Down by one after eight frames that would have been in time.
        const auto first_fine = std::find(played.z.begin() + 200, played.z.end(), 1);
        EXPECT_GE(first_fine - played.z.begin(), 207) << zoom_by_name(by);
        EXPECT_LE(first_fine - played.z.begin(), 240) << zoom_by_name(by);
    }
}

TEST(ZoomChooser, OneHiccupDoesNotTeachThePredictionOtherCosts) {
    ZoomChooser chooser({.by = SceneZoomBy::predictive, .target_ms = 33});
    FakeMachine machine;
    const Moment moment{.share = 1, .lights = 10};
    for (int i = 0; i < 100; ++i) {
        FrameOptions options;
        chooser.begin_frame(wall(moment.share, moment.lights), front(), i, {}, options);
        const FrameResult result = machine.draw(moment.share, moment.lights, options);
        chooser.frame_took(result, i == 50 ? 20 * result.ms : result.ms);
        chooser.frame_took(result, std::numeric_limits<double>::quiet_NaN());
        EXPECT_EQ(options.zoom.z, 1) << i;
    }
}

TEST(ZoomChooser, HeadsAndCamerasInMotionMakePicturesCoarser) {
    ZoomChooser chooser({.by = SceneZoomBy::head, .most = 3});
    Scene scene;
    View view = front();
    TimeNs now = 0;
    const auto step = [&](const std::optional<glm::dvec3>& head_m_s) {
        FrameOptions options;
        now += kNsPerSecond / 30;
        const int z = chooser.begin_frame(scene, view, now, head_m_s, options);
        EXPECT_EQ(options.zoom.z, z);
        EXPECT_EQ(options.timing, graph::Timing::frame);
        return z;
    };
    EXPECT_EQ(step(glm::dvec3(0.1, 0, 0)), 1);
    EXPECT_EQ(step(glm::dvec3(0.5, 0, 0)), 2);
    EXPECT_EQ(step(glm::dvec3(9, 0, 0)), 3);
    for (int i = 0; i < 60; ++i) step(glm::dvec3(0));
    EXPECT_EQ(step({}), 1);
    // A camera that moves by 1 m/s, and one that turns by 90 degrees/s.
    view.world_from_view.translation.x += 1.0 / 30;
    EXPECT_EQ(step({}), 3);
    for (int i = 0; i < 60; ++i) step({});
    view.world_from_view.rotation =
        view.world_from_view.rotation * glm::angleAxis(glm::radians(3.0), glm::dvec3(0, 1, 0));
    EXPECT_EQ(step({}), 2);
    for (int i = 0; i < 60; ++i) step({});
    // Put elsewhere, it does not move.
    view.world_from_view.translation.x += 5;
    EXPECT_EQ(step({}), 1);
}

TEST(ZoomChooser, OffItLeavesEverythingAsItIs) {
    ZoomChooser chooser(ZoomChooserOptions{});
    FrameOptions options;
    options.zoom.z = 3;
    EXPECT_EQ(chooser.begin_frame(wall(1, 5), front(), 0, {}, options), 1);
    EXPECT_EQ(options.zoom.z, 3);
    EXPECT_EQ(options.timing, graph::Timing::frame);
    EXPECT_FALSE(chooser.on());
}

// What is chosen goes through the budget's log, and is drawn again from it.
TEST(ZoomChooser, LevelsAreLoggedAndRepeated) {
    ZoomChooser chooser({.by = SceneZoomBy::reactive, .target_ms = 20});
    FrameBudget budget({.mode = GovernorMode::fixed, .target_ms = 20, .lod = 2});
    FakeMachine machine;
    std::vector<int> drawn;
    for (int i = 0; i < 120; ++i) {
        const Scene scene = wall(1, i < 40 ? 5 : i < 80 ? 60 : 10);
        FrameOptions options;
        budget.set_zoom(chooser.begin_frame(scene, front(), i, {}, options));
        budget.begin_frame(scene, front(), options);
        ASSERT_EQ(options.zoom.z, chooser.choice().z);
        drawn.push_back(options.zoom.z);
        const FrameResult result = machine.draw(1, static_cast<int>(scene.lights.size()), options);
        budget.frame_took(result, result.ms);
        chooser.frame_took(result, result.ms);
    }
    EXPECT_GT(*std::max_element(drawn.begin(), drawn.end()), 1);
    EXPECT_GE(budget.log().size(), 3u);
    FrameBudget again({});
    again.replay(budget.log());
    for (const int z : drawn) {
        FrameOptions options;
        again.begin_frame(wall(1, 5), front(), options);
        EXPECT_EQ(options.zoom.z, z);
        ASSERT_TRUE(options.lod.has_value());
        EXPECT_EQ(options.lod->r, 2);
    }
    EXPECT_EQ(again.log(), budget.log());
}

}  // namespace
}  // namespace kino
