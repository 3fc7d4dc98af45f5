#include "sensor/session/frame_note.h"

#include <algorithm>
#include <limits>
#include <string_view>

namespace kino {
namespace {

constexpr std::uint8_t kVersion = 1;
constexpr std::uint8_t kHasOwnFormat = 1;

template <class T>
void put(std::vector<std::uint8_t>& bytes, T value) {
    const auto bits = static_cast<std::uint64_t>(value);
    for (std::size_t i = 0; i < sizeof(T); ++i) {
        bytes.push_back(static_cast<std::uint8_t>(bits >> (8 * i)));
    }
}

/// Takes little-endian numbers off the front of bytes; past the end it gives 0 and turns bad.
class Cursor {
  public:
    explicit Cursor(std::span<const std::uint8_t> bytes) : bytes_(bytes) {}

    template <class T>
    T get() {
        std::uint64_t bits = 0;
        const auto part = take(sizeof(T));
        for (std::size_t i = 0; i < part.size(); ++i) bits |= std::uint64_t{part[i]} << (8 * i);
        return static_cast<T>(bits);
    }

    std::span<const std::uint8_t> take(std::size_t count) {
        if (count > bytes_.size()) {
            good_ = false;
            return {};
        }
        const auto part = bytes_.first(count);
        bytes_ = bytes_.subspan(count);
        return part;
    }

    [[nodiscard]] bool good() const { return good_; }

  private:
    std::span<const std::uint8_t> bytes_;
    bool good_ = true;
};

}  // namespace

Result<std::vector<std::uint8_t>> write_frame_note(const FrameNote& note) {
    const bool sound = note.damaged_rows.size() <= std::numeric_limits<std::uint16_t>::max() &&
                       std::all_of(note.damaged_rows.begin(), note.damaged_rows.end(),
                                   [](RowRange r) { return r.first >= 0 && r.count >= 0; });
    if (!sound) return fail("a frame's damaged rows make no sense");
    std::vector<std::uint8_t> bytes;
    put(bytes, kVersion);
    put(bytes, note.own_format ? kHasOwnFormat : std::uint8_t{0});
    put(bytes, static_cast<std::uint16_t>(note.damaged_rows.size()));
    put(bytes, note.header.device_time);
    put(bytes, note.header.host_time);
    put(bytes, note.header.sequence);
    put(bytes, note.header.lost_before);
    for (const RowRange& range : note.damaged_rows) {
        put(bytes, static_cast<std::uint32_t>(range.first));
        put(bytes, static_cast<std::uint32_t>(range.count));
    }
    if (note.own_format) {
        const std::string json = format_to_json(note.own_format->format);
        put(bytes, static_cast<std::uint32_t>(json.size()));
        bytes.insert(bytes.end(), json.begin(), json.end());
        const auto& extra = note.own_format->private_data;
        put(bytes, static_cast<std::uint32_t>(extra.size()));
        bytes.insert(bytes.end(), extra.begin(), extra.end());
    }
    return bytes;
}

Result<FrameNote> read_frame_note(std::span<const std::uint8_t> bytes) {
    Cursor cursor(bytes);
    if (cursor.get<std::uint8_t>() != kVersion) return fail("a frame's note is of another version");
    const auto flags = cursor.get<std::uint8_t>();
    const auto ranges = cursor.get<std::uint16_t>();
    FrameNote note;
    note.header.device_time = cursor.get<std::int64_t>();
    note.header.host_time = cursor.get<std::int64_t>();
    note.header.sequence = cursor.get<std::int64_t>();
    note.header.lost_before = cursor.get<std::int64_t>();
    for (int i = 0; i < ranges && cursor.good(); ++i) {
        const auto first = cursor.get<std::uint32_t>();
        const auto count = cursor.get<std::uint32_t>();
        constexpr std::uint32_t kMost = std::numeric_limits<std::int32_t>::max();
        if (first > kMost || count > kMost - first) return fail("a frame's note is damaged");
        note.damaged_rows.push_back({static_cast<int>(first), static_cast<int>(count)});
    }
    if ((flags & kHasOwnFormat) != 0 && cursor.good()) {
        const auto json = cursor.take(cursor.get<std::uint32_t>());
        const auto extra = cursor.take(cursor.get<std::uint32_t>());
        if (!cursor.good()) return fail("a frame's note is cut off");
        OwnFormat own;
        KINO_ASSIGN(own.format,
                    format_from_json({reinterpret_cast<const char*>(json.data()), json.size()},
                                     "a frame's own format"));
        own.private_data.assign(extra.begin(), extra.end());
        note.own_format = std::move(own);
    }
    if (!cursor.good()) return fail("a frame's note is cut off");
    return note;
}

}  // namespace kino
