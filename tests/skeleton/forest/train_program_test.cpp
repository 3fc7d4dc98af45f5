#include <gtest/gtest.h>
#include <sys/wait.h>

#include <cstdlib>
#include <filesystem>
#include <string>

#include "skeleton/forest/forest_file.h"
#include "tests/support/temp_dir.h"

namespace kino {
namespace {

int exit_code(const std::string& arguments) {
    const std::string command = std::string(KINO_TRAIN) + " " + arguments + " >/dev/null 2>&1";
    return WEXITSTATUS(std::system(command.c_str()));
}

const std::string kSmall =
    "--images 6 --pixels 60 --trees 2 --depth 4 --features 16 --deep-features 0 --leaf-pixels 200 ";

TEST(TrainProgram, WritesAForestThatNamesItsCommandAndDependsOnItAlone) {
    const test::TempDir folder;
    const auto made = [&](const std::string& name, const std::string& options) {
        const auto path = folder.path() / name;
        EXPECT_EQ(exit_code(kSmall + options + " --out " + path.string()), 0);
        return test::read_bytes(path);
    };
    const std::string first = made("a.forest", "--seed 5 --threads 1");
    EXPECT_EQ(made("b.forest", "--threads 3 --seed 5"), first);
    EXPECT_NE(made("c.forest", "--seed 6"), first);
    const auto forest = read_forest(folder.path() / "a.forest");
    ASSERT_TRUE(forest.has_value());
    EXPECT_EQ(forest->trees.size(), 2u);
    const std::string note = forest->note;
    ASSERT_EQ(note.substr(0, 15), "kinoscope train");
    EXPECT_NE(note.find(" --seed 5"), std::string::npos) << note;
    EXPECT_NE(note.find(" --images 6"), std::string::npos) << note;
    EXPECT_NE(note.find(" --min-votes 3"), std::string::npos) << note;
    EXPECT_EQ(note.find(folder.path().string()), std::string::npos) << note;
    // The note is a command that makes the same file.
    const auto again = folder.path() / "again.forest";
    ASSERT_EQ(exit_code(note.substr(15) + " --out " + again.string()), 0);
    EXPECT_EQ(test::read_bytes(again), first);
}

TEST(TrainProgram, ExitCodes) {
    const test::TempDir folder;
    EXPECT_EQ(exit_code("--help"), 0);
    EXPECT_EQ(exit_code(""), 2);
    EXPECT_EQ(exit_code("--out " + (folder / "f").string() + " --images 0"), 2);
    EXPECT_EQ(exit_code("--out " + (folder / "f").string() + " --depth 25"), 2);
    EXPECT_EQ(exit_code(kSmall + "--out " + (folder / "none" / "f").string()), 1);
    EXPECT_FALSE(std::filesystem::exists(folder / "f"));
}

}  // namespace
}  // namespace kino
