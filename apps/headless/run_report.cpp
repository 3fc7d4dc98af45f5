#include "apps/headless/run_report.h"

#include <fmt/format.h>

#include <fstream>
#include <nlohmann/json.hpp>
#include <system_error>

#include "apps/exit_codes.h"
#include "apps/tell_error.h"

namespace kino {
namespace {

/// Names from files may hold bytes that are no UTF-8; those are replaced, not thrown at.
std::string text_of(const nlohmann::ordered_json& json) {
    return json.dump(2, ' ', false, nlohmann::ordered_json::error_handler_t::replace) + '\n';
}

}  // namespace

std::unique_ptr<gpu::Device> begin_run(const std::filesystem::path& folder,
                                       const gpu::DeviceOptions& device, int& code) {
    std::error_code error;
    std::filesystem::create_directories(folder, error);
    if (error) {
        tell_error({"could not be made: " + error.message(), folder.string(), {}});
        code = kExitFailed;
        return nullptr;
    }
    auto made = gpu::Device::create(device);
    if (!made) {
        tell_error(made.error());
        code = kExitNoVulkan;
        return nullptr;
    }
    return std::move(*made);
}

nlohmann::ordered_json times_json(const TimeSeries& times) {
    return {{"count", times.count()}, {"median_ms", times.median_ms()}, {"p95_ms", times.p95_ms()}};
}

nlohmann::ordered_json machine_json(const gpu::DeviceInfo& device, const std::string& video_codec) {
    return {{"device", device.name},
            {"driver", device.driver},
            {"is_cpu", device.is_cpu},
            {"video_codec", video_codec}};
}

int end_run(const std::filesystem::path& folder, const nlohmann::ordered_json& summary,
            const std::string& text, bool prints_json, int code) {
    const std::filesystem::path path = folder / "summary.json";
    std::ofstream file(path, std::ios::binary);
    file << text_of(summary);
    file.close();
    if (!file) {
        tell_error({"could not be written", path.string(), {}});
        code = kExitFailed;
    }
    if (prints_json) {
        fmt::print("{}", text_of(summary));
    } else {
        fmt::print("{}written into {}\n", text, folder.string());
    }
    return code;
}

}  // namespace kino
