#include "apps/calibrate/still_scene.h"

#include <algorithm>

#include "apps/interrupt.h"
#include "calibration/rig.h"
#include "sensor/source.h"

namespace kino {
namespace {

constexpr std::int64_t kDriftFrames = 600;
constexpr int kPairFrames = 100;

bool is_over(Source& source) {
    const auto events = source.take_events();
    return std::any_of(events.begin(), events.end(),
                       [](const Event& e) { return e.kind == EventKind::ended; });
}

Result<std::unique_ptr<Source>> open_streams(const std::string& uri, bool with_color) {
    KINO_ASSIGN(auto source, open_source(uri));
    for (const StreamInfo& stream : source->info().streams) {
        if (stream.id.kind == StreamKind::depth ||
            (with_color && stream.id.kind == StreamKind::color)) {
            KINO_TRY(source->subscribe(stream.id));
        }
    }
    return source;
}

Result<Rig> depth_rig(Source& source) {
    KINO_ASSIGN(RigParameters parameters, source.calibration());
    parameters.color.reset();
    return Rig::create(std::move(parameters));
}

}  // namespace

Result<BiasFit> bias_of_wall(const std::string& uri, int frames) {
    KINO_ASSIGN(const auto source, open_streams(uri, false));
    KINO_ASSIGN(Rig rig, depth_rig(*source));
    const int width = rig.depth_rays().width();
    const int height = rig.depth_rays().height();
    Image<float> inverse(width, height, 0);
    Image<float> counts(width, height, 0);
    RegisteredDepth registered;
    for (int seen = 0; seen < frames && !interrupted();) {
        KINO_ASSIGN(const auto set, source->next(kNsPerSecond));
        if (!set && is_over(*source)) break;
        if (!set || !set->depth) continue;
        KINO_TRY(rig.register_depth(*set->depth, registered));
        ++seen;
        for (std::size_t i = 0; i < inverse.size(); ++i) {
            const float z = registered.depth_m.pixels()[i];
            if (!(z > 0)) continue;
            inverse.pixels()[i] += 1 / z;
            counts.pixels()[i] += 1;
        }
    }
    Image<float> mean(width, height, 0);
    for (std::size_t i = 0; i < mean.size(); ++i) {
        if (inverse.pixels()[i] > 0) {
            mean.pixels()[i] = counts.pixels()[i] / inverse.pixels()[i];
        }
    }
    auto samples = samples_on_wall(mean, rig.depth_rays());
    if (!samples) return fail(samples.error().what, uri, samples.error().hint);
    return fit_bias(*samples, width, height);
}

Result<DriftSeries> drift_of(const std::string& uri) {
    KINO_ASSIGN(const auto source, open_streams(uri, false));
    KINO_ASSIGN(Rig rig, depth_rig(*source));
    Timeline* timeline = source->timeline();
    const std::int64_t step =
        timeline ? std::max<std::int64_t>(1, timeline->frame_count() / kDriftFrames) : 1;
    DriftWatch watch;
    RegisteredDepth registered;
    for (std::int64_t frame = 0; !interrupted(); frame += step) {
        if (timeline) {
            if (frame >= timeline->frame_count()) break;
            KINO_TRY(timeline->seek(frame));
        }
        KINO_ASSIGN(const auto set, source->next(kNsPerSecond));
        if (!set && is_over(*source)) break;
        if (!set || !set->depth) continue;
        KINO_TRY(rig.register_depth(*set->depth, registered));
        watch.add(to_seconds(set->time), registered.depth_m);
    }
    DriftSeries series = watch.series();
    if (series.points.empty()) {
        return fail("nothing still and flat was seen", uri,
                    "record a scene in which nothing moves, with walls or furniture in it");
    }
    return series;
}

Result<FramePair> first_pair(const std::string& uri, RigParameters& rig) {
    KINO_ASSIGN(const auto source, open_streams(uri, true));
    KINO_ASSIGN(rig, source->calibration());
    for (int seen = 0; seen < kPairFrames && !interrupted(); ++seen) {
        KINO_ASSIGN(const auto set, source->next(kNsPerSecond));
        if (!set && is_over(*source)) break;
        if (set && set->depth && set->color && set->color_paired) {
            return FramePair{set->depth, set->color};
        }
    }
    return FramePair{};
}

}  // namespace kino
