#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <glm/geometric.hpp>
#include <numbers>
#include <opencv2/calib3d.hpp>
#include <string>
#include <vector>

#include "apps/bench/registry.h"
#include "calibration/boards/gather.h"
#include "calibration/files/camera_text.h"
#include "calibration/projection.h"
#include "calibration/solve/calibrate.h"
#include "calibration/solve/initial.h"
#include "sensor/file_bytes.h"
#include "tests/calibration/solve/synthetic_boards.h"
#include "tests/support/random.h"

namespace kino {
namespace {

constexpr double kDegrees = 180 / 3.14159265358979323846;
const std::string kData = "tests/data/calibration/";

double ms_of(const std::function<void()>& run) {
    const auto began = std::chrono::steady_clock::now();
    run();
    return std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - began)
        .count();
}

CalibrateOptions one_model(LensModel model, bool robust) {
    CalibrateOptions options;
    options.models = {model};
    if (!robust) options.bundle.huber_sigmas = 0;
    return options;
}

// As the tests hold the boards: half of the picture, tilted by 25 to 50 degrees.
test::BoardScene guided(int views, std::uint64_t seed) {
    return test::make_scene(test::typical_rig(), {.views = views,
                                                  .columns = 11,
                                                  .rows = 8,
                                                  .square_m = 0.025,
                                                  .nearest_m = 0.32,
                                                  .farthest_m = 0.5,
                                                  .least_tilt_deg = 25,
                                                  .largest_tilt_deg = 50,
                                                  .seed = seed});
}

struct SyntheticErrors {
    std::vector<double> focal_percent, centre_px, shift_mm, turn_deg, ms;
    int good = 0;           // all of the bounds
    double within_one = 0;  // share of the fourteen numbers within their stated deviation
};

SyntheticErrors synthetic(BenchContext& context, int views, int seeds) {
    SyntheticErrors out;
    for (int seed = 0; seed < seeds; ++seed) {
        const auto scene = guided(views, 1000 + static_cast<std::uint64_t>(seed));
        const Shots shots = test::photograph(scene, 0.2, 77 + static_cast<std::uint64_t>(seed));
        Result<Calibration> found = kino::fail("not run");
        out.ms.push_back(
            ms_of([&] { found = calibrate(shots, one_model(LensModel::brown4, true)); }));
        if (!found) {
            context.fail(found.error());
            continue;
        }
        double focal = 0;
        double centre = 0;
        for (std::size_t c = 0; c < 2; ++c) {
            const Lens truth = lens_of(c == 0 ? scene.rig.depth : *scene.rig.color);
            for (std::size_t i = 0; i < 4; ++i) {
                const SolvedNumber& number = found->cameras[c].numbers[i];
                const double error = std::abs(number.value - truth[i]);
                (i < 2 ? focal : centre) =
                    std::max(i < 2 ? focal : centre, error / (i < 2 ? truth[i] / 100 : 1));
                out.within_one += error <= number.sigma ? 1 : 0;
            }
        }
        const TurnedPose truth = turned(scene.rig.color_from_depth);
        for (std::size_t i = 0; i < 6; ++i) {
            const double scale = i < 3 ? kDegrees : 1000;
            out.within_one +=
                std::abs(found->rig[i].value - scale * truth[i]) <= found->rig[i].sigma ? 1 : 0;
        }
        const Pose step = inverse(scene.rig.color_from_depth) * found->second_from_first;
        out.focal_percent.push_back(focal);
        out.centre_px.push_back(centre);
        out.shift_mm.push_back(1000 * glm::length(step.translation));
        out.turn_deg.push_back(kDegrees * rotation_angle_rad(step));
        const bool good =
            focal < 0.3 && centre < 1.5 && out.shift_mm.back() < 2 && out.turn_deg.back() < 0.1;
        out.good += good ? 1 : 0;
    }
    out.within_one /= 14.0 * seeds;
    return out;
}

void bench_synthetic(BenchContext& context) {
    const int seeds = context.quick() ? 20 : 100;
    for (const int views : {5, 10, 20, 40}) {
        context.progress(fmt::format("synthetic boards, {} views", views));
        const SyntheticErrors e = synthetic(context, views, views == 40 ? seeds / 4 : seeds);
        const auto add = [&](const std::vector<double>& errors, const std::string& metric) {
            BenchRow row;
            row.case_name = "synthetic pair, 0.2 px noise";
            row.knob = "views";
            row.level = std::to_string(views);
            row.ms_median = bench::quantile(e.ms, 0.5);
            row.ms_p95 = bench::quantile(e.ms, 0.95);
            row.error = bench::quantile(errors, 0.95);
            row.metric = metric;
            context.add(std::move(row));
        };
        add(e.focal_percent, "focal %, 95 of 100");
        add(e.centre_px, "centre px, 95 of 100");
        add(e.shift_mm, "shift mm, 95 of 100");
        add(e.turn_deg, "turn deg, 95 of 100");
        if (views == 20) {
            context.claim(
                fmt::format("20 views, 0.2 px noise: focal length within 0.3 %, principal "
                            "point 1.5 px, pose 2 mm and 0.1 deg in 95 of 100 ({} of {})",
                            e.good, seeds),
                e.good >= 0.95 * seeds);
            context.claim(fmt::format("stated standard deviations hold the truth as often as they "
                                      "say, 68.3 % ({:.1f} %)",
                                      100 * e.within_one),
                          std::abs(e.within_one - 0.683) < 0.06);
        }
        if (views == 40) {
            context.claim("a solve of 40 views takes under 10 s",
                          bench::quantile(e.ms, 0.95) < 10000);
        }
    }
}

/// The loss against wrong corners: 2 % of them are off by 5 to 20 px.
void bench_loss(BenchContext& context) {
    context.progress("loss");
    const int seeds = context.quick() ? 5 : 25;
    for (const double sigmas : {0.0, 1.0, 2.0, 3.0, 5.0, 10.0}) {
        std::vector<double> ms, focal_percent;
        for (int seed = 0; seed < seeds; ++seed) {
            const auto scene = guided(20, 3000 + static_cast<std::uint64_t>(seed));
            Shots shots = test::photograph(scene, 0.2, 99 + static_cast<std::uint64_t>(seed));
            test::Random random(500 + static_cast<std::uint64_t>(seed));
            for (CameraShots& camera : shots.cameras) {
                for (auto& view : camera.views) {
                    for (ShotCorner& corner : view) {
                        if (!random.chance(0.02)) continue;
                        const double turn = random.real(0, 2 * std::numbers::pi);
                        corner.px +=
                            random.real(5, 20) * glm::dvec2(std::cos(turn), std::sin(turn));
                    }
                }
            }
            CalibrateOptions options = one_model(LensModel::brown4, true);
            options.bundle.huber_sigmas = sigmas;
            Result<Calibration> found = kino::fail("not run");
            ms.push_back(ms_of([&] { found = calibrate(shots, options); }));
            if (!found) return context.fail(found.error());
            double worst = 0;
            for (std::size_t c = 0; c < 2; ++c) {
                const Lens truth = lens_of(c == 0 ? scene.rig.depth : *scene.rig.color);
                for (std::size_t i = 0; i < 2; ++i) {
                    const double off = std::abs(found->cameras[c].numbers[i].value - truth[i]);
                    worst = std::max(worst, 100 * off / truth[i]);
                }
            }
            focal_percent.push_back(worst);
        }
        context.add({.case_name = "synthetic pair, 20 views, 2 % of the corners wrong",
                     .knob = "loss, sigmas",
                     .level = fmt::format("{}", sigmas),
                     .ms_median = bench::quantile(ms, 0.5),
                     .ms_p95 = bench::quantile(ms, 0.95),
                     .error = bench::quantile(focal_percent, 0.5),
                     .metric = "focal %, median, 2 % of the corners wrong"});
    }
}

struct Rival {
    std::vector<std::vector<cv::Point3f>> boards;
    std::vector<std::vector<cv::Point2f>> seen;
    cv::Mat matrix, distortion;
    double rms = 0;
};

Rival rival(const Shots& shots, std::size_t camera, int flags) {
    Rival out;
    const CameraShots& own = shots.cameras[camera];
    for (const auto& view : own.views) {
        if (view.empty()) continue;
        auto& board = out.boards.emplace_back();
        auto& seen = out.seen.emplace_back();
        for (const ShotCorner& corner : view) {
            const glm::dvec2 at = shots.corners_m[static_cast<std::size_t>(corner.id)];
            board.emplace_back(static_cast<float>(at.x), static_cast<float>(at.y), 0.0f);
            seen.emplace_back(static_cast<float>(corner.px.x), static_cast<float>(corner.px.y));
        }
    }
    std::vector<cv::Mat> rotations, translations;
    out.rms = cv::calibrateCamera(out.boards, out.seen, {own.width, own.height}, out.matrix,
                                  out.distortion, rotations, translations, flags,
                                  {cv::TermCriteria::COUNT | cv::TermCriteria::EPS, 200, 1e-10});
    return out;
}

void add_rms(BenchContext& context, const std::string& case_name, const std::string& level,
             double ms, double error, const std::string& metric = "px RMS") {
    BenchRow row;
    row.case_name = case_name;
    row.knob = "solver";
    row.level = level;
    row.ms_median = ms;
    row.error = error;
    row.metric = metric;
    context.add(std::move(row));
}

// Same model, same corners, squared loss.
void bench_against_opencv(BenchContext& context, const std::string& what, const Shots& shots,
                          std::size_t camera, LensModel model, int flags) {
    const Shots one = only_camera(shots, camera);
    Result<Calibration> ours = kino::fail("not run");
    const double ms = ms_of([&] { ours = calibrate(one, one_model(model, false)); });
    if (!ours) return context.fail(ours.error());
    Rival theirs;
    const double their_ms = ms_of([&] { theirs = rival(shots, camera, flags); });
    add_rms(context, what, "kinoscope, squared loss", ms, ours->rms_px);
    add_rms(context, what, "OpenCV calibrateCamera", their_ms, theirs.rms);
    context.claim(what + ": RMS within 1 % of OpenCV's with the same model and squared loss",
                  std::abs(ours->rms_px - theirs.rms) <= 0.01 * theirs.rms);
    const auto chosen = calibrate(one);
    if (!chosen) return context.fail(chosen.error());
    const auto held = held_out(one, 5, [&](const Shots& training) -> Result<Lens> {
        const Rival fitted = rival(training, 0, flags);
        const auto k = [&](int row, int column) { return fitted.matrix.at<double>(row, column); };
        Lens lens{k(0, 0), k(1, 1), k(0, 2), k(1, 2)};
        const int count = std::min(8, static_cast<int>(fitted.distortion.total()));
        for (int i = 0; i < count; ++i) {
            lens[static_cast<std::size_t>(4 + i)] = fitted.distortion.at<double>(i);
        }
        return lens;
    });
    if (!held) return context.fail(held.error());
    const CameraResult& result = chosen->cameras[0];
    for (const LensScore& score : result.scores) {
        const bool taken = score.model == result.model;
        add_rms(context, what, fmt::format("{}{}", name(score.model), taken ? ", chosen" : ""),
                bench::kNotMeasured, score.held_out_px, "px RMS held out");
    }
    add_rms(context, what, "OpenCV", bench::kNotMeasured, held->held_out_px, "px RMS held out");
}

void bench_real(BenchContext& context) {
    std::vector<std::string> notes;
    const auto pairs = picture_pairs_in(kData + "chessboards");
    const auto board = parse_board("chess:9x6:25");
    if (!pairs || !board) return context.fail(pairs ? board.error() : pairs.error());
    context.progress("chessboards");
    const auto shots = shots_of_pictures(*pairs, *board, notes);
    if (!shots) return context.fail(shots.error());
    bench_against_opencv(context, "OpenCV's chessboards, left", *shots, 0, LensModel::brown5, 0);
    bench_against_opencv(context, "OpenCV's chessboards, right", *shots, 1, LensModel::brown5, 0);

    context.progress("ChArUco");
    const auto pictures = pictures_in(kData + "azure-charuco");
    const auto charuco = parse_board("charuco:14x9:40:30:6");
    if (!pictures || !charuco) return context.fail(pictures ? charuco.error() : pictures.error());
    const auto azure = shots_of_pictures(*pictures, *charuco, notes);
    if (!azure) return context.fail(azure.error());
    bench_against_opencv(context, "Azure Kinect ChArUco", *azure, 0, LensModel::rational8,
                         cv::CALIB_RATIONAL_MODEL);
    const auto text = read_file_text(kData + "parameters/azure_charuco_fullres.yml", 65536);
    const auto published = text ? read_opencv_yaml(*text, "published")
                                : Result<OpenCvCalibration>(kino::fail("not there"));
    if (!published) return context.fail(published.error());
    const auto ours = calibrate(*azure);
    if (!ours) return context.fail(ours.error());
    const CameraModel truth = scaled(published->cameras[0].camera, 1024, 768);
    const CameraModel& c = ours->cameras[0].camera;
    const double focal =
        100 * std::max(std::abs(c.fx / truth.fx - 1), std::abs(c.fy / truth.fy - 1));
    const double centre =
        100 * std::max(std::abs(c.cx - truth.cx), std::abs(c.cy - truth.cy)) / 1024;
    add_rms(context, "Azure Kinect ChArUco", "against the published values", bench::kNotMeasured,
            focal, "focal %");
    add_rms(context, "Azure Kinect ChArUco", "against the published values", bench::kNotMeasured,
            centre, "centre, % of width");
    context.claim(
        "Azure Kinect: within 0.5 % of the published focal length and 0.5 % of the width "
        "for the principal point",
        focal < 0.5 && centre < 0.5);
}

void bench_detection(BenchContext& context) {
    const auto picture = read_grey(kData + "chessboards/left01.jpg");
    const auto board = parse_board("chess:9x6:25");
    // One that is not in the picture.
    const auto other = parse_board("charuco:14x9:40:30:6");
    if (!picture || !board || !other) return context.fail({"no picture of a board", kData, ""});
    // Full of corners, but of another board: the detector's hard case.
    const auto large = read_grey(kData + "azure-charuco/color-0.jpg");
    if (!large || large->width() < 640 || large->height() < 480) {
        return context.fail({"no picture of a board", kData, ""});
    }
    GreyPicture clutter(640, 480);
    for (int y = 0; y < 480; ++y) {
        for (int x = 0; x < 640; ++x) clutter.at(x, y) = large->at(x, y);
    }
    const std::vector<bench::Candidate> candidates = {
        {"guided, sought in vain among other corners",
         [&] { (void)find_board(clutter, *board, {.quick = true}); }},
        {"guided", [&] { (void)find_board(*picture, *board, {.quick = true}); }},
        {"thorough", [&] { (void)find_board(*picture, *board); }},
        {"guided, ChArUco sought in vain",
         [&] { (void)find_board(*picture, *other, {.quick = true}); }}};
    const bench::Comparison times = context.compare("detection", candidates);
    for (const auto& candidate : candidates) {
        context.add(
            {.case_name = "chessboard in 640x480", .knob = "detection", .level = candidate.name},
            times);
    }
    context.claim("guided detection keeps 15 pictures a second at 640x480",
                  times["guided"].median_ms() < 1000.0 / 15);
}

}  // namespace

void bench_calibration(BenchContext& context) {
    bench_synthetic(context);
    bench_loss(context);
    bench_real(context);
    bench_detection(context);
    context.note(
        "Synthetic pair: infrared 581 px and colour 528 px with distortion, 25 mm apart; boards of "
        "11 x 8 corners that fill about half of the picture, tilted by 25 to 50 degrees. The error "
        "is the one that 95 of 100 seeds stay under (25 seeds with 40 views); the worse of the two "
        "cameras counts. Loss: a corner farther off than so many standard deviations counts "
        "linearly; 0: squares throughout.");
    context.note(
        "Held out: five folds over the views; in a view left out the pose comes from every other "
        "corner and the error from the rest. OpenCV is fitted to the same folds.");
    context.note(
        "The ChArUco pictures are a quarter of their size, so the published values are, too. "
        "Solves are timed once each, detection over many rounds.");
}

}  // namespace kino
