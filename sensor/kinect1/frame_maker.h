#pragma once

#include "sensor/kinect1/camera_mode.h"
#include "sensor/kinect1/packet_assembler.h"
#include "sensor/source.h"

namespace kino::kinect1 {

/// What the camera sent to a frame as the rest of the program knows it. A pixel is lost if a bit
/// of it lies in a missing byte (in UYVY: if a byte of its pair does); lost depth pixels hold no
/// reading (2047), all others 0. A row is listed as damaged exactly if one of its pixels is lost.
/// Depth in ten bits is given as twice its value (DepthUnit::kinect_disparity11). The header is
/// the caller's, but for lost_before.
[[nodiscard]] StreamFrame make_frame(CameraMode mode, const AssembledFrame& frame,
                                     FrameHeader header);

}  // namespace kino::kinect1
