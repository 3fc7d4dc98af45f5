#pragma once

#include <CLI/CLI.hpp>
#include <string>

namespace kino {

/// --calibration FILE|none, for find_calibration().
inline void add_calibration_option(CLI::App& app, std::string& calibration) {
    app.add_option("--calibration", calibration,
                   "a rig file, or none: what the source itself says; by default the one that "
                   "`kinoscope calibrate --keep` kept for this device, if any")
        ->type_name("FILE|none");
}

}  // namespace kino
