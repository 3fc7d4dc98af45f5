#pragma once

#include <filesystem>
#include <memory>
#include <nlohmann/json_fwd.hpp>
#include <string>

#include "apps/pipeline/time_series.h"
#include "viz/gpu/device.h"

namespace kino {

/// Makes the folder of a run and opens the device that draws. Null where that failed, which
/// was told; `code` is then the ExitCode.
[[nodiscard]] std::unique_ptr<gpu::Device> begin_run(const std::filesystem::path& folder,
                                                     const gpu::DeviceOptions& device, int& code);

/// Count, median and 95 % quantile.
[[nodiscard]] nlohmann::ordered_json times_json(const TimeSeries& times);
/// Whose figures a summary's are.
[[nodiscard]] nlohmann::ordered_json machine_json(const gpu::DeviceInfo& device,
                                                  const std::string& video_codec);

/// Leaves the summary in folder/summary.json and prints it, or `text` and the folder. Returns
/// `code`, or kExitFailed where the file could not be written, which was told.
[[nodiscard]] int end_run(const std::filesystem::path& folder,
                          const nlohmann::ordered_json& summary, const std::string& text,
                          bool prints_json, int code);

}  // namespace kino
