#pragma once

#include <string>

namespace kino {

/// What to do about a device that is there but closed to this user: names the udev rule and the
/// commands that install it. For Error::hint.
[[nodiscard]] std::string permission_hint();

}  // namespace kino
