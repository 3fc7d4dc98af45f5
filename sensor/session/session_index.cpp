#include "sensor/session/session_index.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <utility>

#include "sensor/rig_json.h"
#include "sensor/session/crc32.h"
#include "sensor/session/ebml_reader.h"
#include "sensor/session/frame_note.h"
#include "sensor/session/session_meta.h"
#include "sensor/session/session_text.h"

namespace kino {
namespace {

using namespace ebml;

constexpr std::size_t kMaxEntries = 10'000'000;
constexpr std::uint64_t kMaxMeta = std::uint64_t{16} << 20;
constexpr std::uint64_t kCheapSize = std::uint64_t{512} << 20;
constexpr std::int64_t kMaxTime = kMaxSessionTime;
// With the origin and a block's own 16 bits it stays below 2^63.
constexpr std::int64_t kMaxTicksTime = kMaxTime - (std::int64_t{1} << 50);

bool is_top_level(std::uint32_t id) {
    constexpr std::uint32_t kChapters = 0x1043A770;
    constexpr std::array<std::uint32_t, 10> kIds = {
        kSeekHead, kInfo, kTracks, kAttachments, kTags, kCluster, kCues, kVoid, kCrc32, kChapters};
    return std::find(kIds.begin(), kIds.end(), id) != kIds.end();
}

std::optional<std::vector<std::uint8_t>> content_of(const ByteSource& bytes,
                                                    const EbmlPlace& place) {
    if (place.end - place.content > kMaxMeta) return std::nullopt;
    std::vector<std::uint8_t> content(static_cast<std::size_t>(place.end - place.content));
    if (!bytes.read(place.content, content)) return std::nullopt;
    return content;
}

std::uint64_t number_at(ByteWindow& window, const EbmlPlace& place) {
    std::uint64_t value = 0;
    if (place.end - place.content > 8) return 0;
    for (const std::uint8_t byte :
         window.at(place.content, static_cast<std::size_t>(place.end - place.content))) {
        value = value << 8 | byte;
    }
    return value;
}

/// Where the Segment's content lies, if the file begins as a Matroska file does.
struct Segment {
    std::uint64_t content = 0;
    std::uint64_t end = 0;  ///< inside the file
    bool closed = false;
    std::uint64_t missing = 0;  ///< bytes that a closed Segment should have and has not
};

std::optional<Segment> find_segment(const ByteSource& bytes) {
    ByteWindow window(bytes);
    const auto head = ebml_at(window, 0, bytes.size());
    if (!head || head->id != kEbml || head->end - head->content > 4096) return std::nullopt;
    const auto content = content_of(bytes, *head);
    if (!content) return std::nullopt;
    std::string doc_type;
    EbmlWalk walk(*content);
    while (const auto child = walk.next()) {
        if (child->id == kDocType) doc_type = child->text();
    }
    if (doc_type != "matroska") return std::nullopt;
    const auto segment = read_ebml_head(window.at(head->end, 12));
    if (!segment || segment->id != kSegment) return std::nullopt;
    Segment found;
    found.content = head->end + segment->head_bytes;
    found.end = bytes.size();
    found.closed = !segment->unknown_size;
    if (found.closed) {
        const std::uint64_t room = bytes.size() - found.content;
        if (segment->size <= room) {
            found.end = found.content + segment->size;
        } else {
            found.missing = segment->size - room;
        }
    }
    return found;
}

/// Finds the elements directly below the Segment.
class TopWalk {
  public:
    TopWalk(const ByteSource& bytes, SessionIndex& index, SessionMeta& meta)
        : bytes_(bytes), window_(bytes), index_(index), meta_(meta) {}

    void run(const Segment& segment, bool check) {
        check_ = check;
        end_ = segment.end;
        budget_ = 4 * bytes_.size() + kMaxMeta;
        std::uint64_t at = segment.content;
        while (at < end_) {
            const auto place = ebml_at(window_, at, end_);
            if (place && take(*place)) {
                at = place->end;
                if (place->id == kCluster) index_.sound_end = at;
                continue;
            }
            const auto head = read_ebml_head(window_.at(at, 12));
            const auto next = next_sound(at + 1);
            if (!next) {
                index_.cut_bytes = end_ - at;
                break;
            }
            if (head && head->id == kCluster) ++index_.bad_clusters;
            index_.skipped_bytes += *next - at;
            at = *next;
        }
    }

