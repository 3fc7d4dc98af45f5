#pragma once

#include <filesystem>
#include <memory>
#include <optional>

#include "sensor/convert/frame_sink.h"
#include "sensor/session/recorder.h"

namespace kino {

struct SinkOptions {
    bool replace = false;  ///< what is there under the name already
    SessionCodec codec = SessionCodec::ffv1;
    /// Counts a metre of TUM depth; none: the recording's own unit, which loses nothing.
    std::optional<double> depth_per_metre;
    std::int64_t first_index = 0;  ///< number of the first PNG or PLY file
};

/// A session (docs/session-format.md): everything.
[[nodiscard]] Result<std::unique_ptr<FrameSink>> make_session_sink(
    const std::filesystem::path& file, const ConvertInput& input, const SinkOptions& options);

/// A folder as tum_folder_opener() reads it, with calibration.json. Colour becomes RGB; infrared,
/// motion and bodies do not fit.
[[nodiscard]] Result<std::unique_ptr<FrameSink>> make_tum_sink(const std::filesystem::path& folder,
                                                               const ConvertInput& input,
                                                               const SinkOptions& options);

/// A folder as described_folder_opener() reads it: depth/, color/ and (for others) infrared/ with
/// one PNG a frame, and kinoscope.json. Disparity stays disparity.
[[nodiscard]] Result<std::unique_ptr<FrameSink>> make_png_sink(const std::filesystem::path& folder,
                                                               const ConvertInput& input,
                                                               const SinkOptions& options);

/// Binary point clouds, one file a frame: into a folder ("00000.ply"), under a pattern with one %d
/// or %05d, or a single frame under a plain name that ends in .ply.
[[nodiscard]] Result<std::unique_ptr<FrameSink>> make_ply_sink(const std::filesystem::path& out,
                                                               const ConvertInput& input,
                                                               const SinkOptions& options);

/// An ONI file: depth in millimetres, colour as RGB.
[[nodiscard]] Result<std::unique_ptr<FrameSink>> make_oni_sink(const std::filesystem::path& file,
                                                               const ConvertInput& input,
                                                               const SinkOptions& options);

/// An Azure Kinect recording (docs/convert.md says what its players take).
[[nodiscard]] Result<std::unique_ptr<FrameSink>> make_k4a_sink(const std::filesystem::path& file,
                                                               const ConvertInput& input,
                                                               const SinkOptions& options);

}  // namespace kino
