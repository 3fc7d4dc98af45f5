#include "program_runner.h"

#include <fmt/format.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <csignal>
#include <cstdlib>
#include <fstream>
#include <thread>

#include "base/check.h"
#include "sensor/png_io.h"
#include "tests/support/temp_dir.h"

namespace kino::test {
namespace {

namespace fs = std::filesystem;

/// The child's side: never returns.
[[noreturn]] void become(const ProgramCall& call, const fs::path& out, const fs::path& err) {
    const bool redirected = std::freopen(out.c_str(), "wb", stdout) != nullptr &&
                            std::freopen(err.c_str(), "wb", stderr) != nullptr;
    if (!redirected || (!call.folder.empty() && chdir(call.folder.c_str()) != 0)) _exit(126);
    for (const std::string& entry : call.environment) {
        const std::size_t equals = entry.find('=');
        if (equals == std::string::npos) {
            unsetenv(entry.c_str());
        } else {
            setenv(entry.substr(0, equals).c_str(), entry.c_str() + equals + 1, 1);
        }
    }
    std::vector<std::string> words = call.wrapper;
    words.emplace_back(KINO_PROGRAM);
    words.insert(words.end(), call.arguments.begin(), call.arguments.end());
    std::vector<char*> argv;
    argv.reserve(words.size() + 1);
    for (std::string& word : words) argv.push_back(word.data());
    argv.push_back(nullptr);
    execvp(argv[0], argv.data());
    _exit(127);
}

}  // namespace

ProgramResult run_program(const ProgramCall& call) {
    const TempDir temp;
    const fs::path out = temp / "out";
    const fs::path err = temp / "err";
    std::fflush(nullptr);
    const pid_t child = fork();
    KINO_CHECK(child >= 0);
    if (child == 0) become(call, out, err);
    int status = 0;
    bool signalled = call.interrupt_when_exists_signal == 0;
    while (waitpid(child, &status, signalled ? 0 : WNOHANG) == 0) {
        if (fs::exists(call.interrupt_when_exists)) {
            kill(child, call.interrupt_when_exists_signal);
            signalled = true;
        }
        std::this_thread::sleep_for(std::chrono::milliseconds(2));
    }
    return {WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status), read_bytes(out),
            read_bytes(err)};
}

std::string bundled(const std::string& name) {
    return (fs::path(KINO_SOURCE_FOLDER) / "recordings" / name).string();
}

fs::path write_tiny_recording(const fs::path& folder, int frames) {
    constexpr int kWidth = 32;
    constexpr int kHeight = 24;
    fs::create_directories(folder / "depth");
    fs::create_directories(folder / "color");
    for (int i = 0; i < frames; ++i) {
        Image<std::uint16_t> depth(kWidth, kHeight);
        Image<Rgba8> color(kWidth, kHeight);
        for (int y = 0; y < kHeight; ++y) {
            for (int x = 0; x < kWidth; ++x) {
                depth.at(x, y) = static_cast<std::uint16_t>(1500 + 10 * i + 3 * x);
                color.at(x, y) = {static_cast<std::uint8_t>(8 * x),
                                  static_cast<std::uint8_t>(10 * y),
                                  static_cast<std::uint8_t>(20 * i), 255};
            }
        }
        const std::string name = fmt::format("{:03}.png", i);
        const Image<std::uint16_t>& fixed_depth = depth;
        const Image<Rgba8>& fixed_color = color;
        KINO_CHECK(write_png_gray16(folder / "depth" / name, fixed_depth.view()).has_value());
        KINO_CHECK(write_png_rgba8(folder / "color" / name, fixed_color.view()).has_value());
    }
    std::ofstream(folder / "kinoscope.json") << R"({"kinoscope": 1, "name": "tiny", "fps": 30,
        "depth": {"dir": "depth", "unit": "millimetres"}, "color": {"dir": "color"},
        "depth_is_registered_to_color": true,
        "cameras": {"depth": {"width": 32, "height": 24, "fx": 30, "fy": 30, "cx": 15.5, "cy": 11.5}}})";
    return folder;
}

}  // namespace kino::test
