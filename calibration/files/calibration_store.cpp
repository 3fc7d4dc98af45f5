#include "calibration/files/calibration_store.h"

#include <fmt/format.h>

#include <cstdlib>
#include <system_error>

#include "sensor/rig_json.h"

namespace kino {

namespace fs = std::filesystem;

Result<fs::path> calibration_folder() {
    const char* config = std::getenv("XDG_CONFIG_HOME");
    if (config && *config == '/') return fs::path(config) / "kinoscope" / "calibration";
    const char* home = std::getenv("HOME");
    if (home && *home == '/') return fs::path(home) / ".config" / "kinoscope" / "calibration";
    return fail("neither XDG_CONFIG_HOME nor HOME says where calibrations are kept");
}

fs::path calibration_file(const fs::path& folder, const std::string& serial) {
    std::string name;
    for (const char c : serial) {
        const bool plain = (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') ||
                           (c >= '0' && c <= '9') || c == '-' || c == '_';
        name += plain ? std::string(1, c) : fmt::format("%{:02X}", static_cast<unsigned char>(c));
    }
    return folder / (name + ".json");
}

Result<fs::path> store_calibration(const fs::path& folder, const RigParameters& rig) {
    if (rig.serial.empty()) {
        return fail("the device has no serial number to keep its calibration under", {},
                    "state one with --serial");
    }
    std::error_code error;
    fs::create_directories(folder, error);
    if (error) return fail(error.message(), folder.string());
    fs::path file = calibration_file(folder, rig.serial);
    KINO_TRY(write_rig_file(file, rig));
    return file;
}

Result<std::optional<RigParameters>> stored_calibration(const fs::path& folder,
                                                        const std::string& serial) {
    if (serial.empty()) return std::nullopt;
    const fs::path file = calibration_file(folder, serial);
    std::error_code error;
    if (!fs::exists(file, error)) return std::nullopt;
    KINO_ASSIGN(RigParameters rig, read_rig_file(file));
    if (rig.serial != serial) {
        return fail(fmt::format("this is the calibration of {}, not of {}", rig.serial, serial),
                    file.string());
    }
    return rig;
}

}  // namespace kino
