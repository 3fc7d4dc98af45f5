#pragma once

#include <string>

#include "base/camera_model.h"
#include "base/error.h"
#include "sensor/source.h"

namespace kino {

/// The calibration a source is played and recorded with.
struct FoundCalibration {
    RigParameters rig;
    std::string file{};  ///< it came from; empty: the source's own
};

/// `choice`: a file of sensor/rig_json.h; "none": what the source itself says; empty: for a live
/// device the file kept for its serial number (calibration/files/calibration_store.h), else what
/// the source says. Fails for a file that cannot be read, is another device's (only where it was
/// found by its serial), or does not fit.
[[nodiscard]] Result<FoundCalibration> find_calibration(Source& source, const std::string& choice);

/// On stderr, where a file was used: which one, and for which device.
void tell_of(const FoundCalibration& calibration);

/// `file` for a source whose own calibration is `own`: cameras scaled to the source's sizes, which
/// must have the same shape; colour only where the source has some, and the source's own where the
/// file has none. Fails where a shape differs or the device has registered depth to colour itself.
[[nodiscard]] Result<RigParameters> fit_calibration(RigParameters file, const RigParameters& own,
                                                    const SourceInfo& info);

}  // namespace kino
