#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <csignal>
#include <cstdlib>
#include <thread>

#include "sensor/session/repair.h"
#include "session_frames.h"
#include "tests/support/random.h"

/// A recorder killed with SIGKILL at a random moment leaves all but its last half second.
namespace kino {
namespace {

using test::PutFrame;

constexpr test::FrameStyle kStyle{.width = 160, .height = 120, .infrared = false, .texts = false};
constexpr int kMoments = 60;

/// Records at 30 Hz until it is killed, saying each frame through the pipe once it was put.
[[noreturn]] void record(const std::filesystem::path& path, const std::vector<PutFrame>& frames,
                         int pipe) {
    auto recorder = Recorder::create(path, test::source_of(kStyle), test::rig_of(kStyle), {});
    if (!recorder) _exit(1);
    const auto start = std::chrono::steady_clock::now();
    for (std::size_t i = 0; i < frames.size(); ++i) {
        std::this_thread::sleep_until(start +
                                      std::chrono::microseconds(33'367) * static_cast<int>(i / 2));
        (*recorder)->put(frames[i].id, frames[i].frame);
        const auto byte = static_cast<std::uint8_t>(i);
        if (::write(pipe, &byte, 1) != 1) _exit(1);
    }
    while (true) ::pause();
}

TEST(Kill, AllButTheLastHalfSecondSurvivesSigkill) {
    const char* wanted = std::getenv("KINO_KILLS");
    const int kills = wanted != nullptr ? std::atoi(wanted) : 20;
    const auto frames = test::frames_between(0, kMoments, kStyle);
    test::Random random(2024);
    const test::TempDir dir;
    int with_frames = 0;
    for (int kill = 0; kill < kills; ++kill) {
        const auto path = dir / "killed.mkv";
        std::filesystem::remove(path);
        std::array<int, 2> pipe{};
        ASSERT_EQ(::pipe(pipe.data()), 0);
        const pid_t child = ::fork();
        ASSERT_GE(child, 0);
        if (child == 0) {
            ::close(pipe[0]);
            record(path, frames, pipe[1]);
        }
        ::close(pipe[1]);
        std::this_thread::sleep_for(std::chrono::microseconds(random.integer(1'000, 1'000'000)));
        ::kill(child, SIGKILL);
        int status = 0;
        ::waitpid(child, &status, 0);
        ASSERT_TRUE(WIFSIGNALED(status));
        std::vector<std::uint8_t> told(1000);
        std::size_t put = 0;
        ssize_t got = 0;
        while ((got = ::read(pipe[0], told.data(), told.size())) > 0) {
            put += static_cast<std::size_t>(got);
        }
        ::close(pipe[0]);

        auto reader = SessionReader::open(path);
        int count = 0;
        if (reader) {
            EXPECT_FALSE((*reader)->index().closed);
            count = test::count_exact(**reader, frames);
            ASSERT_GE(count, 0);
        }
        // At 30 Hz half a second is 15 moments, and a cluster may just have been on its way.
        constexpr int kLost = 2 * 17;
        EXPECT_GE(count, static_cast<int>(put) - kLost) << "kill " << kill;
        EXPECT_LE(count, static_cast<int>(put) + 1);
        if (count == 0) continue;
        ++with_frames;
        const auto repaired = repair_session(path);
        ASSERT_TRUE(repaired.has_value()) << repaired.error().to_string();
        EXPECT_EQ(repaired->frames, count);
        EXPECT_TRUE((*SessionReader::open(path))->index().findings.empty());
    }
    EXPECT_GT(with_frames, kills / 5);
}

}  // namespace
}  // namespace kino
