#pragma once

#include <cstdint>
#include <deque>
#include <functional>
#include <optional>
#include <span>
#include <vector>

namespace kino::fake {

/// What goes wrong on the wire, each as the share of packets it befalls (0 .. 1). The same seed
/// strikes the same packets of the same frames.
struct Faults {
    std::uint64_t seed = 1;
    double lost = 0;         ///< never sent, but counted
    double wrong_magic = 0;  ///< sent without the two letters at its front
    double shortened = 0;    ///< sent with its end missing
    double swapped = 0;      ///< sent after its follower
    double failed = 0;       ///< an error and no bytes from the host controller
    /// No packet at all of frames [stall_at, stall_at + 1) for stall_ms; -1: never.
    int stall_at = -1;
    int stall_ms = 0;
};

enum class PacketFate : std::uint8_t { sent, lost, wrong_magic, shortened, swapped, failed };

/// What truly happened to a packet.
struct SentPacket {
    PacketFate fate = PacketFate::sent;
    int bytes = 0;   ///< of the frame, in it as it should have been
    int intact = 0;  ///< of these, from its front on, what a host can make use of
};

/// What truly happened to a frame.
struct SentFrame {
    int number = 0;           ///< of the feed
    std::uint32_t ticks = 0;  ///< device time in its packets
    std::vector<SentPacket> packets;
};

/// How a stream is cut: `payload` bytes a packet, header flags `family` | 1, 2, 5.
struct PacketShape {
    int payload = 1748;
    std::uint8_t family = 0x70;
};

/// A packet on its way to the host; an error has no bytes.
struct WirePacket {
    std::vector<std::uint8_t> bytes;
    int status = 0;  ///< negative errno
};

/// Cuts frames into packets and spoils some. Not thread-safe.
class PacketStream {
  public:
    PacketStream(PacketShape shape, Faults faults);

    /// The stream is idle: another frame may begin.
    [[nodiscard]] bool between_frames() const { return waiting_.empty(); }
    void begin_frame(int number, std::uint32_t ticks, std::span<const std::uint8_t> bytes);
    /// Forgets what was not sent: the stream was switched off.
    void drop() { waiting_.clear(); }
    /// The next packet, or none between frames.
    [[nodiscard]] std::optional<WirePacket> next();
    [[nodiscard]] const std::vector<SentFrame>& frames() const { return frames_; }

  private:
    [[nodiscard]] PacketFate fate(int frame, int packet) const;

    PacketShape shape_;
    Faults faults_;
    std::uint8_t sequence_ = 0x5a;
    std::deque<WirePacket> waiting_;
    std::vector<SentFrame> frames_;
};

}  // namespace kino::fake
