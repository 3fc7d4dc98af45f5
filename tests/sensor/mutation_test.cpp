#include <gtest/gtest.h>

#include <array>
#include <random>

#include "fuzz/targets.h"
#include "sensor/clip_video.h"
#include "sensor/file_bytes.h"
#include "test_folder.h"

/// The fuzz targets on seeded mutations of good inputs, so that every run of the tests, sanitized
/// ones above all, fuzzes a little without clang.
namespace kino {
namespace {

using Buffer = std::vector<std::uint8_t>;

Buffer bytes_of(std::string_view text) {
    return {text.begin(), text.end()};
}

class Mutator {
  public:
    Mutator(unsigned seed, std::vector<std::string> words)
        : random_(seed), words_(std::move(words)) {}

    Buffer operator()(Buffer input) {
        for (unsigned i = 0; i < 1 + random_() % 6; ++i) change(input);
        return input;
    }

  private:
    std::size_t place(const Buffer& b) { return b.empty() ? 0 : random_() % b.size(); }

    void change(Buffer& b) {
        const auto at = [&] { return b.begin() + static_cast<std::ptrdiff_t>(place(b)); };
        switch (random_() % 6) {
            case 0:
                if (!b.empty()) *at() = static_cast<std::uint8_t>(random_());
                break;
            case 1:
                if (!b.empty()) *at() ^= static_cast<std::uint8_t>(1u << random_() % 8);
                break;
            case 2:
                b.resize(place(b));
                break;
            case 3: {
                const std::string& word = words_[random_() % words_.size()];
                b.insert(at(), word.begin(), word.end());
                break;
            }
            case 4: {
                auto from = at();
                const auto room = static_cast<std::size_t>(b.end() - from);
                b.erase(from, from + static_cast<std::ptrdiff_t>(std::min(room, place(b) % 20)));
                break;
            }
            default: {
                const std::size_t from = place(b);
                const std::size_t length = std::min(b.size() - from, std::size_t{random_() % 40});
                const Buffer copy(b.begin() + static_cast<std::ptrdiff_t>(from),
                                  b.begin() + static_cast<std::ptrdiff_t>(from + length));
                b.insert(at(), copy.begin(), copy.end());
            }
        }
    }

    std::mt19937 random_;
    std::vector<std::string> words_;
};

TEST(Mutations, TumLists) {
    const Buffer list = bytes_of(
        "# depth\n1305031453.374112 depth/1305031453.374112.png\n"
        "1305031453.404816 depth/b.png\n1305031453.436941 depth/c.png\n");
    const Buffer track = bytes_of(
        "1305031453.2695 1.2892 0.8669 1.5137 0.8791 0.2680 -0.1044 -0.3800\n"
        "1305031453.2795 1.2916 0.8654 1.5140 0.8796 0.2647 -0.1026 -0.3817\n"
        "1305031453.2895 1.2940 0.8637 1.5146 0.8801 0.2615 -0.1013 -0.3830\n");
    Mutator mutate(1, {"nan", "inf", "-", "1e308", "9223372036", " ", "\n", "0 0 0 0", "\r", "\t"});
    for (int i = 0; i < 5000; ++i) {
        fuzz::tum_lists(mutate(list));
        fuzz::tum_lists(mutate(track));
    }
}

TEST(Mutations, Descriptions) {
    const std::string camera =
        R"("cameras": {"depth": {"width": 8, "height": 6, "fx": 7, "fy": 7, "cx": 3.5, "cy": 2.5}})";
    const std::vector<Buffer> seeds = {
        bytes_of(R"({"kinoscope": 1, "fps": 30, "depth": {"dir": "d", "per_metre": 5000}, )" +
                 camera + "}"),
        bytes_of(R"({"kinoscope": 1, "times_ns": [0, 5], "depth": {"dir": "d",
                     "unit": "millimetres"}, "range_m": [0.5, 4], )" +
                 camera + "}"),
        bytes_of(R"({"kinoscope": 1, "clip": {"file": "a", "code": "luma", "bright_m": 1,
                     "dark_m": 4, "invalid_below": 0.1, "edge_span": 0.2}, )" +
                 camera + "}"),
        bytes_of(rig_to_json(default_kinect1_rig()))};
    Mutator mutate(2, {"NaN", "null", "1e999", "-1", "[", "{", "\"", "true", "18446744073709551615",
                       "\\ud800", "0.0000001", ",", "1e-320"});
    for (int i = 0; i < 6000; ++i)
        fuzz::descriptions(mutate(seeds[static_cast<std::size_t>(i) % 4]));
}

TEST(Mutations, Png) {
    const test::TestFolder folder;
    const auto depth =
        *read_file_bytes(folder.write_depth("a.png", 40, 30, 1234), std::size_t{1} << 20);
    const auto color =
        *read_file_bytes(folder.write_color("b.png", 40, 30, {1, 2, 3, 4}), std::size_t{1} << 20);
    Mutator mutate(3,
                   {"IDAT", "IEND", "PLTE", "tRNS", std::string("\0\0\0\x0d", 4), "\xFF\xFF\xFF"});
    for (int i = 0; i < 3000; ++i) {
        fuzz::png(mutate(depth));
        fuzz::png(mutate(color));
    }
}

TEST(Mutations, ColourFrames) {
    std::mt19937 random(4);
    Buffer seed(2000);
    for (std::uint8_t& byte : seed) byte = static_cast<std::uint8_t>(random());
    Mutator mutate(5, {"\xFF\xD8\xFF", "\xFF\xD9"});
    for (int i = 0; i < 5000; ++i) {
        seed[0] = static_cast<std::uint8_t>(i);
        seed[1] = static_cast<std::uint8_t>(random() % 40);
        seed[2] = static_cast<std::uint8_t>(random() % 40);
        fuzz::color(mutate(seed));
    }
}

TEST(Mutations, ClipFiles) {
    const test::TestFolder folder;
    Buffer clip = *read_file_bytes("recordings/person/kinect_0_20s.webm", std::size_t{1} << 24);
    clip.resize(60000);
    Mutator mutate(
        6, {std::string("\x1A\x45\xDF\xA3", 4), std::string("\x1F\x43\xB6\x75", 4), "\xFF"});
    int opened = 0;
    for (int i = 0; i < 150; ++i) {
        const Buffer bytes = mutate(clip);
        const auto path = folder.write("clip.webm", std::string(bytes.begin(), bytes.end()));
        auto video = ClipVideo::open(path);
        if (!video) continue;
        ++opened;
        (void)video->picture(video->frame_count() - 1);
        (void)video->picture(0);
    }
    EXPECT_GT(opened, 20);
}

}  // namespace
}  // namespace kino
