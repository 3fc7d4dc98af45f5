#include "sensor/session/repair.h"

#include <gtest/gtest.h>

#include "logged_file.h"
#include "sensor/session/crc32.h"
#include "sensor/session/session_source.h"
#include "session_frames.h"

namespace kino {
namespace {

using test::count_exact;
using test::frames_between;
using test::FrameStyle;

constexpr FrameStyle kSmall{.width = 12, .height = 8, .infrared = false, .texts = false};

/// Reads what a LoggedFile holds now.
class LogBytes final : public ByteSource {
  public:
    explicit LogBytes(const test::FileLog& log) : log_(log) {}
    std::uint64_t size() const override { return log_.content.size(); }
    bool read(std::uint64_t offset, std::span<std::uint8_t> out) const override {
        return memory_byte_source(log_.content)->read(offset, out);
    }

  private:
    const test::FileLog& log_;
};

std::vector<std::uint8_t> whole_session() {
    return test::session_of(frames_between(0, 50, kSmall), {}, kSmall);
}

/// The session as it is while it is being written: up to its last cluster, the end unknown.
std::vector<std::uint8_t> open_session(std::vector<std::uint8_t> bytes) {
    const SessionIndex index = test::reader_of(bytes)->index();
    bytes.resize(static_cast<std::size_t>(index.sound_end));
    SessionHead head;
    head.places = {512, 512, 512, {}};
    const auto unknown = first_sector(head);
    std::copy_n(unknown.begin(), segment_content_start(), bytes.begin());
    return bytes;
}

TEST(Crc32, CheckValue) {
    const std::string digits = "123456789";
    const std::span bytes(reinterpret_cast<const std::uint8_t*>(digits.data()), digits.size());
    EXPECT_EQ(crc32(bytes), 0xCBF43926U);
    for (std::size_t i = 0; i <= digits.size(); ++i) {
        EXPECT_EQ(crc32(bytes.subspan(i), crc32(bytes.first(i))), 0xCBF43926U);
    }
}

TEST(Repair, TouchesNoClusterAndBringsBackEverything) {
    const auto frames = frames_between(0, 50, kSmall);
    const auto whole = open_session(whole_session());
    const std::uint64_t first = test::reader_of(whole)->index().clusters.front().start;
    for (std::size_t size = static_cast<std::size_t>(first) + 1; size < whole.size(); size += 61) {
        test::FileLog log;
        log.content.assign(whole.begin(), whole.begin() + static_cast<std::ptrdiff_t>(size));
        const int before = count_exact(*test::reader_of(log.content), frames);
        const std::uint64_t sound_end = test::reader_of(log.content)->index().sound_end;
        test::LoggedFile file(log);
        const auto report = repair_session(LogBytes(log), file, "cut");
        if (before == 0) {
            EXPECT_FALSE(report.has_value());
            continue;
        }
        ASSERT_TRUE(report.has_value()) << report.error().to_string();
        EXPECT_EQ(report->frames, before);
        EXPECT_EQ(report->cut_bytes, size - sound_end);
        const auto reader = test::reader_of(log.content);
        EXPECT_TRUE(reader->index().closed);
        EXPECT_TRUE(reader->index().findings.empty());
        EXPECT_EQ(count_exact(*reader, frames), before);
        EXPECT_TRUE(std::equal(log.content.begin() + 512,
                               log.content.begin() + static_cast<std::ptrdiff_t>(sound_end),
                               whole.begin() + 512));
        const auto again = repair_session(LogBytes(log), file, "again");
        ASSERT_TRUE(again.has_value());
        EXPECT_TRUE(again->was_closed);
    }
}

TEST(Repair, StoppedByAPowerCutItCanBeDoneAgain) {
    const auto frames = frames_between(0, 50, kSmall);
    auto cut = open_session(whole_session());
    cut.resize(cut.size() - 20);
    const int before = count_exact(*test::reader_of(cut), frames);
    test::FileLog log;
    log.content = cut;
    log.steps.push_back({test::FileStep::Kind::append, 0, cut});
    log.steps.push_back({test::FileStep::Kind::sync, 0, {}});
    test::LoggedFile file(log);
    ASSERT_TRUE(repair_session(LogBytes(log), file, "cut").has_value());
    ASSERT_GE(log.steps.size(), 7U);
    test::Random random(5);
    for (std::size_t steps = 2; steps <= log.steps.size(); ++steps) {
        for (int trial = 0; trial < 20; ++trial) {
            test::FileLog left;
            left.content = test::after_power_cut(log, steps, random);
            EXPECT_EQ(count_exact(*test::reader_of(left.content), frames), before);
            test::LoggedFile again(left);
            ASSERT_TRUE(repair_session(LogBytes(left), again, "again").has_value());
            const auto reader = test::reader_of(left.content);
            EXPECT_TRUE(reader->index().closed);
            EXPECT_EQ(count_exact(*reader, frames), before);
        }
    }
}

TEST(Repair, AFileOnDisk) {
    const auto whole = whole_session();
    const test::TempDir dir;
    const auto path =
        dir.write("a.mkv", {reinterpret_cast<const char*>(whole.data()), whole.size() - 700});
    const auto report = repair_session(path);
    ASSERT_TRUE(report.has_value()) << report.error().to_string();
    EXPECT_FALSE(report->was_closed);
    EXPECT_TRUE(repair_session(path)->was_closed);
    EXPECT_FALSE(repair_session(dir.write("b.mkv", "no session")).has_value());
    EXPECT_FALSE(repair_session(dir / "missing").has_value());
}

}  // namespace
}  // namespace kino
