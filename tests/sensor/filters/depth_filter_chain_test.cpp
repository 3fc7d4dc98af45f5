#include "sensor/filters/depth_filter_chain.h"

#include <gmock/gmock.h>

#include <cstring>

#include "sensor/filters/decimation_filter.h"
#include "sensor/filters/flying_pixel_filter.h"
#include "sensor/filters/hole_filter.h"
#include "sensor/filters/spatial_filter.h"
#include "sensor/filters/temporal_filter.h"
#include "tests/sensor/filters/depth_samples.h"
#include "tests/sensor/filters/fuzz/target.h"
#include "tests/support/counted_allocations.h"

namespace kino {
namespace {

using testing::HasSubstr;

Image<float> run(DepthFilterChain& chain, const Image<float>& in) {
    Image<float> out;
    chain.apply(in, out);
    return out;
}

DepthFilterChain parsed(std::string_view text) {
    auto chain = DepthFilterChain::parse(text);
    KINO_CHECK(chain.has_value());
    return std::move(*chain);
}

std::string error_of(std::string_view text) {
    const auto chain = DepthFilterChain::parse(text);
    return chain ? "parsed" : chain.error().to_string();
}

TEST(Chain, NothingAskedForChangesNothing) {
    DepthFilterChain none = parsed("");
    EXPECT_TRUE(none.empty());
    const auto in = test::hostile_room(40, 30, 1);
    EXPECT_TRUE(test::same_bits(run(none, in), in));
    EXPECT_EQ(none.reduction(), 1);
}

TEST(Chain, IsTheFiltersOneAfterTheOther) {
    DepthFilterChain chain =
        parsed("flying:support=3,spatial:radius=1,temporal:alpha=0.4,holes:gap=4,decimate");
    const auto flying = test::make_filter<FlyingPixelFilter>(FlyingPixelParameters{.support = 3});
    const auto spatial = test::make_filter<SpatialFilter>(SpatialParameters{.radius = 1});
    const auto temporal = test::make_filter<TemporalFilter>(TemporalParameters{.alpha = 0.4});
    const auto holes = test::make_filter<HoleFilter>(HoleParameters{.gap = 4});
    const auto decimate = test::make_filter<DecimationFilter>(DecimationParameters{});
    for (std::uint64_t frame = 0; frame < 4; ++frame) {
        const auto in = test::noisy_room(75, 51, 40 + frame / 2);
        auto expected = test::filtered(*flying, in);
        expected = test::filtered(*spatial, expected);
        expected = test::filtered(*temporal, expected);
        expected = test::filtered(*holes, expected);
        expected = test::filtered(*decimate, expected);
        EXPECT_TRUE(test::same_bits(run(chain, in), expected)) << frame;
    }
}

TEST(Chain, OrderIsTheCallers) {
    const auto in = test::noisy_room(75, 51, 3, 0.0017, 0.05);
    auto a = parsed("spatial,holes");
    auto b = parsed("holes,spatial");
    EXPECT_FALSE(test::same_bits(run(a, in), run(b, in)));
}

TEST(Chain, SpecificationSaysWhatDiffersAndParsesToItself) {
    EXPECT_EQ(parsed("temporal:alpha=0.15,holes").specification(), "temporal,holes");
    for (const char* text :
         {"spatial,temporal:alpha=0.4,holes", "holes:gap=12:background=0",
          "decimate:factor=3:readings=2,flying:steps=2.5", "temporal:noise=0.00123"}) {
        EXPECT_EQ(parsed(text).specification(), text);
    }
    const std::string preset = parsed("temporal:preset=librealsense").specification();
    EXPECT_THAT(preset, HasSubstr("alpha=0.4"));
    EXPECT_EQ(parsed(preset).specification(), preset);
}

TEST(Chain, ErrorsNameWhatThereIs) {
    EXPECT_THAT(error_of("spatia"), HasSubstr("flying, decimate, spatial, temporal, holes"));
    EXPECT_THAT(error_of("Spatial"), HasSubstr("no depth filter \"Spatial\""));
    EXPECT_THAT(error_of("spatial, holes"), HasSubstr("no depth filter \" holes\""));
    EXPECT_THAT(error_of("spatial,"), HasSubstr("no depth filter \"\""));
    EXPECT_THAT(error_of(",spatial"), HasSubstr("no depth filter \"\""));
    EXPECT_THAT(error_of("spatial,spatial"), HasSubstr("twice"));
    EXPECT_THAT(error_of("spatial:size=3"), HasSubstr("radius, sigmas, noise"));
    EXPECT_THAT(error_of("spatial:"), HasSubstr(":key=value"));
    EXPECT_THAT(error_of("spatial:radius"), HasSubstr(":key=value"));
    EXPECT_THAT(error_of("spatial:radius=1:"), HasSubstr(":key=value"));
    for (const char* value : {"", "0", "5", "1.5", "nan", "inf", "-1", "2px", " 2", "+2", "0x2"}) {
        EXPECT_THAT(error_of(std::string("spatial:radius=") + value),
                    HasSubstr("a whole number from 1 to 4"))
            << value;
    }
    EXPECT_THAT(error_of("temporal:alpha=1.0001"), HasSubstr("alpha is 0 to 1"));
    EXPECT_THAT(error_of("temporal:alpha=nan"), HasSubstr("alpha is 0 to 1"));
    EXPECT_THAT(error_of("temporal:preset=fast"), HasSubstr("default, librealsense"));
    EXPECT_THAT(error_of("temporal:alpha=0.1:preset=librealsense"), HasSubstr("first"));
    EXPECT_EQ(error_of("temporal:alpha=0,holes:gap=250"), "parsed");
}

TEST(Chain, ParametersOutOfRangeAreRefused) {
    EXPECT_FALSE(SpatialFilter::create({.radius = 0}).has_value());
    EXPECT_FALSE(SpatialFilter::create({.sigmas = std::nan("")}).has_value());
    EXPECT_FALSE(TemporalFilter::create({.alpha = -0.1}).has_value());
    EXPECT_FALSE(HoleFilter::create({.gap = 251}).has_value());
    EXPECT_FALSE(DecimationFilter::create({.factor = 9}).has_value());
    EXPECT_FALSE(FlyingPixelFilter::create({.support = 9}).has_value());
}

TEST(Chain, HelpNamesEverySetting) {
    const std::string help = DepthFilterChain::help();
    for (const char* word : {"flying", "decimate", "spatial", "temporal", "holes", "alpha=0.15",
                             "persistence", "background", "factor=2"}) {
        EXPECT_THAT(help, HasSubstr(word));
    }
}

TEST(Chain, DecimationChangesSizeAndCamera) {
    DepthFilterChain chain = parsed("decimate:factor=3,spatial");
    EXPECT_EQ(chain.reduction(), 3);
    const CameraModel camera{
        .width = 640, .height = 480, .fx = 570, .fy = 570, .cx = 320, .cy = 240};
    EXPECT_EQ(chain.camera(camera), decimated(camera, 3));
    const Image<float> out = run(chain, test::noisy_room(640, 480, 5));
    EXPECT_EQ(out.width(), chain.camera(camera).width);
    EXPECT_EQ(out.height(), chain.camera(camera).height);
}

TEST(Chain, ResetForgetsAndSizesMayChange) {
    DepthFilterChain chain = parsed("flying,decimate,spatial,temporal,holes");
    const auto a = test::noisy_room(64, 48, 1);
    const auto first = run(chain, a);
    for (const test::Size size : test::kSizes) {
        const auto out = run(chain, test::hostile_room(size.width, size.height, 2));
        EXPECT_EQ(out.width(), (size.width + 1) / 2);
    }
    chain.reset();
    EXPECT_TRUE(test::same_bits(run(chain, a), first));
}

TEST(Chain, NothingIsAllocatedAfterTheFirstFrame) {
    for (const char* text : {"", "flying,spatial,temporal,holes", "decimate,temporal,holes"}) {
        DepthFilterChain chain = parsed(text);
        const Image<float> frames[] = {test::noisy_room(160, 120, 1),
                                       test::hostile_room(160, 120, 2)};
        Image<float> out;
        const long before = test::allocations;
        chain.apply(frames[0], out);
        const long after = test::allocations;
        for (int i = 0; i < 6; ++i) chain.apply(frames[i % 2], out);
        EXPECT_EQ(test::allocations, after) << text;
        EXPECT_GT(after, before) << "the counter counts";
    }
}

TEST(Chain, AnyTextIsParsedOrRefused) {
    test::Random random(8);
    const std::vector<std::string> words = {
        "flying", "decimate", "spatial", "temporal",     "holes",   ",", ":",   "=",   "alpha",
        "radius", "gap",      "preset",  "librealsense", "default", "1", "0.5", "nan", "1e-3",
        "250",    "-",        "\0"};
    int accepted = 0;
    for (int i = 0; i < 20000; ++i) {
        std::string text = "spatial:radius=2,temporal:alpha=0.4:persistence=3,holes:gap=4";
        for (int k = random.integer(0, 4); k > 0; --k) {
            const auto at =
                static_cast<std::size_t>(random.integer(0, static_cast<int>(text.size())));
            const std::string& word = words[static_cast<std::size_t>(
                random.integer(0, static_cast<int>(words.size()) - 1))];
            if (random.chance(0.5)) {
                text.insert(at, word);
            } else if (random.chance(0.5)) {
                text.erase(at, static_cast<std::size_t>(random.integer(0, 12)));
            } else if (at < text.size()) {
                text[at] = static_cast<char>(random.integer(0, 255));
            }
        }
        const std::span bytes(reinterpret_cast<const std::uint8_t*>(text.data()), text.size());
        fuzz::filter_spec(bytes);
        accepted += DepthFilterChain::parse(text).has_value() ? 1 : 0;
    }
    EXPECT_GT(accepted, 2000);
    EXPECT_LT(accepted, 15000);
}

}  // namespace
}  // namespace kino
