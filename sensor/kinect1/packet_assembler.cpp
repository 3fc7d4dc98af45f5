#include "sensor/kinect1/packet_assembler.h"

#include <algorithm>
#include <cstring>
#include <utility>

#include "base/check.h"

namespace kino::kinect1 {
namespace {

std::uint32_t u32_le(const std::uint8_t* p) {
    return static_cast<std::uint32_t>(p[0]) | static_cast<std::uint32_t>(p[1]) << 8 |
           static_cast<std::uint32_t>(p[2]) << 16 | static_cast<std::uint32_t>(p[3]) << 24;
}

}  // namespace

PacketAssembler::PacketAssembler(const PacketLayout& layout, Deliver deliver)
    : layout_(layout),
      deliver_(std::move(deliver)),
      bytes_(static_cast<std::size_t>(layout.frame_bytes)),
      received_(static_cast<std::size_t>(layout.packets()), -1) {
    KINO_CHECK(layout.payload_bytes > 0 && layout.packets() >= 2);
}

PacketAssembler::Part PacketAssembler::part_at(int index) const {
    if (index == 0) return Part::first;
    return index == layout_.packets() - 1 ? Part::last : Part::middle;
}

int PacketAssembler::payload_at(int index) const {
    return std::min(layout_.payload_bytes, layout_.frame_bytes - index * layout_.payload_bytes);
}

bool PacketAssembler::within_frame(const Header& header) const {
    return header.ticks - first_ticks_ <= layout_.longest_frame;
}

void PacketAssembler::feed(std::span<const std::uint8_t> packet, TimeNs arrival_host) {
    if (packet.empty()) return;
    if (packet.size() <= kPacketHeaderBytes || packet[0] != 'R' || packet[1] != 'B') {
        ++counts_.malformed;
        return;
    }
    const int part = packet[3] - layout_.flag_base;
    const auto payload = packet.subspan(kPacketHeaderBytes);
    if ((part != 1 && part != 2 && part != 5) ||
        payload.size() > static_cast<std::size_t>(layout_.payload_bytes)) {
        ++counts_.malformed;
        return;
    }
    const Header header{static_cast<Part>(part), packet[5], u32_le(packet.data() + 8)};

    if (!located_) {
        if (header.part == Part::first) {
            located_ = true;
            started_ = true;
            next_index_ = 0;
            next_sequence_ = header.sequence;
        } else {
            // The first end may belong to the frame that was counted when the position was lost.
            if (started_ && header.part == Part::last && std::exchange(end_seen_, true)) {
                ++counts_.dropped_frames;
                ++lost_before_;
            }
            return;
        }
    }

    const auto ahead = static_cast<std::uint8_t>(header.sequence - next_sequence_);
    if (ahead >= 256 - kLateWindow) {
        place_late(256 - ahead, header, payload, arrival_host);
        return;
    }
    const int packets = layout_.packets();
    const int index = (next_index_ + ahead) % packets;
    const int borders = (next_index_ + ahead) / packets;
    const bool far_off = ahead > 0 && borders == 0 && recording_ && !within_frame(header);
    if (header.part != part_at(index) || far_off) {
        lose_position(header, payload, arrival_host);
        return;
    }
    counts_.lost += ahead;
    for (int i = 0; i < borders; ++i) close_frame();
    place(index, header, payload, arrival_host);
}

void PacketAssembler::place(int index, const Header& header, std::span<const std::uint8_t> payload,
                            TimeNs arrival_host) {
    if (index == 0) {
        recording_ = true;
        first_ticks_ = header.ticks;
    }
    if (payload.size() > static_cast<std::size_t>(payload_at(index))) {
        ++counts_.malformed;  // it keeps its place, but what is in it cannot be trusted
    } else {
        ++counts_.packets;
        received_[static_cast<std::size_t>(index)] = static_cast<int>(payload.size());
        std::memcpy(bytes_.data() + index * layout_.payload_bytes, payload.data(), payload.size());
    }
    ticks_ = header.ticks;
    arrival_host_ = arrival_host;
    next_sequence_ = static_cast<std::uint8_t>(header.sequence + 1);
    next_index_ = index + 1;
    if (next_index_ == layout_.packets()) {
        close_frame();
        next_index_ = 0;
    }
}

void PacketAssembler::place_late(int steps_back, const Header& header,
                                 std::span<const std::uint8_t> payload, TimeNs arrival_host) {
    const int index = next_index_ - steps_back;
    const bool this_frame = index >= 0;
    if (header.part != part_at(this_frame ? index : index + layout_.packets())) {
        lose_position(header, payload, arrival_host);
        return;
    }
    if (!this_frame || !recording_ || received_[static_cast<std::size_t>(index)] >= 0 ||
        !within_frame(header) || payload.size() > static_cast<std::size_t>(payload_at(index))) {
        ++counts_.duplicates;
        return;
    }
    ++counts_.packets;
    --counts_.lost;
    received_[static_cast<std::size_t>(index)] = static_cast<int>(payload.size());
    std::memcpy(bytes_.data() + index * layout_.payload_bytes, payload.data(), payload.size());
}

// What has been placed so far may be in the wrong place: none of it is handed on.
void PacketAssembler::lose_position(const Header& header, std::span<const std::uint8_t> payload,
                                    TimeNs arrival_host) {
    ++counts_.resyncs;
    ++counts_.dropped_frames;
    ++lost_before_;
    recording_ = false;
    std::fill(received_.begin(), received_.end(), -1);
    located_ = header.part == Part::first;
    end_seen_ = false;
    if (located_) place(0, header, payload, arrival_host);
}

int PacketAssembler::collect_missing() {
    missing_.clear();
    int total = 0;
    for (int i = 0; i < layout_.packets(); ++i) {
        const int got = std::max(received_[static_cast<std::size_t>(i)], 0);
        const ByteRange hole{i * layout_.payload_bytes + got,
                             i * layout_.payload_bytes + payload_at(i)};
        if (hole.first == hole.end) continue;
        total += hole.end - hole.first;
        if (!missing_.empty() && missing_.back().end == hole.first) {
            missing_.back().end = hole.end;
        } else {
            missing_.push_back(hole);
        }
    }
    return total;
}

void PacketAssembler::close_frame() {
    const bool complete_enough = recording_ && collect_missing() <= layout_.frame_bytes / 4;
    recording_ = false;
    if (!complete_enough) {
        ++counts_.dropped_frames;
        ++lost_before_;
    } else {
        for (const ByteRange& hole : missing_) {
            std::fill(bytes_.begin() + hole.first, bytes_.begin() + hole.end, std::uint8_t{0});
        }
        ++counts_.frames;
        counts_.damaged_frames += missing_.empty() ? 0 : 1;
        deliver_({bytes_, missing_, ticks_, arrival_host_, std::exchange(lost_before_, 0)});
    }
    std::fill(received_.begin(), received_.end(), -1);
}

}  // namespace kino::kinect1