  private:
    bool take(const EbmlPlace& place) {
        if (!is_top_level(place.id)) return false;
        switch (place.id) {
            case kCluster:
                return take_cluster(place);
            case kInfo:
            case kTracks:
            case kAttachments:
            case kTags: {
                const auto content = content_of(bytes_, place);
                if (!content) return true;
                if (place.id == kInfo) meta_.add_info(*content);
                if (place.id == kTracks) meta_.add_tracks(*content);
                if (place.id == kAttachments) meta_.add_attachments(*content);
                if (place.id == kTags) meta_.add_tags(*content);
                return true;
            }
            default:
                return true;
        }
    }

    bool take_cluster(const EbmlPlace& place) {
        if (place.end - place.content > kMaxElement) return false;
        SessionCluster cluster{place.start, place.end, read_crc(place), place.content + 6};
        if (cluster.crc && check_ && !sum_is_right(cluster)) return false;
        index_.clusters.push_back(cluster);
        return true;
    }

    std::optional<std::uint32_t> read_crc(const EbmlPlace& place) {
        const auto first = ebml_at(window_, place.content, place.end);
        if (!first || first->id != kCrc32 || first->end != place.content + 6) return std::nullopt;
        const auto sum = window_.at(first->content, 4);
        if (sum.size() < 4) return std::nullopt;
        return sum[0] | static_cast<std::uint32_t>(sum[1]) << 8 |
               static_cast<std::uint32_t>(sum[2]) << 16 | static_cast<std::uint32_t>(sum[3]) << 24;
    }

    bool sum_is_right(const SessionCluster& cluster) {
        constexpr std::uint64_t kPart = 1 << 20;
        std::uint32_t sum = 0;
        for (std::uint64_t at = cluster.checked_from; at < cluster.end; at += kPart) {
            buffer_.resize(static_cast<std::size_t>(std::min(kPart, cluster.end - at)));
            if (!bytes_.read(at, buffer_)) return false;
            sum = crc32(buffer_, sum);
        }
        return sum == *cluster.crc;
    }

    /// The next Cluster or Cues whose CRC-32 is right. Gives up when hostile bytes make it dear.
    std::optional<std::uint64_t> next_sound(std::uint64_t at) {
        constexpr std::uint64_t kPart = 1 << 16;
        std::vector<std::uint8_t> part;
        for (; at + 4 <= end_; at += kPart - 3) {
            part.resize(static_cast<std::size_t>(std::min(kPart, end_ - at)));
            if (!bytes_.read(at, part)) return std::nullopt;
            for (std::size_t i = 0; i + 4 <= part.size(); ++i) {
                if (part[i] != 0x1F && part[i] != 0x1C) continue;
                const std::uint32_t id = static_cast<std::uint32_t>(part[i]) << 24 |
                                         static_cast<std::uint32_t>(part[i + 1]) << 16 |
                                         static_cast<std::uint32_t>(part[i + 2]) << 8 | part[i + 3];
                if ((id == kCluster || id == kCues) && is_sound(at + i)) return at + i;
            }
            if (part.size() < kPart) break;
        }
        return std::nullopt;
    }

    bool is_sound(std::uint64_t at) {
        const auto place = ebml_at(window_, at, end_);
        if (!place || place->end - place->content > kMaxElement) return false;
        const std::uint64_t size = place->end - place->content;
        if (size > budget_) return false;
        budget_ -= size;
        const SessionCluster cluster{place->start, place->end, read_crc(*place),
                                     place->content + 6};
        return cluster.crc && sum_is_right(cluster);
    }

    const ByteSource& bytes_;
    ByteWindow window_;
    SessionIndex& index_;
    SessionMeta& meta_;
    bool check_ = true;
    std::uint64_t end_ = 0;
    std::uint64_t budget_ = 0;
    std::vector<std::uint8_t> buffer_;
};

/// Finds the blocks of a cluster.
class ClusterWalk {
  public:
    ClusterWalk(const ByteSource& bytes, SessionIndex& index, std::int64_t ns_per_tick)
        : window_(bytes), index_(index), ns_per_tick_(ns_per_tick) {}

