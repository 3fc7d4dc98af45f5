#include <gtest/gtest.h>

#include <cstdlib>
#include <fstream>
#include <random>
#include <string>

#include "logged_file.h"
#include "sensor/session/crc32.h"
#include "session_frames.h"
#include "session_target.h"
#include "tests/support/mutation.h"

/// The fuzz target on seeded mutations, half of them with the clusters' check sums put right again
/// so that damage gets past them.
namespace kino {
namespace {

using Buffer = std::vector<std::uint8_t>;

void mend_sums(Buffer& bytes) {
    for (std::size_t at = 0; at + 22 < bytes.size(); ++at) {
        if (bytes[at] != 0x1F || bytes[at + 1] != 0x43 || bytes[at + 2] != 0xB6) continue;
        std::size_t size = 0;
        for (std::size_t i = 5; i < 12; ++i) size = size << 8 | bytes[at + i];
        if (bytes[at + 12] != 0xBF || size < 6 || size > bytes.size() - at - 12) continue;
        const std::uint32_t sum = crc32(std::span(bytes).subspan(at + 18, size - 6));
        for (std::size_t i = 0; i < 4; ++i) {
            bytes[at + 14 + i] = static_cast<std::uint8_t>(sum >> (8 * i));
        }
    }
}

TEST(SessionMutations, AnyBytesAreSafe) {
    const test::FrameStyle style{.width = 12, .height = 8};
    auto frames = test::frames_between(0, 12, style);
    auto other = test::frames_between(20, 21, {.width = 16, .height = 10});
    frames.insert(frames.end(), other.begin(), other.end());
    for (const SessionCodec codec :
         {SessionCodec::ffv1, SessionCodec::fast, SessionCodec::rvl, SessionCodec::raw}) {
        RecorderOptions options;
        options.codec = codec;
        test::FileLog log;
        SessionWriter writer(std::make_unique<test::LoggedFile>(log), test::source_of(style),
                             test::rig_of(style), options, 0);
        ASSERT_TRUE(test::write_all(writer, frames).has_value());
        ASSERT_TRUE(writer
                        .put_event({.kind = "gesture",
                                    .time = 98'765'432'101'251,
                                    .text = "wave",
                                    .detail = R"({"body":1,"gesture":"wave","phase":"once"})"},
                                   0)
                        .has_value());
        ASSERT_TRUE(writer.finish(0).has_value());
        const Buffer seed = log.content;
        fuzz::session(seed);
        // How tests/data/fuzz/session was made.
        if (const char* folder = std::getenv("KINO_WRITE_SEEDS")) {
            std::ofstream(std::string(folder) + "/" + std::to_string(static_cast<int>(codec)),
                          std::ios::binary)
                .write(reinterpret_cast<const char*>(seed.data()),
                       static_cast<std::streamsize>(seed.size()));
        }
        std::mt19937 random(static_cast<unsigned>(codec) + 1);
        for (int i = 0; i < 400; ++i) {
            Buffer bytes = seed;
            for (unsigned n = 0; n < 1 + random() % 5; ++n) test::damage(bytes, random, 4096);
            if (i % 2 == 0) mend_sums(bytes);
            fuzz::session(bytes);
        }
    }
}

}  // namespace
}  // namespace kino
