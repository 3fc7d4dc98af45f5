#include "fake_camera.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cstring>

#include "support/random.h"

namespace kino::test {
namespace {

using kinect1::Command;
using usb::Failure;

void put16(Bytes& out, unsigned value) {
    out.push_back(static_cast<std::uint8_t>(value & 0xFF));
    out.push_back(static_cast<std::uint8_t>(value >> 8 & 0xFF));
}
void put32(Bytes& out, std::uint32_t value) {
    put16(out, value & 0xFFFF);
    put16(out, value >> 16);
}
std::uint16_t get16(std::span<const std::uint8_t> bytes, std::size_t at) {
    return static_cast<std::uint16_t>(bytes[at] | bytes[at + 1] << 8);
}

}  // namespace

FakeCamera::FakeCamera() {
    registers_[0x15] = 30;
    color_registers_[0x106] = 0x708E | 1u << 14 | 1u << 1;
    set_block(Command::fixed_parameters, 0, zero_plane_block(7.5F, 2.3F, 120, 0.1042F));
    set_block(Command::algorithm_parameters, 0x40, real_registration_block());
    set_block(Command::algorithm_parameters, 0x41, Bytes(8));
    set_block(Command::algorithm_parameters, 0x00, {0, 0, 200, 0});
}

void FakeCamera::set_block(Command command, std::uint16_t id, Bytes data) {
    const std::lock_guard lock(mutex_);
    blocks_[{static_cast<std::uint16_t>(command), id}] = std::move(data);
}

void FakeCamera::spoil(std::deque<ReplySpoiler> next, ReplySpoiler for_ever) {
    const std::lock_guard lock(mutex_);
    spoilers_ = std::move(next);
    for_ever_ = for_ever;
}
void FakeCamera::fail_out(std::deque<Failure> next) {
    const std::lock_guard lock(mutex_);
    out_failures_ = std::move(next);
}
void FakeCamera::fail_in(std::deque<Failure> next) {
    const std::lock_guard lock(mutex_);
    in_failures_ = std::move(next);
}

Bytes FakeCamera::data_for(std::uint16_t command, std::span<const std::uint8_t> data) {
    Bytes out;
    switch (static_cast<Command>(command)) {
        case Command::read_register:
            put16(out, get16(data, 0));
            put16(out, registers_[get16(data, 0)]);
            break;
        case Command::write_register:
            registers_[get16(data, 0)] = get16(data, 2);
            writes_.emplace_back(get16(data, 0), get16(data, 2));
            put16(out, 0);
            break;
        case Command::color_sensor: {
            const unsigned address = get16(data, 2);
            if (address & 0x8000u) {
                color_registers_[static_cast<std::uint16_t>(address & 0x7FFF)] = get16(data, 4);
            }
            put16(out, 1);
            put16(out, address);
            put16(out, color_registers_[static_cast<std::uint16_t>(address & 0x7FFF)]);
            break;
        }
        default:
            out = blocks_[{command, get16(data, 0)}];
            break;
    }
    return out;
}

usb::Outcome<void> FakeCamera::take(std::span<const std::uint8_t> bytes) {
    const std::lock_guard lock(mutex_);
    if (!out_failures_.empty()) {
        const Failure failure = out_failures_.front();
        out_failures_.pop_front();
        return usb::fault(failure, std::string("out: ") + usb::describe(failure));
    }
    // A real camera stalls on what it does not understand.
    if (bytes.size() < 8 || bytes[0] != 'G' || bytes[1] != 'M' ||
        2u * get16(bytes, 2) != bytes.size() - 8) {
        return usb::fault(Failure::stall, "not a command");
    }
    const std::uint16_t command = get16(bytes, 4);
    const std::uint16_t tag = get16(bytes, 6);
    const Bytes data = data_for(command, bytes.subspan(8));

    ReplySpoiler spoiler = for_ever_;
    if (!spoilers_.empty()) {
        spoiler = spoilers_.front();
        spoilers_.pop_front();
    }
    Bytes reply = {'R', 'B'};
    put16(reply,
          static_cast<unsigned>(data.size() / 2) + (spoiler == ReplySpoiler::wrong_length ? 1 : 0));
    put16(reply, command + (spoiler == ReplySpoiler::wrong_command ? 1u : 0u));
    put16(reply, tag + (spoiler == ReplySpoiler::wrong_tag ? 77u : 0u));
    reply.insert(reply.end(), data.begin(), data.end());
    if (spoiler == ReplySpoiler::wrong_magic) reply[0] = 'X';
    if (spoiler == ReplySpoiler::odd_length) reply.push_back(0);
    if (spoiler == ReplySpoiler::cut_header) reply.resize(5);

    // Answers that nobody fetched are gone with the next command, but for the one wanted late.
    answers_.clear();
    if (spoiler == ReplySpoiler::empty_for_ever) return {};
    if (spoiler == ReplySpoiler::empty_thrice) answers_.assign(3, {});
    if (spoiler == ReplySpoiler::late_one_first) {
        Bytes earlier = reply;
        --earlier[6];
        answers_.push_back(std::move(earlier));
    }
    answers_.push_back(std::move(reply));
    return {};
}

usb::Outcome<std::size_t> FakeCamera::answer(std::span<std::uint8_t> bytes) {
    const std::lock_guard lock(mutex_);
    if (!in_failures_.empty()) {
        const Failure failure = in_failures_.front();
        in_failures_.pop_front();
        return usb::fault(failure, std::string("in: ") + usb::describe(failure));
    }
    if (answers_.empty()) return std::size_t{0};
    const Bytes reply = std::move(answers_.front());
    answers_.pop_front();
    const std::size_t n = std::min(bytes.size(), reply.size());
    std::copy_n(reply.begin(), n, bytes.begin());
    return n;
}

std::uint16_t FakeCamera::camera_register(std::uint16_t address) const {
    const std::lock_guard lock(mutex_);
    const auto found = registers_.find(address);
    return found == registers_.end() ? std::uint16_t{0} : found->second;
}
std::uint16_t FakeCamera::color_register(std::uint16_t address) const {
    const std::lock_guard lock(mutex_);
    const auto found = color_registers_.find(address);
    return found == color_registers_.end() ? std::uint16_t{0} : found->second;
}
std::vector<std::pair<int, int>> FakeCamera::writes() const {
    const std::lock_guard lock(mutex_);
    return writes_;
}

std::vector<Bytes> packets_of(kinect1::CameraMode mode, std::span<const std::uint8_t> frame,
                              std::uint8_t& sequence, std::uint32_t first_ticks) {
    constexpr std::uint32_t kTicksPerPacket = 7500;
    const bool depth = kinect1::traits(mode).endpoint == 0x82;
    const std::size_t payload = depth ? 1748 : 1908;
    const unsigned base = depth ? 0x70 : 0x80;
    std::vector<Bytes> out;
    for (std::size_t at = 0; at < frame.size(); at += payload) {
        const std::size_t end = std::min(at + payload, frame.size());
        const unsigned part = at == 0 ? 1 : end == frame.size() ? 5 : 2;
        Bytes packet = {'R', 'B', 0, static_cast<std::uint8_t>(base | part), 0, sequence++, 0, 0};
        put32(packet, first_ticks + static_cast<std::uint32_t>(out.size()) * kTicksPerPacket);
        packet.insert(packet.end(), frame.begin() + static_cast<std::ptrdiff_t>(at),
                      frame.begin() + static_cast<std::ptrdiff_t>(end));
        out.push_back(std::move(packet));
    }
    return out;
}

Bytes random_frame(kinect1::CameraMode mode, std::uint64_t seed) {
    Random random(seed);
    Bytes out(static_cast<std::size_t>(kinect1::packet_layout(mode).frame_bytes));
    for (std::size_t i = 0; i < out.size(); i += 8) {
        const std::uint64_t bits = random.bits();
        std::memcpy(out.data() + i, &bits, std::min<std::size_t>(8, out.size() - i));
    }
    return out;
}

Bytes real_registration_block() {
    // The numbers that libfreenect's registration.c carried as those of its author's unit.
    constexpr std::array<std::int32_t, 29> kWords = {
        2048330528, 1964,    56,        -26,   600,      6161,      -13,       2825,
        684,        5,       6434,      10062, 130801,   0,         0,         170,
        136,        2095986, 890,       763,   2096378,  134215474, 134217093, 134216989,
        134216925,  0,       134216984, 0,     134214659};
    Bytes out;
    put16(out, 0);
    for (const std::int32_t word : kWords) put32(out, static_cast<std::uint32_t>(word));
    return out;
}

Bytes zero_plane_block(float emitter, float color, float reference, float pixel) {
    Bytes out(94);
    for (const float value : {emitter, color, reference, pixel}) {
        put32(out, std::bit_cast<std::uint32_t>(value));
    }
    out.resize(322);
    return out;
}

}  // namespace kino::test
