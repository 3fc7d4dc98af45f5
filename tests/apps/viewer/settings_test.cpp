#include "apps/viewer/settings.h"

#include <gtest/gtest.h>

#include <cstdlib>

#include "tests/support/temp_dir.h"

namespace kino {
namespace {

using test::TempDir;

TEST(Settings, SavedAndReadBack) {
    const TempDir temp;
    const Settings wanted{.width = 900,
                          .height = 700,
                          .style = DepthStyle::cloud,
                          .splat_px = 5,
                          .view = ViewKind::fly,
                          .show_overlay = false,
                          .show_panes = false};
    ASSERT_TRUE(save_settings(temp / "deep/below/settings.json", wanted));
    const LoadedSettings loaded = load_settings(temp / "deep/below/settings.json");
    EXPECT_EQ(loaded.settings, wanted);
    EXPECT_TRUE(loaded.note.empty());
}

TEST(Settings, MissingFileMeansDefaultsWithoutANote) {
    const TempDir temp;
    const LoadedSettings loaded = load_settings(temp / "none.json");
    EXPECT_EQ(loaded.settings, Settings{});
    EXPECT_TRUE(loaded.note.empty());
}

TEST(Settings, DamagedFileMeansDefaultsWithANote) {
    const TempDir temp;
    for (const char* content : {"", "{", "[1, 2]", "null", "\xff\xfe\x00", "{\"width\": 12"}) {
        const LoadedSettings loaded = load_settings(temp.write("settings.json", content));
        EXPECT_EQ(loaded.settings, Settings{}) << content;
        EXPECT_NE(loaded.note.find("settings.json"), std::string::npos) << content;
    }
}

TEST(Settings, WrongValuesAreDefaultsTheOthersStay) {
    const TempDir temp;
    const LoadedSettings loaded = load_settings(temp.write(
        "settings.json",
        R"({"width": 1e300, "height": 600, "style": 3, "splat_px": -1, "view": "upside down",
            "show_panes": "yes", "show_overlay": false, "from_the_future": 1})"));
    Settings expected;
    expected.height = 600;
    expected.show_overlay = false;
    EXPECT_EQ(loaded.settings, expected);
    for (const char* name : {"width", "style", "splat_px", "view", "show_panes"}) {
        EXPECT_NE(loaded.note.find(name), std::string::npos) << name;
    }
}

TEST(Settings, PathFollowsTheStandard) {
    setenv("XDG_CONFIG_HOME", "/somewhere", 1);
    EXPECT_EQ(settings_path(), "/somewhere/kinoscope/settings.json");
    setenv("XDG_CONFIG_HOME", "relative", 1);
    setenv("HOME", "/home/somebody", 1);
    EXPECT_EQ(settings_path(), "/home/somebody/.config/kinoscope/settings.json");
    unsetenv("HOME");
    unsetenv("XDG_CONFIG_HOME");
    EXPECT_TRUE(settings_path().empty());
}

TEST(Settings, AFolderThatCannotBeMadeIsAnError) {
    const TempDir temp;
    temp.write("file", "x");
    EXPECT_FALSE(save_settings(temp / "file/settings.json", {}));
}

}  // namespace
}  // namespace kino
