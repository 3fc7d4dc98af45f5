#include "apps/bench/framebuffer_lod_fix.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>
#include <string>
#include <string_view>

#include "tests/scenes/depth_scene.h"
#include "viz/frame/renderer.h"
#include "viz/quality/image_metrics.h"
#include "viz/surface/mesh_shapes.h"

namespace kino::bench {
namespace {

constexpr double kWiresM = 1.5;  ///< from the viewer

struct FixScene {
    Scene scene;
    View view;
};

/// Wires of half a pixel, upright and slanted, before a wall. Half of the lights reach only the
/// wires, half only the wall.
FixScene wires(int width, int height) {
    FixScene made;
    made.view = {.width = width,
                 .height = height,
                 .projection = perspective(0.8, width, height),
                 .world_from_view = look_at({0, 0, 0}, {0, 0, -1})};
    Scene& scene = made.scene;
    scene.color_mode = ColorMode::relit;
    scene.ambient = glm::vec3(0.03f);
    scene.materials.push_back({.name = "wall", .base_color = glm::vec3(0.5f)});
    scene.materials.push_back({.name = "wire", .base_color = glm::vec3(0.7f, 0.6f, 0.5f)});
    const auto add = [&](const std::shared_ptr<const MeshAsset>& mesh, const glm::dmat4& place,
                         std::uint32_t material) {
        MeshNode node{.id = static_cast<std::uint32_t>(scene.meshes.size() + 1),
                      .mesh = mesh,
                      .material = material};
        node.world_from_object = place;
        node.previous_world_from_object = place;
        scene.meshes.push_back(std::move(node));
    };
    glm::dmat4 wall(1);
    wall[3] = {0, 0, -3.1, 1};
    add(make_box({8, 8, 0.2f}), wall, 1);
    const double pixel_m = kWiresM / made.view.projection.fx;
    const auto wire = make_box({static_cast<float>(0.5 * pixel_m), 2, 0.002f});
    constexpr int kWires = 40;
    for (int i = 0; i < kWires; ++i) {
        const double slant = i % 2 == 0 ? 0.05 : 0.23;
        glm::dmat4 place(1);
        place[0] = {std::cos(slant), std::sin(slant), 0, 0};
        place[1] = {-std::sin(slant), std::cos(slant), 0, 0};
        place[3] = {-0.95 + 1.9 * i / (kWires - 1), 0, -kWiresM, 1};
        add(wire, place, 2);
    }
    for (int i = 0; i < 64; ++i) {
        const bool near = i % 2 == 0;
        scene.lights.push_back(
            {.kind = LightKind::point,
             .position = {-1.0 + 2.0 * (i % 8) / 7, -0.5 + 0.14 * (i / 8), near ? -1.1 : -2.5},
             .color = near ? glm::vec3(0.1f, 0.05f, 0.03f) : glm::vec3(0.05f),
             .radius_m = 0.9f});
    }
    return made;
}

/// The recorded office from its sensor's place under lights from everywhere.
Result<FixScene> office(int width, int height) {
    KINO_ASSIGN(test::RecordedScene recorded, test::load_recording("recordings/office"));
    FixScene made;
    made.scene = std::move(recorded.scene);
    made.scene.color_mode = ColorMode::relit;
    made.scene.ambient = glm::vec3(0.1f);
    const Pose& sensor = made.scene.live->world_from_depth;
    made.view = sensor_view(recorded.rig.depth, sensor, width, height);
    for (int i = 0; i < 60; ++i) {
        const glm::dvec3 place(0.4 * (i % 10 - 4.5), 0.4 * (i / 10 - 2.5), 1.0 + 0.35 * (i % 7));
        made.scene.lights.push_back({.kind = LightKind::point,
                                     .position = sensor.rotation * place + sensor.translation,
                                     .color = {0.25f + 0.2f * static_cast<float>(i % 2), 0.3f,
                                               0.25f + 0.2f * static_cast<float>(i % 3)},
                                     .radius_m = 1.5f});
    }
    return made;
}

class FixBench {
  public:
    FixBench(BenchContext& context, gpu::Device& device)
        : context_(context),
          renderer_(device),
          made_(wires(context.quick() ? 640 : 1280, context.quick() ? 360 : 720)) {}

    void run() {
        FrameOptions whole;
        whole.read_surface = true;
        truth_ = render(whole);
        std::vector<Level> levels = {{"direct", {}}};
        const auto add = [&](std::string name, float share, float confidence) {
            FramebufferLodOptions lod{.r = 4, .fix_share = share, .fix_confidence = confidence};
            levels.push_back({std::move(name), lod});
        };
        add("none", 0, 0.05f);
        const std::size_t first_share = levels.size();
        for (const float share : {0.005f, 0.01f, 0.02f, 0.05f, 0.1f}) {
            add(fmt::format("cap {:g}", share), share, 0.05f);
        }
        const std::size_t first_confidence = levels.size();
        for (const float confidence : {1e-6f, 0.001f, 0.2f, 0.5f}) {
            add(fmt::format("tau {:g}", confidence), 0.1f, confidence);
        }
        std::vector<Candidate> candidates;
        for (const Level& level : levels) {
            candidates.push_back({level.name, [this, level] { (void)render(options_of(level)); }});
        }
        const Comparison times = context_.compare("thin wires", candidates, {.repeats = 15});
        for (std::size_t i = 0; i < levels.size() && !failed_; ++i) {
            const bool by_share = i >= first_share && i < first_confidence;
            row(levels[i], by_share ? "cap" : i < first_share ? "third pass" : "confidence", times);
        }
        if (failed_) return;
        claim_time();
        context_.claim(
            fmt::format("thin wires at r = 4: with the third pass (cap 0.1) the squared error on "
                        "wires is {:.4f} of that without (limit 0.1)",
                        errors_["cap 0.1"] / errors_["none"]),
            errors_["cap 0.1"] <= 0.1 * errors_["none"]);
        auto room = office(made_.view.width, made_.view.height);
        if (!room) return context_.fail(room.error());
        made_ = std::move(*room);
        run_office();
    }

