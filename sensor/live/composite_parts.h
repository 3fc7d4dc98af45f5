#pragma once

#include <memory>
#include <mutex>
#include <string>
#include <vector>

#include "sensor/live/set_builder.h"
#include "sensor/source.h"

namespace kino {

/// The two sources of a composite and what both kinds of composite do alike.
struct CompositeParts {
    std::unique_ptr<Source> depth;
    std::unique_ptr<Source> color;

    [[nodiscard]] Source& of(StreamKind kind) const {
        return kind == StreamKind::color ? *color : *depth;
    }
    [[nodiscard]] SourceInfo info() const;
    [[nodiscard]] Result<RigParameters> calibration() const;
};

[[nodiscard]] bool has_stream(const Source& source, StreamKind kind);

[[nodiscard]] Result<std::unique_ptr<Source>> make_live_composite(CompositeParts parts,
                                                                  const SetBuilderOptions& options);
[[nodiscard]] std::unique_ptr<Source> make_recorded_composite(CompositeParts parts);

/// The knobs of two devices as those of one. Null for neither.
[[nodiscard]] std::unique_ptr<Controls> merge_controls(Controls* first, Controls* second);

}  // namespace kino
