#include <fmt/format.h>
#include <lz4.h>
#include <spng.h>
#include <zstd.h>

#include <algorithm>
#include <cstdlib>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "apps/bench/registry.h"
#include "base/check.h"
#include "sensor/codec/image_codec.h"
#include "sensor/codec/rvl.h"
#include "sensor/color_conversion.h"
#include "sensor/source.h"
#include "skeleton/synthetic/synthetic_source.h"

namespace kino {
namespace {

using Bytes = std::vector<std::uint8_t>;

struct Picture {
    ImageFormat format;
    Bytes pixels;
};
/// By the name that stands in the table.
using Sets = std::map<std::string, std::vector<Picture>>;

/// One way of coding: both answer the bytes that were made.
struct Codec {
    std::string name;
    std::function<void(const Picture&, Bytes&)> encode;
    std::function<void(const Picture&, const Bytes&, Bytes&)> decode;
};

Codec zstd_codec(int level) {
    const auto encode = [level](const Picture& picture, Bytes& out) {
        out.resize(ZSTD_compressBound(picture.pixels.size()));
        out.resize(ZSTD_compress(out.data(), out.size(), picture.pixels.data(),
                                 picture.pixels.size(), level));
    };
    const auto decode = [](const Picture&, const Bytes& data, Bytes& out) {
        KINO_CHECK_EQ(ZSTD_decompress(out.data(), out.size(), data.data(), data.size()),
                      out.size());
    };
    return {fmt::format("zstd-{}", level), encode, decode};
}

Codec lz4_codec() {
    const auto encode = [](const Picture& picture, Bytes& out) {
        const int size = static_cast<int>(picture.pixels.size());
        out.resize(static_cast<std::size_t>(LZ4_compressBound(size)));
        out.resize(static_cast<std::size_t>(LZ4_compress_default(
            reinterpret_cast<const char*>(picture.pixels.data()),
            reinterpret_cast<char*>(out.data()), size, static_cast<int>(out.size()))));
    };
    const auto decode = [](const Picture&, const Bytes& data, Bytes& out) {
        const int size = LZ4_decompress_safe(
            reinterpret_cast<const char*>(data.data()), reinterpret_cast<char*>(out.data()),
            static_cast<int>(data.size()), static_cast<int>(out.size()));
        KINO_CHECK_EQ(static_cast<std::size_t>(size), out.size());
    };
    return {"lz4", encode, decode};
}

struct PngFree {
    void operator()(spng_ctx* c) const { spng_ctx_free(c); }
};
using Png = std::unique_ptr<spng_ctx, PngFree>;

Codec png_codec(int level) {
    const auto encode = [level](const Picture& picture, Bytes& out) {
        const Png png(spng_ctx_new(SPNG_CTX_ENCODER));
        spng_ihdr head{};
        head.width = static_cast<std::uint32_t>(picture.format.width);
        head.height = static_cast<std::uint32_t>(picture.format.height);
        head.bit_depth = picture.format.layout == PixelLayout::gray16 ? 16 : 8;
        head.color_type = picture.format.layout == PixelLayout::rgb8 ? SPNG_COLOR_TYPE_TRUECOLOR
                                                                     : SPNG_COLOR_TYPE_GRAYSCALE;
        spng_set_ihdr(png.get(), &head);
        spng_set_option(png.get(), SPNG_ENCODE_TO_BUFFER, 1);
        spng_set_option(png.get(), SPNG_IMG_COMPRESSION_LEVEL, level);
        KINO_CHECK_EQ(spng_encode_image(png.get(), picture.pixels.data(), picture.pixels.size(),
                                        SPNG_FMT_PNG, SPNG_ENCODE_FINALIZE),
                      0);
        std::size_t size = 0;
        int error = 0;
        void* data = spng_get_png_buffer(png.get(), &size, &error);
        KINO_CHECK_EQ(error, 0);
        const auto* bytes = static_cast<const std::uint8_t*>(data);
        out.assign(bytes, bytes + size);
        std::free(data);
    };
    const auto decode = [](const Picture& picture, const Bytes& data, Bytes& out) {
        const Png png(spng_ctx_new(0));
        spng_set_png_buffer(png.get(), data.data(), data.size());
        // SPNG_FMT_RAW keeps the file's big-endian order.
        const int format =
            picture.format.layout == PixelLayout::gray16 ? SPNG_FMT_PNG : SPNG_FMT_RAW;
        KINO_CHECK_EQ(spng_decode_image(png.get(), out.data(), out.size(), format, 0), 0);
    };
    return {fmt::format("PNG {}", level), encode, decode};
}

Codec rvl_codec() {
    const auto encode = [](const Picture& picture, Bytes& out) {
        out.resize(rvl_bound_bytes(picture.pixels.size() / 2));
        out.resize(rvl_encode(picture.pixels, out));
    };
    const auto decode = [](const Picture&, const Bytes& data, Bytes& out) {
        KINO_CHECK(rvl_decode(data, out));
    };
    return {"RVL", encode, decode};
}

/// One of our codecs, its memory kept from frame to frame as a recording does.
Codec session_codec(std::string name, ImageCodec codec, CodecOptions options = {}) {
    struct Pair {
        ImageFormat format;
        std::unique_ptr<ImageEncoder> encoder;
        std::unique_ptr<ImageDecoder> decoder;
    };
    const auto pair = std::make_shared<Pair>();
    const auto prepare = [pair, codec, options](ImageFormat format) {
        format.codec = codec;
        if (pair->encoder && pair->format == format) return;
        pair->format = format;
        pair->encoder = *make_image_encoder(format, options);
        pair->decoder = *make_image_decoder(format, pair->encoder->private_data(), options);
    };
    const auto encode = [pair, prepare](const Picture& picture, Bytes& out) {
        prepare(picture.format);
        const auto data = pair->encoder->encode(picture.pixels);
        KINO_CHECK(data.has_value());
        out.assign(data->begin(), data->end());
    };
    const auto decode = [pair, prepare](const Picture& picture, const Bytes& data, Bytes& out) {
        prepare(picture.format);
        KINO_CHECK(pair->decoder->decode(data, out).has_value());
    };
    return {std::move(name), encode, decode};
}

std::vector<Codec> codecs_of(PixelLayout layout) {
    const bool depth = layout == PixelLayout::gray16;
    std::vector<Codec> out = {zstd_codec(1), zstd_codec(3), lz4_codec(), png_codec(1),
                              png_codec(6)};
    if (depth) {
        out.push_back(rvl_codec());
        out.push_back(session_codec("RVL+zstd-1", ImageCodec::rvl_zstd));
    }
    out.push_back(session_codec("FFV1", ImageCodec::ffv1));
    out.push_back(session_codec("fast portable", ImageCodec::fast, {.simd = false}));
    out.push_back(session_codec("fast", ImageCodec::fast));
    return out;
}

struct Score {
    double ratio = 0;
    double encode_ms = 0;  ///< a frame, median
    double decode_ms = 0;
};

/// Adds the set's rows and answers each codec's figures; without times if not `timed`.
std::map<std::string, Score> measure(BenchContext& context, const std::string& name,
                                     const std::vector<Picture>& pictures, bool timed) {
    const std::vector<Codec> codecs = codecs_of(pictures.front().format.layout);
    std::map<std::string, std::vector<Bytes>> coded;
    std::vector<bench::Candidate> encoders;
    std::vector<bench::Candidate> decoders;
    Bytes back(pictures.front().pixels.size());
    std::size_t before = 0;
    for (const Picture& picture : pictures) before += picture.pixels.size();
    for (const Codec& codec : codecs) {
        std::vector<Bytes>& frames = coded[codec.name];
        frames.resize(pictures.size());
        for (std::size_t i = 0; i < pictures.size(); ++i) {
            codec.encode(pictures[i], frames[i]);
            std::fill(back.begin(), back.end(), std::uint8_t{0xA5});
            codec.decode(pictures[i], frames[i], back);
            if (back != pictures[i].pixels) {
                context.fail({"what " + codec.name + " gives back differs", name, {}});
            }
        }
        encoders.push_back({codec.name, [&] {
                                for (std::size_t i = 0; i < pictures.size(); ++i) {
                                    codec.encode(pictures[i], frames[i]);
                                }
                            }});
        decoders.push_back({codec.name, [&] {
                                for (std::size_t i = 0; i < pictures.size(); ++i) {
                                    codec.decode(pictures[i], frames[i], back);
                                }
                            }});
    }
    const auto count = static_cast<double>(pictures.size());
    const std::string case_name =
        fmt::format("{}, {} frame{}", name, pictures.size(), pictures.size() == 1 ? "" : "s");
    std::map<std::string, Score> scores;
    for (const Codec& codec : codecs) {
        std::size_t after = 0;
        for (const Bytes& frame : coded[codec.name]) after += frame.size();
        scores[codec.name].ratio = static_cast<double>(before) / static_cast<double>(after);
    }
    if (!timed) {
        for (const auto& [level, score] : scores) {
            context.add({.case_name = case_name,
                         .knob = "size",
                         .level = level,
                         .error = score.ratio,
                         .metric = "ratio"});
        }
        return scores;
    }
    const bench::RepeatOptions repeats{.repeats = 25, .max_seconds = 8};
    const bench::Comparison encode = context.compare("encode " + name, encoders, repeats);
    const bench::Comparison decode = context.compare("decode " + name, decoders, repeats);
    for (const Codec& codec : codecs) {
        Score& score = scores[codec.name];
        const auto add = [&](const char* knob, const bench::Comparison& times) {
            const bool is_base = codec.name == "FFV1";
            context.add(
                {.case_name = case_name,
                 .knob = knob,
                 .level = codec.name,
                 .ms_median = times[codec.name].median_ms() / count,
                 .ms_p95 = times[codec.name].p95_ms() / count,
                 .error = score.ratio,
                 .metric = fmt::format("ratio, {}, {}", name, knob),
                 .baseline = is_base ? "" : "FFV1",
                 .speedup = is_base ? bench::kNotMeasured : times.speedup(codec.name, "FFV1")});
            return times[codec.name].median_ms() / count;
        };
        score.encode_ms = add("encode", encode);
        score.decode_ms = add("decode", decode);
    }
    return scores;
}

void add_depth(Sets& sets, const std::string& name, const DepthFrame& frame) {
    const auto* bytes = reinterpret_cast<const std::uint8_t*>(frame.raw.data());
    sets[name].push_back(
        {{ImageCodec::fast, PixelLayout::gray16, frame.raw.width(), frame.raw.height()},
         Bytes(bytes, bytes + 2 * frame.raw.size())});
}

/// The picture as a Kinect's sensor would have seen it, GRBG, and as it is.
Result<void> add_color(Sets& sets, const ColorFrame& frame) {
    Image<Rgba8> picture;
    KINO_TRY(to_rgba8(frame, picture));
    const int width = picture.width();
    const int height = picture.height();
    Bytes mosaic;
    Bytes rgb;
    for (int y = 0; y < height; ++y) {
        for (int x = 0; x < width; ++x) {
            const Rgba8 p = picture.at(x, y);
            mosaic.push_back(y % 2 == 0 ? (x % 2 == 0 ? p.g : p.r) : (x % 2 == 0 ? p.b : p.g));
            rgb.insert(rgb.end(), {p.r, p.g, p.b});
        }
    }
    const auto add = [&](const char* name, PixelLayout layout, Bytes pixels) {
        sets[name].push_back({{ImageCodec::fast, layout, width, height}, std::move(pixels)});
    };
    add("colour as Bayer 640x480", PixelLayout::bayer8, std::move(mosaic));
    add("colour as RGB 640x480", PixelLayout::rgb8, std::move(rgb));
    return {};
}

constexpr const char* kDepth = "depth, ";
constexpr const char* kAllDepth = "depth, all of these";

/// Frames of one source: `depth_name` says under which name its depth is kept.
Result<void> read(Sets& sets, const std::string& uri, const std::string& depth_name,
                  bool with_color, int most) {
    KINO_ASSIGN(const auto source, open_source(uri));
    KINO_TRY(subscribe_all(*source));
    for (int i = 0; i < most; ++i) {
        KINO_ASSIGN(const auto frames, source->next(kNsPerSecond));
        if (!frames) break;
        if (frames->depth) add_depth(sets, depth_name, *frames->depth);
        if (frames->color && with_color) KINO_TRY(add_color(sets, *frames->color));
    }
    if (!sets.contains(depth_name)) return fail("no depth in it", uri);
    return {};
}

Result<Sets> read_all() {
    Sets sets;
    for (const char* name : {"bust", "desk", "gestures", "laptop", "office", "tabletop"}) {
        KINO_TRY(
            read(sets, std::string("recordings/") + name, kDepth + std::string(name), true, 100));
    }
    std::vector<Picture> all;
    for (const auto& [name, pictures] : sets) {
        if (!name.starts_with(kDepth)) continue;
        all.insert(all.end(), pictures.begin(), pictures.end());
    }
    sets[kAllDepth] = std::move(all);
    register_synthetic_source();
    KINO_TRY(read(sets, "synthetic:", "synthetic Kinect disparity", false, 8));
    return sets;
}

/// Two from all over the set.
std::vector<Picture> some_of(const std::vector<Picture>& pictures) {
    constexpr std::size_t kSome = 2;
    std::vector<Picture> some;
    for (std::size_t i = 0; i < std::min(kSome, pictures.size()); ++i) {
        some.push_back(pictures[i * pictures.size() / kSome]);
    }
    return some;
}

}  // namespace

void bench_codecs(BenchContext& context) {
    const auto sets = read_all();
    if (!sets) return context.fail(sets.error());
    for (const auto& [name, all] : *sets) {
        const bool timed = !name.starts_with(kDepth) || name == kAllDepth;
        const std::vector<Picture> pictures = context.quick() && timed ? some_of(all) : all;
        auto scores = measure(context, name, pictures, timed);
        if (name != kAllDepth) continue;
        const Score fast = scores["fast"];
        context.claim(fmt::format("real depth, 640x480, one thread: the fast codec shrinks it at "
                                  "least 9 times (here {:.1f})",
                                  fast.ratio),
                      fast.ratio >= 9);
        context.claim(fmt::format("it encodes a frame in at most 1.3 ms (here {:.2f}) and decodes "
                                  "it in at most 0.8 ms (here {:.2f})",
                                  fast.encode_ms, fast.decode_ms),
                      fast.encode_ms <= 1.3 && fast.decode_ms <= 0.8);
    }
    context.note(
        "Every 16-bit frame of the bundled recordings, frames of the synthetic Kinect in raw "
        "disparity, and the colour of the recordings as it is and put back into a GRBG mosaic. "
        "Each codec's answer is compared with the pixels before it is timed. One thread; times "
        "are of a frame, medians of passes over the whole set; the ratio is of the set's bytes. ");
    context.note(
        "FFV1 is libavcodec's, version 3, four slices with checksums, as our sessions hold it; "
        "RVL+zstd-1 and fast carry checksums, too, and check them; the others have none or, PNG, "
        "their own. The speedup is over FFV1.");
    context.note(
        "Why fast shrinks depth further than FFV1 at a fraction of its time: a depth sensor has "
        "far fewer levels than its unit has values, so that the values of a frame are replaced by "
        "their ranks; holes are a symbol of their own and do not disturb the prediction; and 16 "
        "stripes with a rANS state each fill AVX2 registers. docs/session-codec.md has the bit "
        "stream.");
}

}  // namespace kino
