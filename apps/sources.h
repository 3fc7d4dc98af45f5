#pragma once

namespace kino {

/// Makes the sources of higher rooms known to open_source().
void register_sources();

}  // namespace kino
