#pragma once

#include "sensor/source.h"

namespace kino {

/// A folder of the TUM RGB-D benchmark: depth/ and rgb/ with 16-bit and 8-bit PNGs, optionally
/// depth.txt, rgb.txt (else the file names are the times), groundtruth.txt and calibration.json.
/// Depth is registered to colour and counts 5000 a metre unless calibration.json says otherwise.
[[nodiscard]] SourceOpener tum_folder_opener();

/// A folder with kinoscope.json (sensor/description.h): PNG frames, or a clip whose brightness
/// codes depth.
[[nodiscard]] SourceOpener described_folder_opener();

}  // namespace kino
