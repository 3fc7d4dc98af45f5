#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <opencv2/calib3d.hpp>

#include "calibration/boards/gather.h"
#include "calibration/files/camera_text.h"
#include "calibration/projection.h"
#include "calibration/solve/calibrate.h"
#include "sensor/file_bytes.h"
#include "tests/support/random.h"

namespace kino {
namespace {

const std::string kData = "tests/data/calibration/";

struct Rival {
    std::vector<std::vector<cv::Point3f>> boards;
    std::vector<std::vector<cv::Point2f>> seen;
    cv::Mat matrix;
    cv::Mat distortion;
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
    std::vector<cv::Mat> rotations;
    std::vector<cv::Mat> translations;
    out.rms = cv::calibrateCamera(out.boards, out.seen, {own.width, own.height}, out.matrix,
                                  out.distortion, rotations, translations, flags,
                                  {cv::TermCriteria::COUNT | cv::TermCriteria::EPS, 200, 1e-10});
    return out;
}

CalibrateOptions squared(LensModel model) {
    CalibrateOptions options;
    options.models = {model};
    options.bundle.huber_sigmas = 0;
    return options;
}

Result<Shots> chessboards() {
    std::vector<std::string> notes;
    KINO_ASSIGN(const PictureSet set, picture_pairs_in(kData + "chessboards"));
    return shots_of_pictures(set, *parse_board("chess:9x6:25"), notes);
}

Result<Shots> azure() {
    std::vector<std::string> notes;
    KINO_ASSIGN(const PictureSet set, pictures_in(kData + "azure-charuco"));
    return shots_of_pictures(set, *parse_board("charuco:14x9:40:30:6"), notes);
}

TEST(RealSets, ChessboardsAsOpenCvOneCamera) {
    const auto shots = chessboards();
    ASSERT_TRUE(shots) << shots.error().to_string();
    for (std::size_t camera = 0; camera < 2; ++camera) {
        const Shots one = only_camera(*shots, camera);
        const auto ours = calibrate(one, squared(LensModel::brown5));
        ASSERT_TRUE(ours) << ours.error().to_string();
        const Rival theirs = rival(*shots, camera, 0);
        EXPECT_NEAR(ours->rms_px, theirs.rms, 0.01 * theirs.rms);
        EXPECT_NEAR(ours->cameras[0].camera.fx, theirs.matrix.at<double>(0, 0), 0.5);
        EXPECT_EQ(one.names.size(), 9u);
    }
}

TEST(RealSets, ChessboardsAsOpenCvStereo) {
    const auto shots = chessboards();
    ASSERT_TRUE(shots) << shots.error().to_string();
    const auto ours = calibrate(*shots, squared(LensModel::brown5));
    ASSERT_TRUE(ours) << ours.error().to_string();
    Rival left = rival(*shots, 0, 0);
    Rival right = rival(*shots, 1, 0);
    cv::Mat rotation;
    cv::Mat translation;
    cv::Mat essential;
    cv::Mat fundamental;
    const double rms =
        cv::stereoCalibrate(left.boards, left.seen, right.seen, left.matrix, left.distortion,
                            right.matrix, right.distortion, {640, 480}, rotation, translation,
                            essential, fundamental, cv::CALIB_USE_INTRINSIC_GUESS,
                            {cv::TermCriteria::COUNT | cv::TermCriteria::EPS, 300, 1e-12});
    EXPECT_NEAR(ours->rms_px, rms, 0.01 * rms);
    EXPECT_NEAR(1000 * ours->second_from_first.translation.x, 1000 * translation.at<double>(0),
                0.5);
}

TEST(RealSets, AzureCharucoAsOpenCvAndAsPublished) {
    const auto shots = azure();
    ASSERT_TRUE(shots) << shots.error().to_string();
    EXPECT_EQ(shots->names.size(), 12u);
    const auto same = calibrate(*shots, squared(LensModel::rational8));
    ASSERT_TRUE(same) << same.error().to_string();
    const Rival theirs = rival(*shots, 0, cv::CALIB_RATIONAL_MODEL);
    EXPECT_NEAR(same->rms_px, theirs.rms, 0.01 * theirs.rms);

    const auto chosen = calibrate(*shots);
    ASSERT_TRUE(chosen) << chosen.error().to_string();
    EXPECT_EQ(chosen->cameras[0].model, LensModel::rational8);
    const std::string path = kData + "parameters/azure_charuco_fullres.yml";
    const auto published = read_opencv_yaml(*read_file_text(path, 65536), path);
    ASSERT_TRUE(published) << published.error().to_string();
    const CameraModel truth = scaled(published->cameras[0].camera, 1024, 768);
    const CameraModel& ours = chosen->cameras[0].camera;
    EXPECT_NEAR(ours.fx, truth.fx, 0.005 * truth.fx);
    EXPECT_NEAR(ours.fy, truth.fy, 0.005 * truth.fy);
    EXPECT_NEAR(ours.cx, truth.cx, 0.005 * 1024);
    EXPECT_NEAR(ours.cy, truth.cy, 0.005 * 1024);
}

TEST(RealSets, OurChoiceHoldsUpAgainstOpenCvOnViewsLeftOut) {
    const auto shots = chessboards();
    ASSERT_TRUE(shots);
    for (std::size_t camera = 0; camera < 2; ++camera) {
        const Shots one = only_camera(*shots, camera);
        const auto chosen = calibrate(one);
        ASSERT_TRUE(chosen) << chosen.error().to_string();
        const CameraResult& ours = chosen->cameras[0];
        const auto theirs = held_out(one, 5, [](const Shots& training) -> Result<Lens> {
            const Rival fitted = rival(training, 0, 0);
            const auto k = [&](int row, int column) {
                return fitted.matrix.at<double>(row, column);
            };
            Lens lens{k(0, 0), k(1, 1), k(0, 2), k(1, 2)};
            for (int i = 0; i < 5; ++i)
                lens[static_cast<std::size_t>(4 + i)] = fitted.distortion.at<double>(i);
            return lens;
        });
        ASSERT_TRUE(theirs) << theirs.error().to_string();
        const auto own = std::find_if(ours.scores.begin(), ours.scores.end(),
                                      [&](const LensScore& s) { return s.model == ours.model; });
        ASSERT_NE(own, ours.scores.end());
        // The bootstrap of the difference over the views: not above zero beyond its 95 %.
        test::Random random(5);
        std::vector<double> means;
        const std::size_t views = own->view_squares.size();
        for (int draw = 0; draw < 1000; ++draw) {
            double sum = 0;
            for (std::size_t i = 0; i < views; ++i) {
                const auto v =
                    static_cast<std::size_t>(random.integer(0, static_cast<int>(views) - 1));
                sum += own->view_squares[v] - theirs->view_squares[v];
            }
            means.push_back(sum / static_cast<double>(views));
        }
        std::sort(means.begin(), means.end());
        EXPECT_LE(means[25], 0) << own->held_out_px << " against " << theirs->held_out_px;
    }
}

}  // namespace
}  // namespace kino
