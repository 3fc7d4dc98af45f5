#pragma once

#include <memory>

#include "sensor/live/set_builder.h"
#include "sensor/source.h"

namespace kino {

/// Two sources that belong together: depth and all else from the one that has depth (the first,
/// if both have), colour from the other. Both are devices, paired as they come, or both are
/// recordings, paired by time from their first frames on; the timeline is that of the depth.
/// Fails for a device with a recording, and where depth or colour is missing.
///
/// Calibration: the depth source's, with the colour camera of the other; how the two stand to each
/// other is not known and taken to be the depth source's own, or none. Controls are those of both;
/// where an id is taken, the colour source's is called "color.<id>".
[[nodiscard]] Result<std::unique_ptr<Source>> make_composite_source(
    std::unique_ptr<Source> first, std::unique_ptr<Source> second,
    const SetBuilderOptions& options = {});

/// "a+b", for URIs that other openers know. Asked before those, so that it is registered last; a
/// path that exists and has a '+' in it is no composite.
[[nodiscard]] SourceOpener composite_opener();

}  // namespace kino
