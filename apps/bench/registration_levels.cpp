#include "apps/bench/registration_levels.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <memory>
#include <opencv2/core.hpp>
#include <opencv2/rgbd/depth.hpp>
#include <string>
#include <vector>

#include "apps/bench/registration_peers.h"
#include "calibration/files/camera_text.h"
#include "calibration/registration_rays.h"
#include "calibration/rig.h"
#include "sensor/convert/k4a_calibration.h"
#include "sensor/file_bytes.h"
#include "tests/reference/registration_reference.h"
#include "tests/reference/registration_scene.h"

namespace kino {
namespace {

// What came out in the colour camera's picture and on the depth camera's, against what is true.
struct RoomScore {
    double empty = 0;        // share of what both cameras see that has no depth
    double wrong = 0;        // share of the depths given that belong to another surface
    double rms_mm = 0;       // of the others
    double wrong_color = 0;  // share of the readings that got colour and should not, or did not
};

double allowed_m(double z) {
    return 0.03 + 2 * 0.00307 * z * z;
}

template <class DepthM>
void score_depth(const reference::RegistrationTruth& truth, DepthM depth_m, RoomScore& score) {
    double measured = 0, empty = 0, filled = 0, wrong = 0, squares = 0;
    for (std::size_t i = 0; i < truth.measured.size(); ++i) {
        const double z = depth_m(i);
        const double exact = truth.depth_in_color_m.pixels()[i];
        if (truth.measured.pixels()[i] != 0) {
            ++measured;
            empty += z == 0 ? 1 : 0;
        }
        if (z == 0) continue;
        ++filled;
        if (exact == 0 || std::abs(z - exact) > allowed_m(exact)) {
            ++wrong;
        } else {
            squares += (z - exact) * (z - exact);
        }
    }
    score.empty = empty / measured;
    score.wrong = wrong / filled;
    score.rms_mm = 1000 * std::sqrt(squares / (filled - wrong));
}

void score_color(const reference::RegistrationTruth& truth, const DepthFrame& frame,
                 const Image<ColorUv>& uv, RoomScore& score) {
    double readings = 0, wrong = 0;
    for (std::size_t i = 0; i < uv.size(); ++i) {
        if (frame.raw.pixels()[i] == 0) continue;
        ++readings;
        wrong += uv.pixels()[i].valid() != (truth.seen_by_color.pixels()[i] != 0) ? 1 : 0;
    }
    score.wrong_color = wrong / readings;
}

struct RoomSizes {
    int depth_width, depth_height, color_width, color_height;
};

RigParameters make_room_rig(const RoomSizes& sizes) {
    RigParameters rig = make_rig(640, 480, true);
    const auto resize = [](CameraModel& camera, int width, int height) {
        camera.fx = camera.fy = camera.fx * width / camera.width;
        camera.width = width;
        camera.height = height;
        camera.cx = (width - 1) / 2.0;
        camera.cy = (height - 1) / 2.0;
    };
    resize(rig.depth, sizes.depth_width, sizes.depth_height);
    resize(*rig.color, sizes.color_width, sizes.color_height);
    return rig;
}

void bench_coverage(BenchContext& context, const RoomSizes& sizes) {
    const std::string what = fmt::format("room, depth {}x{}, colour {}x{}", sizes.depth_width,
                                         sizes.depth_height, sizes.color_width, sizes.color_height);
    const RigParameters parameters = make_room_rig(sizes);
    const CameraModel& color = *parameters.color;
    const Image<glm::dvec2> rays = reference::rays(parameters.depth);
    const auto scene = reference::registration_room();
    const DepthFrame frame = reference::depth_frame(scene, parameters, rays, 0.001);
    const auto truth =
        reference::registration_truth(scene, parameters, rays, reference::rays(color));

    struct Level {
        std::string name;
        RigOptions options;
        RegisteredDepth out{};
    };
    std::vector<Level> levels = {
        {"nearest", {}},
        {"bilinear", {.coverage = Coverage::bilinear}},
        {"splat", {.coverage = Coverage::splat}},
        {"splat, holes closed", {.coverage = Coverage::splat, .fill_holes_px = 100}}};
    std::vector<bench::Candidate> candidates;
    for (Level& level : levels) {
        auto rig = Rig::create(parameters, level.options);
        if (!rig) return context.fail(rig.error());
        candidates.push_back(
            {level.name, [&level, &frame, rig = std::make_shared<Rig>(std::move(*rig))] {
                 (void)rig->register_depth(frame, level.out);
             }});
    }
    reference::SplatPicture exact;
    candidates.push_back({"double reference", [&] {
                              exact = reference::splat_depth(
                                  parameters, rays,
                                  reference::register_depth(parameters, rays, frame));
                          }});
    const cv::Mat raw(frame.raw.height(), frame.raw.width(), CV_16UC1,
                      const_cast<std::uint16_t*>(frame.raw.data()));
    const cv::Mat five_terms =
        (cv::Mat_<double>(1, 5) << color.k1, color.k2, color.p1, color.p2, color.k3);
    cv::Mat dilated;
    candidates.push_back({"OpenCV registerDepth, dilated", [&] {
                              cv::rgbd::registerDepth(
                                  matrix(parameters.depth), matrix(color), five_terms,
                                  matrix(parameters.color_from_depth), raw,
                                  cv::Size(color.width, color.height), dilated, true);
                          }});
    const bench::Comparison times = context.compare(what, candidates, {.repeats = 15});

    const auto add = [&](const std::string& level, const RoomScore& score, bool has_color) {
        const auto row = [&](double error, const char* metric) {
            context.add({.case_name = what,
                         .knob = "coverage",
                         .level = level,
                         .error = error,
                         .metric = metric,
                         .baseline = level == "nearest" ? "" : "nearest"},
                        times);
        };
        row(score.empty, "share empty");
        row(score.wrong, "share of another surface");
        row(score.rms_mm, "mm RMS");
        if (has_color) row(score.wrong_color, "share colour wrong");
    };
    RoomScore splat;
    for (const Level& level : levels) {
        RoomScore score;
        score_depth(
            truth, [&](std::size_t i) { return level.out.depth_in_color_m.pixels()[i] * 1.0; },
            score);
        score_color(truth, frame, level.out.uv, score);
        add(level.name, score, true);
        if (level.name == "splat") splat = score;
    }
    RoomScore slow;
    score_depth(
        truth, [&](std::size_t i) { return exact.depth_in_color_m.pixels()[i]; }, slow);
    add("double reference", slow, false);
    RoomScore theirs;
    score_depth(
        truth, [&](std::size_t i) { return dilated.ptr<std::uint16_t>()[i] / 1000.0; }, theirs);
    add("OpenCV registerDepth, dilated", theirs, false);
    context.claim(what +
                      ": splat leaves no hole in what both cameras see, and shows another "
                      "surface, all at outlines, in fewer pixels than OpenCV's dilated picture",
                  splat.empty == 0 && splat.wrong < theirs.wrong);
}

/// How far behind the nearest surface a reading loses its colour.
void bench_occlusion(BenchContext& context, const RoomSizes& sizes) {
    const std::string what = fmt::format("room, depth {}x{}, colour {}x{}", sizes.depth_width,
                                         sizes.depth_height, sizes.color_width, sizes.color_height);
    const RigParameters parameters = make_room_rig(sizes);
    const Image<glm::dvec2> rays = reference::rays(parameters.depth);
    const auto scene = reference::registration_room();
    const DepthFrame frame = reference::depth_frame(scene, parameters, rays, 0.001);
    const auto truth =
        reference::registration_truth(scene, parameters, rays, reference::rays(*parameters.color));
    std::vector<std::string> levels;
    std::vector<bench::Candidate> candidates;
    std::vector<RegisteredDepth> out(7);
    for (const int margin_mm : {0, 10, 20, 30, 60, 120, -1}) {
        auto rig = Rig::create(parameters, {.occlusion_margin_m = 0.001 * std::max(margin_mm, 0),
                                            .occlusion_test = margin_mm >= 0});
        if (!rig) return context.fail(rig.error());
        levels.push_back(margin_mm < 0 ? "no test" : std::to_string(margin_mm));
        candidates.push_back({levels.back(), [&frame, &target = out[candidates.size()],
                                              rig = std::make_shared<Rig>(std::move(*rig))] {
                                  (void)rig->register_depth(frame, target);
                              }});
    }
    const bench::Comparison times =
        context.compare("occlusion margin, " + what, candidates, {.repeats = 15});
    for (std::size_t i = 0; i < levels.size(); ++i) {
        RoomScore score;
        score_color(truth, frame, out[i].uv, score);
        context.add({.case_name = what,
                     .knob = "occlusion margin, mm",
                     .level = levels[i],
                     .error = score.wrong_color,
                     .metric = "share colour wrong, by margin"},
                    times);
    }
}

void bench_ray_tables(BenchContext& context, const std::string& what, RigParameters parameters) {
    parameters.min_depth_m = 0;
    const Image<glm::dvec2> exact = reference::rays(parameters.depth);
    DepthFrame frame;
    frame.raw = Image<std::uint16_t>(parameters.depth.width, parameters.depth.height, 2000);
    RegisteredDepth out;
    std::vector<bench::Candidate> reading;
    std::vector<bench::Candidate> building;
    const int steps[] = {1, 2, 4, 8};
    for (const int step : steps) {
        auto rig = Rig::create(parameters, {.ray_table_step = step});
        if (!rig) return context.fail(rig.error());
        reading.push_back({std::to_string(step), [&, rig = std::make_shared<Rig>(std::move(*rig))] {
                               (void)rig->register_depth(frame, out);
                           }});
        building.push_back({std::to_string(step),
                            [&, step] { (void)registration::find_rays(parameters.depth, step); }});
    }
    const bench::Comparison read_times = context.compare("ray tables, " + what, reading);
    const bench::Comparison build_times =
        context.compare("building them, " + what, building, {.repeats = 7});
    for (const int step : steps) {
        const registration::RayTable table(registration::find_rays(parameters.depth, step),
                                           glm::dmat3(1));
        std::vector<float> x(exact.size()), y(exact.size()), z(exact.size());
        table.read(0, exact.size(), x.data(), y.data(), z.data());
        double squares = 0, worst = 0, count = 0;
        for (std::size_t i = 0; i < exact.size(); ++i) {
            if (std::isnan(exact.pixels()[i].x) || std::isnan(x[i])) continue;
            const glm::dvec2 error = (glm::dvec2(x[i], y[i]) - exact.pixels()[i]) *
                                     glm::dvec2(parameters.depth.fx, parameters.depth.fy);
            squares += glm::dot(error, error);
            worst = std::max(worst, glm::length(error));
            ++count;
        }
        const auto row = [&](const std::string& name, double error, const char* metric,
                             const bench::Comparison& times) {
            context.add({.case_name = name,
                         .knob = "ray every n pixels",
                         .level = std::to_string(step),
                         .error = error,
                         .metric = metric,
                         .baseline = step == 1 ? "" : "1"},
                        times);
        };
        row(what, std::sqrt(squares / count), "px RMS", read_times);
        row(what, worst, "px max of rays", read_times);
        row(what + ", building the table", static_cast<double>(table.bytes()) / 1024, "KiB",
            build_times);
    }
}

void bench_real_lenses(BenchContext& context) {
    const std::string folder = "tests/data/calibration/parameters/";
    const auto kinect = read_file_text(folder + "kinect1_rgbdemo.yml", 1 << 20);
    if (!kinect) return context.fail(kinect.error());
    const auto cameras = read_opencv_yaml(*kinect, "kinect1_rgbdemo.yml");
    if (!cameras) return context.fail(cameras.error());
    RigParameters rig;
    rig.depth = cameras->cameras[0].camera;
    rig.color = cameras->cameras[1].camera;
    rig.color_from_depth = *cameras->second_from_first;
    bench_ray_tables(context, "Kinect v1 (rgbdemo) 640x480", rig);
    if (context.quick()) return;
    auto azure = read_file_text(folder + "azure_pyk4a_001514394512.json", 1 << 20);
    if (!azure) return context.fail(azure.error());
    const auto wide =
        rig_from_k4a(*azure, {1024, 1024}, PixelSize{1280, 720}, "azure_pyk4a_001514394512.json");
    if (!wide) return context.fail(wide.error());
    bench_ray_tables(context, "Azure Kinect, wide 1024x1024", *wide);
}

}  // namespace

void bench_registration_levels(BenchContext& context) {
    bench_coverage(context, {320, 240, 640, 480});
    bench_occlusion(context, {320, 240, 640, 480});
    if (!context.quick()) {
        bench_coverage(context, {640, 480, 640, 480});
        bench_coverage(context, {320, 240, 1280, 720});
    }
    bench_real_lenses(context);
    context.note(
        "\"room\" is a scene of slanted walls, boxes, balls and rods from 1 to 40 mm, cut by rays "
        "in closed form from both cameras: depth in whole millimetres without noise. Empty counts "
        "what both cameras see at least a depth pixel away from an outline; another surface means "
        "off by more than 30 mm and two quantisation steps. At outlines no method can know which "
        "half of a depth pixel is which.");
}

}  // namespace kino
