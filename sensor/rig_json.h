#pragma once

#include <filesystem>
#include <string>
#include <string_view>

#include "base/camera_model.h"
#include "base/error.h"

namespace kino {

class JsonCursor;

/// A rig's calibration as JSON text:
///   {"kinoscope_rig": 1, "serial": "", "note": "",
///    "cameras": {"depth": {"width": 640, "height": 480, "fx": .., "fy": .., "cx": .., "cy": ..,
///                          "k1": .. "k6", "p1", "p2"},
///                "color": {..}},
///    "color_from_depth": {"rotation_wxyz": [..], "translation_m": [..]},
///    "disparity": {"const_shift": .., "reference_pixel_size_mm": ..,
///                  "reference_distance_cm": .., "emitter_distance_cm": ..},
///    "range_m": [nearest, farthest]}
/// Lengths in px unless named. cameras.depth with size and fx, fy, cx, cy must be there, all else
/// may be left out. Unknown keys are errors. Writing and reading back gives the same bits.
[[nodiscard]] std::string rig_to_json(const RigParameters& rig);

/// `where` names the text in errors. Fails also where validate(rig) does.
[[nodiscard]] Result<RigParameters> rig_from_json(std::string_view text, const std::string& where);

[[nodiscard]] Result<RigParameters> read_rig_file(const std::filesystem::path& path);
[[nodiscard]] Result<void> write_rig_file(const std::filesystem::path& path,
                                          const RigParameters& rig);

/// Reads the keys above from an object that may hold others too (kinoscope.json). With
/// "depth_is_registered_to_color": true, cameras.color and color_from_depth must be absent and the
/// colour camera becomes the depth camera. Not validated yet.
[[nodiscard]] Result<RigParameters> read_rig_members(const JsonCursor& object);

/// validate(rig), its complaint naming the file too.
[[nodiscard]] Result<void> validate_rig_of(const RigParameters& rig, const std::string& where);

}  // namespace kino
