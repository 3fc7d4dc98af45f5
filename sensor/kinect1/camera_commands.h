#pragma once

#include <chrono>
#include <cstdint>
#include <mutex>
#include <span>
#include <vector>

#include "sensor/kinect1/usb.h"

namespace kino::kinect1 {

/// Commands of the camera (OpenKinect protocol documentation; libfreenect cameras.c, flags.c).
enum class Command : std::uint16_t {
    read_register = 0x02,
    write_register = 0x03,
    fixed_parameters = 0x04,
    algorithm_parameters = 0x16,
    color_sensor = 0x95  ///< registers of the colour sensor itself
};

enum class ReplyFlaw : std::uint8_t { none, too_short, magic, command, tag, length };
[[nodiscard]] const char* describe(ReplyFlaw flaw);

struct ParsedReply {
    ReplyFlaw flaw = ReplyFlaw::none;
    std::span<const std::uint8_t> data;  ///< within the reply; empty if there is a flaw
};
/// Reply: {'R', 'B', u16 words, u16 command, u16 tag}, then as many words; all little-endian.
[[nodiscard]] ParsedReply parse_reply(std::span<const std::uint8_t> reply, Command command,
                                      std::uint16_t tag);

/// How long a command may take and how often it is sent anew.
struct CommandPatience {
    std::chrono::milliseconds transfer{200};  ///< each USB transfer
    std::chrono::milliseconds answer{250};    ///< polling for the reply of one attempt
    std::chrono::milliseconds total{900};     ///< everything; no attempt starts after it
    int attempts = 3;
};

/// Sends {'G', 'M', u16 words, u16 command, u16 tag} + data and polls for the reply with the same
/// command and tag. Replies that belong to an earlier command are passed over; a flawed one, a
/// refused or timed-out transfer or endless empty replies lead to another attempt with a new tag.
/// Thread-safe: one command at a time.
class CameraCommands {
  public:
    explicit CameraCommands(usb::Handle& camera, CommandPatience patience = {});

    [[nodiscard]] usb::Outcome<std::vector<std::uint8_t>> send(
        Command command, std::span<const std::uint16_t> words);
    [[nodiscard]] usb::Outcome<std::uint16_t> read_register(std::uint16_t address);
    [[nodiscard]] usb::Outcome<void> write_register(std::uint16_t address, std::uint16_t value);
    /// Registers of the colour sensor; not while it is off.
    [[nodiscard]] usb::Outcome<std::uint16_t> read_color_register(std::uint16_t address);
    [[nodiscard]] usb::Outcome<void> write_color_register(std::uint16_t address,
                                                          std::uint16_t value);
    /// One attempt, done with in at most a quarter of a second: for switching off.
    [[nodiscard]] usb::Outcome<void> write_register_once(std::uint16_t address,
                                                         std::uint16_t value);

  private:
    [[nodiscard]] usb::Outcome<std::vector<std::uint8_t>> send_with(
        Command command, std::span<const std::uint16_t> words, const CommandPatience& patience);
    [[nodiscard]] usb::Outcome<std::vector<std::uint8_t>> attempt(
        Command command, std::span<const std::uint16_t> words, const CommandPatience& patience);

    usb::Handle& camera_;
    CommandPatience patience_;
    std::mutex mutex_;
    std::uint16_t tag_ = 0;
};

}  // namespace kino::kinect1
