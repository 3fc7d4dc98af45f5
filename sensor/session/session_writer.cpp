#include "sensor/session/session_writer.h"

#include <algorithm>
#include <type_traits>
#include <utility>

#include "base/check.h"

namespace kino {
namespace {

constexpr TimeNs kStartWait = 400 * kNsPerMs;
constexpr TimeNs kClusterWait = 500 * kNsPerMs;
constexpr TimeNs kSyncEvery = kNsPerSecond;
constexpr std::size_t kMaxWaiting = 256;
constexpr std::size_t kMaxWaitingBytes = std::size_t{64} << 20;
constexpr std::size_t kMaxCoders = 16;
constexpr std::int64_t kTextTicks = 30 * kNsPerMs / kNsPerTick;
constexpr std::int64_t kTicksPerSecond = kNsPerSecond / kNsPerTick;

std::span<const std::uint8_t> bytes_of(const Image<std::uint16_t>& image) {
    return {reinterpret_cast<const std::uint8_t*>(image.data()), image.size() * 2};
}

std::span<const std::uint8_t> bytes_of(const std::string& text) {
    return {reinterpret_cast<const std::uint8_t*>(text.data()), text.size()};
}

TimeNs host_time_of(const StreamFrame& frame) {
    return std::visit(
        [](const auto& pointer) {
            if constexpr (std::is_same_v<decltype(pointer),
                                         const std::shared_ptr<const BodyFrame>&>) {
                return pointer->time;
            } else {
                return pointer->header.host_time;
            }
        },
        frame);
}

std::int64_t sequence_of(const StreamFrame& frame) {
    return std::visit(
        [](const auto& pointer) -> std::int64_t {
            if constexpr (std::is_same_v<decltype(pointer),
                                         const std::shared_ptr<const BodyFrame>&>) {
                return 0;
            } else {
                return pointer->header.sequence;
            }
        },
        frame);
}

bool is_picture(StreamKind kind) {
    return kind == StreamKind::depth || kind == StreamKind::color || kind == StreamKind::infrared;
}

}  // namespace

SessionWriter::SessionWriter(std::unique_ptr<RecordingFile> file, SourceInfo source,
                             RigParameters rig, RecorderOptions options, std::int64_t date_ns)
    : file_(std::move(file)),
      source_(std::move(source)),
      rig_(std::move(rig)),
      options_(std::move(options)) {
    head_.date_ns = date_ns;
}

std::int64_t SessionWriter::tick_of(TimeNs host_time) const {
    if (host_time <= origin_) return 0;
    constexpr std::uint64_t kMost = std::uint64_t{1} << 61;
    const auto since = std::min(
        kMost, static_cast<std::uint64_t>(host_time) - static_cast<std::uint64_t>(origin_));
    return static_cast<std::int64_t>(since / static_cast<std::uint64_t>(kNsPerTick));
}

TimeNs SessionWriter::duration() const {
    const auto span =
        static_cast<std::uint64_t>(last_time_) - static_cast<std::uint64_t>(first_time_);
    return static_cast<TimeNs>(std::min(span, static_cast<std::uint64_t>(kMaxSessionTime)));
}

bool SessionWriter::all_seen() const {
    const auto seen = [&](StreamId id) {
        return std::any_of(waiting_.begin(), waiting_.end(),
                           [&](const Waiting& frame) { return frame.id == id; });
    };
    if (!options_.streams.empty()) {
        return std::all_of(options_.streams.begin(), options_.streams.end(),
                           [&](StreamId id) { return !is_picture(id.kind) || seen(id); });
    }
    return std::all_of(
        source_.streams.begin(), source_.streams.end(),
        [&](const StreamInfo& stream) { return !is_picture(stream.id.kind) || seen(stream.id); });
}

Result<void> SessionWriter::put(StreamId id, const StreamFrame& frame, std::size_t bytes,
                                TimeNs now) {
    const TimeNs time = host_time_of(frame);
    first_time_ = any_time_ ? std::min(first_time_, time) : time;
    last_time_ = any_time_ ? std::max(last_time_, time) : time;
    any_time_ = true;
    if (started_) return write_frame({id, frame}, now);
    waiting_.push_back({id, frame});
    if (!waiting_since_) waiting_since_ = now;
    waiting_bytes_ += bytes;
    if (all_seen() || waiting_.size() >= kMaxWaiting || waiting_bytes_ >= kMaxWaitingBytes) {
        return start(now);
    }
    return tick(now);
}

Result<void> SessionWriter::put_event(const SessionEvent& event, TimeNs now) {
    if (started_) return write_text(TrackRole::events, 0, event.time, event_to_text(event), now);
    if (!waiting_since_) waiting_since_ = now;
    waiting_events_.push_back(event);
    if (waiting_events_.size() >= kMaxWaiting) return start(now);
    return tick(now);
}

Result<void> SessionWriter::put_pose(const SessionPose& pose, TimeNs now) {
    if (started_) return write_text(TrackRole::poses, 0, pose.time, pose_to_text(pose), now);
    if (!waiting_since_) waiting_since_ = now;
    waiting_poses_.push_back(pose);
    if (waiting_poses_.size() >= kMaxWaiting) return start(now);
    return tick(now);
}

std::optional<TimeNs> SessionWriter::due() const {
    if (!started_) {
        if (!waiting_since_) return std::nullopt;
        return *waiting_since_ + kStartWait;
    }
    std::optional<TimeNs> first;
    if (!cluster_.empty()) first = cluster_since_ + kClusterWait;
    if (!synced_)
        first = std::min(first.value_or(synced_at_ + kSyncEvery), synced_at_ + kSyncEvery);
    return first;
}

Result<void> SessionWriter::tick(TimeNs now) {
    if (!started_) {
        if (waiting_since_ && now - *waiting_since_ >= kStartWait) return start(now);
        return {};
    }
    if (!cluster_.empty() && now - cluster_since_ >= kClusterWait) KINO_TRY(flush(now));
    if (!synced_ && now - synced_at_ >= kSyncEvery) KINO_TRY(sync(now));
    return {};
}

Result<void> SessionWriter::start(TimeNs now) {
    started_ = true;
    origin_ = any_time_ ? std::clamp(first_time_, 1 - kMaxSessionTime, kMaxSessionTime - 1) : 0;
    if (!any_time_ && !waiting_events_.empty()) origin_ = waiting_events_.front().time;
    int number = 0;
    std::vector<int> devices = {0};
    for (const Waiting& frame : waiting_) {
        if (std::find(devices.begin(), devices.end(), frame.id.device) == devices.end()) {
            devices.push_back(frame.id.device);
        }
        if (!is_picture(frame.id.kind) || number >= kMaxTracks / 4) continue;
        const auto picture = picture_of(frame.id, frame.frame);
        if (!picture) continue;
        const auto coder = coder_of(picture->format);
        if (!coder || (*coder)->track != 0) continue;
        SessionTrack track;
        track.number = (*coder)->track = ++number;
        track.format = (*coder)->format;
        if ((*coder)->encoder) {
            const auto extra = (*coder)->encoder->private_data();
            track.private_data.assign(extra.begin(), extra.end());
        }
        for (const StreamInfo& stream : source_.streams) {
            if (stream.id == frame.id) track.nominal_hz = stream.nominal_hz;
        }
        tracks_.push_back(std::move(track));
    }
    for (std::size_t i = 0; i < std::min<std::size_t>(devices.size(), kMaxTracks / 4); ++i) {
        tracks_.push_back({.number = ++number, .role = TrackRole::motion, .device = devices[i]});
        tracks_.push_back({.number = ++number, .role = TrackRole::bodies, .device = devices[i]});
    }
    tracks_.push_back({.number = ++number, .role = TrackRole::poses});
    tracks_.push_back({.number = ++number, .role = TrackRole::events});
    tracks_.push_back({.number = ++number, .role = TrackRole::frames});

    const auto bytes = session_start(head_, source_, rig_, tracks_, origin_);
    const auto written = file_->append(bytes);
    if (!written) {
        failed_ = true;
        return tl::unexpected<Error>(written.error());
    }
    good_size_ = file_->size();
    synced_ = false;
    KINO_TRY(sync(now));
    for (const SessionEvent& event : std::exchange(waiting_events_, {})) {
        KINO_TRY(put_event(event, now));
    }
    for (const SessionPose& pose : std::exchange(waiting_poses_, {})) {
        KINO_TRY(put_pose(pose, now));
    }
    for (const Waiting& frame : std::exchange(waiting_, {})) KINO_TRY(write_frame(frame, now));
    return {};
}

Result<SessionWriter::Picture> SessionWriter::picture_of(StreamId id, const StreamFrame& frame) {
    Picture picture;
    if (const auto* depth = std::get_if<std::shared_ptr<const DepthFrame>>(&frame)) {
        picture = {format_of(id.device, **depth, options_.codec), &(*depth)->header,
                   &(*depth)->damaged_rows, bytes_of((*depth)->raw)};
    } else if (const auto* infrared = std::get_if<std::shared_ptr<const InfraredFrame>>(&frame)) {
        picture = {format_of(id.device, **infrared, options_.codec), &(*infrared)->header,
                   &(*infrared)->damaged_rows, bytes_of((*infrared)->raw)};
    } else {
        const auto& color = std::get<std::shared_ptr<const ColorFrame>>(frame);
        picture = {
            format_of(id.device, *color, options_.codec), &color->header, &color->damaged_rows, {}};
        KINO_ASSIGN(picture.pixels, packed_pixels(*color, packed_));
    }
    return picture;
}

Result<SessionWriter::Coder*> SessionWriter::coder_of(const StreamFormat& wanted) {
    for (Coder& coder : coders_) {
        if (coder.wanted == wanted) return &coder;
    }
    Coder coder{wanted, wanted, nullptr, 0};
    if (!wanted.jpeg) {
        auto encoder = make_image_encoder(wanted.image);
        if (!encoder) {
            coder.format.image.codec = ImageCodec::raw;
            encoder = make_image_encoder(coder.format.image);
        }
        if (!encoder) return tl::unexpected<Error>(std::move(encoder).error());
        coder.encoder = *std::move(encoder);
    }
    // Encoders are large; of formats that only pass through, the oldest goes.
    if (coders_.size() >= kMaxCoders) {
        const auto oldest = std::find_if(coders_.begin(), coders_.end(),
                                         [](const Coder& other) { return other.track == 0; });
        if (oldest != coders_.end()) coders_.erase(oldest);
    }
    coders_.push_back(std::move(coder));
    return &coders_.back();
}

Result<void> SessionWriter::write_frame(const Waiting& frame, TimeNs now) {
    if (is_picture(frame.id.kind)) return write_picture(frame, now);
    if (const auto* motion = std::get_if<std::shared_ptr<const MotionFrame>>(&frame.frame)) {
        return write_text(TrackRole::motion, frame.id.device, (*motion)->header.host_time,
                          motion_to_text(**motion), now);
    }
    const auto& bodies = *std::get<std::shared_ptr<const BodyFrame>>(frame.frame);
    return write_text(TrackRole::bodies, frame.id.device, bodies.time, bodies_to_text(bodies), now);
}

Result<void> SessionWriter::write_picture(const Waiting& frame, TimeNs now) {
    const auto picture = picture_of(frame.id, frame.frame);
    if (!picture) return refuse(frame, picture.error().what, now);
    const auto coder = coder_of(picture->format);
    if (!coder) return refuse(frame, coder.error().what, now);
    const auto in_range = [](TimeNs time) {
        return time > -kMaxSessionTime && time < kMaxSessionTime;
    };
    if (!in_range(picture->header->host_time) || !in_range(picture->header->device_time)) {
        return refuse(frame, "its time is more than 146 years from 0", now);
    }
    FrameNote note{*picture->header, *picture->damaged_rows, std::nullopt};
    std::span<const std::uint8_t> data = picture->pixels;
    if ((*coder)->encoder) {
        const auto coded = (*coder)->encoder->encode(picture->pixels);
        if (!coded) return refuse(frame, coded.error().what, now);
        data = *coded;
    }
    int track = (*coder)->track;
    if (track == 0) {
        track = tracks_.back().number;
        note.own_format.emplace().format = (*coder)->format;
        if ((*coder)->encoder) {
            const auto extra = (*coder)->encoder->private_data();
            note.own_format->private_data.assign(extra.begin(), extra.end());
        }
    }
    const auto note_bytes = write_frame_note(note);
    if (!note_bytes) return refuse(frame, note_bytes.error().what, now);
    return add(
        {.track = track, .tick = tick_of(note.header.host_time), .data = data, .note = *note_bytes},
        true, now);
}

Result<void> SessionWriter::write_text(TrackRole role, int device, TimeNs time,
                                       const std::string& text, TimeNs now) {
    const auto track =
        std::find_if(tracks_.begin(), tracks_.end(), [&](const SessionTrack& candidate) {
            return candidate.role == role && candidate.device == device;
        });
    if (track == tracks_.end()) {
        const StreamKind kind = role == TrackRole::motion ? StreamKind::motion : StreamKind::bodies;
        ++refused_;
        return put_event({.kind = "refused",
                          .time = time,
                          .text = "the device came after the file was begun: " + text,
                          .stream = StreamId{device, kind},
                          .count = 1},
                         now);
    }
    return add({.track = track->number,
                .tick = tick_of(time),
                .data = bytes_of(text),
                .duration_ticks = kTextTicks},
               role == TrackRole::motion || role == TrackRole::bodies, now);
}

Result<void> SessionWriter::refuse(const Waiting& frame, const std::string& why, TimeNs now) {
    ++refused_;
    return put_event({.kind = "refused",
                      .time = host_time_of(frame.frame),
                      .text = why,
                      .stream = frame.id,
                      .count = 1,
                      .first_sequence = sequence_of(frame.frame),
                      .last_sequence = sequence_of(frame.frame)},
                     now);
}

Result<void> SessionWriter::add(const ClusterBlock& block, bool is_frame, TimeNs now) {
    if (!cluster_.fits(block)) KINO_TRY(flush(now));
    if (cluster_.empty()) cluster_since_ = now;
    cluster_.add(block);
    if (is_frame) ++cluster_frames_;
    const bool leads =
        block.track == tracks_.front().number && tracks_.front().role == TrackRole::picture;
    if (leads && !cluster_cue_) cluster_cue_ = {block.tick, block.track, 0};
    return tick(now);
}

Result<void> SessionWriter::flush(TimeNs now) {
    if (cluster_.empty()) return {};
    const auto written = file_->append(cluster_.finish());
    const std::int64_t tick = cluster_.first_tick();
    cluster_.clear();
    const std::int64_t frames = std::exchange(cluster_frames_, 0);
    const auto cue = std::exchange(cluster_cue_, std::nullopt);
    if (!written) {
        failed_ = true;
        return tl::unexpected<Error>(written.error());
    }
    if (cue) cues_.push_back({cue->tick, cue->track, good_size_});
    frames_written_ += frames;
    good_size_ = file_->size();
    synced_ = false;
    if (now - synced_at_ >= kSyncEvery || tick - synced_tick_ >= kTicksPerSecond) {
        synced_tick_ = tick;
        return sync(now);
    }
    return {};
}

Result<void> SessionWriter::sync(TimeNs now) {
    synced_at_ = now;
    synced_ = true;
    auto done = file_->sync();
    if (!done) failed_ = true;
    return done;
}

Result<void> SessionWriter::finish(TimeNs now) {
    if (!failed_ && !started_) {
        auto begun = start(now);
        if (!begun) return begun;
    }
    Result<void> flushed;
    if (!failed_) flushed = flush(now);
    // What follows an error can only be tried: the space of a torn cluster may hold the index.
    if (failed_ && file_->size() > good_size_ && !file_->truncate(good_size_)) return flushed;
    if (good_size_ == 0) return flushed;
    auto closed = close_file();
    return flushed ? closed : flushed;
}

Result<void> SessionWriter::close_file() {
    const std::uint64_t index_at = file_->size();
    head_.duration = tick_of(last_time_) * kNsPerTick;
    Result<void> indexed;
    if (!cues_.empty()) {
        indexed = file_->append(session_cues(cues_));
        if (indexed) {
            head_.places.cues = index_at;
        } else if (!file_->truncate(index_at)) {
            return indexed;
        }
    }
    // The head may name only what is on the disk for good.
    KINO_TRY(file_->sync());
    head_.file_size = file_->size();
    KINO_TRY(file_->overwrite(0, first_sector(head_)));
    KINO_TRY(file_->sync());
    return indexed;
}

}  // namespace kino
