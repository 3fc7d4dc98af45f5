#pragma once

#include <string>
#include <vector>

#include "base/error.h"

namespace kino {

/// Motions of people recorded by other trackers, as ActorTake names them: "log:FILE" of all files
/// of tests/data/motion below the working directory, by name. No training set has them.
[[nodiscard]] Result<std::vector<std::string>> logged_motions();

}  // namespace kino
