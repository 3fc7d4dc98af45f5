#pragma once

#include <memory>

#include "sensor/session/session_reader.h"
#include "sensor/source.h"

namespace kino {

/// Plays a session: frame i is the i-th depth frame (infrared or colour where there is no depth)
/// by host time, the others beside it as pair_in_time() says. Frames keep their headers as they
/// were recorded. One device: the one of the leading stream. Lost, back and gestures come again as
/// events when playing passes them. Fails where there is no frame to lead.
[[nodiscard]] Result<std::unique_ptr<Source>> make_session_source(
    std::unique_ptr<SessionReader> reader, const std::string& uri);

/// Files that hold a session, whatever their name.
[[nodiscard]] SourceOpener session_opener();

/// Folders with a session in them that are no recording of another kind: the only `.mkv` file that
/// holds a session. Where there are several, the error names them.
[[nodiscard]] SourceOpener session_folder_opener();

}  // namespace kino
