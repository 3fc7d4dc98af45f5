#include "tests/sensor/device/fake_kinect/camera.h"

#include <algorithm>
#include <bit>
#include <utility>

#include "tests/sensor/device/fake_kinect/bits.h"

namespace kino::fake {
namespace {

constexpr std::uint16_t kVideoSwitch = 0x05;
constexpr std::uint16_t kDepthSwitch = 0x06;
constexpr std::uint16_t kColorFormat = 0x0c;
constexpr std::uint16_t kColorResolution = 0x0d;
constexpr std::uint16_t kDepthFormat = 0x12;
constexpr std::uint16_t kInfraredResolution = 0x1a;
constexpr std::size_t kHeaderBytes = 8;

void put_float(std::vector<std::uint8_t>& bytes, std::size_t offset, float value) {
    const auto word = std::bit_cast<std::uint32_t>(value);
    for (std::size_t i = 0; i < 4; ++i)
        bytes[offset + i] = static_cast<std::uint8_t>(word >> (8 * i));
}

std::vector<std::uint8_t> fixed_parameters(const FactoryTables& tables) {
    std::vector<std::uint8_t> bytes(322);
    put_float(bytes, 94, tables.emitter_cm);
    put_float(bytes, 98, tables.color_camera_cm);
    put_float(bytes, 102, tables.reference_cm);
    put_float(bytes, 106, tables.pixel_mm);
    return bytes;
}

std::vector<std::uint8_t> algorithm_parameters(const FactoryTables& tables, std::uint16_t which) {
    std::vector<std::uint8_t> bytes = {0, 0};
    switch (which) {
        case 0x00:
            put_u16(bytes, tables.const_shift);
            break;
        case 0x40:
            for (const std::int32_t number : tables.registration) {
                put_u32(bytes, static_cast<std::uint32_t>(number));
            }
            break;
        case 0x41:
            bytes.resize(8);
            break;
        default:
            break;
    }
    return bytes;
}

}  // namespace

FactoryTables plausible_tables() {
    FactoryTables tables;
    // Only small numbers: a nearly straight mapping with a slight rotation and curvature.
    tables.registration = {0,  0,  0, 0,  0, 2500, 0, 0, 0, 0, -1800, 16000, 16300, 0, 0,
                           12, -9, 3, -2, 1, 4,    0, 0, 0, 0, 0,     0,     0,     0};
    return tables;
}

Camera::Camera(std::shared_ptr<const Feed> feed, CameraOptions options)
    : feed_(std::move(feed)),
      options_(std::move(options)),
      identity_{.product = options_.product,
                .release = options_.release,
                .maker = "Microsoft",
                .name = "Xbox NUI Camera",
                .serial = options_.serial,
                .iso_endpoints = {0x81, 0x82}},
      switched_on_(Clock::now()),
      depth_{.packets = PacketStream({.payload = 1748, .family = 0x70}, options_.faults),
             .hz = options_.depth_hz,
             .stall_at = options_.faults.stall_at,
             .stall_ms = options_.faults.stall_ms},
      video_{.packets = PacketStream({.payload = 1908, .family = 0x80}, options_.faults),
             .hz = options_.video_hz} {}

Camera::Stream& Camera::stream_of(int endpoint) {
    return endpoint == 2 ? depth_ : video_;
}
const Camera::Stream& Camera::stream_of(int endpoint) const {
    return endpoint == 2 ? depth_ : video_;
}

VideoMode Camera::video_mode() const {
    const auto value = [&](std::uint16_t address) {
        const auto found = registers_.find(address);
        return found == registers_.end() ? 0 : found->second;
    };
    switch (value(kVideoSwitch)) {
        case 1:
            if (value(kColorFormat) == 5) return VideoMode::uyvy;
            return value(kColorResolution) == 2 ? VideoMode::bayer_large : VideoMode::bayer;
        case 3:
            return value(kInfraredResolution) == 2 ? VideoMode::infrared_large
                                                   : VideoMode::infrared;
        default:
            return VideoMode::off;
    }
}

std::vector<std::uint8_t> Camera::frame_bytes(int endpoint, int number) const {
    if (endpoint == 2) {
        auto depth = feed_->depth(number);
        const auto format = registers_.find(kDepthFormat);
        if (format != registers_.end() && format->second == 2) {
            for (auto& value : depth) value = static_cast<std::uint16_t>(value >> 1);
            return pack_bits(depth, 10);
        }
        return pack_bits(depth, 11);
    }
    switch (video_mode()) {
        case VideoMode::bayer:
            return feed_->bayer(number, 640, 480);
        case VideoMode::bayer_large:
            return feed_->bayer(number, 1280, 1024);
        case VideoMode::uyvy:
            return feed_->uyvy(number);
        case VideoMode::infrared:
            return pack_bits(feed_->infrared(number, 640, 488), 10);
        case VideoMode::infrared_large:
            return pack_bits(feed_->infrared(number, 1280, 1024), 10);
        case VideoMode::off:
            break;
    }
    return {};
}

void Camera::switch_stream(Stream& stream, bool on) {
    if (!on) stream.packets.drop();
    if (on && !stream.on) stream.next_start = Clock::now();
    stream.on = on;
}

void Camera::write_register(std::uint16_t address, std::uint16_t value) {
    registers_[address] = value;
    if (address == kDepthSwitch) switch_stream(depth_, value == 2);
    if (address == kVideoSwitch) switch_stream(video_, value != 0);
}

std::vector<std::uint8_t> Camera::obey(std::uint16_t command, std::span<const std::uint8_t> data) {
    const auto word = [&](std::size_t i) {
        return 2 * i + 1 < data.size() ? get_u16(data, 2 * i) : std::uint16_t{0};
    };
    std::vector<std::uint8_t> reply;
    switch (command) {
        case 0x02:
            put_u16(reply, word(0));
            put_u16(reply, registers_[word(0)]);
            return reply;
        case 0x03:
            write_register(word(0), word(1));
            return {0, 0};
        case 0x04:
            return fixed_parameters(options_.tables);
        case 0x16:
            return algorithm_parameters(options_.tables, word(0));
        case 0x95: {
            const std::uint16_t address = word(1) & 0x7fff;
            if ((word(1) & 0x8000) != 0) cmos_[address] = word(2);
            put_u16(reply, 0);
            put_u16(reply, word(1));
            put_u16(reply, cmos_[address]);
            return reply;
        }
        default:
            ++bad_commands_;
            return {};
    }
}

Answer Camera::vendor_request(const Setup& setup, std::span<const std::uint8_t> out) {
    const std::scoped_lock lock(mutex_);
    if (setup.request != 0) return stalled();
    if (setup.in()) {
        if (replies_.empty()) return {};
        Answer answer{.status = 0, .bytes = std::move(replies_.front())};
        replies_.pop_front();
        answer.bytes.resize(std::min<std::size_t>(answer.bytes.size(), setup.length));
        return answer;
    }
    if (out.size() < kHeaderBytes || out[0] != 'G' || out[1] != 'M' ||
        kHeaderBytes + 2u * get_u16(out, 2) != out.size()) {
        ++bad_commands_;
        return stalled();
    }
    const auto data = obey(get_u16(out, 4), out.subspan(kHeaderBytes));
    std::vector<std::uint8_t> reply = {'R', 'B'};
    put_u16(reply, static_cast<unsigned>(data.size() / 2));
    put_u16(reply, get_u16(out, 4));
    put_u16(reply, get_u16(out, 6));
    reply.insert(reply.end(), data.begin(), data.end());
    // A command whose predecessor's reply was never fetched replaces it.
    replies_.clear();
    ++replies_made_;
    if (options_.busy_every > 0 && replies_made_ % options_.busy_every == 0)
        replies_.emplace_back();
    replies_.push_back(std::move(reply));
    return {};
}

std::optional<WirePacket> Camera::next_packet(int endpoint, Clock::time_point now) {
    const std::scoped_lock lock(mutex_);
    Stream& stream = stream_of(endpoint);
    if (stream.on && stream.packets.between_frames() && now >= stream.next_start &&
        (options_.frames < 0 || stream.next_frame < options_.frames)) {
        if (stream.next_frame == stream.stall_at) {
            stream.stall_at = -1;
            stream.next_start = now + std::chrono::milliseconds(stream.stall_ms);
            return std::nullopt;
        }
        const auto elapsed = std::chrono::duration<double>(now - switched_on_).count();
        const auto ticks = static_cast<std::uint64_t>(elapsed * 60e6) + options_.first_tick;
        const int number = stream.next_frame++;
        stream.packets.begin_frame(number, static_cast<std::uint32_t>(ticks),
                                   frame_bytes(endpoint, number));
        // A host that fell behind does not get a burst to catch up with.
        const auto period = std::chrono::duration_cast<Clock::duration>(
            std::chrono::duration<double>(1.0 / stream.hz));
        stream.next_start = std::max(stream.next_start + period, now);
    }
    return stream.packets.next();
}

Clock::time_point Camera::wake_at(int endpoint) const {
    const std::scoped_lock lock(mutex_);
    const Stream& stream = stream_of(endpoint);
    if (!stream.on) return Clock::time_point::max();
    if (!stream.packets.between_frames()) return Clock::time_point::min();
    if (options_.frames >= 0 && stream.next_frame >= options_.frames)
        return Clock::time_point::max();
    return stream.next_start;
}

std::vector<SentFrame> Camera::sent(int endpoint) const {
    const std::scoped_lock lock(mutex_);
    return stream_of(endpoint & 0x7f).packets.frames();
}

std::map<std::uint16_t, std::uint16_t> Camera::registers() const {
    const std::scoped_lock lock(mutex_);
    return registers_;
}

int Camera::bad_commands() const {
    const std::scoped_lock lock(mutex_);
    return bad_commands_;
}

}  // namespace kino::fake
