#include "sensor/kinect1/camera_commands.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <string>
#include <thread>

#include "base/check.h"

namespace kino::kinect1 {
namespace {

using usb::Failure;
using usb::fault;
using usb::Outcome;
using Clock = std::chrono::steady_clock;
using Bytes = std::vector<std::uint8_t>;

constexpr std::size_t kHeaderBytes = 8;
constexpr std::size_t kLongestReply = 0x200;
constexpr std::chrono::milliseconds kPollPause{1};

std::uint16_t u16_le(const std::uint8_t* p) {
    return static_cast<std::uint16_t>(p[0] | p[1] << 8);
}

void append(Bytes& bytes, std::uint16_t word) {
    bytes.push_back(static_cast<std::uint8_t>(word & 0xFF));
    bytes.push_back(static_cast<std::uint8_t>(word >> 8));
}

std::string command_name(Command command, std::span<const std::uint16_t> words) {
    const unsigned first = words.empty() ? 0 : words[0];
    switch (command) {
        case Command::read_register:
            return fmt::format("reading camera register 0x{:x}", first);
        case Command::write_register:
            return fmt::format("writing camera register 0x{:x}", first);
        case Command::fixed_parameters:
            return "reading the zero plane";
        case Command::algorithm_parameters:
            return fmt::format("reading calibration block 0x{:x}", first);
        case Command::color_sensor:
            return fmt::format("register 0x{:x} of the colour sensor", words[1] & 0x7FFFu);
    }
    return "camera command";
}

// Whatever can pass by itself is worth another attempt.
bool is_final(Failure failure) {
    return failure == Failure::no_device || failure == Failure::no_permission ||
           failure == Failure::not_found || failure == Failure::unsupported;
}

}  // namespace

const char* describe(ReplyFlaw flaw) {
    switch (flaw) {
        case ReplyFlaw::none:
            return "sound";
        case ReplyFlaw::too_short:
            return "too short";
        case ReplyFlaw::magic:
            return "without its mark";
        case ReplyFlaw::command:
            return "for another command";
        case ReplyFlaw::tag:
            return "for an earlier command";
        case ReplyFlaw::length:
            return "of another length than it says";
    }
    return "flawed";
}

ParsedReply parse_reply(std::span<const std::uint8_t> reply, Command command, std::uint16_t tag) {
    if (reply.size() < kHeaderBytes) return {ReplyFlaw::too_short, {}};
    if (reply[0] != 'R' || reply[1] != 'B') return {ReplyFlaw::magic, {}};
    if (u16_le(&reply[6]) != tag) return {ReplyFlaw::tag, {}};
    if (u16_le(&reply[4]) != static_cast<std::uint16_t>(command)) return {ReplyFlaw::command, {}};
    const auto data = reply.subspan(kHeaderBytes);
    if (data.size() % 2 != 0 || u16_le(&reply[2]) != data.size() / 2) {
        return {ReplyFlaw::length, {}};
    }
    return {ReplyFlaw::none, data};
}

CameraCommands::CameraCommands(usb::Handle& camera, CommandPatience patience)
    : camera_(camera), patience_(patience) {}

Outcome<Bytes> CameraCommands::attempt(Command command, std::span<const std::uint16_t> words,
                                       const CommandPatience& patience) {
    const std::uint16_t tag = tag_++;
    Bytes out = {'G', 'M'};
    append(out, static_cast<std::uint16_t>(words.size()));
    append(out, static_cast<std::uint16_t>(command));
    append(out, tag);
    for (const std::uint16_t word : words) append(out, word);
    if (auto sent = camera_.control_out({}, out, patience.transfer); !sent) {
        return tl::unexpected(std::move(sent).error());
    }
    const auto deadline = Clock::now() + patience.answer;
    ReplyFlaw last_flaw = ReplyFlaw::none;
    std::array<std::uint8_t, kLongestReply> buffer{};
    do {
        auto got = camera_.control_in({}, buffer, patience.transfer);
        if (!got) {
            // A reply that is not there yet may also be refused or time out.
            if (is_final(got.error().kind)) return tl::unexpected(std::move(got).error());
            if (Clock::now() + kPollPause >= deadline) {
                return tl::unexpected(std::move(got).error());
            }
        } else if (*got > 0) {
            const ParsedReply reply =
                parse_reply({buffer.data(), std::min(*got, buffer.size())}, command, tag);
            if (reply.flaw == ReplyFlaw::none) return Bytes(reply.data.begin(), reply.data.end());
            last_flaw = reply.flaw;
            // One with another tag is the late answer to a command that was given up; anything
            // else was meant as this one's answer.
            if (reply.flaw != ReplyFlaw::tag) break;
        }
        std::this_thread::sleep_for(kPollPause);
    } while (Clock::now() < deadline);
    if (last_flaw != ReplyFlaw::none) {
        return fault(Failure::io, fmt::format("the answer came back {}", describe(last_flaw)));
    }
    return fault(Failure::timeout, "the camera gave no answer");
}

Outcome<Bytes> CameraCommands::send_with(Command command, std::span<const std::uint16_t> words,
                                         const CommandPatience& patience) {
    const std::lock_guard lock(mutex_);
    const auto deadline = Clock::now() + patience.total;
    Outcome<Bytes> result;
    int attempts = 0;
    do {
        result = attempt(command, words, patience);
        ++attempts;
        if (result) return result;
    } while (!is_final(result.error().kind) && attempts < patience.attempts &&
             Clock::now() + patience.answer < deadline);
    return fault(result.error().kind,
                 fmt::format("{} failed in {} attempt{}: {}", command_name(command, words),
                             attempts, attempts == 1 ? "" : "s", result.error().what));
}

Outcome<Bytes> CameraCommands::send(Command command, std::span<const std::uint16_t> words) {
    return send_with(command, words, patience_);
}

Outcome<std::uint16_t> CameraCommands::read_register(std::uint16_t address) {
    const std::array words = {address};
    auto reply = send(Command::read_register, words);
    if (!reply) return tl::unexpected(std::move(reply).error());
    if (reply->size() < 4) {
        return fault(Failure::io,
                     fmt::format("reading camera register 0x{:x} gave {} bytes instead of 4",
                                 address, reply->size()));
    }
    return u16_le(reply->data() + 2);
}

Outcome<void> CameraCommands::write_register(std::uint16_t address, std::uint16_t value) {
    const std::array words = {address, value};
    auto reply = send(Command::write_register, words);
    if (!reply) return tl::unexpected(std::move(reply).error());
    return {};
}

Outcome<void> CameraCommands::write_register_once(std::uint16_t address, std::uint16_t value) {
    constexpr std::chrono::milliseconds kShort{100};
    const std::array words = {address, value};
    auto reply = send_with(Command::write_register, words, {kShort, kShort, kShort, 1});
    if (!reply) return tl::unexpected(std::move(reply).error());
    return {};
}

Outcome<std::uint16_t> CameraCommands::read_color_register(std::uint16_t address) {
    const std::array words = {std::uint16_t{1}, static_cast<std::uint16_t>(address & 0x7FFFu),
                              std::uint16_t{0}};
    auto reply = send(Command::color_sensor, words);
    if (!reply) return tl::unexpected(std::move(reply).error());
    if (reply->size() < 6) {
        return fault(Failure::io, fmt::format("register 0x{:x} of the colour sensor gave {} bytes "
                                              "instead of 6",
                                              address, reply->size()));
    }
    return u16_le(reply->data() + 4);
}

Outcome<void> CameraCommands::write_color_register(std::uint16_t address, std::uint16_t value) {
    const std::array words = {std::uint16_t{1}, static_cast<std::uint16_t>(address | 0x8000u),
                              value};
    auto reply = send(Command::color_sensor, words);
    if (!reply) return tl::unexpected(std::move(reply).error());
    return {};
}

}  // namespace kino::kinect1
