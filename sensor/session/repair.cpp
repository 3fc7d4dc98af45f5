#include "sensor/session/repair.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <optional>

#include "sensor/session/ebml_reader.h"
#include "sensor/session/session_index.h"
#include "sensor/session/session_layout.h"

namespace kino {
namespace {

using namespace ebml;

/// A file as it will be when what follows `size` is taken off.
class FrontOf final : public ByteSource {
  public:
    FrontOf(const ByteSource& bytes, std::uint64_t size) : bytes_(bytes), size_(size) {}
    std::uint64_t size() const override { return size_; }
    bool read(std::uint64_t offset, std::span<std::uint8_t> out) const override {
        return offset <= size_ && out.size() <= size_ - offset && bytes_.read(offset, out);
    }

  private:
    const ByteSource& bytes_;
    std::uint64_t size_;
};

/// The head's own facts, which the index does not keep. None where the head is not one that our
/// recorder writes: only those are filled in.
std::optional<SessionHead> read_head(const ByteSource& bytes) {
    std::vector<std::uint8_t> sector(kFirstSector);
    if (!bytes.read(0, sector)) return std::nullopt;
    SessionHead head;
    ByteWindow window(bytes);
    std::uint64_t at = kFirstSector;
    while (const auto place = ebml_at(window, at, bytes.size())) {
        if (place->id == kCluster) break;
        if (place->id == kTracks) head.places.tracks = place->start;
        if (place->id == kAttachments) head.places.attachments = place->start;
        if (place->id == kTags) head.places.tags = place->start;
        at = place->end;
    }
    const SessionPlaces& places = head.places;
    if (places.tracks == 0 || places.attachments == 0 || places.tags == 0) return std::nullopt;

    // Info says the date; all of it but that and the duration is the same in every session.
    const auto start = static_cast<std::size_t>(segment_content_start());
    const std::size_t info_at = info_start();
    const auto info_head = read_ebml_head(std::span(sector).subspan(info_at));
    if (!info_head || info_head->id != kInfo) return std::nullopt;
    const std::span<const std::uint8_t> info =
        std::span(sector).subspan(info_at + info_head->head_bytes);
    EbmlWalk walk(info);
    std::size_t duration_at = info_at + info_head->head_bytes;
    while (const auto child = walk.next()) {
        if (child->id == kDateUtc)
            head.date_ns = static_cast<std::int64_t>(child->number().value_or(0));
        if (child->id == kTimestampScale) {
            duration_at = static_cast<std::size_t>(child->content.data() - sector.data()) +
                          child->content.size();
        }
    }
    if (!walk.sound()) return std::nullopt;
    constexpr std::size_t kSizeBytes = 8;
    constexpr std::size_t kDurationBytes = 11;
    const std::vector<std::uint8_t> ours = first_sector(head);
    const auto same = [&](std::size_t from, std::size_t to) {
        return from <= to && to <= kFirstSector &&
               std::equal(ours.begin() + static_cast<std::ptrdiff_t>(from),
                          ours.begin() + static_cast<std::ptrdiff_t>(to),
                          sector.begin() + static_cast<std::ptrdiff_t>(from));
    };
    const bool known = same(0, start - kSizeBytes) && same(info_at, duration_at) &&
                       same(duration_at + kDurationBytes, kFirstSector);
    return known ? std::optional(head) : std::nullopt;
}

std::vector<SessionCue> cues_of(const SessionIndex& index) {
    const auto lead =
        std::find_if(index.tracks.begin(), index.tracks.end(),
                     [](const SessionTrack& track) { return track.role == TrackRole::picture; });
    std::vector<SessionCue> cues;
    if (lead == index.tracks.end()) return cues;
    const auto number = static_cast<std::size_t>(lead - index.tracks.begin());
    std::size_t next_cluster = 0;
    for (const SessionEntry& entry : index.entries) {
        if (entry.track != number || entry.cluster < next_cluster) continue;
        cues.push_back({std::max<TimeNs>(entry.time - index.origin, 0) / kNsPerTick, lead->number,
                        index.clusters[entry.cluster].start});
        next_cluster = entry.cluster + 1;
    }
    return cues;
}

}  // namespace

Result<RepairReport> repair_session(const ByteSource& bytes, RecordingFile& file,
                                    const std::string& where) {
    KINO_ASSIGN(const SessionIndex index, index_session(bytes, where, CheckClusters::all));
    RepairReport report;
    report.clusters = static_cast<std::int64_t>(index.clusters.size());
    report.bad_clusters = index.bad_clusters;
    report.frames =
        std::count_if(index.entries.begin(), index.entries.end(), [&](const SessionEntry& entry) {
            const TrackRole role = index.tracks[entry.track].role;
            return role != TrackRole::events && role != TrackRole::poses;
        });
    report.lines = index.findings;
    report.was_closed = index.closed && index.cut_bytes == 0 && index.missing_bytes == 0;
    if (report.was_closed) {
        report.lines.emplace_back("the recording is closed; nothing was changed");
        return report;
    }
    if (index.clusters.empty()) return fail("no frame of this session can be saved", where);
    // Nothing that reading needs may lie behind what is kept.
    const auto kept =
        index_session(FrontOf(bytes, index.sound_end), where, CheckClusters::where_cheap);
    std::optional<SessionHead> head = read_head(bytes);
    if (!head || !kept || kept->entries.size() != index.entries.size()) {
        return fail("this session was written by another program and cannot be repaired here",
                    where, "it can be read all the same");
    }

    report.cut_bytes = index.cut_bytes;
    // Also an index goes that a repair before this one wrote and did not come to use.
    if (file.size() > index.sound_end) KINO_TRY(file.truncate(index.sound_end));
    const std::vector<SessionCue> cues = cues_of(index);
    if (!cues.empty()) {
        head->places.cues = file.size();
        KINO_TRY(file.append(session_cues(cues)));
    }
    KINO_TRY(file.sync());
    TimeNs last = index.origin;
    for (const SessionEntry& entry : index.entries) last = std::max(last, entry.time);
    head->duration = std::min(last - index.origin, kMaxSessionTime);
    head->file_size = file.size();
    KINO_TRY(file.overwrite(0, first_sector(*head)));
    KINO_TRY(file.sync());
    report.lines.push_back(fmt::format("{} frames in {} clusters kept, index and end written",
                                       report.frames, report.clusters));
    return report;
}

Result<RepairReport> repair_session(const std::filesystem::path& path) {
    KINO_ASSIGN(const auto bytes, open_byte_source(path));
    // Asked first, so that a foreign file is not even opened for writing.
    if (!looks_like_session(*bytes)) {
        return fail("not a session, or cut off before its first frame", path.string());
    }
    KINO_ASSIGN(const auto file, open_recording_file(path));
    return repair_session(*bytes, *file, path.string());
}

}  // namespace kino
