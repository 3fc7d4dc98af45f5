#include "sensor/convert/bag_record.h"

#include <algorithm>
#include <bit>

namespace kino {

std::uint64_t BagCursor::number(std::size_t bytes) {
    const auto part = take(bytes);
    std::uint64_t value = 0;
    for (std::size_t i = part.size(); i > 0; --i) value = value << 8 | part[i - 1];
    return value;
}

float BagCursor::f32() {
    return std::bit_cast<float>(u32());
}

double BagCursor::f64() {
    return std::bit_cast<double>(number(8));
}

std::span<const std::uint8_t> BagCursor::counted() {
    return take(u32());
}

std::string BagCursor::text() {
    const auto part = counted();
    return {part.begin(), part.end()};
}

std::span<const std::uint8_t> BagCursor::take(std::size_t count) {
    if (count > bytes_.size()) {
        good_ = false;
        bytes_ = {};
        return {};
    }
    const auto part = bytes_.first(count);
    bytes_ = bytes_.subspan(count);
    return part;
}

std::optional<BagHeader> read_bag_header(std::span<const std::uint8_t> bytes) {
    BagHeader header;
    bool has_op = false;
    BagCursor cursor(bytes);
    while (cursor.left() > 0) {
        const auto field = cursor.counted();
        if (!cursor.good()) return std::nullopt;
        const auto equals = std::find(field.begin(), field.end(), std::uint8_t{'='});
        if (equals == field.end()) return std::nullopt;
        const std::string name(field.begin(), equals);
        const auto value = field.subspan(static_cast<std::size_t>(equals - field.begin()) + 1);
        BagCursor content(value);
        const auto number = [&](std::size_t size) {
            return value.size() == size ? std::optional(content.number(size)) : std::nullopt;
        };
        if (name == "op" && value.size() == 1) {
            header.op = value[0];
            has_op = true;
        }
        if (name == "conn") {
            const auto id = number(4);
            if (!id) return std::nullopt;
            header.connection = static_cast<std::uint32_t>(*id);
        }
        if (name == "time") header.time = number(8);
        if (name == "index_pos") header.index_position = number(8);
        if (name == "count") header.count = static_cast<std::uint32_t>(number(4).value_or(0));
        if (name == "size") header.size = static_cast<std::uint32_t>(number(4).value_or(0));
        if (name == "topic") header.topic.assign(value.begin(), value.end());
        if (name == "compression") header.compression.assign(value.begin(), value.end());
    }
    if (!has_op) return std::nullopt;
    return header;
}

std::optional<BagRecord> read_bag_record(std::span<const std::uint8_t> bytes) {
    BagCursor cursor(bytes);
    const auto fields = cursor.counted();
    if (!cursor.good() || fields.size() > bag::kMaxHeader) return std::nullopt;
    auto header = read_bag_header(fields);
    const auto data = cursor.counted();
    if (!header || !cursor.good()) return std::nullopt;
    return BagRecord{*std::move(header), data, bytes.size() - cursor.left()};
}

std::int64_t bag_time(std::uint64_t stamp) {
    constexpr std::uint64_t kLow = 0xFFFFFFFF;
    return static_cast<std::int64_t>((stamp & kLow) * 1'000'000'000 + (stamp >> 32));
}

}  // namespace kino
