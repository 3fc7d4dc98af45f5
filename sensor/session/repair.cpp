#include "sensor/session/repair.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cstring>

#include "sensor/session/ebml_reader.h"
#include "sensor/session/session_index.h"
#include "sensor/session/session_layout.h"

namespace kino {
namespace {

using namespace ebml;

/// The head's own facts, which the index does not keep.
Result<SessionHead> read_head(const ByteSource& bytes, const std::string& where) {
    ByteWindow window(bytes);
    SessionHead head;
    std::uint64_t at = segment_content_start();
    bool has_info = false;
    while (const auto place = ebml_at(window, at, bytes.size())) {
        if (place->id == kCluster) break;
        if (place->id == kTracks) head.places.tracks = place->start;
        if (place->id == kAttachments) head.places.attachments = place->start;
        if (place->id == kTags) head.places.tags = place->start;
        if (place->id == kInfo && place->end == kFirstSector) {
            has_info = true;
            std::vector<std::uint8_t> content(
                static_cast<std::size_t>(place->end - place->content));
            if (!bytes.read(place->content, content)) break;
            EbmlWalk walk(content);
            while (const auto child = walk.next()) {
                if (child->id != kDateUtc) continue;
                head.date_ns = static_cast<std::int64_t>(child->number().value_or(0));
            }
        }
        at = place->end;
    }
    // Only what our own recorder wrote is changed in place; its head fills one sector.
    if (!has_info || head.places.tracks == 0 || head.places.attachments == 0 ||
        head.places.tags == 0) {
        return fail("this session was written by another program and cannot be repaired here",
                    where, "it can be read all the same");
    }
    return head;
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
    KINO_ASSIGN(SessionHead head, read_head(bytes, where));

    report.cut_bytes = index.cut_bytes;
    // Also an index goes that a repair before this one wrote and did not come to use.
    if (file.size() > index.sound_end) KINO_TRY(file.truncate(index.sound_end));
    const std::vector<SessionCue> cues = cues_of(index);
    if (!cues.empty()) {
        head.places.cues = file.size();
        KINO_TRY(file.append(session_cues(cues)));
    }
    KINO_TRY(file.sync());
    TimeNs last = index.origin;
    for (const SessionEntry& entry : index.entries) last = std::max(last, entry.time);
    head.duration = std::min(last - index.origin, kMaxSessionTime);
    head.file_size = file.size();
    KINO_TRY(file.overwrite(0, first_sector(head)));
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
