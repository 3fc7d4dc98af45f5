#include "sensor/openni2/oni_depth_codec.h"

#include <algorithm>
#include <cstring>

namespace kino {
namespace {

constexpr std::size_t kMaxValues = 32768;

void put16(std::vector<std::uint8_t>& out, unsigned value) {
    out.push_back(static_cast<std::uint8_t>(value));
    out.push_back(static_cast<std::uint8_t>(value >> 8));
}

unsigned get16(const std::uint8_t* bytes) {
    return static_cast<unsigned>(bytes[0] | bytes[1] << 8);
}

/// Gives `sink` the numbers of a coded frame one after the other; it says no to stop.
template <class Sink>
bool for_each_number(std::span<const std::uint8_t> bytes, Sink&& sink) {
    if (bytes.size() < 2) return false;
    std::uint16_t last = static_cast<std::uint16_t>(get16(bytes.data()));
    if (!sink(last)) return false;
    std::size_t at = 2;
    const auto differ = [&](int difference) {
        last = static_cast<std::uint16_t>(last - difference);
        return sink(last);
    };
    const auto take_long = [&] {
        if (at >= bytes.size()) return false;
        const int high = bytes[at++];
        if (high >= 128) return differ(high - 192);
        if (at >= bytes.size()) return false;
        last = static_cast<std::uint16_t>(high << 8 | bytes[at++]);
        return sink(last);
    };
    while (at < bytes.size()) {
        const int byte = bytes[at++];
        if (byte == 0xFF) {
            if (!take_long()) return false;
        } else if (byte >= 0xE0) {
            for (int i = 0; i < 2 * (byte - 0xE0); ++i) {
                if (!sink(last)) return false;
            }
        } else {
            if (!differ((byte >> 4) - 6)) return false;
            const int low = byte & 15;
            if (low == 15) {
                if (!take_long()) return false;
            } else if (low != 13) {
                if (!differ(low - 6)) return false;
            }
        }
    }
    return true;
}

/// Calls `store(position, value)` for every pixel.
template <class Store>
bool decode(std::span<const std::uint8_t> bytes, bool table, std::size_t pixels, Store&& store) {
    const std::uint8_t* values = nullptr;
    std::size_t count = std::size_t{1} << 16;
    if (table) {
        if (bytes.size() < 2) return false;
        count = get16(bytes.data());
        if (bytes.size() - 2 < 2 * count) return false;
        values = bytes.data() + 2;
        bytes = bytes.subspan(2 + 2 * count);
    }
    std::size_t done = 0;
    const bool sound = for_each_number(bytes, [&](std::uint16_t number) {
        if (done == pixels || number >= count) return false;
        store(done++, values ? get16(values + 2 * std::size_t{number}) : number);
        return true;
    });
    return sound && done == pixels;
}

}  // namespace

std::optional<std::vector<std::uint8_t>> encode_16z_table(std::span<const std::uint16_t> pixels) {
    std::vector<std::uint16_t> place(std::size_t{1} << 16, 0);
    for (const std::uint16_t value : pixels) place[value] = 1;
    std::vector<std::uint8_t> out(2);
    out.reserve(pixels.size());
    std::size_t count = 0;
    for (std::size_t value = 0; value < place.size(); ++value) {
        if (place[value] == 0) continue;
        place[value] = static_cast<std::uint16_t>(count++);
        put16(out, static_cast<unsigned>(value));
    }
    if (count > kMaxValues || pixels.empty()) return std::nullopt;
    out[0] = static_cast<std::uint8_t>(count);
    out[1] = static_cast<std::uint8_t>(count >> 8);

    int last = place[pixels.front()];
    put16(out, static_cast<unsigned>(last));
    int half = -1;  // the first of two small differences, waiting for the second
    int still = 0;  // pairs of pixels without a difference
    const auto flush_still = [&] {
        if (still > 0) out.push_back(static_cast<std::uint8_t>(0xE0 + still));
        still = 0;
    };
    for (const std::uint16_t value : pixels.subspan(1)) {
        const int number = place[value];
        const int difference = last - number;
        last = number;
        if (difference >= -6 && difference <= 6) {
            if (half < 0) {
                half = difference + 6;
            } else if (half == 6 && difference == 0) {
                half = -1;
                if (++still == 15) flush_still();
            } else {
                flush_still();
                out.push_back(static_cast<std::uint8_t>(half << 4 | (difference + 6)));
                half = -1;
            }
            continue;
        }
        flush_still();
        out.push_back(half < 0 ? std::uint8_t{0xFF} : static_cast<std::uint8_t>(half << 4 | 15));
        half = -1;
        if (difference >= -63 && difference <= 63) {
            out.push_back(static_cast<std::uint8_t>(difference + 192));
        } else {
            out.push_back(static_cast<std::uint8_t>(number >> 8));
            out.push_back(static_cast<std::uint8_t>(number));
        }
    }
    // In this order: the library's own recorder writes the last half before the run that stands
    // before it, and so spoils the end of some frames.
    flush_still();
    if (half >= 0) out.push_back(static_cast<std::uint8_t>(half << 4 | 13));
    return out;
}

bool decode_16z(std::span<const std::uint8_t> bytes, bool table, std::span<std::uint16_t> out) {
    return decode(bytes, table, out.size(), [&](std::size_t position, unsigned value) {
        out[position] = static_cast<std::uint16_t>(value);
    });
}

bool check_16z(std::span<const std::uint8_t> bytes, bool table, std::size_t pixels) {
    return decode(bytes, table, pixels, [](std::size_t, unsigned) {});
}

}  // namespace kino
