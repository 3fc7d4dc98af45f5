#pragma once

namespace kino {

/// From here on Ctrl-C (SIGINT) and SIGTERM are noted instead of ending the process; a second one
/// ends it as usual.
void catch_interrupts();
[[nodiscard]] bool interrupted();

}  // namespace kino
