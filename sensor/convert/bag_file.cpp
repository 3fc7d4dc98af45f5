#include "sensor/convert/bag_file.h"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "sensor/convert/bag_record.h"
#include "sensor/convert/bag_unpack.h"

namespace kino {
namespace {

constexpr std::size_t kMaxMessages = 20'000'000;
constexpr std::size_t kMaxConnections = 65'536;
constexpr std::size_t kMaxChunks = 10'000'000;
constexpr std::size_t kIndexEntry = 12;
constexpr std::uint64_t kMostPacking = 64;

/// A record in the file; its data is not read.
struct Place {
    BagHeader header;
    std::uint64_t data = 0;
    std::uint64_t size = 0;
    bool cut = false;  ///< the file ends before its data does
};

std::optional<Place> record_at(ByteWindow& window, std::uint64_t at) {
    const auto head = window.at(at, 4);
    if (head.size() < 4) return std::nullopt;
    const std::uint32_t header_size = BagCursor(head).u32();
    if (header_size > bag::kMaxHeader) return std::nullopt;
    const auto bytes = window.at(at, std::size_t{header_size} + 8);
    if (bytes.size() < std::size_t{header_size} + 8) return std::nullopt;
    auto header = read_bag_header(bytes.subspan(4, header_size));
    if (!header) return std::nullopt;
    Place place;
    place.size = BagCursor(bytes.last(4)).u32();
    place.header = *std::move(header);
    place.data = at + header_size + 8;
    place.cut = place.size > window.size() - place.data;
    return place;
}

}  // namespace

BagFile::BagFile(std::unique_ptr<ByteSource> bytes, std::string where)
    : bytes_(std::move(bytes)), where_(std::move(where)) {}

Result<std::unique_ptr<BagFile>> BagFile::open(std::unique_ptr<ByteSource> bytes,
                                               const std::string& where, const Wanted& wanted) {
    if (!looks_like_bag(*bytes)) {
        return fail("not a ROS bag of version 2.0", where);
    }
    std::unique_ptr<BagFile> file(new BagFile(std::move(bytes), where));
    KINO_TRY(file->scan(wanted));
    return file;
}

Result<void> BagFile::scan(const Wanted& wanted) {
    std::vector<IndexedMessage> indexed;
    KINO_TRY(scan_records(wanted, indexed));
    KINO_TRY(read_index(wanted, indexed));
    std::size_t looked_through = 0;
    // Pictures pack a few times; a small file must not keep us busy for hours.
    std::uint64_t budget = kMaxBagChunk + kMostPacking * bytes_->size();
    for (std::size_t i = 0; i < chunks_.size(); ++i) {
        if (chunks_[i].indexed) continue;
        const std::uint64_t unpacked = std::min(chunks_[i].unpacked_size, kMaxBagChunk);
        if (unpacked > budget) return fail("the bag unpacks to far more than pictures do", where_);
        budget -= unpacked;
        scan_chunk(i, wanted);
        ++looked_through;
    }
    if (looked_through > 0) {
        findings_.push_back(fmt::format(
            "the bag was never closed: {} of its {} chunks were looked through for messages",
            looked_through, chunks_.size()));
    }
    std::stable_sort(messages_.begin(), messages_.end(),
                     [](const BagMessage& a, const BagMessage& b) { return a.time < b.time; });
    return {};
}

Result<void> BagFile::scan_records(const Wanted& wanted, std::vector<IndexedMessage>& indexed) {
    ByteWindow window(*bytes_);
    std::uint64_t at = bag::kMagic.size();
    while (at < bytes_->size()) {
        auto place = record_at(window, at);
        if (!place) {
            find("the bag is cut off or damaged behind its last sound record");
            break;
        }
        const BagHeader& header = place->header;
        if (place->cut && header.op != bag::kChunk) {
            find("the bag is cut off");
            break;
        }
        switch (header.op) {
            case bag::kChunk: {
                if (chunks_.size() >= kMaxChunks) return fail("too many chunks", where_);
                Chunk chunk;
                chunk.data = place->data;
                chunk.size = std::min(place->size, bytes_->size() - place->data);
                chunk.unpacked_size = header.size;
                chunk.cut = place->cut;
                if (header.compression == "lz4") {
                    chunk.packing = Packing::lz4;
                } else if (header.compression == "bz2") {
                    chunk.packing = Packing::bz2;
                } else if (header.compression != "none") {
                    return fail(fmt::format("a chunk is packed as \"{}\", which is not known",
                                            header.compression),
                                where_);
                }
                chunks_.push_back(chunk);
                break;
            }
            case bag::kIndex:
                if (!chunks_.empty() && header.connection &&
                    place->size == std::uint64_t{header.count} * kIndexEntry) {
                    chunks_.back().indexed = true;
                    indexed.push_back(
                        {chunks_.size() - 1, place->data, header.count, *header.connection});
                }
                break;
            case bag::kConnection:
                if (header.connection && topics_.size() < kMaxConnections) {
                    topics_.emplace(*header.connection, header.topic);
                }
                break;
            case bag::kMessage:
                // What follows the head of a chunk that was being filled when all ended.
                if (header.connection && header.time &&
                    !remember({*header.connection, bag_time(*header.time), SIZE_MAX, at}, wanted)) {
                    return fail("too many messages", where_);
                }
                break;
            default:
                break;
        }
        if (place->cut) break;
        at = place->data + place->size;
    }
    return {};
}

Result<void> BagFile::read_index(const Wanted& wanted, const std::vector<IndexedMessage>& indexed) {
    // Topics of a bag that has lost its end stand in the chunks alone.
    for (const IndexedMessage& entry : indexed) {
        if (!topics_.contains(entry.connection)) chunks_[entry.chunk].indexed = false;
    }
    std::vector<std::uint8_t> data;
    for (const IndexedMessage& entry : indexed) {
        if (!chunks_[entry.chunk].indexed) continue;
        const auto topic = topics_.find(entry.connection);
        if (topic == topics_.end() || !wanted(topic->second)) continue;
        // Bounded by the file: the record was seen to lie inside it.
        data.resize(std::size_t{entry.count} * kIndexEntry);
        if (!bytes_->read(entry.record, data)) return fail("could not be read", where_);
        BagCursor cursor(data);
        for (std::uint32_t i = 0; i < entry.count; ++i) {
            const std::uint64_t stamp = cursor.number(8);
            if (!remember({entry.connection, bag_time(stamp), entry.chunk, cursor.u32()}, wanted)) {
                return fail("too many messages", where_);
            }
        }
    }
    return {};
}

void BagFile::scan_chunk(std::size_t chunk, const Wanted& wanted) {
    const auto bytes = load(chunk);
    if (!bytes) {
        find(bytes.error().what);
        return;
    }
    std::size_t at = 0;
    while (at < bytes->size()) {
        const auto record = read_bag_record(bytes->subspan(at));
        if (!record) {
            find("a chunk is cut off: its last message is lost");
            return;
        }
        const BagHeader& header = record->header;
        if (header.op == bag::kConnection && header.connection &&
            topics_.size() < kMaxConnections) {
            topics_.emplace(*header.connection, header.topic);
        }
        if (header.op == bag::kMessage && header.connection && header.time) {
            (void)remember({*header.connection, bag_time(*header.time), chunk, at}, wanted);
        }
        at += record->size;
    }
}

void BagFile::find(const std::string& what) {
    if (std::find(findings_.begin(), findings_.end(), what) == findings_.end()) {
        findings_.push_back(what);
    }
}

bool BagFile::remember(const BagMessage& message, const Wanted& wanted) {
    auto known = wanted_.find(message.connection);
    if (known == wanted_.end()) {
        const auto topic = topics_.find(message.connection);
        if (topic == topics_.end()) return true;
        known = wanted_.emplace(message.connection, wanted(topic->second)).first;
    }
    if (!known->second || message.time < 0) return true;
    if (messages_.size() >= kMaxMessages) return false;
    messages_.push_back(message);
    return true;
}

Result<std::span<const std::uint8_t>> BagFile::load(std::size_t index) {
    for (const Loaded& loaded : loaded_) {
        if (loaded.chunk == index) return std::span<const std::uint8_t>(loaded.bytes);
    }
    const Chunk& chunk = chunks_[index];
    if (chunk.unpacked_size > kMaxBagChunk || chunk.size > kMaxBagChunk) {
        return fail(fmt::format("a chunk has {} bytes, the most is {}",
                                std::max(chunk.unpacked_size, chunk.size), kMaxBagChunk),
                    where_);
    }
    std::vector<std::uint8_t> packed(static_cast<std::size_t>(chunk.size));
    if (!bytes_->read(chunk.data, packed)) return fail("a chunk could not be read", where_);
    Loaded& slot = loaded_[next_slot_];
    slot.chunk = SIZE_MAX;
    const auto size = static_cast<std::size_t>(chunk.unpacked_size);
    auto bytes = chunk.packing == Packing::lz4   ? unpack_lz4(packed, size, chunk.cut)
                 : chunk.packing == Packing::bz2 ? unpack_bz2(packed, size, chunk.cut)
                                                 : std::move(packed);
    if (!bytes) return fail(bytes.error(), where_);
    next_slot_ = (next_slot_ + 1) % loaded_.size();
    slot.bytes = *std::move(bytes);
    slot.chunk = index;
    return std::span<const std::uint8_t>(slot.bytes);
}

Result<std::span<const std::uint8_t>> BagFile::read(const BagMessage& message) {
    if (message.chunk == SIZE_MAX) {
        ByteWindow window(*bytes_);
        const auto place = record_at(window, message.offset);
        if (!place || place->cut || place->size > kMaxBagChunk) {
            return fail("a message is damaged", where_);
        }
        loose_.resize(static_cast<std::size_t>(place->size));
        if (!bytes_->read(place->data, loose_)) return fail("could not be read", where_);
        return std::span<const std::uint8_t>(loose_);
    }
    KINO_ASSIGN(const auto chunk, load(message.chunk));
    if (message.offset >= chunk.size()) return fail("the bag's index is damaged", where_);
    const auto record = read_bag_record(chunk.subspan(static_cast<std::size_t>(message.offset)));
    const bool same = record && record->header.op == bag::kMessage &&
                      record->header.connection == message.connection;
    if (!same) return fail("the bag's index is damaged", where_);
    return record->data;
}

bool looks_like_bag(const ByteSource& bytes) {
    std::array<std::uint8_t, bag::kMagic.size()> start{};
    return bytes.read(0, start) && std::equal(start.begin(), start.end(), bag::kMagic.begin());
}

}  // namespace kino
