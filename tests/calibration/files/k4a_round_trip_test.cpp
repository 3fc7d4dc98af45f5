#include <gtest/gtest.h>

#include <cmath>
#include <glm/geometric.hpp>
#include <glm/gtc/quaternion.hpp>
#include <nlohmann/json.hpp>

#include "sensor/convert/k4a_calibration.h"
#include "sensor/file_bytes.h"
#include "tests/support/random.h"

namespace kino {
namespace {

constexpr PixelSize kDepthSizes[] = {{320, 288}, {640, 576}, {512, 512}, {1024, 1024}};
constexpr PixelSize kColorSizes[] = {{1280, 720},  {1920, 1080}, {2560, 1440},
                                     {2048, 1536}, {3840, 2160}, {4096, 3072}};
constexpr const char* kFiles[] = {"azure_TestCalibration.json", "azure_pyk4a_001514394512.json"};

std::string k4a_file(const std::string& name) {
    return read_file_text("tests/data/calibration/parameters/" + name, 1 << 20).value();
}

double ulps_apart(double a, double b) {
    if (a == b) return 0;
    const double ulp = std::nextafter(std::abs(a), INFINITY) - std::abs(a);
    return std::abs(a - b) / ulp;
}

nlohmann::json numbers_of(const std::string& json, const std::string& location) {
    // The factory's files begin with a byte order mark.
    const auto root = nlohmann::json::parse(json.substr(json.find('{')));
    for (const auto& camera : root["CalibrationInformation"]["Cameras"]) {
        if (camera["Location"] == location) return camera;
    }
    return {};
}

TEST(K4aRoundTrip, RealFilesKeepTheirDigits) {
    for (const char* name : kFiles) {
        const std::string file = k4a_file(name);
        for (const PixelSize depth : kDepthSizes) {
            for (const PixelSize color : kColorSizes) {
                const RigParameters rig = rig_from_k4a(file, depth, color, name).value();
                const std::string written = rig_to_k4a(rig).value();
                const RigParameters again = rig_from_k4a(written, depth, color, "again").value();
                EXPECT_EQ(again.depth, rig.depth) << name;
                EXPECT_EQ(again.color, rig.color) << name;
                EXPECT_EQ(again.color_from_depth, rig.color_from_depth) << name;
                EXPECT_TRUE(rig_to_k4a(again).value() == written) << name;
                for (const char* place :
                     {"CALIBRATION_CameraLocationD0", "CALIBRATION_CameraLocationPV0"}) {
                    const auto theirs = numbers_of(file, place);
                    const auto ours = numbers_of(written, place);
                    for (std::size_t i = 0; i < 14; ++i) {
                        // A CameraModel has no centre of distortion of its own.
                        if (i == 10 || i == 11) continue;
                        EXPECT_EQ(theirs["Intrinsics"]["ModelParameters"][i].get<double>(),
                                  ours["Intrinsics"]["ModelParameters"][i].get<double>())
                            << name << " " << place << " parameter " << i << " at " << depth.width
                            << ", " << color.width;
                    }
                    EXPECT_EQ(theirs["Rt"]["Translation"], ours["Rt"]["Translation"]) << name;
                    // Nine floats are a rotation to 1e-7 only; ours is one to 1e-16.
                    for (std::size_t i = 0; i < 9; ++i) {
                        EXPECT_NEAR(theirs["Rt"]["Rotation"][i].get<double>(),
                                    ours["Rt"]["Rotation"][i].get<double>(), 2e-7);
                    }
                }
            }
        }
    }
}

TEST(K4aRoundTrip, AnyRigIsExactToTheDigitsWritten) {
    test::Random random(41);
    const auto camera = [&](PixelSize size) {
        CameraModel c{.width = size.width, .height = size.height};
        c.fx = size.width * random.real(0.3, 2);
        c.fy = size.height * random.real(0.3, 2);
        c.cx = size.width * random.real(0.001, 0.999);
        c.cy = size.height * random.real(0.001, 0.999);
        for (double* k : {&c.k1, &c.k2, &c.k3, &c.k4, &c.k5, &c.k6, &c.p1, &c.p2}) {
            *k = random.real(-1, 1);
        }
        return c;
    };
    int exact = 0;
    constexpr int kRigs = 600;
    for (int i = 0; i < kRigs; ++i) {
        const PixelSize depth = kDepthSizes[i % 4];
        const PixelSize color = kColorSizes[i % 6];
        RigParameters rig = typical_k4a_rig(depth, color);
        rig.depth = camera(depth);
        rig.color = camera(color);
        rig.color_from_depth.rotation =
            glm::angleAxis(random.real(-3.1, 3.1),
                           glm::normalize(glm::dvec3(random.real(-1, 1), random.real(-1, 1), 0.5)));
        rig.color_from_depth.translation = {random.real(-1, 1), random.real(-1, 1), 0.1};
        const std::string written = rig_to_k4a(rig).value();
        const RigParameters again = rig_from_k4a(written, depth, color, "again").value();
        EXPECT_TRUE(rig_to_k4a(again).value() == written) << i;
        for (const auto& [a, b] :
             {std::pair(rig.depth, again.depth), std::pair(*rig.color, *again.color)}) {
            EXPECT_LE(ulps_apart(a.fx, b.fx), 1);
            EXPECT_LE(ulps_apart(a.fy, b.fy), 1);
            EXPECT_NEAR(a.cx, b.cx, 1e-12);
            EXPECT_NEAR(a.cy, b.cy, 1e-12);
            EXPECT_EQ(a.k6, b.k6);
            EXPECT_EQ(a.p1, b.p1);
            EXPECT_EQ(a.p2, b.p2);
        }
        EXPECT_EQ(again.color_from_depth.translation, rig.color_from_depth.translation);
        EXPECT_NEAR(
            std::abs(glm::dot(again.color_from_depth.rotation, rig.color_from_depth.rotation)), 1,
            1e-15);
        exact += again.depth == rig.depth && again.color == rig.color;
    }
    EXPECT_GT(exact, kRigs / 10);
}

}  // namespace
}  // namespace kino
