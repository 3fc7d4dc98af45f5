#include "apps/stage_source.h"

#include <algorithm>
#include <utility>

namespace kino {

Result<OpenedSource> open_with_people(const std::string& uri, PlayOptions options,
                                      bool wants_people) {
    KINO_ASSIGN(auto source, open_source(uri));
    const auto& streams = source->info().streams;
    const bool recorded = std::any_of(streams.begin(), streams.end(), [](const auto& stream) {
        return stream.id.kind == StreamKind::bodies;
    });
    if (wants_people && !recorded) options.bodies.mode = BodyMode::on;
    return prepare_for_playing(std::move(source), options);
}

}  // namespace kino
