#include "sensor/session/session_reader.h"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "sensor/session/crc32.h"

namespace kino {
namespace {

constexpr std::size_t kMaxPixelBytes = std::size_t{1} << 28;
constexpr std::size_t kMaxDecoders = 8;
constexpr std::uint64_t kMaxText = std::uint64_t{1} << 20;

std::span<std::uint8_t> bytes_of(Image<std::uint16_t>& image) {
    return {reinterpret_cast<std::uint8_t*>(image.data()), image.size() * 2};
}

}  // namespace

Result<std::unique_ptr<SessionReader>> SessionReader::open(const std::filesystem::path& path) {
    KINO_ASSIGN(auto bytes, open_byte_source(path));
    return open(std::move(bytes), path.string());
}

Result<std::unique_ptr<SessionReader>> SessionReader::open(std::unique_ptr<ByteSource> bytes,
                                                           const std::string& where) {
    KINO_ASSIGN(auto index, index_session(*bytes, where, CheckClusters::where_cheap));
    std::unique_ptr<SessionReader> reader(
        new SessionReader(std::move(bytes), where, std::move(index)));
    reader->read_texts();
    return reader;
}

SessionReader::SessionReader(std::unique_ptr<ByteSource> bytes, std::string where,
                             SessionIndex index)
    : bytes_(std::move(bytes)), where_(std::move(where)), index_(std::move(index)) {}

void SessionReader::read_texts() {
    for (const SessionEntry& entry : index_.entries) {
        const TrackRole role = index_.tracks[entry.track].role;
        if (role != TrackRole::events && role != TrackRole::poses) {
            frames_.push_back(entry);
            continue;
        }
        const auto text = text_of(entry);
        if (!text) continue;
        if (role == TrackRole::events) {
            if (auto event = event_from_text(*text, where_)) events_.push_back(*std::move(event));
        } else {
            if (auto pose = pose_from_text(*text, where_)) poses_.push_back(*pose);
        }
    }
    index_.entries.clear();
    index_.entries.shrink_to_fit();
}

Result<std::span<const std::uint8_t>> SessionReader::load(std::size_t number) {
    for (const Loaded& loaded : loaded_) {
        if (loaded.cluster == number) return std::span<const std::uint8_t>(loaded.bytes);
    }
    const SessionCluster& cluster = index_.clusters[number];
    Loaded& slot = loaded_[next_slot_];
    slot.cluster = SIZE_MAX;
    slot.bytes.resize(static_cast<std::size_t>(cluster.end - cluster.start));
    if (!bytes_->read(cluster.start, slot.bytes)) {
        return fail("the recording can no longer be read", where_,
                    "it may have been cut while it was open");
    }
    const auto checked_at = static_cast<std::size_t>(cluster.checked_from - cluster.start);
    if (cluster.crc && crc32(std::span(slot.bytes).subspan(checked_at)) != *cluster.crc) {
        return fail("this part of the recording is damaged (wrong check sum)", where_);
    }
    slot.cluster = number;
    next_slot_ = 1 - next_slot_;
    return std::span<const std::uint8_t>(slot.bytes);
}

Result<std::string> SessionReader::text_of(const SessionEntry& entry) {
    if (entry.data_size > kMaxText) return fail("a text is too long", where_);
    std::string text(static_cast<std::size_t>(entry.data_size), '\0');
    if (!bytes_->read(entry.data, {reinterpret_cast<std::uint8_t*>(text.data()), text.size()})) {
        return fail("the recording can no longer be read", where_);
    }
    return text;
}

Result<StreamFrame> SessionReader::read(const SessionEntry& entry) {
    const SessionTrack& track = index_.tracks[entry.track];
    switch (track.role) {
        case TrackRole::motion: {
            KINO_ASSIGN(const std::string text, text_of(entry));
            KINO_ASSIGN(auto motion, motion_from_text(text, where_));
            return std::make_shared<const MotionFrame>(motion);
        }
        case TrackRole::bodies: {
            KINO_ASSIGN(const std::string text, text_of(entry));
            KINO_ASSIGN(auto bodies, bodies_from_text(text, where_));
            return std::make_shared<const BodyFrame>(std::move(bodies));
        }
        case TrackRole::picture:
        case TrackRole::frames:
            return picture(entry, track);
        case TrackRole::poses:
        case TrackRole::events:
            break;
    }
    return fail("not a frame", where_);
}

Result<StreamFrame> SessionReader::picture(const SessionEntry& entry, const SessionTrack& track) {
    KINO_ASSIGN(const auto cluster, load(entry.cluster));
    const std::uint64_t start = index_.clusters[entry.cluster].start;
    const auto part = [&](std::uint64_t offset, std::uint64_t size) {
        return cluster.subspan(static_cast<std::size_t>(offset - start),
                               static_cast<std::size_t>(size));
    };
    FrameNote note;
    note.header = {entry.device_time, entry.time, entry.sequence, 0};
    if (entry.note_size > 0) {
        KINO_ASSIGN(note, read_frame_note(part(entry.note, entry.note_size)));
    }
    const bool own = track.role == TrackRole::frames;
    if (own && !note.own_format) return fail("a frame has no format", where_);
    const StreamFormat& format = own ? note.own_format->format : track.format;
    const std::span<const std::uint8_t> private_data =
        own ? note.own_format->private_data : track.private_data;
    const auto data = part(entry.data, entry.data_size);
    const std::size_t raw_bytes = format.jpeg ? 0 : bytes_per_frame(format.image);
    if (raw_bytes > kMaxPixelBytes) {
        return fail(
            fmt::format("pictures of {}x{} are too large", format.image.width, format.image.height),
            where_);
    }
    const int width = format.image.width;
    const int height = format.image.height;
    if (format.id.kind == StreamKind::color) {
        ColorFrame frame;
        frame.header = note.header;
        frame.format = format.pixel_format;
        frame.width = width;
        frame.height = height;
        frame.pitch = packed_pitch(format.pixel_format, width);
        frame.matrix = format.matrix;
        frame.range = format.range;
        frame.damaged_rows = std::move(note.damaged_rows);
        if (format.jpeg) {
            frame.bytes.assign(data.begin(), data.end());
        } else {
            frame.bytes.resize(raw_bytes);
            KINO_TRY(decode(format.image, private_data, data, frame.bytes));
        }
        return std::make_shared<const ColorFrame>(std::move(frame));
    }
    Image<std::uint16_t> image;
    image.resize(width, height);
    KINO_TRY(decode(format.image, private_data, data, bytes_of(image)));
    if (format.id.kind == StreamKind::infrared) {
        InfraredFrame frame{note.header, std::move(image), format.significant_bits,
                            std::move(note.damaged_rows)};
        return std::make_shared<const InfraredFrame>(std::move(frame));
    }
    DepthFrame frame{note.header, std::move(image), format.unit, format.metres_per_unit,
                     std::move(note.damaged_rows)};
    return std::make_shared<const DepthFrame>(std::move(frame));
}

Result<void> SessionReader::decode(const ImageFormat& format,
                                   std::span<const std::uint8_t> private_data,
                                   std::span<const std::uint8_t> data,
                                   std::span<std::uint8_t> pixels) {
    const auto same = [&](const Decoder& other) {
        return other.format == format &&
               std::equal(private_data.begin(), private_data.end(), other.private_data.begin(),
                          other.private_data.end());
    };
    auto found = std::find_if(decoders_.begin(), decoders_.end(), same);
    if (found == decoders_.end()) {
        auto decoder = make_image_decoder(format, private_data);
        if (!decoder) return fail(std::move(decoder).error(), where_);
        if (decoders_.size() >= kMaxDecoders) decoders_.erase(decoders_.begin());
        decoders_.push_back(
            {format, {private_data.begin(), private_data.end()}, *std::move(decoder)});
        found = std::prev(decoders_.end());
    }
    if (auto decoded = found->decoder->decode(data, pixels); !decoded) {
        return fail(std::move(decoded).error(), where_);
    }
    return {};
}

}  // namespace kino
