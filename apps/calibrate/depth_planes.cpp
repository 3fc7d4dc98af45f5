#include "apps/calibrate/depth_planes.h"

#include <algorithm>

#include "apps/interrupt.h"
#include "sensor/source.h"

namespace kino {

Result<std::vector<PlaneBand>> depth_planes(const std::string& uri, int frames) {
    KINO_ASSIGN(const auto source, open_source(uri));
    for (const StreamInfo& stream : source->info().streams) {
        if (stream.id.kind == StreamKind::depth) KINO_TRY(source->subscribe(stream.id));
    }
    KINO_ASSIGN(RigParameters parameters, source->calibration());
    parameters.color.reset();
    KINO_ASSIGN(Rig rig, Rig::create(std::move(parameters)));
    std::vector<FlatPart> parts;
    RegisteredDepth registered;
    for (int seen = 0; seen < frames && !interrupted();) {
        KINO_ASSIGN(const auto set, source->next(kNsPerSecond));
        if (!set) {
            const auto events = source->take_events();
            if (std::any_of(events.begin(), events.end(),
                            [](const Event& e) { return e.kind == EventKind::ended; })) {
                break;
            }
            continue;
        }
        if (!set->depth) continue;
        KINO_TRY(rig.register_depth(*set->depth, registered));
        const auto more = flat_parts(registered.depth_m, rig.depth_rays());
        parts.insert(parts.end(), more.begin(), more.end());
        ++seen;
    }
    auto bands = by_distance(parts);
    if (bands.empty()) return fail("no flat part is in these depth frames", uri);
    return bands;
}

}  // namespace kino
