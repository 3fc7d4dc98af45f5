#include "sensor/session/recorder.h"

#include <gtest/gtest.h>

#include <atomic>
#include <condition_variable>
#include <filesystem>
#include <fstream>
#include <mutex>
#include <thread>

#include "logged_file.h"
#include "sensor/session/recorder_parts.h"
#include "sensor/session/session_source.h"
#include "session_frames.h"

namespace kino {
namespace {

using test::count_exact;
using test::frames_between;
using test::PutFrame;

/// A disk that stands still until it is let go.
class SlowFile final : public RecordingFile {
  public:
    explicit SlowFile(test::FileLog& log) : inner_(log) {}
    Result<void> append(std::span<const std::uint8_t> bytes) override {
        std::unique_lock lock(mutex_);
        ++waiting_;
        changed_.notify_all();
        changed_.wait(lock, [&] { return open_; });
        return inner_.append(bytes);
    }
    Result<void> overwrite(std::uint64_t offset, std::span<const std::uint8_t> bytes) override {
        return inner_.overwrite(offset, bytes);
    }
    Result<void> sync() override { return inner_.sync(); }
    Result<void> truncate(std::uint64_t size) override { return inner_.truncate(size); }
    std::uint64_t size() const override { return inner_.size(); }

    void let_go() {
        const std::lock_guard lock(mutex_);
        open_ = true;
        changed_.notify_all();
    }
    void wait_until_it_waits() {
        std::unique_lock lock(mutex_);
        changed_.wait(lock, [&] { return waiting_ > 0; });
    }

