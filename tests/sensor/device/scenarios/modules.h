#pragma once

#include <string>

#include "base/error.h"

namespace kino::guest {

/// Inserts the kernel module and what it depends on; parameters as for insmod. One that is there
/// already is removed first.
Result<void> insert_module(const std::string& name, const std::string& parameters);

/// Without effect if it is not there; fails while it is in use.
Result<void> remove_module(const std::string& name);

/// "/dev/video0" of a video device whose name begins so, once it has appeared; empty if
/// that takes too long.
[[nodiscard]] std::string wait_for_video_node(const std::string& name_begin);

}  // namespace kino::guest
