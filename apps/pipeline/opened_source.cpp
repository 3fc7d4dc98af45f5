#include "apps/pipeline/opened_source.h"

#include <utility>

#include "skeleton/gestures/gesture_json.h"

namespace kino {

Result<std::vector<StreamId>> subscribe_what_goes(Source& source) {
    std::vector<StreamId> going;
    std::optional<Error> refused;
    for (const StreamInfo& stream : source.info().streams) {
        if (auto subscribed = source.subscribe(stream.id)) {
            going.push_back(stream.id);
        } else if (!refused) {
            refused = std::move(subscribed).error();
        }
    }
    // A recording whose streams do not open is broken; a device may have to choose.
    if (refused && (going.empty() || source.timeline() != nullptr)) return fail(*refused);
    return going;
}

Result<OpenedSource> prepare_for_playing(std::unique_ptr<Source> source,
                                         const PlayOptions& options) {
    const std::string uri = source->info().uri;
    KINO_ASSIGN(std::vector<StreamId> streams, subscribe_what_goes(*source));
    auto calibration = find_calibration(*source, options.calibration);
    if (!calibration) return fail(calibration.error(), uri);
    tell_of(*calibration);
    KINO_ASSIGN(DepthFilterChain filters, DepthFilterChain::parse(options.filters));
    KINO_ASSIGN(const auto bias, bias_beside(calibration->file, calibration->rig.serial));
    auto processor = Processor::create(calibration->rig, {}, std::move(filters), bias);
    if (!processor) return fail(processor.error(), uri);
    LoopMode mode = LoopMode::loop;
    if (options.mode) {
        mode = *options.mode;
    } else if (const Timeline* timeline = source->timeline()) {
        mode = natural_loop(*timeline);
    }
    BodyOptions of_bodies = options.bodies;
    of_bodies.seated = of_bodies.seated || source->info().seated_people;
    KINO_ASSIGN(auto bodies, BodyStage::create(of_bodies, processor->rig()));
    return OpenedSource{
        std::move(source), std::move(*processor),  mode, std::move(streams), of_bodies,
        std::move(bodies), std::move(*calibration)};
}

Result<OpenedSource> open_for_playing(const std::string& uri, const PlayOptions& options) {
    KINO_ASSIGN(auto source, open_source(uri));
    return prepare_for_playing(std::move(source), options);
}

Result<std::optional<ProcessedFrame>> read_frame(
    OpenedSource& opened, std::optional<std::int64_t> index, TimeNs timeout,
    const std::function<void(const FrameSet&)>& on_set) {
    const TimeNs began = now_ns();
    if (Timeline* timeline = opened.source->timeline(); timeline != nullptr && index) {
        if (const std::int64_t ahead = *index - timeline->position(); ahead != 0) {
            // Colour of before a jump would be shown as if it were recent; frames that were
            // skipped for lack of time are no jump.
            constexpr std::int64_t kSkip = 30;
            if (ahead < 0 || ahead > kSkip) opened.processor.forget();
            KINO_TRY(timeline->seek(*index));
        }
    }
    KINO_ASSIGN(std::optional<FrameSet> set, opened.source->next(timeout));
    if (!set) return std::nullopt;
    const TimeNs read = now_ns() - began;
    if (on_set) on_set(*set);
    KINO_ASSIGN(ProcessedFrame frame, opened.processor.process(std::move(*set)));
    frame.times.read = read;
    if (opened.bodies) {
        opened.bodies->process(frame);
        frame.ready = now_ns();
    }
    return frame;
}

std::vector<GestureEvent> gestures_in(const std::vector<Event>& events) {
    std::vector<GestureEvent> gestures;
    for (const Event& event : events) {
        if (event.kind != EventKind::gesture) continue;
        if (auto gesture = gesture_event_from_json(event.detail, "event")) {
            gestures.push_back(*std::move(gesture));
        }
    }
    return gestures;
}

}  // namespace kino
