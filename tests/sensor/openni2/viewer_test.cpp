#include <gtest/gtest.h>
#include <sys/wait.h>

#include <cstdlib>
#include <string>

#include "oni_samples.h"
#include "tests/support/temp_dir.h"

namespace kino {
namespace {

/// Debian's viewer (openni2-utils, under xvfb-run) opens and plays what we write: it runs until it
/// is ended, and complains of nothing. A damaged file, as the counter-proof, it does not open.
struct Ran {
    int status = 0;  ///< 124: it ran until timeout ended it
    std::string output;
};

Ran run_viewer(const std::filesystem::path& file, const test::TempDir& folder) {
    const auto log = folder / "viewer.log";
    const std::string command = "HOME=" + folder.path().string() +
                                " LIBGL_ALWAYS_SOFTWARE=1 xvfb-run -a -s '-screen 0 1280x1024x24' "
                                "timeout 3 NiViewer2 " +
                                file.string() + " > " + log.string() + " 2>&1 < /dev/null";
    const int status = std::system(command.c_str());
    return {WIFEXITED(status) ? WEXITSTATUS(status) : -1, test::read_bytes(log)};
}

TEST(NiViewer2, OpensWhatWeWrite) {
    const test::TempDir folder;
    const auto file = folder / "a.oni";
    test::write_sample(file, 20, true, 320, 240);
    const Ran good = run_viewer(file, folder);
    EXPECT_EQ(good.status, 124) << good.output;
    EXPECT_EQ(good.output.find("rror"), std::string::npos) << good.output;
    EXPECT_EQ(good.output.find("ailed"), std::string::npos) << good.output;

    std::string bytes = test::read_bytes(file);
    bytes.resize(bytes.size() / 2);
    bytes[30] = 'x';
    const Ran bad = run_viewer(folder.write("b.oni", bytes), folder);
    EXPECT_NE(bad.status, 124) << "the test would see a file that the viewer refuses";
}

}  // namespace
}  // namespace kino
