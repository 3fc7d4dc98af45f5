#include "sensor/session/session_meta.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <utility>

#include "sensor/json_cursor.h"
#include "sensor/session/ebml_reader.h"

namespace kino {
namespace {

using namespace ebml;

Result<SessionTrack> track_of(const std::string& text, const std::string& where) {
    KINO_ASSIGN(const nlohmann::json value, parse_json(text, where));
    const JsonCursor object(value, where);
    KINO_ASSIGN(const JsonCursor stream, object.member("stream"));
    KINO_ASSIGN(const std::string name, stream.text());
    SessionTrack track;
    constexpr std::array<std::pair<const char*, TrackRole>, 5> kRoles = {
        {{"motion", TrackRole::motion},
         {"bodies", TrackRole::bodies},
         {"poses", TrackRole::poses},
         {"events", TrackRole::events},
         {"frames", TrackRole::frames}}};
    for (const auto& [role_name, role] : kRoles) {
        if (name != role_name) continue;
        track.role = role;
        if (const auto device = object.find("device")) {
            KINO_ASSIGN(const std::int64_t number, device->integer(0, 1000));
            track.device = static_cast<int>(number);
        }
        return track;
    }
    KINO_ASSIGN(track.format, format_from_json(text, where));
    track.device = track.format.id.device;
    return track;
}

}  // namespace

void SessionMeta::add_info(std::span<const std::uint8_t> content) {
    EbmlWalk walk(content);
    while (const auto child = walk.next()) {
        if (child->id != kTimestampScale) continue;
        const auto scale = child->number();
        if (scale && *scale >= 1 && *scale <= 1'000'000'000) {
            ns_per_tick_ = static_cast<std::int64_t>(*scale);
        }
    }
}

void SessionMeta::add_tracks(std::span<const std::uint8_t> content) {
    EbmlWalk walk(content);
    while (const auto child = walk.next()) {
        if (child->id == kTrackEntry && raw_.size() < kMaxTracks) add_track(child->content);
    }
}

void SessionMeta::add_track(std::span<const std::uint8_t> content) {
    RawTrack track;
    EbmlWalk walk(content);
    while (const auto child = walk.next()) {
        switch (child->id) {
            case kTrackNumber:
                track.number = child->number().value_or(0);
                break;
            case kTrackUid:
                track.uid = child->number().value_or(0);
                break;
            case kDefaultDuration:
                track.default_duration = child->number().value_or(0);
                break;
            case kCodecId:
                track.codec = child->text();
                break;
            case kCodecPrivate:
                track.private_data.assign(child->content.begin(), child->content.end());
                break;
            case kContentEncodings:
                track.encoded = true;
                break;
            default:
                break;
        }
    }
    raw_.push_back(std::move(track));
}

void SessionMeta::add_attachments(std::span<const std::uint8_t> content) {
    EbmlWalk walk(content);
    while (const auto file = walk.next()) {
        if (file->id != kAttachedFile) continue;
        std::string name;
        std::optional<std::string> data;
        EbmlWalk parts(file->content);
        while (const auto part = parts.next()) {
            if (part->id == kFileName) name = part->text();
            if (part->id == kFileData) data.emplace(part->content.begin(), part->content.end());
        }
        if (name == kCalibrationFile && !calibration_) calibration_ = std::move(data);
        if (name == kSourceFile && !source_) source_ = std::move(data);
    }
}

void SessionMeta::add_tags(std::span<const std::uint8_t> content) {
    EbmlWalk walk(content);
    while (const auto child = walk.next()) {
        if (child->id == kTag) add_tag(child->content);
    }
}

void SessionMeta::add_tag(std::span<const std::uint8_t> content) {
    std::uint64_t uid = 0;
    std::vector<std::pair<std::string, std::string>> texts;
    EbmlWalk walk(content);
    while (const auto child = walk.next()) {
        if (child->id == kTargets) {
            EbmlWalk targets(child->content);
            while (const auto target = targets.next()) {
                if (target->id == kTagTrackUid) uid = target->number().value_or(0);
            }
        } else if (child->id == kSimpleTag) {
            std::pair<std::string, std::string> text;
            EbmlWalk parts(child->content);
            while (const auto part = parts.next()) {
                if (part->id == kTagName) text.first = part->text();
                if (part->id == kTagString) text.second = part->text();
            }
            texts.push_back(std::move(text));
        }
    }
    for (const auto& [name, text] : texts) {
        if (name == kProfileTag && text == kProfileVersion) is_session_ = true;
        if (name == kFormatTag && texts_.size() < kMaxTracks) texts_.push_back({uid, text});
        if (name == kOriginTag) {
            std::int64_t origin = 0;
            const auto read = std::from_chars(text.data(), text.data() + text.size(), origin);
            constexpr std::int64_t kMost = std::int64_t{1} << 62;
            if (read.ec == std::errc() && origin > -kMost && origin < kMost) origin_ = origin;
        }
    }
}

std::vector<SessionTrack> SessionMeta::tracks(std::vector<std::string>& findings) const {
    std::vector<SessionTrack> tracks;
    for (const RawTrack& raw : raw_) {
        const std::string where = fmt::format("track {}", raw.number);
        const auto text = std::find_if(texts_.begin(), texts_.end(), [&](const TrackText& other) {
            return other.uid == raw.uid;
        });
        if (text == texts_.end() || raw.number < 1 || raw.number > kMaxTracks || raw.encoded) {
            findings.push_back(where + " is not one of ours and was left out");
            continue;
        }
        auto track = track_of(text->format, where);
        if (!track) {
            findings.push_back(track.error().to_string() + "; the track was left out");
            continue;
        }
        const bool double_number =
            std::any_of(tracks.begin(), tracks.end(), [&](const SessionTrack& other) {
                return other.number == static_cast<int>(raw.number);
            });
        if (double_number) continue;
        track->number = static_cast<int>(raw.number);
        track->private_data = raw.private_data;
        if (raw.default_duration > 0) {
            track->nominal_hz = 1e9 / static_cast<double>(raw.default_duration);
        }
        tracks.push_back(*std::move(track));
    }
    return tracks;
}

}  // namespace kino