  private:
    struct Level {
        std::string name;
        std::optional<FramebufferLodOptions> lod;
    };

    /// Pixels that are shaded anew cost the same wherever they are: a straight line.
    void claim_time() {
        const auto ms = [&](const char* level) { return ms_[level]; };
        const auto count = [&](const char* level) { return shaded_[level]; };
        const double a_pixel = (ms("cap 0.05") - ms("cap 0.005")) /
                               std::max(1.0, count("cap 0.05") - count("cap 0.005"));
        double worst = 0;
        for (const char* level : {"cap 0.01", "cap 0.02"}) {
            const double predicted =
                ms("cap 0.005") + a_pixel * (count(level) - count("cap 0.005"));
            worst = std::max(worst, ms(level) / predicted);
        }
        context_.claim(fmt::format("thin wires at r = 4: frames with caps between take at most "
                                   "{:.2f} of what those with caps 0.005 and 0.05 predict (limit "
                                   "1.2)",
                                   worst),
                       worst <= 1.2);
    }

    void run_office() {
        truth_ = render({});
        std::vector<Level> levels = {{"direct", {}}};
        for (const double r : {2.0, 4.0, 8.0}) {
            for (const float share : {0.0f, 0.05f}) {
                levels.push_back({fmt::format("r {:g}{}", r, share > 0 ? ", third pass" : ""),
                                  FramebufferLodOptions{.r = r, .fix_share = share}});
            }
        }
        std::vector<Candidate> candidates;
        for (const Level& level : levels) {
            candidates.push_back({level.name, [this, level] { (void)render(options_of(level)); }});
        }
        const Comparison times = context_.compare("office, live", candidates, {.repeats = 15});
        for (const Level& level : levels) {
            if (!failed_) row(level, "r", times);
        }
        if (failed_) return;
        context_.claim(fmt::format("office, live, at r = 4: the third pass makes {:.2f} dB of "
                                   "{:.2f} dB PSNR",
                                   errors_["r 4, third pass"], errors_["r 4"]),
                       errors_["r 4, third pass"] > errors_["r 4"] + 1);
    }

    static FrameOptions options_of(const Level& level) {
        FrameOptions options;
        options.lod = level.lod;
        return options;
    }

    FrameResult render(const FrameOptions& options) {
        auto frame = renderer_.render_to_image(made_.scene, made_.view, options);
        if (frame) return std::move(*frame);
        if (!failed_) context_.fail(frame.error());
        failed_ = true;
        return {};
    }

    void row(const Level& level, const char* knob, const Comparison& times) {
        FrameOptions options = options_of(level);
        options.count_fixed = true;
        const FrameResult frame = render(options);
        if (failed_) return;
        if (std::string_view(knob) == "r") {
            const auto difference = compare_images(frame.picture, truth_.picture);
            context_.add({.case_name = "office, live",
                          .knob = knob,
                          .level = level.name,
                          .error = level.lod ? difference->psnr_db : kNotMeasured,
                          .metric = "dB PSNR",
                          .baseline = "direct"},
                         times);
            errors_[level.name] = difference->psnr_db;
            note_count(level, frame);
            return;
        }
        double sum = 0;
        std::size_t count = 0;
        for (std::size_t i = 0; i < truth_.picture.size(); ++i) {
            const float z = truth_.surface.view_z_m.pixels()[i];
            if (z <= 0 || z > 2) continue;
            const Rgba8 a = frame.picture.pixels()[i];
            const Rgba8 b = truth_.picture.pixels()[i];
            sum += (std::pow(a.r - b.r, 2) + std::pow(a.g - b.g, 2) + std::pow(a.b - b.b, 2)) / 3;
            ++count;
        }
        const double error = sum / static_cast<double>(std::max<std::size_t>(count, 1));
        errors_[level.name] = error;
        ms_[level.name] = times[level.name].median_ms();
        if (frame.fixed) shaded_[level.name] = frame.fixed->shaded;
        context_.add({.case_name = "thin wires, r = 4",
                      .knob = knob,
                      .level = level.name,
                      .error = error,
                      .metric = "MSE on wires, of 255^2",
                      .baseline = "none"},
                     times);
        note_count(level, frame);
    }

    void note_count(const Level& level, const FrameResult& frame) {
        if (!frame.fixed) return;
        context_.note(fmt::format(
            "Third pass, {}: {} pixels doubtful, {} shaded anew, {:.1f} % of the picture.",
            level.name, frame.fixed->failed, frame.fixed->shaded,
            100.0 * frame.fixed->shaded / static_cast<double>(truth_.picture.size())));
    }

    BenchContext& context_;
    Renderer renderer_;
    FixScene made_;
    FrameResult truth_;
    std::map<std::string, double> errors_;
    std::map<std::string, double> ms_;
    std::map<std::string, double> shaded_;  ///< pixels
    bool failed_ = false;
};

}  // namespace

void bench_lod_fixes(BenchContext& context, gpu::Device& device) {
    FixBench(context, device).run();
}

}  // namespace kino::bench
