#include "tests/sensor/device/fake_kinect/packet_stream.h"

#include <algorithm>
#include <cerrno>
#include <cstddef>
#include <utility>

#include "tests/sensor/device/fake_kinect/bits.h"

namespace kino::fake {

PacketStream::PacketStream(PacketShape shape, Faults faults) : shape_(shape), faults_(faults) {}

PacketFate PacketStream::fate(int frame, int packet) const {
    const std::uint64_t random = mix(faults_.seed, shape_.family, static_cast<std::uint64_t>(frame),
                                     static_cast<std::uint64_t>(packet));
    double at = static_cast<double>(random >> 11) * 0x1p-53;
    const std::pair<double, PacketFate> shares[] = {{faults_.lost, PacketFate::lost},
                                                    {faults_.wrong_magic, PacketFate::wrong_magic},
                                                    {faults_.shortened, PacketFate::shortened},
                                                    {faults_.swapped, PacketFate::swapped},
                                                    {faults_.failed, PacketFate::failed}};
    for (const auto& [share, result] : shares) {
        if (at < share) return result;
        at -= share;
    }
    return PacketFate::sent;
}

void PacketStream::begin_frame(int number, std::uint32_t ticks,
                               std::span<const std::uint8_t> bytes) {
    const auto payload = static_cast<std::size_t>(shape_.payload);
    const std::size_t count = (bytes.size() + payload - 1) / payload;
    SentFrame sent{.number = number, .ticks = ticks, .packets = {}};
    std::optional<WirePacket> delayed;
    for (std::size_t i = 0; i < count; ++i) {
        const auto part = bytes.subspan(i * payload, std::min(payload, bytes.size() - i * payload));
        PacketFate what = fate(number, static_cast<int>(i));
        // The last packet of a frame has no follower to swap with.
        if (what == PacketFate::swapped && (i + 1 == count || delayed)) what = PacketFate::sent;
        SentPacket record{.fate = what, .bytes = static_cast<int>(part.size()), .intact = 0};

        WirePacket packet;
        const int place = i == 0 ? 1 : i + 1 == count ? 5 : 2;
        packet.bytes = {'R', 'B',         0, static_cast<std::uint8_t>(shape_.family | place),
                        0,   sequence_++, 0, 0};
        put_u32(packet.bytes, ticks);
        packet.bytes.insert(packet.bytes.end(), part.begin(), part.end());
        if (what == PacketFate::wrong_magic) packet.bytes[0] = 0;
        if (what == PacketFate::shortened) {
            const auto keep = mix(faults_.seed, i, ticks) % part.size();
            packet.bytes.resize(12 + static_cast<std::size_t>(keep));
            record.intact = static_cast<int>(keep);
        }
        if (what == PacketFate::sent || what == PacketFate::swapped) record.intact = record.bytes;
        sent.packets.push_back(record);
        if (what == PacketFate::failed) packet = {.bytes = {}, .status = -EXDEV};
        if (what == PacketFate::swapped) {
            delayed = std::move(packet);
            continue;
        }
        if (what != PacketFate::lost) waiting_.push_back(std::move(packet));
        if (delayed) {
            waiting_.push_back(std::move(*delayed));
            delayed.reset();
        }
    }
    frames_.push_back(std::move(sent));
}

std::optional<WirePacket> PacketStream::next() {
    if (waiting_.empty()) return std::nullopt;
    WirePacket packet = std::move(waiting_.front());
    waiting_.pop_front();
    return packet;
}

}  // namespace kino::fake
