#pragma once

namespace kino::guest {

/// Does what libusb needs of a udev daemon, in a process that ends with the caller: libusb (as
/// Debian builds it) learns of new devices only from the daemon's messages, and the guest has none.
/// Each event of the kernel is sent on to libudev's multicast group unchanged.
void start_udev_relay();

}  // namespace kino::guest
