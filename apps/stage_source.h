#pragma once

#include <string>

#include "apps/pipeline/opened_source.h"

namespace kino {

/// open_for_playing(); with `wants_people`, bodies are looked for unless the source brings its own.
[[nodiscard]] Result<OpenedSource> open_with_people(const std::string& uri, PlayOptions options,
                                                    bool wants_people);

}  // namespace kino
