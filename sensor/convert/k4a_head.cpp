#include "sensor/convert/k4a_head.h"

#include <fmt/format.h>

#include <bit>
#include <string_view>
#include <utility>

#include "base/check.h"
#include "sensor/rig_json.h"

namespace kino {
namespace {

constexpr auto kTitle = static_cast<ebml::Id>(0x7BA9);
constexpr auto kTargetType = static_cast<ebml::Id>(0x63CA);
constexpr auto kTagAttachmentUid = static_cast<ebml::Id>(0x63C6);
constexpr std::uint64_t kVideoType = 1;
constexpr std::uint64_t kCalibrationUid = 0x4B0001;
constexpr std::uint64_t kRigUid = 0x4B0002;
// Whatever is not 0 and differs.
constexpr std::uint64_t kFirstTrackUid = 0x4B1000;

std::uint64_t uid_of(std::uint64_t track) {
    return kFirstTrackUid + track;
}

/// BITMAPINFOHEADER, 40 bytes, little-endian.
std::vector<std::uint8_t> bitmap_header(PixelSize size, int bits, std::string_view fourcc) {
    std::vector<std::uint8_t> out;
    const auto put = [&](std::uint32_t value, int bytes) {
        for (int i = 0; i < bytes; ++i) out.push_back(static_cast<std::uint8_t>(value >> (8 * i)));
    };
    constexpr std::uint32_t kBytes = 40;
    put(kBytes, 4);
    put(static_cast<std::uint32_t>(size.width), 4);
    put(static_cast<std::uint32_t>(size.height), 4);
    put(1, 2);
    put(static_cast<std::uint32_t>(bits), 2);
    out.insert(out.end(), fourcc.begin(), fourcc.end());
    put(static_cast<std::uint32_t>(size.width * size.height * bits / 8), 4);
    for (int i = 0; i < 4; ++i) put(0, 4);
    KINO_CHECK_EQ(out.size(), kBytes);
    return out;
}

struct TrackText {
    std::uint64_t number;
    const char* name;
    PixelSize size;
    int bits;
    std::string_view fourcc;
};

void put_track(EbmlWriter& tracks, const TrackText& text, int hz) {
    EbmlWriter video;
    video.put_unsigned(ebml::kPixelWidth, static_cast<std::uint64_t>(text.size.width));
    video.put_unsigned(ebml::kPixelHeight, static_cast<std::uint64_t>(text.size.height));
    EbmlWriter track;
    track.put_unsigned(ebml::kTrackNumber, text.number);
    track.put_unsigned(ebml::kTrackUid, uid_of(text.number));
    track.put_unsigned(ebml::kTrackType, kVideoType);
    track.put_unsigned(ebml::kFlagLacing, 0);
    track.put_text(ebml::kTrackName, text.name);
    track.put_text(ebml::kCodecId, "V_MS/VFW/FOURCC");
    track.put_binary(ebml::kCodecPrivate, bitmap_header(text.size, text.bits, text.fourcc));
    track.put_unsigned(ebml::kDefaultDuration,
                       static_cast<std::uint64_t>(kNsPerSecond) / static_cast<std::uint64_t>(hz));
    track.put_master(ebml::kVideo, video);
    tracks.put_master(ebml::kTrackEntry, track);
}

void put_tag(EbmlWriter& tags, const char* name, const std::string& value, ebml::Id target_id,
             std::uint64_t target) {
    EbmlWriter targets;
    if (target != 0) {
        targets.put_text(kTargetType, target_id == kTagAttachmentUid ? "ATTACHMENT" : "TRACK");
        targets.put_unsigned(target_id, target);
    }
    EbmlWriter simple;
    simple.put_text(ebml::kTagName, name);
    simple.put_text(ebml::kTagString, value);
    EbmlWriter tag;
    tag.put_master(ebml::kTargets, targets);
    tag.put_master(ebml::kSimpleTag, simple);
    tags.put_master(ebml::kTag, tag);
}

void put_attachment(EbmlWriter& out, const char* name, const std::string& text, std::uint64_t uid) {
    EbmlWriter file;
    file.put_text(ebml::kFileName, name);
    file.put_text(ebml::kFileMediaType, "application/octet-stream");
    file.put_binary(ebml::kFileData,
                    std::span(reinterpret_cast<const std::uint8_t*>(text.data()), text.size()));
    file.put_unsigned(ebml::kFileUid, uid);
    out.put_master(ebml::kAttachedFile, file);
}

std::string color_mode_name(const K4aColorTrack& color) {
    const K4aMode* mode = k4a_color_mode(color.size.width, color.size.height);
    return color.fourcc + "_" + (mode ? mode->name : std::to_string(color.size.height) + "P");
}

EbmlWriter tracks_of(const K4aHeadInput& input) {
    EbmlWriter tracks;
    if (input.color) {
        const int bits = input.color->fourcc == "BGRA"   ? 32
                         : input.color->fourcc == "YUY2" ? 16
                                                         : 24;
        put_track(tracks, {kK4aColorTrack, "COLOR", input.color->size, bits, input.color->fourcc},
                  input.hz);
    }
    const bool custom = input.depth_mode.empty();
    put_track(tracks,
              {kK4aDepthTrack, custom ? "KINOSCOPE_DEPTH" : "DEPTH", input.depth, 16, "b16g"},
              input.hz);
    if (input.infrared) {
        put_track(tracks,
                  {kK4aInfraredTrack, custom ? "KINOSCOPE_IR" : "IR", *input.infrared, 16, "b16g"},
                  input.hz);
    }
    return tracks;
}

EbmlWriter tags_of(const K4aHeadInput& input, bool calibrated) {
    EbmlWriter tags;
    const auto of_track = [&](const char* name, const std::string& value, std::uint64_t track) {
        put_tag(tags, name, value, ebml::kTagTrackUid, uid_of(track));
    };
    const auto global = [&](const char* name, const std::string& value) {
        put_tag(tags, name, value, ebml::kTagTrackUid, 0);
    };
    const auto uid_text = [](std::uint64_t track) { return std::to_string(uid_of(track)); };
    if (input.color) {
        of_track("K4A_COLOR_TRACK", uid_text(kK4aColorTrack), kK4aColorTrack);
        of_track("K4A_COLOR_MODE", color_mode_name(*input.color), kK4aColorTrack);
    }
    if (input.depth_mode.empty()) {
        of_track("K4A_CUSTOM_TRACK_KINOSCOPE_DEPTH", uid_text(kK4aDepthTrack), kK4aDepthTrack);
        of_track("KINOSCOPE_DEPTH_UNIT", input.depth_unit, kK4aDepthTrack);
        if (input.infrared) {
            of_track("K4A_CUSTOM_TRACK_KINOSCOPE_IR", uid_text(kK4aInfraredTrack),
                     kK4aInfraredTrack);
        }
    } else {
        of_track("K4A_DEPTH_TRACK", uid_text(kK4aDepthTrack), kK4aDepthTrack);
        of_track("K4A_DEPTH_MODE", input.depth_mode, kK4aDepthTrack);
        if (input.infrared) {
            of_track("K4A_IR_TRACK", uid_text(kK4aInfraredTrack), kK4aInfraredTrack);
            of_track("K4A_IR_MODE", "ACTIVE", kK4aInfraredTrack);
        }
    }
    global("K4A_DEPTH_DELAY_NS", "0");
    global("K4A_WIRED_SYNC_MODE", "STANDALONE");
    global("K4A_COLOR_FIRMWARE_VERSION", "0.0.0");
    global("K4A_DEPTH_FIRMWARE_VERSION", "0.0.0");
    global("K4A_DEVICE_SERIAL_NUMBER", input.rig.serial);
    if (calibrated) {
        put_tag(tags, "K4A_CALIBRATION_FILE", "calibration.json", kTagAttachmentUid,
                kCalibrationUid);
    }
    global("K4A_START_OFFSET_NS", std::to_string(input.start_offset));
    return tags;
}

std::vector<std::uint8_t> big_endian_8(std::uint64_t value) {
    EbmlWriter out;
    out.put_big_endian(value, 8);
    return out.take();
}

}  // namespace

Result<K4aHeadPlaces> write_k4a_head(EbmlWriter& out, const K4aHeadInput& input) {
    KINO_TRY(validate(input.rig));
    EbmlWriter ebml;
    ebml.put_unsigned(ebml::kEbmlVersion, 1);
    ebml.put_unsigned(ebml::kEbmlReadVersion, 1);
    ebml.put_unsigned(ebml::kEbmlMaxIdLength, 4);
    ebml.put_unsigned(ebml::kEbmlMaxSizeLength, 8);
    ebml.put_text(ebml::kDocType, "matroska");
    ebml.put_unsigned(ebml::kDocTypeVersion, 2);
    ebml.put_unsigned(ebml::kDocTypeReadVersion, 2);
    out.put_master(ebml::kEbml, ebml);

    K4aHeadPlaces places;
    constexpr std::uint64_t kSegmentId = ebml::kSegment;
    out.put_big_endian(kSegmentId, 4);
    places.segment_size = out.size();
    constexpr std::uint64_t kUnknownSize = 0x01FFFFFFFFFFFFFF;
    out.put_big_endian(kUnknownSize, 8);
    places.segment_content = out.size();
    places.seek_head = out.size();
    out.put_void(kK4aSeekHeadBytes);

    EbmlWriter info;
    info.put_unsigned(ebml::kTimestampScale, 1000);
    info.put_text(kTitle, "Azure Kinect");
    info.put_text(ebml::kMuxingApp, "kinoscope");
    info.put_text(ebml::kWritingApp, "kinoscope");
    info.put_float(ebml::kDuration, 0);
    places.info = out.size();
    out.put_master(ebml::kInfo, info);
    places.duration = out.size() - 8;

    places.tracks = out.size();
    out.put_master(ebml::kTracks, tracks_of(input));

    EbmlWriter attachments;
    RigParameters rig = input.rig;
    if (!input.color) rig.color.reset();
    const auto calibration = rig_to_k4a(rig);
    if (calibration) {
        put_attachment(attachments, "calibration.json", *calibration, kCalibrationUid);
    }
    put_attachment(attachments, "kinoscope_rig.json", rig_to_json(rig), kRigUid);
    places.attachments = out.size();
    out.put_master(ebml::kAttachments, attachments);
    places.tags = out.size();
    out.put_master(ebml::kTags, tags_of(input, calibration.has_value()));
    return places;
}

void write_k4a_cues(EbmlWriter& out, const std::vector<K4aCuePoint>& points) {
    EbmlWriter cues;
    for (const K4aCuePoint& point : points) {
        EbmlWriter positions;
        positions.put_unsigned(ebml::kCueTrack, point.track);
        positions.put_unsigned(ebml::kCueClusterPosition, point.position);
        EbmlWriter entry;
        entry.put_unsigned(ebml::kCueTime, point.time);
        entry.put_master(ebml::kCueTrackPositions, positions);
        cues.put_master(ebml::kCuePoint, entry);
    }
    out.put_master(ebml::kCues, cues);
}

std::vector<K4aPatch> k4a_patches(const K4aHeadPlaces& places, std::uint64_t cues,
                                  std::uint64_t file_size, double duration) {
    EbmlWriter seeks;
    for (const auto& [id, position] :
         {std::pair(ebml::kInfo, places.info), std::pair(ebml::kTracks, places.tracks),
          std::pair(ebml::kAttachments, places.attachments), std::pair(ebml::kTags, places.tags),
          std::pair(ebml::kCues, cues)}) {
        EbmlWriter id_bytes;
        id_bytes.put_big_endian(id, 4);
        EbmlWriter seek;
        seek.put_binary(ebml::kSeekId, id_bytes.bytes());
        seek.put_unsigned(ebml::kSeekPosition, position - places.segment_content);
        seeks.put_master(ebml::kSeek, seek);
    }
    EbmlWriter seek_head;
    seek_head.put_master(ebml::kSeekHead, seeks);
    seek_head.put_void(kK4aSeekHeadBytes - seek_head.size());
    // An 8-byte size keeps its marker bit in the first byte.
    constexpr std::uint64_t kMarker = std::uint64_t{1} << 56;
    return {{places.segment_size, big_endian_8(kMarker | (file_size - places.segment_content))},
            {places.seek_head, seek_head.take()},
            {places.duration, big_endian_8(std::bit_cast<std::uint64_t>(duration))}};
}

}  // namespace kino