  private:
    test::LoggedFile inner_;
    std::mutex mutex_;
    std::condition_variable changed_;
    bool open_ = false;
    int waiting_ = 0;
};

void put_all(Recorder& recorder, const std::vector<PutFrame>& frames) {
    for (const PutFrame& put : frames) recorder.put(put.id, put.frame);
}

TEST(Recorder, AFileOnDiskComesBackThroughOpenSource) {
    const test::TempDir dir;
    const auto path = dir / "recording.mkv";
    const auto frames = frames_between(0, 30);
    {
        auto recorder = Recorder::create(path, test::source_of(), test::rig_of(), {});
        ASSERT_TRUE(recorder.has_value()) << recorder.error().to_string();
        put_all(**recorder, frames);
        const auto closed = (*recorder)->close();
        ASSERT_TRUE(closed.has_value()) << closed.error().to_string();
        EXPECT_EQ(closed->frames, 150);
        EXPECT_EQ(closed->dropped, 0);
        EXPECT_EQ(closed->bytes, static_cast<std::int64_t>(std::filesystem::file_size(path)));
        EXPECT_EQ(closed->queue_fill, 0);
        EXPECT_TRUE((*recorder)->close().has_value());
    }
    const auto reader = SessionReader::open(path);
    ASSERT_TRUE(reader.has_value()) << reader.error().to_string();
    EXPECT_EQ(count_exact(**reader, frames), 150);
    EXPECT_TRUE(session_opener().probe(path.string()));
}

TEST(Recorder, NothingIsOverwritten) {
    const test::TempDir dir;
    const auto path = dir.write("there.mkv", "precious");
    const auto recorder = Recorder::create(path, test::source_of(), test::rig_of(), {});
    ASSERT_FALSE(recorder.has_value());
    EXPECT_EQ(recorder.error().where, path.string());
    EXPECT_EQ(test::read_bytes(path), "precious");
}

TEST(Recorder, AFolderThatIsNotThereIsSaid) {
    const test::TempDir dir;
    const auto recorder =
        Recorder::create(dir / "no" / "a.mkv", test::source_of(), test::rig_of(), {});
    ASSERT_FALSE(recorder.has_value());
    EXPECT_FALSE(recorder.error().hint.empty());
}

TEST(Recorder, AnEmptyRecordingIsClosedSoundly) {
    test::FileLog log;
    const auto recorder = make_recorder(std::make_unique<test::LoggedFile>(log), test::source_of(),
                                        test::rig_of(), {});
    ASSERT_TRUE(recorder->close().has_value());
    const auto reader = test::reader_of(log.content);
    EXPECT_TRUE(reader->index().closed);
    EXPECT_TRUE(reader->frames().empty());
    EXPECT_FALSE(make_session_source(test::reader_of(log.content), "x").has_value());
}

TEST(Recorder, WhatTheQueueRefusesIsCountedAndToldInTheFile) {
    test::FileLog log;
    auto slow = std::make_unique<SlowFile>(log);
    SlowFile& disk = *slow;
    RecorderOptions options;
    options.queue_bytes = 20'000;  // room for about five depth frames of 3,456 bytes
    const auto recorder =
        make_recorder(std::move(slow), test::source_of(), test::rig_of(), options);
    std::vector<PutFrame> pictures;
    for (const PutFrame& put : frames_between(0, 100)) {
        if (put.id.kind == StreamKind::depth || put.id.kind == StreamKind::color) {
            pictures.push_back(put);
        }
    }
    put_all(*recorder, {pictures.begin(), pictures.begin() + 2});
    disk.wait_until_it_waits();
    put_all(*recorder, {pictures.begin() + 2, pictures.end()});
    disk.let_go();
    const auto closed = recorder->close();
    ASSERT_TRUE(closed.has_value()) << closed.error().to_string();
    EXPECT_GT(closed->dropped, 100);
    EXPECT_EQ(closed->frames + closed->dropped, 200);

    const auto reader = test::reader_of(log.content);
    EXPECT_EQ(count_exact(*reader, pictures), static_cast<int>(closed->frames));
    std::int64_t told = 0;
    for (const SessionEvent& event : reader->events()) {
        EXPECT_EQ(event.kind, "dropped");
        EXPECT_TRUE(event.stream.has_value());
        EXPECT_LE(event.first_sequence, event.last_sequence);
        told += event.count;
    }
    EXPECT_EQ(told, closed->dropped);
    const auto source = make_session_source(test::reader_of(log.content), "x");
    ASSERT_TRUE(source.has_value());
    EXPECT_NE((*source)->info().note.find("were dropped while recording"), std::string::npos);
}

TEST(Recorder, SetsAreTakenOnceEach) {
    test::FileLog log;
    const auto recorder = make_recorder(std::make_unique<test::LoggedFile>(log), test::source_of(),
                                        test::rig_of(), {});
    for (int i = 0; i < 10; ++i) {
        const auto now = test::frames_at(i);
        const auto slow_color = test::frames_at(i / 2);
        FrameSet set;
        set.depth = std::get<0>(now[0].frame);
        set.color = std::get<1>(slow_color[1].frame);
        recorder->put(set);
        recorder->put(set);
    }
    const auto closed = recorder->close();
    ASSERT_TRUE(closed.has_value());
    EXPECT_EQ(closed->frames, 15);
}

TEST(Recorder, AFullDiskEndsItWithWhatWasWritten) {
    test::FileLog log;
    const auto frames = frames_between(0, 60);
    const auto recorder = make_recorder(std::make_unique<test::LoggedFile>(log, 150'000),
                                        test::source_of(), test::rig_of(), {});
    put_all(*recorder, frames);
    const auto closed = recorder->close();
    ASSERT_FALSE(closed.has_value());
    const RecorderStatus status = recorder->status();
    EXPECT_NE(status.error.find("No space left"), std::string::npos);
    EXPECT_GT(status.frames, 0);
    EXPECT_EQ(status.frames + status.dropped, static_cast<std::int64_t>(frames.size()));
    const auto reader = test::reader_of(log.content);
    EXPECT_EQ(count_exact(*reader, frames), static_cast<int>(status.frames));
    EXPECT_TRUE(reader->index().closed);
}

TEST(Recorder, ABrokenDiskIsSaidAtOnce) {
    test::FileLog log;
    auto file = std::make_unique<test::LoggedFile>(log);
    file->break_sync();
    const auto recorder = make_recorder(std::move(file), test::source_of(), test::rig_of(), {});
    put_all(*recorder, frames_between(0, 2));
    while (recorder->status().error.empty()) std::this_thread::yield();
    EXPECT_NE(recorder->status().error.find("Input/output error"), std::string::npos);
    const auto more = frames_between(2, 4);
    put_all(*recorder, more);
    EXPECT_FALSE(recorder->close().has_value());
    EXPECT_EQ(recorder->status().frames + recorder->status().dropped, 20);
}

TEST(Recorder, ManyThreadsPutAtOnce) {
    test::FileLog log;
    const auto recorder = make_recorder(std::make_unique<test::LoggedFile>(log), test::source_of(),
                                        test::rig_of(), {});
    const auto frames = frames_between(0, 40);
    std::atomic<bool> stop = false;
    std::thread watcher([&] {
        while (!stop) (void)recorder->status();
    });
    std::vector<std::thread> threads;
    for (std::size_t t = 0; t < 4; ++t) {
        threads.emplace_back([&, t] {
            for (std::size_t i = t; i < frames.size(); i += 4) {
                recorder->put(frames[i].id, frames[i].frame);
                if (i % 16 == 0) recorder->put_event({EventKind::lost, 5, "x"});
            }
        });
    }
    for (std::thread& thread : threads) thread.join();
    const auto closed = recorder->close();
    stop = true;
    watcher.join();
    ASSERT_TRUE(closed.has_value());
    EXPECT_EQ(closed->frames, 200);
    const auto reader = test::reader_of(log.content);
    EXPECT_EQ(count_exact(*reader, frames), 200);
    EXPECT_EQ(reader->events().size(), 13U);
}

TEST(Recorder, ClosedWhileOthersStillPut) {
    test::FileLog log;
    const auto frames = frames_between(0, 40);
    const auto recorder = make_recorder(std::make_unique<test::LoggedFile>(log), test::source_of(),
                                        test::rig_of(), {});
    std::thread putter([&] { put_all(*recorder, frames); });
    std::thread closer([&] { (void)recorder->close(); });
    (void)recorder->close();
    putter.join();
    closer.join();
    const auto reader = test::reader_of(log.content);
    EXPECT_EQ(count_exact(*reader, frames), static_cast<int>(recorder->status().frames));
}

}  // namespace
}  // namespace kino
