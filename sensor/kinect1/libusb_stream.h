#pragma once

#include <libusb.h>

#include <memory>

#include "sensor/kinect1/usb.h"

namespace kino::usb {

[[nodiscard]] Failure failure_of(int libusb_error);
/// "what: libusb's words".
[[nodiscard]] tl::unexpected<Fault> libusb_fault(int error, const std::string& what);

/// Submits all transfers; somebody must be handling the context's events until the stream is gone.
[[nodiscard]] Outcome<std::unique_ptr<IsoStream>> start_libusb_stream(
    libusb_device_handle* handle, const IsoParameters& parameters, PacketSink& sink);

}  // namespace kino::usb
