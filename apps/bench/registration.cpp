#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <opencv2/rgbd/depth.hpp>
#include <string>
#include <vector>

#include "apps/bench/registration_levels.h"
#include "apps/bench/registration_peers.h"
#include "apps/bench/registry.h"
#include "calibration/color_in_depth.h"
#include "calibration/depth_points.h"
#include "calibration/rig.h"
#include "sensor/source.h"
#include "tests/reference/registration_reference.h"

namespace kino {
namespace {

constexpr const char* kRecording = "recordings/office";

Result<DepthFrame> read_office() {
    KINO_ASSIGN(const auto source, open_source(kRecording));
    KINO_TRY(subscribe_all(*source));
    KINO_ASSIGN(const auto frames, source->next(kNsPerSecond));
    if (!frames || !frames->depth) return fail("the recording holds no depth frame", kRecording);
    return *frames->depth;
}

struct DepthError {
    double worst_mm = 0;      // where both chose the same winner
    double other_winner = 0;  // share of the reference's filled pixels
};

// `same_mm`: how far two values of one winner can lie apart by rounding.
template <class DepthMm>
DepthError depth_error(const Image<double>& exact_m, DepthMm depth_mm, double same_mm) {
    DepthError out;
    std::size_t filled = 0;
    std::size_t other = 0;
    for (std::size_t i = 0; i < exact_m.size(); ++i) {
        const double exact = exact_m.pixels()[i] * 1000;
        const double mm = depth_mm(i);
        if (exact > 0) ++filled;
        if ((mm > 0) != (exact > 0) || std::abs(mm - exact) > same_mm) {
            ++other;
        } else {
            out.worst_mm = std::max(out.worst_mm, std::abs(mm - exact));
        }
    }
    out.other_winner = static_cast<double>(other) / static_cast<double>(filled);
    return out;
}

double worst_uv_px(const reference::Registration& exact, const Image<ColorUv>& uv,
                   const CameraModel& color) {
    double worst = 0;
    for (std::size_t i = 0; i < uv.size(); ++i) {
        const ColorUv p = uv.pixels()[i];
        const glm::dvec2 e = exact.uv.pixels()[i];
        if (!p.valid() || std::isnan(e.x)) continue;
        const glm::dvec2 inside(std::clamp(e.x, 0.0, color.width - 1.0),
                                std::clamp(e.y, 0.0, color.height - 1.0));
        worst = std::max(worst, glm::length(glm::dvec2(p.u, p.v) / 16.0 - inside));
    }
    return worst;
}

void bench_rig(BenchContext& context, const DepthFrame& frame, bool distorted) {
    const std::string what =
        distorted ? "office 640x480, 5-term distortion" : "office 640x480, no distortion";
    const RigParameters parameters = make_rig(frame.raw.width(), frame.raw.height(), distorted);
    const CameraModel& color = *parameters.color;
    auto fast = Rig::create(parameters);
    auto portable = Rig::create(parameters, {.simd = false});
    if (!fast || !portable) return context.fail((fast ? portable : fast).error());
    RegisteredDepth fast_out;
    RegisteredDepth portable_out;
    reference::Registration exact;
    const Image<glm::dvec2> rays = reference::rays(parameters.depth);

    // Shares the frame's pixels; OpenCV only reads them.
    const cv::Mat raw(frame.raw.height(), frame.raw.width(), CV_16UC1,
                      const_cast<std::uint16_t*>(frame.raw.data()));
    const cv::Mat no_distortion;
    const cv::Mat five_terms =
        (cv::Mat_<double>(1, 5) << color.k1, color.k2, color.p1, color.p2, color.k3);
    cv::Mat registered;
    const std::vector<bench::Candidate> candidates = {
        {"rig", [&] { (void)fast->register_depth(frame, fast_out); }},
        {"rig portable", [&] { (void)portable->register_depth(frame, portable_out); }},
        {"double reference", [&] { exact = reference::register_depth(parameters, rays, frame); }},
        {"OpenCV registerDepth", [&] {
             cv::rgbd::registerDepth(matrix(parameters.depth), matrix(color),
                                     distorted ? five_terms : no_distortion,
                                     matrix(parameters.color_from_depth), raw,
                                     cv::Size(color.width, color.height), registered, false);
         }}};
    const bench::Comparison times = context.compare("registration, " + what, candidates);

    const auto in_mm = [](const RegisteredDepth& out) {
        return [&out](std::size_t i) { return out.depth_in_color_m.pixels()[i] * 1000.0; };
    };
    const auto add = [&](const std::string& level, double error, const std::string& metric) {
        context.add({.case_name = what,
                     .knob = "path",
                     .level = level,
                     .error = error,
                     .metric = metric,
                     .baseline = level == "OpenCV registerDepth" ? "" : "OpenCV registerDepth"},
                    times);
    };
    const auto add_ours = [&](const std::string& level, const RegisteredDepth& out) {
        const DepthError error = depth_error(exact.depth_in_color_m, in_mm(out), 0.1);
        add(level, worst_uv_px(exact, out.uv, color), "px max");
        add(level, error.worst_mm, "mm max");
        add(level, error.other_winner, "share other winner");
        return error;
    };
    const DepthError ours = add_ours("rig", fast_out);
    add_ours("rig portable", portable_out);
    add("double reference", 0, "mm max");
    // OpenCV answers in whole millimetres, so one winner may come out up to 1 mm apart.
    const DepthError theirs = depth_error(
        exact.depth_in_color_m,
        [&](std::size_t i) { return registered.ptr<std::uint16_t>()[i] * 1.0; }, 1.0);
    add("OpenCV registerDepth", theirs.worst_mm, "mm max");
    add("OpenCV registerDepth", theirs.other_winner, "share other winner");

    if (distorted) {
        context.claim(
            "registration with distortion, uv map and occlusion test is at least 6 times "
            "faster than OpenCV's registerDepth, one thread",
            times.speedup("rig", "OpenCV registerDepth") >= 6);
    }
    context.claim(what +
                      ": uv within 0.05 px and depth within 0.1 mm of the double reference, "
                      "other winner in at most 0.1 % of pixels",
                  worst_uv_px(exact, fast_out.uv, color) < 0.05 && ours.worst_mm < 0.1 &&
                      ours.other_winner <= 0.001);
}

void bench_points(BenchContext& context, const DepthFrame& frame) {
    const RigParameters parameters = make_rig(frame.raw.width(), frame.raw.height(), false);
    auto rig = Rig::create(parameters);
    if (!rig) return context.fail(rig.error());
    RegisteredDepth registered;
    if (const auto done = rig->register_depth(frame, registered); !done) {
        return context.fail(done.error());
    }
    const cv::Mat raw(frame.raw.height(), frame.raw.width(), CV_16UC1,
                      const_cast<std::uint16_t*>(frame.raw.data()));
    cv::Mat metres;
    raw.convertTo(metres, CV_32F, frame.metres_per_unit);
    const cv::Matx33d camera = matrix(parameters.depth);
    cv::Mat from_u16;
    cv::Mat from_f32;
    Image<glm::vec3> points;
    const std::vector<bench::Candidate> candidates = {
        {"unproject_depth",
         [&] { unproject_depth(registered.depth_m, rig->depth_rays(), points); }},
        {"OpenCV depthTo3d f32", [&] { cv::rgbd::depthTo3d(metres, camera, from_f32); }},
        {"OpenCV depthTo3d u16", [&] { cv::rgbd::depthTo3d(raw, camera, from_u16); }}};
    const bench::Comparison times = context.compare("back-projection", candidates);
    const CameraModel& c = parameters.depth;
    const auto worst_mm = [&](auto&& point) {
        double worst = 0;
        for (int y = 0; y < c.height; ++y) {
            for (int x = 0; x < c.width; ++x) {
                const double z = frame.raw.at(x, y) * frame.metres_per_unit;
                if (frame.raw.at(x, y) == 0) continue;
                const glm::dvec3 exact(z * (x - c.cx) / c.fx, z * (y - c.cy) / c.fy, z);
                worst = std::max(worst, 1000 * glm::length(point(x, y) - exact));
            }
        }
        return worst;
    };
    const auto from = [](const cv::Mat& mat) {
        return [&mat](int x, int y) {
            const auto& p = mat.at<cv::Vec3f>(y, x);
            return glm::dvec3(p[0], p[1], p[2]);
        };
    };
    const auto add = [&](const std::string& level, double error, const std::string& baseline) {
        context.add({.case_name = "office 640x480, depth to points",
                     .knob = "path",
                     .level = level,
                     .error = error,
                     .metric = "mm max",
                     .baseline = baseline},
                    times);
    };
    add("unproject_depth", worst_mm([&](int x, int y) { return glm::dvec3(points.at(x, y)); }),
        "OpenCV depthTo3d f32");
    add("OpenCV depthTo3d f32", worst_mm(from(from_f32)), "");
    add("OpenCV depthTo3d u16", worst_mm(from(from_u16)), "");
}

void bench_color(BenchContext& context, const DepthFrame& frame) {
    const RigParameters parameters = make_rig(frame.raw.width(), frame.raw.height(), true);
    auto rig = Rig::create(parameters);
    if (!rig) return context.fail(rig.error());
    RegisteredDepth registered;
    const Image<Rgba8> color(parameters.color->width, parameters.color->height);
    Image<Rgba8> out;
    const auto run = [&](ColorSampling sampling) {
        return [&, sampling] {
            (void)rig->register_depth(frame, registered);
            register_color(registered.uv, color, sampling, out);
        };
    };
    const std::vector<bench::Candidate> candidates = {{"nearest", run(ColorSampling::nearest)},
                                                      {"bilinear", run(ColorSampling::bilinear)}};
    const bench::Comparison times = context.compare("colour to depth", candidates);
    for (const auto& candidate : candidates) {
        context.add({.case_name = "office 640x480, register depth, then colour to its grid",
                     .knob = "sampling",
                     .level = candidate.name},
                    times);
    }
}

}  // namespace

void bench_registration(BenchContext& context) {
    const auto frame = read_office();
    if (!frame) return context.fail(frame.error());
    cv::setNumThreads(1);
    bench_rig(context, *frame, true);
    if (!context.quick()) bench_rig(context, *frame, false);
    bench_points(context, *frame);
    bench_color(context, *frame);
    bench_registration_levels(context);
    context.note(
        "One frame of recordings/office (PrimeSense), depth camera 575.8 px, colour camera "
        "525 px, 25 mm beside it and turned by 5 mrad; everything on one thread. \"rig\" "
        "gives depth in metres, the uv map, the occlusion test and the depth seen from the "
        "colour camera; OpenCV gives the last of these, in whole millimetres. Nothing is "
        "allocated per frame in ours; OpenCV's outputs are reused, too.");
}

}  // namespace kino
