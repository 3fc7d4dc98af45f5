#include <gtest/gtest.h>

#include <algorithm>

#include "logged_file.h"
#include "sensor/session/session_source.h"
#include "session_frames.h"

/// What is left of a recording after a power cut, a full disk, a cut or a flipped bit: whole
/// clusters are read bit by bit, nothing else is passed off as a frame.
namespace kino {
namespace {

using test::count_exact;
using test::FileLog;
using test::FileStep;
using test::FrameStyle;
using test::PutFrame;

constexpr FrameStyle kSmallWithTexts{.width = 12, .height = 8, .infrared = false, .texts = true};

struct Written {
    FileLog log;
    std::vector<PutFrame> frames;
};

/// Pictures at every moment, texts (which are long) now and then.
std::vector<PutFrame> small_frames(int moments) {
    std::vector<PutFrame> frames;
    for (int i = 0; i < moments; ++i) {
        for (PutFrame& frame : test::frames_at(i, kSmallWithTexts)) {
            if (frames.size() % 32 < 2 || frame.id.kind == StreamKind::depth ||
                frame.id.kind == StreamKind::color) {
                frames.push_back(std::move(frame));
            }
        }
    }
    return frames;
}

Written write_small(std::vector<PutFrame> frames, std::uint64_t capacity = UINT64_MAX,
                    bool* ended_well = nullptr) {
    Written written;
    written.frames = std::move(frames);
    RecorderOptions options;
    options.codec = SessionCodec::rvl;
    SessionWriter writer(std::make_unique<test::LoggedFile>(written.log, capacity),
                         test::source_of(kSmallWithTexts), test::rig_of(kSmallWithTexts), options,
                         0);
    const bool put = test::write_all(writer, written.frames).has_value();
    const bool finished = writer.finish(1).has_value();
    if (ended_well != nullptr) *ended_well = put && finished;
    return written;
}

Written write_small(int moments) {
    return write_small(small_frames(moments));
}

/// How many frames lie in clusters that end at or before each offset, by the file's own index.
int frames_before(const SessionReader& whole, std::uint64_t offset) {
    return static_cast<int>(std::ranges::count_if(whole.frames(), [&](const SessionEntry& entry) {
        return whole.index().clusters[entry.cluster].end <= offset;
    }));
}

TEST(Survival, ClustersAreShort) {
    const Written written = write_small(60);
    const auto reader = test::reader_of(written.log.content);
    std::vector<std::pair<TimeNs, TimeNs>> spans(reader->index().clusters.size(),
                                                 {INT64_MAX, INT64_MIN});
    for (const SessionEntry& entry : reader->frames()) {
        auto& [first, last] = spans[entry.cluster];
        first = std::min(first, entry.time);
        last = std::max(last, entry.time);
    }
    EXPECT_GE(spans.size(), 4U);
    for (const auto& [first, last] : spans) EXPECT_LE(last - first, 500 * kNsPerMs);
}

TEST(Survival, TruncatedAtEveryByte) {
    const Written written = write_small(32);
    const auto& bytes = written.log.content;
    const auto whole = test::reader_of(bytes);
    ASSERT_EQ(count_exact(*whole, written.frames), static_cast<int>(written.frames.size()));
    const std::uint64_t first = whole->index().clusters.front().start;
    for (std::size_t size = 0; size < bytes.size(); ++size) {
        const std::vector<std::uint8_t> cut(bytes.begin(),
                                            bytes.begin() + static_cast<std::ptrdiff_t>(size));
        auto reader = SessionReader::open(memory_byte_source(cut), "cut");
        if (size < first) {
            ASSERT_TRUE(!reader || (*reader)->frames().empty()) << size;
            continue;
        }
        ASSERT_TRUE(reader.has_value()) << size << ": " << reader.error().to_string();
        // All of a sample, and the number in any case.
        const int expected = frames_before(*whole, size);
        ASSERT_EQ(static_cast<int>((*reader)->frames().size()), expected) << size;
        if (size % 97 == 0) {
            ASSERT_EQ(count_exact(**reader, written.frames), expected) << size;
        }
        ASSERT_FALSE((*reader)->index().findings.empty()) << size;
    }
}

TEST(Survival, PowerCutAtEveryStep) {
    const Written written = write_small(75);
    const FileLog& log = written.log;
    test::Random random(1);
    const auto whole = test::reader_of(log.content);
    const auto syncs = std::ranges::count_if(
        log.steps, [](const FileStep& step) { return step.kind == FileStep::Kind::sync; });
    EXPECT_GE(syncs, 5);
    for (std::size_t steps = 0; steps <= log.steps.size(); ++steps) {
        for (int trial = 0; trial < 12; ++trial) {
            const auto left = test::after_power_cut(log, steps, random);
            const std::uint64_t safe = test::synced_size(log, steps);
            auto reader = SessionReader::open(memory_byte_source(left), "power cut");
            if (!reader) {
                ASSERT_EQ(safe, 0U) << steps;
                continue;
            }
            const int count = count_exact(**reader, written.frames);
            ASSERT_GE(count, frames_before(*whole, safe)) << steps;
            // A head that calls the file closed is never there before the rest of it.
            if ((*reader)->index().closed) {
                ASSERT_TRUE((*reader)->index().findings.empty()) << steps;
            }
        }
    }
}

TEST(Survival, AtMostASecondWaitsForTheDisk) {
    const Written written = write_small(120);
    const auto whole = test::reader_of(written.log.content);
    std::uint64_t synced = 0;
    for (std::size_t steps = 1; steps <= written.log.steps.size(); ++steps) {
        if (written.log.steps[steps - 1].kind != FileStep::Kind::append) {
            synced = test::synced_size(written.log, steps);
            continue;
        }
        const std::uint64_t size = written.log.steps[steps - 1].offset;
        TimeNs first = INT64_MAX;
        TimeNs last = INT64_MIN;
        for (const SessionEntry& entry : whole->frames()) {
            const SessionCluster& cluster = whole->index().clusters[entry.cluster];
            if (cluster.start < synced || cluster.end > size) continue;
            first = std::min(first, entry.time);
            last = std::max(last, entry.time);
        }
        if (first < last) {
            EXPECT_LE(last - first, kNsPerSecond + 500 * kNsPerMs);
        }
    }
}

TEST(Survival, OutOfSpaceAtEveryByte) {
    const Written whole_file = write_small(32);
    const auto whole = test::reader_of(whole_file.log.content);
    const std::size_t size = whole_file.log.content.size();
    for (std::size_t capacity = 0; capacity < size; ++capacity) {
        bool ended_well = true;
        const Written written = write_small(whole_file.frames, capacity, &ended_well);
        ASSERT_FALSE(ended_well) << capacity;
        ASSERT_LE(written.log.content.size(), capacity);
        auto reader = SessionReader::open(memory_byte_source(written.log.content), "full");
        const int expected = frames_before(*whole, capacity);
        if (!reader) {
            ASSERT_EQ(expected, 0) << capacity;
            continue;
        }
        ASSERT_EQ(static_cast<int>((*reader)->frames().size()), expected) << capacity;
        ASSERT_TRUE((*reader)->index().closed) << capacity;
        ASSERT_EQ((*reader)->index().cut_bytes, 0U) << capacity;
        if (capacity % 211 == 0) {
            ASSERT_EQ(count_exact(**reader, written.frames), expected) << capacity;
        }
    }
}

TEST(Survival, ADamagedClusterIsSkippedAndSaid) {
    const Written written = write_small(60);
    const auto whole = test::reader_of(written.log.content);
    ASSERT_GE(whole->index().clusters.size(), 4U);
    for (std::size_t c = 0; c < whole->index().clusters.size(); ++c) {
        const SessionCluster& cluster = whole->index().clusters[c];
        const auto inside = std::ranges::count_if(
            whole->frames(), [&](const SessionEntry& entry) { return entry.cluster == c; });
        // Its head, its size, its CRC, its time, a block's head, pixels, its last byte.
        const std::uint64_t length = cluster.end - cluster.start;
        for (const std::uint64_t at :
             {std::uint64_t{0}, std::uint64_t{5}, std::uint64_t{11}, std::uint64_t{14},
              std::uint64_t{20}, std::uint64_t{30}, length / 2, length - 1}) {
            auto bytes = written.log.content;
            bytes[static_cast<std::size_t>(cluster.start + at)] ^= 0x10;
            const auto reader = test::reader_of(bytes);
            const int count = count_exact(*reader, written.frames);
            ASSERT_EQ(count, static_cast<int>(written.frames.size() - inside)) << c << " " << at;
            ASSERT_FALSE(reader->index().findings.empty());
            const auto source = make_session_source(test::reader_of(bytes), "x");
            ASSERT_TRUE(source.has_value());
            EXPECT_NE((*source)->info().note.find("skipped"), std::string::npos);
        }
    }
}

TEST(Survival, DamageAfterOpeningIsAnErrorOfTheFrame) {
    const Written written = write_small(30);
    auto bytes = written.log.content;
    auto source = make_session_source(*SessionReader::open(memory_byte_source(bytes), "x"), "x");
    ASSERT_TRUE(source && subscribe_all(**source));
    const SessionCluster first = test::reader_of(bytes)->index().clusters.front();
    bytes[static_cast<std::size_t>(first.end - 20)] ^= 1;
    int good = 0;
    int bad = 0;
    for (std::int64_t i = 0; i < (*source)->timeline()->frame_count(); ++i) {
        if ((*source)->next(0)) {
            ++good;
        } else {
            ++bad;
        }
    }
    EXPECT_GT(bad, 5);
    EXPECT_GT(good, 5);
    EXPECT_FALSE(*(*source)->next(0));
}

}  // namespace
}  // namespace kino
