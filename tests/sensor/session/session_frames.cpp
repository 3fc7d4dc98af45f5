#include "session_frames.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <map>
#include <tuple>

#include "base/check.h"
#include "logged_file.h"
#include "sensor/session/stream_format.h"
#include "tests/support/random.h"

namespace kino::test {
namespace {

constexpr TimeNs kFirst = 98'765'432'101'234;

FrameHeader header_at(int i, TimeNs later) {
    const TimeNs device = std::int64_t{i} * 33'366'700 + 17;
    return {device, kFirst + device + later, 1000 + i, i % 7 == 3 ? 2 : 0};
}

Image<std::uint16_t> picture16(int width, int height, int i, int most) {
    Random random(static_cast<std::uint64_t>(i) * 7919 + static_cast<std::uint64_t>(most));
    Image<std::uint16_t> image(width, height);
    for (int y = 0; y < height; ++y) {
        for (int x = 0; x < width; ++x) {
            const double wave = std::sin(0.1 * x + 0.05 * i) + std::cos(0.13 * y);
            const int value = static_cast<int>((0.5 + 0.2 * wave) * most) + random.integer(-2, 2);
            image.at(x, y) =
                static_cast<std::uint16_t>(random.chance(0.05) ? most : std::clamp(value, 0, most));
        }
    }
    return image;
}

std::vector<RowRange> rows_at(int i, int height) {
    if (i % 5 != 2) return {};
    return {{1, 2}, {height / 2, height / 4}};
}

const FrameHeader* header_of(const StreamFrame& frame) {
    return std::visit(
        [](const auto& f) -> const FrameHeader* {
            if constexpr (requires { f->header; }) {
                return &f->header;
            } else {
                return nullptr;
            }
        },
        frame);
}

bool same_header(const FrameHeader& a, const FrameHeader& b) {
    return std::tie(a.device_time, a.host_time, a.sequence, a.lost_before) ==
           std::tie(b.device_time, b.host_time, b.sequence, b.lost_before);
}

bool same(const DepthFrame& a, const DepthFrame& b) {
    return same_header(a.header, b.header) && a.raw == b.raw && a.unit == b.unit &&
           (a.unit != DepthUnit::linear || a.metres_per_unit == b.metres_per_unit) &&
           a.damaged_rows == b.damaged_rows;
}

bool same(const ColorFrame& a, const ColorFrame& b) {
    std::vector<std::uint8_t> store_a;
    std::vector<std::uint8_t> store_b;
    const auto pixels_a = packed_pixels(a, store_a);
    const auto pixels_b = packed_pixels(b, store_b);
    return same_header(a.header, b.header) && a.format == b.format && a.width == b.width &&
           a.height == b.height && a.matrix == b.matrix && a.range == b.range && pixels_a &&
           pixels_b && std::ranges::equal(*pixels_a, *pixels_b) && a.damaged_rows == b.damaged_rows;
}

bool same(const InfraredFrame& a, const InfraredFrame& b) {
    return same_header(a.header, b.header) && a.raw == b.raw &&
           a.significant_bits == b.significant_bits && a.damaged_rows == b.damaged_rows;
}

bool same(const MotionFrame& a, const MotionFrame& b) {
    return same_header(a.header, b.header) && a.acceleration_m_s2 == b.acceleration_m_s2 &&
           a.tilt_deg == b.tilt_deg;
}

bool same(const BodyFrame& a, const BodyFrame& b) {
    if (a.time != b.time || a.bodies.size() != b.bodies.size()) return false;
    for (std::size_t i = 0; i < a.bodies.size(); ++i) {
        if (a.bodies[i].id != b.bodies[i].id) return false;
        for (std::size_t j = 0; j < kJointCount; ++j) {
            const JointPosition& p = a.bodies[i].joints[j];
            const JointPosition& q = b.bodies[i].joints[j];
            if (std::memcmp(&p.position_m, &q.position_m, sizeof p.position_m) != 0 ||
                p.state != q.state || p.confidence != q.confidence) {
                return false;
            }
        }
    }
    return true;
}

}  // namespace

std::shared_ptr<const ColorFrame> color_at(int i, PixelFormat format, int width, int height) {
    Random random(static_cast<std::uint64_t>(i) * 31 + 5);
    ColorFrame frame;
    frame.header = header_at(i, 4'000'001);
    frame.format = format;
    frame.width = width;
    frame.height = height;
    frame.matrix = YuvMatrix::bt709;
    frame.range = YuvRange::limited;
    frame.damaged_rows = rows_at(i, height);
    if (format == PixelFormat::mjpeg) {
        frame.bytes = {0xFF, 0xD8};
        for (int n = 0; n < 300; ++n) {
            frame.bytes.push_back(static_cast<std::uint8_t>(random.integer(0, 255)));
        }
        frame.bytes.insert(frame.bytes.end(), {0xFF, 0xD9});
        return std::make_shared<const ColorFrame>(std::move(frame));
    }
    frame.pitch = packed_pitch(format, width) + (i % 2 == 0 ? 0 : 12);
    frame.bytes.resize(static_cast<std::size_t>(frame.pitch) * static_cast<std::size_t>(height));
    for (std::size_t n = 0; n < frame.bytes.size(); ++n) {
        frame.bytes[n] = static_cast<std::uint8_t>(n / 8 + static_cast<std::size_t>(i) +
                                                   static_cast<std::size_t>(random.integer(0, 3)));
    }
    return std::make_shared<const ColorFrame>(std::move(frame));
}

std::vector<PutFrame> frames_at(int i, const FrameStyle& style) {
    std::vector<PutFrame> frames;
    const DepthFrame depth{header_at(i, 0), picture16(style.width, style.height, i, 2047),
                           DepthUnit::kinect_disparity11, 0.001, rows_at(i, style.height)};
    frames.push_back({{0, StreamKind::depth}, std::make_shared<const DepthFrame>(depth)});
    frames.push_back({{0, StreamKind::color}, color_at(i, style.color, style.width, style.height)});
    if (style.infrared) {
        const InfraredFrame infrared{header_at(i, 1'000'003),
                                     picture16(style.width, style.height, i + 500, 1023), 10,
                                     rows_at(i + 1, style.height)};
        frames.push_back(
            {{0, StreamKind::infrared}, std::make_shared<const InfraredFrame>(infrared)});
    }
    if (!style.texts) return frames;
    MotionFrame motion;
    motion.header = header_at(i, 2'000'005);
    motion.acceleration_m_s2 = {0.1 * i, -9.80665 + 1e-15 * i, -0.0};
    if (i % 2 == 0) motion.tilt_deg = -i / 3.0;
    frames.push_back({{0, StreamKind::motion}, std::make_shared<const MotionFrame>(motion)});
    BodyFrame bodies;
    bodies.time = header_at(i, 0).host_time;
    for (int b = 0; b < i % 3; ++b) {
        Body body;
        body.id = static_cast<std::uint32_t>(b + 1);
        for (std::size_t j = 0; j < kJointCount; ++j) {
            const float v = 0.1F * static_cast<float>(j) + 0.017F * static_cast<float>(i);
            body.joints[j] = {
                {v, -v, j == 0 ? -0.0F : 1 / (v + 1)}, static_cast<JointState>(j % 3), v / 3};
        }
        bodies.bodies.push_back(body);
    }
    frames.push_back({{0, StreamKind::bodies}, std::make_shared<const BodyFrame>(bodies)});
    return frames;
}

std::vector<PutFrame> frames_between(int from, int to, const FrameStyle& style) {
    std::vector<PutFrame> all;
    for (int i = from; i < to; ++i) {
        for (PutFrame& frame : frames_at(i, style)) all.push_back(std::move(frame));
    }
    return all;
}

SourceInfo source_of(const FrameStyle& style) {
    SourceInfo source;
    source.uri = "test:frames";
    source.name = "Frames for a t\xC3\xA9st";
    source.serial = "A00364";
    source.note = "made up";
    source.licence = "CC0";
    const auto add = [&](StreamKind kind) {
        source.streams.push_back({{0, kind}, style.width, style.height, 30, "test"});
    };
    add(StreamKind::depth);
    add(StreamKind::color);
    if (style.infrared) add(StreamKind::infrared);
    if (style.texts) add(StreamKind::motion);
    if (style.texts) add(StreamKind::bodies);
    return source;
}

RigParameters rig_of(const FrameStyle& style) {
    RigParameters rig = default_kinect1_rig(style.width, style.height);
    rig.serial = "A00364";
    rig.color_from_depth.translation.x = 0.1 / 3;
    return rig;
}

bool equal(const StreamFrame& a, const StreamFrame& b) {
    if (a.index() != b.index()) return false;
    return std::visit(
        [&b](const auto& frame) {
            const auto& other = std::get<std::remove_cvref_t<decltype(frame)>>(b);
            return same(*frame, *other);
        },
        a);
}

bool same_place(const PutFrame& put, const SessionEntry& entry) {
    if (put.id != entry.id) return false;
    const FrameHeader* header = header_of(put.frame);
    if (header == nullptr || put.id.kind == StreamKind::motion) return true;
    return header->sequence == entry.sequence && header->host_time == entry.time;
}

Result<void> write_all(SessionWriter& writer, const std::vector<PutFrame>& frames) {
    for (const PutFrame& put : frames) {
        const FrameHeader* header = header_of(put.frame);
        const TimeNs now = header != nullptr
                               ? header->host_time
                               : std::get<std::shared_ptr<const BodyFrame>>(put.frame)->time;
        KINO_TRY(writer.put(put.id, put.frame, 0, now));
    }
    return {};
}

std::vector<std::uint8_t> session_of(const std::vector<PutFrame>& frames,
                                     const RecorderOptions& options, const FrameStyle& style) {
    FileLog log;
    SessionWriter writer(std::make_unique<LoggedFile>(log), source_of(style), rig_of(style),
                         options, 700'000'000'000'000'000);
    const auto written = write_all(writer, frames);
    KINO_CHECK(written.has_value());
    const auto finished = writer.finish(0);
    KINO_CHECK(finished.has_value());
    return log.content;
}

std::unique_ptr<SessionReader> reader_of(const std::vector<std::uint8_t>& bytes) {
    auto reader = SessionReader::open(memory_byte_source(bytes), "test");
    if (!reader) ADD_FAILURE() << reader.error().to_string();
    KINO_CHECK(reader.has_value());
    return *std::move(reader);
}

int count_exact(SessionReader& reader, const std::vector<PutFrame>& put) {
    std::vector<bool> used(put.size(), false);
    int count = 0;
    for (const SessionEntry& entry : reader.frames()) {
        const auto frame = reader.read(entry);
        if (!frame) {
            ADD_FAILURE() << frame.error().to_string();
            return -1;
        }
        bool found = false;
        for (std::size_t i = 0; i < put.size() && !found; ++i) {
            if (used[i] || !same_place(put[i], entry) || !equal(put[i].frame, *frame)) continue;
            used[i] = found = true;
        }
        if (!found) {
            ADD_FAILURE() << "a frame of stream " << stream_name(entry.id.kind) << " number "
                          << entry.sequence << " is none of those recorded";
            return -1;
        }
        ++count;
    }
    return count;
}

}  // namespace kino::test
