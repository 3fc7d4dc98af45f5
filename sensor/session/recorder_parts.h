#pragma once

#include <memory>

#include "sensor/session/recorder.h"
#include "sensor/session/recording_file.h"

namespace kino {

/// Recorder::create() over any file, for tests.
[[nodiscard]] std::unique_ptr<Recorder> make_recorder(std::unique_ptr<RecordingFile> file,
                                                      const SourceInfo& source,
                                                      const RigParameters& rig,
                                                      const RecorderOptions& options);

}  // namespace kino
