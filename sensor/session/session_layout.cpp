#include "sensor/session/session_layout.h"

#include <fmt/format.h>

#include "base/check.h"
#include "sensor/rig_json.h"
#include "sensor/session/ebml_writer.h"
#include "sensor/session/frame_note.h"
#include "sensor/session/session_text.h"

namespace kino {
namespace {

using namespace ebml;

constexpr std::size_t kSegmentHead = 12;
constexpr std::size_t kDurationSize = 11;
constexpr std::uint64_t kUnknownSize = 0x01FFFFFFFFFFFFFF;

EbmlWriter ebml_head() {
    EbmlWriter head;
    head.put_unsigned(kEbmlVersion, 1);
    head.put_unsigned(kEbmlReadVersion, 1);
    head.put_unsigned(kEbmlMaxIdLength, 4);
    head.put_unsigned(kEbmlMaxSizeLength, 8);
    head.put_text(kDocType, "matroska");
    head.put_unsigned(kDocTypeVersion, 4);
    head.put_unsigned(kDocTypeReadVersion, 2);
    EbmlWriter all;
    all.put_master(kEbml, head);
    return all;
}

std::size_t content_start() {
    return ebml_head().size() + kSegmentHead;
}

EbmlWriter info_element(const SessionHead& head) {
    EbmlWriter info;
    info.put_unsigned(kTimestampScale, kNsPerTick);
    if (head.duration) {
        info.put_float(kDuration, static_cast<double>(*head.duration) / kNsPerTick);
    } else {
        info.put_void(kDurationSize);
    }
    info.put_signed(kDateUtc, head.date_ns);
    info.put_text(kMuxingApp, "kinoscope");
    info.put_text(kWritingApp, "kinoscope session 1");
    EbmlWriter element;
    element.put_master(kInfo, info);
    return element;
}

void put_seek(EbmlWriter& seek_head, Id id, std::uint64_t offset) {
    EbmlWriter id_bytes;
    id_bytes.put_big_endian(id, 4);
    EbmlWriter seek;
    seek.put_binary(kSeekId, id_bytes.bytes());
    seek.put_unsigned(kSeekPosition, offset - content_start());
    seek_head.put_master(kSeek, seek);
}

void put_tag(EbmlWriter& tag, const char* name, std::string_view text) {
    EbmlWriter simple;
    simple.put_text(kTagName, name);
    simple.put_text(kTagString, text);
    tag.put_master(kSimpleTag, simple);
}

const char* name_of(const SessionTrack& track) {
    switch (track.role) {
        case TrackRole::picture:
            return track_name(track.format.id.kind);
        case TrackRole::motion:
            return "motion";
        case TrackRole::bodies:
            return "bodies";
        case TrackRole::poses:
            return "poses";
        case TrackRole::events:
            return "events";
        case TrackRole::frames:
            break;
    }
    return "frames";
}

void put_video(EbmlWriter& entry, const SessionTrack& track) {
    EbmlWriter video;
    video.put_unsigned(kFlagInterlaced, 2);
    video.put_unsigned(kPixelWidth, static_cast<std::uint64_t>(track.format.image.width));
    video.put_unsigned(kPixelHeight, static_cast<std::uint64_t>(track.format.image.height));
    if (codec_id_of(track.format) == "V_UNCOMPRESSED") {
        video.put_text(kColourSpace, fourcc_of(track.format));
    }
    entry.put_master(kVideo, video);
}

void put_track(EbmlWriter& tracks, const SessionTrack& track) {
    KINO_CHECK(track.number > 0 && track.number <= kMaxTracks);
    constexpr std::uint64_t kVideoTrack = 1;
    constexpr std::uint64_t kSubtitleTrack = 17;
    const bool picture = track.role == TrackRole::picture;
    const bool noted = picture || track.role == TrackRole::frames;
    EbmlWriter entry;
    entry.put_unsigned(kTrackNumber, static_cast<std::uint64_t>(track.number));
    entry.put_unsigned(kTrackUid, static_cast<std::uint64_t>(track.number));
    entry.put_unsigned(kTrackType, picture ? kVideoTrack : kSubtitleTrack);
    entry.put_unsigned(kFlagDefault, 0);
    entry.put_unsigned(kFlagLacing, 0);
    entry.put_text(kLanguage, "und");
    entry.put_text(kTrackName, name_of(track));
    if (picture && track.nominal_hz > 0) {
        entry.put_unsigned(kDefaultDuration,
                           static_cast<std::uint64_t>(1e9 / track.nominal_hz + 0.5));
    }
    if (noted) {
        entry.put_unsigned(kMaxBlockAdditionId, kFrameNoteId);
        EbmlWriter mapping;
        mapping.put_unsigned(kBlockAddIdValue, kFrameNoteId);
        mapping.put_text(kBlockAddIdName, "kinoscope frame note");
        mapping.put_unsigned(kBlockAddIdType, 1);  // opaque data
        entry.put_master(kBlockAdditionMapping, mapping);
    }
    if (picture) {
        entry.put_text(kCodecId, codec_id_of(track.format));
        if (!track.private_data.empty()) entry.put_binary(kCodecPrivate, track.private_data);
        put_video(entry, track);
    } else {
        entry.put_text(kCodecId, noted ? kOwnFormatCodec : "S_TEXT/UTF8");
    }
    tracks.put_master(kTrackEntry, entry);
}

void put_attachment(EbmlWriter& files, const char* name, const char* description, std::uint64_t uid,
                    std::string_view text) {
    EbmlWriter file;
    file.put_text(kFileDescription, description);
    file.put_text(kFileName, name);
    file.put_text(kFileMediaType, "application/json");
    file.put_text(kFileData, text);
    file.put_unsigned(kFileUid, uid);
    files.put_master(kAttachedFile, file);
}

EbmlWriter tags_content(const SourceInfo& source, std::span<const SessionTrack> tracks,
                        TimeNs origin) {
    EbmlWriter tags;
    EbmlWriter global;
    EbmlWriter targets;
    targets.put_unsigned(kTargetTypeValue, 50);
    global.put_master(kTargets, targets);
    put_tag(global, kProfileTag, kProfileVersion);
    put_tag(global, kOriginTag, fmt::format("{}", origin));
    if (!source.name.empty()) put_tag(global, "TITLE", source.name);
    tags.put_master(kTag, global);
    for (const SessionTrack& track : tracks) {
        EbmlWriter tag;
        EbmlWriter target;
        target.put_unsigned(kTargetTypeValue, 30);
        target.put_unsigned(kTagTrackUid, static_cast<std::uint64_t>(track.number));
        tag.put_master(kTargets, target);
        put_tag(tag, kFormatTag, track_tag(track));
        if (track.role == TrackRole::picture && track.format.id.kind == StreamKind::color &&
            track.format.pixel_format == PixelFormat::bayer_grbg8) {
            put_tag(tag, "BAYER", "GRBG");
        }
        tags.put_master(kTag, tag);
    }
    return tags;
}

}  // namespace

std::uint64_t segment_content_start() {
    return content_start();
}

std::size_t info_start() {
    return kFirstSector - info_element({}).size();
}

std::string track_tag(const SessionTrack& track) {
    if (track.role == TrackRole::picture) return format_to_json(track.format);
    return fmt::format(R"({{"stream":"{}","device":{}}})", name_of(track), track.device);
}

std::vector<std::uint8_t> first_sector(const SessionHead& head) {
    EbmlWriter out = ebml_head();
    out.put_big_endian(kSegment, 4);
    out.put_big_endian(head.file_size ? (*head.file_size - content_start()) | std::uint64_t{1} << 56
                                      : kUnknownSize,
                       8);
    EbmlWriter seeks;
    const EbmlWriter info = info_element(head);
    put_seek(seeks, kInfo, kFirstSector - info.size());
    put_seek(seeks, kTracks, head.places.tracks);
    put_seek(seeks, kAttachments, head.places.attachments);
    put_seek(seeks, kTags, head.places.tags);
    if (head.places.cues) put_seek(seeks, kCues, *head.places.cues);
    out.put_master(kSeekHead, seeks);
    KINO_CHECK_LE(out.size() + info.size() + 2, kFirstSector);
    out.put_void(kFirstSector - out.size() - info.size());
    out.put_raw(info.bytes());
    return out.take();
}

std::vector<std::uint8_t> session_start(SessionHead& head, const SourceInfo& source,
                                        const RigParameters& rig,
                                        std::span<const SessionTrack> tracks, TimeNs origin) {
    EbmlWriter after;
    EbmlWriter entries;
    for (const SessionTrack& track : tracks) put_track(entries, track);
    head.places.tracks = kFirstSector;
    after.put_checked_master(kTracks, entries);
    EbmlWriter files;
    put_attachment(files, kCalibrationFile, "how the cameras stand to each other", 1,
                   rig_to_json(rig));
    put_attachment(files, kSourceFile, "what was recorded", 2, source_to_text(source));
    head.places.attachments = kFirstSector + after.size();
    after.put_checked_master(kAttachments, files);
    head.places.tags = kFirstSector + after.size();
    after.put_checked_master(kTags, tags_content(source, tracks, origin));
    std::vector<std::uint8_t> start = first_sector(head);
    start.insert(start.end(), after.bytes().begin(), after.bytes().end());
    return start;
}

std::vector<std::uint8_t> session_cues(std::span<const SessionCue> cues) {
    EbmlWriter points;
    for (const SessionCue& cue : cues) {
        EbmlWriter positions;
        positions.put_unsigned(kCueTrack, static_cast<std::uint64_t>(cue.track));
        positions.put_unsigned(kCueClusterPosition, cue.cluster - content_start());
        EbmlWriter point;
        point.put_unsigned(kCueTime, static_cast<std::uint64_t>(cue.tick));
        point.put_master(kCueTrackPositions, positions);
        points.put_master(kCuePoint, point);
    }
    EbmlWriter out;
    out.put_checked_master(kCues, points);
    return out.take();
}

}  // namespace kino
