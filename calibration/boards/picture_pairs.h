#pragma once

#include <array>
#include <filesystem>
#include <string>
#include <vector>

#include "base/error.h"

namespace kino {

/// One view: a picture by each camera; an empty path where a camera has none.
struct PictureView {
    std::string name;  ///< what the pictures' names have in common: "01"
    std::array<std::filesystem::path, 2> files;
};

/// Pictures by one or two cameras.
struct PictureSet {
    std::vector<std::string> cameras;  ///< 1 or 2 names
    std::vector<PictureView> views;    ///< sorted by name, numbers as numbers
};

/// Every PNG and JPEG of a folder by one camera, whose name is the folder's. Fails where there is
/// none.
[[nodiscard]] Result<PictureSet> pictures_in(const std::filesystem::path& folder);

/// Pairs by name, "FIRST..." and "SECOND..." with the same rest ("left01.jpg", "right01.png"), or
/// the pictures of the same name in the folders FIRST and SECOND below. `names` "first,second";
/// empty: the first that is there of infrared and color, ir and color, depth and color, ir and rgb,
/// left and right. Fails where no pair is found; pictures without a partner stay, with one file.
[[nodiscard]] Result<PictureSet> picture_pairs_in(const std::filesystem::path& folder,
                                                  const std::string& names = {});

}  // namespace kino
