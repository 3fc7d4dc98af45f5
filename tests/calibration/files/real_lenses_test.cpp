#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <sstream>

#include "calibration/files/camera_text.h"
#include "calibration/projection.h"
#include "calibration/registration_rays.h"
#include "calibration/rig.h"
#include "sensor/convert/k4a_calibration.h"
#include "sensor/file_bytes.h"
#include "tests/reference/camera_reference.h"
#include "tests/reference/registration_reference.h"

/// Lenses and rigs of real sensors: the inverse of their distortion, and float against double.
namespace kino {
namespace {

std::string parameters_of(const std::string& name) {
    return read_file_text("tests/data/calibration/parameters/" + name, 1 << 20).value();
}

// The numbers of "name: ... data: [ ... ]" in a file that no YAML reader of ours takes.
std::vector<double> numbers_after(const std::string& text, const std::string& name) {
    const std::size_t begin = text.find('[', text.find("data:", text.find(name))) + 1;
    std::string list = text.substr(begin, text.find(']', begin) - begin);
    std::ranges::replace(list, ',', ' ');
    std::istringstream in(list);
    std::vector<double> out;
    for (double value = 0; in >> value;) out.push_back(value);
    return out;
}

CameraModel pykinect(const std::string& file) {
    const std::string text = parameters_of("kinect1_pykinecttools/" + file);
    const std::vector<double> k = numbers_after(text, " K:");
    const std::vector<double> d = numbers_after(text, "Dist:");
    EXPECT_EQ(k.size(), 9u);
    EXPECT_GE(d.size(), 4u);
    CameraModel c{.width = 640, .height = 480, .fx = k[0], .fy = k[4], .cx = k[2], .cy = k[5]};
    c.k1 = d[0];
    c.k2 = d[1];
    c.p1 = d[2];
    c.p2 = d[3];
    if (d.size() > 4) c.k3 = d[4];
    return c;
}

RigParameters rgbdemo() {
    const auto file = read_opencv_yaml(parameters_of("kinect1_rgbdemo.yml"), "rgbdemo").value();
    RigParameters rig;
    rig.depth = file.cameras[0].camera;
    rig.color = file.cameras[1].camera;
    rig.color_from_depth = *file.second_from_first;
    return rig;
}

RigParameters bauhaus() {
    const auto file = read_opencv_yaml(parameters_of("kinect2_bauhaus_50.yml"), "bauhaus").value();
    RigParameters rig;
    const bool depth_first = file.cameras[0].camera.width < file.cameras[1].camera.width;
    rig.depth = file.cameras[depth_first ? 0 : 1].camera;
    rig.color = file.cameras[depth_first ? 1 : 0].camera;
    rig.color_from_depth.translation = {-0.052, 0, 0};
    return rig;
}

RigParameters azure(const char* name, PixelSize depth, PixelSize color) {
    return rig_from_k4a(parameters_of(name), depth, color, name).value();
}

struct NamedLens {
    std::string name;
    CameraModel camera;
};

std::vector<NamedLens> real_lenses() {
    std::vector<NamedLens> out = {{"pykinect colour", pykinect("Kinect_Color_Param.yml")},
                                  {"pykinect depth", pykinect("Kinect_Depth_Param.yml")},
                                  {"rgbdemo depth", rgbdemo().depth},
                                  {"rgbdemo colour", *rgbdemo().color},
                                  {"bauhaus depth", bauhaus().depth},
                                  {"bauhaus colour", *bauhaus().color}};
    for (const char* name : {"azure_TestCalibration.json", "azure_pyk4a_001514394512.json"}) {
        for (const PixelSize depth : {PixelSize{320, 288}, PixelSize{1024, 1024}}) {
            const RigParameters rig = azure(name, depth, {1920, 1080});
            out.push_back({name, rig.depth});
            out.push_back({name, *rig.color});
        }
    }
    for (const auto& [name, width, height] :
         {std::tuple("calib_ir.yaml", 512, 424), std::tuple("calib_color.yaml", 1920, 1080)}) {
        const auto file =
            read_opencv_yaml(parameters_of(std::string("kinect2_iai_196605135147/") + name), name,
                             std::pair(width, height))
                .value();
        out.push_back({name, file.cameras[0].camera});
    }
    return out;
}

TEST(RealLenses, InverseWithinAHundredthOfAPixelOrInvalid) {
    for (const auto& [name, c] : real_lenses()) {
        const Projection projection(c);
        const double fold = reference::fold_radius(c);
        EXPECT_LE(projection.max_radius(), fold + 1e-4) << name;
        double worst = 0;
        int without = 0;
        for (int j = 0; j <= 24; ++j) {
            for (int i = 0; i <= 24; ++i) {
                const glm::dvec2 pixel(i / 24.0 * (c.width - 1), j / 24.0 * (c.height - 1));
                const auto ray = projection.unproject(pixel);
                const auto expected = reference::unproject(c, fold, pixel);
                if (!ray) {
                    ++without;
                    continue;
                }
                // Never the folded branch: inside the disc where the lens is one-to-one.
                EXPECT_LE(glm::length(*ray), fold * (1 + 1e-9)) << name;
                const glm::dvec2 d = reference::distort(c, *ray);
                const glm::dvec2 again(c.fx * d.x + c.cx, c.fy * d.y + c.cy);
                worst = std::max(worst, glm::length(again - pixel));
                if (expected) {
                    EXPECT_LT(glm::length(*ray - *expected) * c.fx, 0.01) << name;
                }
            }
        }
        EXPECT_LT(worst, 0.01) << name;
        // Wide pictures have black corners, and so does the Kinect v2 that folds there.
        EXPECT_LT(without, c.width == 1024 ? 625 / 3 : 625 / 12) << name;
    }
}

TEST(RealLenses, RayTablesOfEveryDensity) {
    for (const auto& [name, lens] : real_lenses()) {
        // Coarser pictures of the same lens: quicker, and harder on the table.
        const CameraModel c = scaled(lens, lens.width / 4, lens.height / 4);
        const Projection projection(c);
        for (const int step : {1, 2, 4, 8}) {
            const registration::RayTable table(registration::find_rays(c, step), glm::dmat3(1));
            double worst = 0;
            int lost = 0;
            for (int y = 0; y < c.height; y += 3) {
                std::vector<float> row(3 * static_cast<std::size_t>(c.width));
                const auto width = static_cast<std::size_t>(c.width);
                table.read(static_cast<std::size_t>(y) * width, width, row.data(),
                           row.data() + width, row.data() + 2 * width);
                for (int x = 0; x < c.width; x += 2) {
                    const auto ray = projection.unproject({x, y});
                    const auto i = static_cast<std::size_t>(x);
                    if (!ray || std::isnan(row[i])) {
                        lost += ray.has_value() != !std::isnan(row[i]);
                        continue;
                    }
                    const glm::dvec2 error(row[i] - ray->x, row[width + i] - ray->y);
                    worst = std::max(worst, glm::length(error * glm::dvec2(c.fx, c.fy)));
                }
            }
            EXPECT_EQ(lost, 0) << name << " step " << step;
            EXPECT_LT(worst, step == 1 ? 2e-4 : 0.1) << name << " step " << step;
        }
    }
}

TEST(RealRigs, FloatAgainstTheDoubleReference) {
    const char* pyk4a = "azure_pyk4a_001514394512.json";
    std::vector<std::pair<std::string, RigParameters>> rigs = {
        {"rgbdemo", rgbdemo()},
        {"azure narrow", azure(pyk4a, {320, 288}, {1280, 720})},
        {"azure", azure("azure_TestCalibration.json", {320, 288}, {1280, 720})}};
    for (auto& [name, rig] : rigs) {
        rig.min_depth_m = 0.2;
        DepthFrame frame;
        frame.raw = Image<std::uint16_t>(rig.depth.width, rig.depth.height);
        for (int y = 0; y < rig.depth.height; ++y) {
            for (int x = 0; x < rig.depth.width; ++x) {
                frame.raw.at(x, y) = static_cast<std::uint16_t>(700 + 7 * x + 2 * y);
            }
        }
        Image<glm::dvec2> rays(rig.depth.width, rig.depth.height);
        const Projection depth(rig.depth);
        for (int y = 0; y < rays.height(); ++y) {
            for (int x = 0; x < rays.width(); ++x) {
                rays.at(x, y) = depth.unproject({x, y}).value_or(glm::dvec2(std::nan("")));
            }
        }
        const reference::Registration exact = reference::register_depth(rig, rays, frame);
        for (const int step : {1, 8}) {
            Rig fast = Rig::create(rig, {.occlusion_test = false, .ray_table_step = step}).value();
            RegisteredDepth out;
            ASSERT_TRUE(fast.register_depth(frame, out));
            double worst = 0;
            int seen = 0;
            for (std::size_t i = 0; i < out.uv.size(); ++i) {
                const glm::dvec2 e = exact.uv.pixels()[i];
                if (!out.uv.pixels()[i].valid() || std::isnan(e.x)) continue;
                const glm::dvec2 inside(std::clamp(e.x, 0.0, rig.color->width - 1.0),
                                        std::clamp(e.y, 0.0, rig.color->height - 1.0));
                const ColorUv uv = out.uv.pixels()[i];
                worst = std::max(worst, glm::length(glm::dvec2(uv.u, uv.v) / 16.0 - inside));
                ++seen;
            }
            EXPECT_GT(seen, 50'000) << name;
            // Half a sixteenth each way is 0.0442; the table's 0.05 depth pixels are some more
            // colour pixels.
            const double ratio = rig.color->fx / rig.depth.fx;
            EXPECT_LT(worst, step == 1 ? 0.05 : 0.05 + 0.1 * ratio) << name << " step " << step;
        }
    }
}

}  // namespace
}  // namespace kino
