#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "fuzz/targets.h"
#include "sensor/file_bytes.h"
#include "tests/support/random.h"

namespace kino {
namespace {

std::vector<std::uint8_t> mutated(std::vector<std::uint8_t> bytes, test::Random& random) {
    const std::vector<std::string> words = {
        "[", "]",  ":", "\n", "  ", "data: [", "rows: 3", "1e308", "-0", "nan", "!!opencv-matrix",
        "#", "\"", ","};
    const int changes = random.integer(1, 6);
    for (int i = 0; i < changes && !bytes.empty(); ++i) {
        const auto at = bytes.begin() + random.integer(0, static_cast<int>(bytes.size()) - 1);
        switch (random.integer(0, 4)) {
            case 0:
                *at = static_cast<std::uint8_t>(random.bits());
                break;
            case 1:
                *at ^= static_cast<std::uint8_t>(1 << random.integer(0, 7));
                break;
            case 2: {
                const auto& word = words[static_cast<std::size_t>(
                    random.integer(0, static_cast<int>(words.size()) - 1))];
                bytes.insert(at, word.begin(), word.end());
                break;
            }
            case 3:
                bytes.erase(at,
                            at + std::min<std::ptrdiff_t>(bytes.end() - at, random.integer(1, 20)));
                break;
            default:
                if (random.chance(0.1)) bytes.erase(at, bytes.end());
                break;
        }
    }
    return bytes;
}

TEST(CameraTextMutations, NothingBreaksTheReaders) {
    const std::string folder = "tests/data/calibration/parameters/";
    std::vector<std::vector<std::uint8_t>> seeds;
    for (const char* name : {"kinect1_rgbdemo.yml", "azure_charuco_ir.yml", "opencv_left.yml"}) {
        seeds.push_back(read_file_bytes(folder + name, 1 << 20).value());
    }
    const NamedCamera camera{
        "color",
        {.width = 640, .height = 480, .fx = 500, .fy = 501, .cx = 320, .cy = 240, .k1 = 0.1}};
    for (const std::string& text : {ros_camera_info(camera), *tum_intrinsics(camera)}) {
        seeds.emplace_back(text.begin(), text.end());
    }
    test::Random random(21);
    for (int i = 0; i < 4000; ++i) {
        fuzz::camera_text(mutated(seeds[static_cast<std::size_t>(i) % seeds.size()], random));
    }
}

}  // namespace
}  // namespace kino
