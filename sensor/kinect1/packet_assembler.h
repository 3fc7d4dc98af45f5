#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "base/time.h"

namespace kino::kinect1 {

/// Bytes [first, end) of a frame.
struct ByteRange {
    int first = 0;
    int end = 0;
    friend bool operator==(const ByteRange&, const ByteRange&) = default;
};

/// How one endpoint cuts its frames into packets (OpenKinect protocol documentation; libfreenect
/// cameras.c): every packet starts with 12 bytes {'R', 'B', 0, flag, ?, sequence, ?, ?, u32 LE
/// device time}; flag is base|1 for a frame's first packet, base|2 within and base|5 for the last.
struct PacketLayout {
    std::uint8_t flag_base = 0;       ///< 0x70 depth, 0x80 colour and infrared
    int payload_bytes = 0;            ///< of every packet but the last: 1748 or 1908
    int frame_bytes = 0;              ///< at least two packets
    std::uint32_t longest_frame = 0;  ///< ticks from a frame's first packet to its last
    [[nodiscard]] int packets() const { return (frame_bytes + payload_bytes - 1) / payload_bytes; }
};
constexpr int kPacketHeaderBytes = 12;

struct AssembledFrame {
    std::span<const std::uint8_t> bytes;  ///< frame_bytes long; missing ones are 0
    std::span<const ByteRange> missing;   ///< rising, apart
    std::uint32_t ticks = 0;              ///< device time of the frame's last packet that came
    TimeNs arrival_host = 0;              ///< when that one came
    std::int64_t lost_before = 0;         ///< frames missing between this and the one before
};

/// Running totals, for a person.
struct PacketCounts {
    std::int64_t packets = 0;         ///< well-formed, in place
    std::int64_t lost = 0;            ///< by the sequence numbers
    std::int64_t malformed = 0;       ///< bad magic, unknown flag, too short, too long
    std::int64_t duplicates = 0;      ///< or too late to be of use
    std::int64_t frames = 0;          ///< handed on
    std::int64_t damaged_frames = 0;  ///< of those, with bytes missing
    std::int64_t dropped_frames = 0;  ///< not handed on
    std::int64_t resyncs = 0;         ///< times when everything up to the next start was skipped
};

/// Packets of one endpoint to frames. What it promises whatever gets lost: a byte of a frame is
/// either what the device sent for that place of that very frame, or listed as missing. (The one
/// exception the 8-bit sequence leaves: exactly 256 packets in a row, or twice as many, and later
/// in the same frame just those few whose flags would show it.)
///
/// A packet's place follows from the 8-bit sequence numbers, which run on across frames. Frames
/// are handed on at their last packet, or at the first one of the next. A frame is dropped, and
/// counted in the next one's lost_before, if its first packet did not come, if more than a quarter
/// of its bytes is missing, or if its place in the sequence turns out wrong: a flag that does not
/// fit, or packets further apart in device time than a frame is long, mean that the 8 bits wrapped
/// unseen, and everything up to the next first packet is skipped. Frames of which no packet at all
/// arrived during such a skip cannot be counted. Packets up to kLateWindow places late fill their
/// gap.
class PacketAssembler {
  public:
    static constexpr int kLateWindow = 3;
    using Deliver = std::function<void(const AssembledFrame&)>;

    PacketAssembler(const PacketLayout& layout, Deliver deliver);

    /// One packet with its header. Empty ones are ignored.
    void feed(std::span<const std::uint8_t> packet, TimeNs arrival_host);
    [[nodiscard]] const PacketCounts& counts() const { return counts_; }

  private:
    enum class Part : std::uint8_t { first = 1, middle = 2, last = 5 };
    struct Header {
        Part part = Part::middle;
        std::uint8_t sequence = 0;
        std::uint32_t ticks = 0;
    };

    [[nodiscard]] Part part_at(int index) const;
    [[nodiscard]] int payload_at(int index) const;
    [[nodiscard]] bool within_frame(const Header& header) const;
    void place(int index, const Header& header, std::span<const std::uint8_t> payload,
               TimeNs arrival_host);
    void place_late(int steps_back, const Header& header, std::span<const std::uint8_t> payload,
                    TimeNs arrival_host);
    void close_frame();
    void lose_position(const Header& header, std::span<const std::uint8_t> payload,
                       TimeNs arrival_host);
    [[nodiscard]] int collect_missing();

    PacketLayout layout_;
    Deliver deliver_;
    std::vector<std::uint8_t> bytes_;
    std::vector<int> received_;       // payload bytes by packet, -1 for none
    std::vector<ByteRange> missing_;  // of the frame being handed on

    bool located_ = false;    // next_index_ and next_sequence_ mean something
    bool recording_ = false;  // the current frame has its first packet
    int next_index_ = 0;
    std::uint8_t next_sequence_ = 0;
    std::uint32_t first_ticks_ = 0;
    std::uint32_t ticks_ = 0;
    TimeNs arrival_host_ = 0;
    std::int64_t lost_before_ = 0;
    bool started_ = false;   // a first packet has been seen
    bool end_seen_ = false;  // while not located: a frame's end has passed
    PacketCounts counts_;
};

}  // namespace kino::kinect1
