#pragma once

#include <cstdint>
#include <deque>
#include <map>
#include <mutex>
#include <span>
#include <utility>
#include <vector>

#include "sensor/kinect1/camera_mode.h"
#include "sensor/kinect1/usb.h"

namespace kino::test {

using Bytes = std::vector<std::uint8_t>;

/// How the camera spoils the answer to one command.
enum class ReplySpoiler : std::uint8_t {
    none,
    wrong_magic,
    wrong_command,
    wrong_tag,
    wrong_length,
    odd_length,
    cut_header,    ///< 5 bytes
    empty_thrice,  ///< three empty answers, then the right one
    empty_for_ever,
    late_one_first  ///< an earlier command's answer comes before the right one
};

/// The control protocol of a Kinect's camera, byte for byte: registers, calibration blocks,
/// replies. Thread-safe.
class FakeCamera {
  public:
    FakeCamera();

    usb::Outcome<void> take(std::span<const std::uint8_t> bytes);
    usb::Outcome<std::size_t> answer(std::span<std::uint8_t> bytes);

    /// The next commands' answers are spoilt like this, then `for_ever`.
    void spoil(std::deque<ReplySpoiler> next, ReplySpoiler for_ever = ReplySpoiler::none);
    /// The next transfers out, and in, fail like this.
    void fail_out(std::deque<usb::Failure> next);
    void fail_in(std::deque<usb::Failure> next);
    /// Data of the reply to a command, or to an algorithm parameter's id.
    void set_block(kinect1::Command command, std::uint16_t id, Bytes data);

    [[nodiscard]] std::uint16_t camera_register(std::uint16_t address) const;
    [[nodiscard]] std::uint16_t color_register(std::uint16_t address) const;
    /// (address, value) of all registers written, in order.
    [[nodiscard]] std::vector<std::pair<int, int>> writes() const;

  private:
    [[nodiscard]] Bytes data_for(std::uint16_t command, std::span<const std::uint8_t> data);

    mutable std::mutex mutex_;
    std::map<std::uint16_t, std::uint16_t> registers_;
    std::map<std::uint16_t, std::uint16_t> color_registers_;
    std::map<std::pair<std::uint16_t, std::uint16_t>, Bytes> blocks_;
    std::vector<std::pair<int, int>> writes_;
    std::deque<Bytes> answers_;
    std::deque<ReplySpoiler> spoilers_;
    ReplySpoiler for_ever_ = ReplySpoiler::none;
    std::deque<usb::Failure> out_failures_;
    std::deque<usb::Failure> in_failures_;
};

/// A frame's bytes as the camera cuts them into packets. `sequence` runs on; each packet's stamp
/// is 125 us after the one before.
[[nodiscard]] std::vector<Bytes> packets_of(kinect1::CameraMode mode,
                                            std::span<const std::uint8_t> frame,
                                            std::uint8_t& sequence, std::uint32_t first_ticks);

/// Random bytes of the mode's frame size.
[[nodiscard]] Bytes random_frame(kinect1::CameraMode mode, std::uint64_t seed);

/// The factory's data of a real unit: registration of the one published with libfreenect.
[[nodiscard]] Bytes real_registration_block();
[[nodiscard]] Bytes zero_plane_block(float emitter, float color, float reference, float pixel);

}  // namespace kino::test