    /// False, and no entries, where the cluster makes no sense.
    bool run(std::size_t number) {
        const std::size_t before = index_.entries.size();
        const SessionCluster cluster = index_.clusters[number];
        number_ = number;
        timestamp_.reset();
        const auto whole = ebml_at(window_, cluster.start, cluster.end);
        bool sound = whole.has_value();
        for (std::uint64_t at = sound ? whole->content : cluster.end; sound && at < cluster.end;) {
            const auto child = ebml_at(window_, at, cluster.end);
            sound = child && take(*child);
            if (child) at = child->end;
        }
        if (!sound) index_.entries.resize(before);
        return sound;
    }

  private:
    bool take(const EbmlPlace& child) {
        switch (child.id) {
            case kTimestamp:
                timestamp_ = number_at(window_, child);
                return *timestamp_ <= static_cast<std::uint64_t>(kMaxTicksTime / ns_per_tick_);
            case kSimpleBlock:
                return take_block(child, SessionEntry{});
            case kBlockGroup: {
                std::optional<EbmlPlace> block;
                SessionEntry entry;
                for (std::uint64_t at = child.content; at < child.end;) {
                    const auto part = ebml_at(window_, at, child.end);
                    if (!part) return false;
                    if (part->id == kBlock) block = *part;
                    if (part->id == kBlockAdditions && !find_note(*part, entry)) return false;
                    at = part->end;
                }
                return block && take_block(*block, entry);
            }
            default:
                return true;
        }
    }

    bool find_note(const EbmlPlace& additions, SessionEntry& entry) {
        for (std::uint64_t at = additions.content; at < additions.end;) {
            const auto more = ebml_at(window_, at, additions.end);
            if (!more) return false;
            std::uint64_t id = 1;
            std::optional<EbmlPlace> bytes;
            for (std::uint64_t in = more->content; in < more->end;) {
                const auto part = ebml_at(window_, in, more->end);
                if (!part) return false;
                if (part->id == kBlockAddId) id = number_at(window_, *part);
                if (part->id == kBlockAdditional) bytes = *part;
                in = part->end;
            }
            // mkvmerge keeps the note and forgets its number.
            if ((id == kFrameNoteId || id == 1) && bytes) {
                entry.note = bytes->content;
                entry.note_size = bytes->end - bytes->content;
            }
            at = more->end;
        }
        return true;
    }

    bool take_block(const EbmlPlace& block, SessionEntry entry) {
        const auto head = window_.at(block.content, 4);
        if (!timestamp_ || block.end - block.content < 4 || head.size() < 4) return false;
        if ((head[0] & 0x80) == 0) return true;  // track numbers above 126 are not ours
        const bool laced = (head[3] & 0x06) != 0;
        const auto track = std::find_if(
            index_.tracks.begin(), index_.tracks.end(),
            [&](const SessionTrack& other) { return other.number == (head[0] & 0x7F); });
        if (track == index_.tracks.end() || laced) return true;
        const auto relative = static_cast<std::int16_t>(head[1] << 8 | head[2]);
        entry.track = static_cast<std::size_t>(track - index_.tracks.begin());
        entry.cluster = number_;
        entry.time =
            index_.origin + (static_cast<std::int64_t>(*timestamp_) + relative) * ns_per_tick_;
        entry.device_time = entry.time;
        entry.data = block.content + 4;
        entry.data_size = block.end - entry.data;
        if (!identify(*track, entry)) return false;
        if (index_.entries.size() >= kMaxEntries) return false;
        index_.entries.push_back(entry);
        return true;
    }

    bool identify(const SessionTrack& track, SessionEntry& entry) {
        switch (track.role) {
            case TrackRole::motion:
                entry.id = {track.device, StreamKind::motion};
                return true;
            case TrackRole::bodies:
                entry.id = {track.device, StreamKind::bodies};
                return true;
            case TrackRole::poses:
            case TrackRole::events:
                return true;
            case TrackRole::picture:
            case TrackRole::frames:
                break;
        }
        entry.id = track.format.id;
        if (entry.note_size == 0) return track.role == TrackRole::picture;
        if (entry.note_size > kMaxMeta) return false;
        const auto note =
            read_frame_note(window_.at(entry.note, static_cast<std::size_t>(entry.note_size)));
        if (!note) return false;
        const FrameHeader& header = note->header;
        const auto in_range = [](TimeNs time) { return time > -kMaxTime && time < kMaxTime; };
        if (!in_range(header.host_time) || !in_range(header.device_time)) return false;
        entry.time = header.host_time;
        entry.device_time = header.device_time;
        entry.sequence = header.sequence;
        if (track.role == TrackRole::frames) {
            if (!note->own_format) return false;
            entry.id = note->own_format->format.id;
        }
        return true;
    }

