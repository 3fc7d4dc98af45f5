#pragma once

#include <filesystem>
#include <memory>
#include <vector>

#include "base/error.h"
#include "skeleton/forest/forest.h"

namespace kino {

/// Where the shipped forest may lie, in the order in which it is looked for: the folder named by
/// the environment variable KINOSCOPE_DATA, ../share/kinoscope beside the running program, and the
/// source tree that the program was built from.
[[nodiscard]] std::vector<std::filesystem::path> default_forest_places();

/// The shipped forest; its labels are those of BodyPart. Fails naming all the places if it is in
/// none, and as read_forest() does.
[[nodiscard]] Result<std::shared_ptr<const Forest>> default_forest();

}  // namespace kino
