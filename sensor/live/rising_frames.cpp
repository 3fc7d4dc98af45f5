#include "sensor/live/rising_frames.h"

#include <algorithm>
#include <memory>

namespace kino {
namespace {

FrameHeader header_of(const BodyFrame& frame) {
    return {.device_time = frame.time, .host_time = frame.time};
}
void set_header(BodyFrame& frame, const FrameHeader& header) {
    frame.time = header.host_time;
}
template <class Frame>
FrameHeader header_of(const Frame& frame) {
    return frame.header;
}
template <class Frame>
void set_header(Frame& frame, const FrameHeader& header) {
    frame.header = header;
}

bool same(const FrameHeader& a, const FrameHeader& b) {
    return a.device_time == b.device_time && a.host_time == b.host_time && a.sequence == b.sequence;
}

}  // namespace

RisingFrames::Stream* RisingFrames::find(StreamId id) {
    const auto found =
        std::find_if(streams_.begin(), streams_.end(), [&](const Stream& s) { return s.id == id; });
    return found == streams_.end() ? nullptr : &*found;
}

FrameHeader RisingFrames::raise(StreamId id, FrameHeader header) {
    if (!shift_known_ && any_) {
        const TimeNs gone = std::max<TimeNs>(1, header.host_time - newest_.host_time);
        device_shift_ = newest_.device_time + gone - header.device_time;
    }
    shift_known_ = true;
    header.device_time += device_shift_;

    if (Stream* stream = find(id)) {
        const FrameHeader& last = stream->last;
        if (header.sequence + stream->sequence_shift <= last.sequence) {
            const std::int64_t lost = std::max<std::int64_t>(0, header.lost_before);
            stream->sequence_shift = last.sequence + 1 + lost - header.sequence;
        }
        header.sequence += stream->sequence_shift;
        header.device_time = std::max(header.device_time, last.device_time + 1);
        header.host_time = std::max(header.host_time, last.host_time + 1);
        stream->last = header;
    } else {
        streams_.push_back({id, header, 0});
    }
    newest_.device_time =
        any_ ? std::max(newest_.device_time, header.device_time) : header.device_time;
    newest_.host_time = any_ ? std::max(newest_.host_time, header.host_time) : header.host_time;
    any_ = true;
    return header;
}

StreamFrame RisingFrames::pass(StreamId id, StreamFrame frame) {
    return std::visit(
        [&](const auto& given) -> StreamFrame {
            const FrameHeader before = header_of(*given);
            const FrameHeader after = raise(id, before);
            // Bodies have neither a sequence nor a device time to compare.
            if (id.kind == StreamKind::bodies ? before.host_time == after.host_time
                                              : same(before, after)) {
                return given;
            }
            using Frame = std::remove_cvref_t<decltype(*given)>;
            auto copy = std::make_shared<Frame>(*given);
            set_header(*copy, after);
            return std::shared_ptr<const Frame>(std::move(copy));
        },
        frame);
}

}  // namespace kino
