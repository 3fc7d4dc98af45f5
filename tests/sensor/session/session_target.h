#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "base/check.h"
#include "logged_file.h"
#include "sensor/session/repair.h"
#include "sensor/session/session_source.h"

/// What the session reader promises for any bytes at all: no crash, every offset inside the file,
/// times that rise, and a repair that leaves a file as readable as it was.
namespace kino::fuzz {

inline void session(std::span<const std::uint8_t> bytes) {
    const bool ours = looks_like_session(*memory_byte_source(bytes));
    auto reader = SessionReader::open(memory_byte_source(bytes), "fuzz");
    if (!reader) return;
    (void)ours;
    const SessionIndex& index = (*reader)->index();
    KINO_CHECK(validate(index.rig).has_value());
    for (const SessionEntry& entry : (*reader)->frames()) {
        const SessionCluster& cluster = index.clusters[entry.cluster];
        KINO_CHECK(cluster.end <= bytes.size() && entry.data + entry.data_size <= cluster.end);
    }
    const std::size_t frames = (*reader)->frames().size();
    std::size_t left = 20;
    for (const SessionEntry& entry : (*reader)->frames()) {
        if (left-- == 0) break;
        const StreamFormat& format = index.tracks[entry.track].format;
        // Large pictures are only slow.
        if (format.image.width > 256 || format.image.height > 256) continue;
        (void)(*reader)->read(entry);
    }
    auto source = make_session_source(*std::move(reader), "fuzz");
    if (source) {
        const Timeline& timeline = *(*source)->timeline();
        for (std::int64_t i = 1; i < timeline.frame_count(); ++i) {
            KINO_CHECK(timeline.time_of(i) > timeline.time_of(i - 1));
        }
        (void)(*source)->next(0);
    }
    test::FileLog log;
    log.content.assign(bytes.begin(), bytes.end());
    test::LoggedFile file(log);
    const auto report = repair_session(*memory_byte_source(bytes), file, "fuzz");
    if (!report) return;
    auto again = SessionReader::open(memory_byte_source(log.content), "fuzz");
    KINO_CHECK(again.has_value() && (*again)->frames().size() == frames);
}

}  // namespace kino::fuzz
