#pragma once

#include <filesystem>
#include <string>

#include "apps/viewer/camera_control.h"
#include "base/error.h"
#include "viz/scene/scene.h"

namespace kino {

/// What the viewer remembers from one run to the next.
struct Settings {
    int width = 1280;  ///< of the window, px
    int height = 720;
    DepthStyle style = DepthStyle::mesh;
    int splat_px = 3;
    ViewKind view = ViewKind::orbit;
    bool show_overlay = true;
    bool show_panes = true;
    friend bool operator==(const Settings&, const Settings&) = default;
};

struct LoadedSettings {
    Settings settings;
    std::string note;  ///< what was wrong with the file; empty: nothing
};

/// $XDG_CONFIG_HOME/kinoscope/settings.json, below ~/.config where that is not set; empty where
/// there is no home either.
[[nodiscard]] std::filesystem::path settings_path();

/// Never fails: a missing file means defaults, a damaged one defaults with a note. Values outside
/// their range are defaults, too.
[[nodiscard]] LoadedSettings load_settings(const std::filesystem::path& path);

/// Replaces the file as a whole, making the folders on the way.
[[nodiscard]] Result<void> save_settings(const std::filesystem::path& path,
                                         const Settings& settings);

}  // namespace kino