    ByteWindow window_;
    SessionIndex& index_;
    std::int64_t ns_per_tick_;
    std::size_t number_ = 0;
    std::optional<std::uint64_t> timestamp_;
};

void tell(const Segment& segment, SessionIndex& index) {
    auto& findings = index.findings;
    if (!segment.closed) findings.emplace_back("the recording was never closed");
    if (segment.missing > 0) {
        findings.push_back(fmt::format("{} bytes are missing at the end", segment.missing));
    }
    if (index.cut_bytes > 0) {
        findings.push_back(
            fmt::format("the last cluster is cut off: {} bytes were left out", index.cut_bytes));
    }
    if (index.bad_clusters > 0 || index.skipped_bytes > 0) {
        findings.push_back(fmt::format("{} damaged clusters and {} bytes in all were skipped",
                                       index.bad_clusters, index.skipped_bytes));
    }
}

void read_attachments(const SessionMeta& meta, SessionIndex& index) {
    if (meta.source()) {
        auto source = source_from_text(*meta.source(), kSourceFile);
        if (source) {
            index.source = *std::move(source);
        } else {
            index.findings.push_back(source.error().to_string());
        }
    }
    if (meta.calibration()) {
        auto rig = rig_from_json(*meta.calibration(), kCalibrationFile);
        if (rig) {
            index.rig = *std::move(rig);
            return;
        }
        index.findings.push_back(rig.error().to_string());
    }
    int width = 640;
    int height = 480;
    for (const SessionTrack& track : index.tracks) {
        if (track.role != TrackRole::picture || track.format.id.kind != StreamKind::depth) continue;
        width = track.format.image.width;
        height = track.format.image.height;
    }
    index.rig = default_kinect1_rig(width, height);
    index.findings.emplace_back("it has no calibration; the Kinect's defaults stand in");
}

}  // namespace

Result<SessionIndex> index_session(const ByteSource& bytes, const std::string& where,
                                   CheckClusters check) {
    const auto segment = find_segment(bytes);
    if (!segment) return fail("not a Matroska file", where);
    SessionIndex index;
    SessionMeta meta;
    index.closed = segment->closed;
    index.missing_bytes = segment->missing;
    TopWalk(bytes, index, meta)
        .run(*segment,
             check == CheckClusters::all || !segment->closed || bytes.size() < kCheapSize);
    if (!meta.is_session()) {
        return fail("not a session, or cut off before its first frame", where);
    }
    index.origin = meta.origin();
    index.tracks = meta.tracks(index.findings);
    ClusterWalk walk(bytes, index, meta.ns_per_tick());
    for (std::size_t i = 0; i < index.clusters.size(); ++i) {
        if (!walk.run(i)) {
            ++index.bad_clusters;
            index.skipped_bytes += index.clusters[i].end - index.clusters[i].start;
        }
    }
    tell(*segment, index);
    read_attachments(meta, index);
    return index;
}

bool looks_like_session(const ByteSource& bytes) {
    const auto segment = find_segment(bytes);
    if (!segment) return false;
    ByteWindow window(bytes);
    SessionMeta meta;
    const auto read_tags = [&](const EbmlPlace& place) {
        if (place.id != kTags) return;
        if (const auto content = content_of(bytes, place)) meta.add_tags(*content);
    };
    std::uint64_t at = segment->content;
    while (const auto place = ebml_at(window, at, segment->end)) {
        if (place->id == kCluster || !is_top_level(place->id)) break;
        read_tags(*place);
        if (place->id == kSeekHead) {
            // Tools that copy a session may put its tags last.
            const auto content = content_of(bytes, *place);
            EbmlWalk seeks(content ? std::span<const std::uint8_t>(*content)
                                   : std::span<const std::uint8_t>());
            while (const auto seek = seeks.next()) {
                EbmlWalk parts(seek->content);
                std::optional<std::uint64_t> id;
                std::optional<std::uint64_t> position;
                while (const auto part = parts.next()) {
                    if (part->id == kSeekId) id = part->number();
                    if (part->id == kSeekPosition) position = part->number();
                }
                if (id != kTags || !position || *position > segment->end) continue;
                const auto tags = ebml_at(window, segment->content + *position, segment->end);
                if (tags) read_tags(*tags);
            }
        }
        if (meta.is_session()) return true;
        at = place->end;
    }
    return meta.is_session();
}

}  // namespace kino
