#include <gtest/gtest.h>

#include "codec_pictures.h"
#include "fuzz/targets.h"

/// The fuzz targets on seeded mutations of good frames, so that every run of the tests, sanitized
/// ones above all, fuzzes a little without clang.
namespace kino {
namespace {

using test::Bytes;

Bytes mutated(Bytes input, test::Random& random) {
    const auto place = [&] {
        return static_cast<std::ptrdiff_t>(random.integer(0, static_cast<int>(input.size()) - 1));
    };
    for (int i = random.integer(1, 6); i > 0 && !input.empty(); --i) {
        switch (random.integer(0, 5)) {
            case 0:
                input[place()] = static_cast<std::uint8_t>(random.bits());
                break;
            case 1:
                input[place()] ^= static_cast<std::uint8_t>(1 << random.integer(0, 7));
                break;
            case 2:
                input.resize(static_cast<std::size_t>(place()));
                break;
            case 3:
                input.insert(input.begin() + place(), 4, std::uint8_t{0xFF});
                break;
            case 4: {
                const auto from = place();
                const auto end =
                    std::min<std::ptrdiff_t>(from + random.integer(1, 20), std::ssize(input));
                input.erase(input.begin() + from, input.begin() + end);
                break;
            }
            default: {
                // Where the sizes of the parts stand.
                const auto at =
                    std::min<std::ptrdiff_t>(8 + random.integer(0, 11), std::ssize(input) - 1);
                input[at] = static_cast<std::uint8_t>(random.bits());
            }
        }
    }
    return input;
}

using Target = void (*)(fuzz::Bytes);

/// A target's input that is good: the frame of a small picture behind its format.
Bytes good_input(ImageCodec codec, PixelLayout layout, bool header, std::uint64_t seed) {
    const ImageFormat format{codec, layout, 2 + 2 * static_cast<int>(seed % 20), 24};
    const auto encoder = make_image_encoder(format);
    EXPECT_TRUE(encoder);
    const auto content = test::kContents[seed % std::size(test::kContents)];
    Bytes out = {static_cast<std::uint8_t>(layout), static_cast<std::uint8_t>(format.width - 1),
                 static_cast<std::uint8_t>(format.height - 1)};
    const Bytes data = header ? test::private_of(**encoder)
                              : test::encoded(**encoder, test::make_picture(format, content, seed));
    out.insert(out.end(), data.begin(), data.end());
    return out;
}

void run(Target target, ImageCodec codec, bool header, int times) {
    test::Random random(static_cast<std::uint64_t>(codec) + 40);
    for (int i = 0; i < times; ++i) {
        const PixelLayout layout = test::kLayouts[i % std::size(test::kLayouts)];
        if (!test::has_layout(codec, layout)) continue;
        const Bytes good = good_input(codec, layout, header, static_cast<std::uint64_t>(i % 50));
        target(good);
        target(mutated(good, random));
        Bytes one = good;
        one[static_cast<std::size_t>(random.integer(3, static_cast<int>(one.size()) - 1))] ^=
            static_cast<std::uint8_t>(1 << random.integer(0, 7));
        target(one);
    }
}

TEST(CodecMutations, FastFrames) {
    run(&fuzz::fast_frame, ImageCodec::fast, false, 3000);
}
TEST(CodecMutations, FastPixels) {
    run(&fuzz::fast_pixels, ImageCodec::raw, false, 300);
}
TEST(CodecMutations, RvlZstdFrames) {
    run(&fuzz::rvl_zstd, ImageCodec::rvl_zstd, false, 6000);
}
TEST(CodecMutations, RvlGroups) {
    test::Random random(9);
    for (int i = 0; i < 1500; ++i) {
        const ImageFormat format{ImageCodec::rvl_zstd, PixelLayout::gray16, 20, 16};
        const Bytes pixels = test::make_picture(format, test::kContents[i % 8], i);
        Bytes groups(rvl_bound_bytes(pixels.size() / 2));
        groups.resize(rvl_encode(pixels, groups));
        groups.insert(groups.begin(), {0, 19, 15});
        fuzz::rvl_zstd(groups);
        fuzz::rvl_zstd(mutated(groups, random));
    }
}
TEST(CodecMutations, Ffv1Frames) {
    run(&fuzz::ffv1_frame, ImageCodec::ffv1, false, 500);
}
TEST(CodecMutations, Ffv1Headers) {
    run(&fuzz::ffv1_header, ImageCodec::ffv1, true, 500);
}

}  // namespace
}  // namespace kino
