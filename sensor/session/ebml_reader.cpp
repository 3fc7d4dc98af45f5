#include "sensor/session/ebml_reader.h"

#include <algorithm>
#include <bit>

namespace kino {

std::optional<EbmlHead> read_ebml_head(std::span<const std::uint8_t> bytes) {
    if (bytes.empty() || bytes[0] < 0x10) return std::nullopt;
    const auto id_bytes = static_cast<std::size_t>(std::countl_zero(bytes[0])) + 1;
    if (bytes.size() <= id_bytes) return std::nullopt;
    EbmlHead head;
    for (std::size_t i = 0; i < id_bytes; ++i) head.id = head.id << 8 | bytes[i];
    const std::uint8_t first = bytes[id_bytes];
    if (first == 0) return std::nullopt;
    const auto size_bytes = static_cast<std::size_t>(std::countl_zero(first)) + 1;
    if (bytes.size() < id_bytes + size_bytes) return std::nullopt;
    head.size = first & (0xFFu >> size_bytes);
    for (std::size_t i = 1; i < size_bytes; ++i) head.size = head.size << 8 | bytes[id_bytes + i];
    if (head.size == (std::uint64_t{1} << (7 * size_bytes)) - 1) {
        head.unknown_size = true;
        head.size = 0;
    }
    head.head_bytes = id_bytes + size_bytes;
    return head;
}

std::optional<std::uint64_t> EbmlChild::number() const {
    if (content.size() > 8) return std::nullopt;
    std::uint64_t value = 0;
    for (const std::uint8_t byte : content) value = value << 8 | byte;
    return value;
}

std::string EbmlChild::text() const {
    return {content.begin(), std::find(content.begin(), content.end(), 0)};
}

std::optional<EbmlChild> EbmlWalk::next() {
    if (rest_.empty() || !sound_) return std::nullopt;
    const auto head = read_ebml_head(rest_);
    if (!head || head->unknown_size || head->size > rest_.size() - head->head_bytes) {
        sound_ = false;
        return std::nullopt;
    }
    const EbmlChild child{head->id,
                          rest_.subspan(head->head_bytes, static_cast<std::size_t>(head->size))};
    rest_ = rest_.subspan(head->head_bytes + child.content.size());
    return child;
}

std::optional<EbmlPlace> ebml_at(ByteWindow& window, std::uint64_t offset, std::uint64_t end) {
    const auto head = read_ebml_head(window.at(offset, 12));
    if (!head || head->unknown_size || offset > end || head->head_bytes > end - offset ||
        head->size > end - offset - head->head_bytes) {
        return std::nullopt;
    }
    const std::uint64_t content = offset + head->head_bytes;
    return EbmlPlace{head->id, offset, content, content + head->size};
}

}  // namespace kino
