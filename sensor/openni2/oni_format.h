#pragma once

#include <cstdint>

/// Numbers of the ONI container, version 1.0.1.0 (written by OpenNI 1.5 and 2), little-endian:
///   file   = "NI10", u8 major, u8 minor, u16 maintenance, u32 build, u64 largest time in us,
///            u32 largest node id; then records
///   record = u32 magic, u32 type, u32 node, u32 size of head and fields, u32 size of the payload,
///            u64 position of the record this one replaces (u32 before 1.0.1.0); fields; payload
///   text   = u32 size with the final NUL, bytes
/// Fields: kNodeAdded text name, u32 type, u32 codec, u32 frames, u64 first and last time, u64
/// position of the seek table (u32 before 1.0.1.0). Properties: text name, u32 size, bytes.
/// kNodeDataBegin: u32 frames, u64 last time. kNewData: u64 time in us, u32 number from 1; the
/// payload is the coded frame. kSeekTable: payload of frames+1 entries, the first unused, each u64
/// time, u32 configuration, u64 position (u32 before 1.0.1.0).
namespace kino::oni {

constexpr std::uint32_t kRecordMagic = 0x0052494E;  ///< "NIR\0"
constexpr std::uint32_t kFileHeadBytes = 24;
constexpr std::uint32_t kRecordHeadBytes = 28;
constexpr std::uint32_t kOldRecordHeadBytes = 24;
constexpr std::uint32_t kSeekEntryBytes = 20;
constexpr std::uint32_t kOldSeekEntryBytes = 16;

enum RecordType : std::uint32_t {
    kNodeAdded104 = 0x02,
    kIntProperty = 0x03,
    kRealProperty = 0x04,
    kStringProperty = 0x05,
    kGeneralProperty = 0x06,
    kNodeRemoved = 0x07,
    kNodeDataBegin = 0x08,
    kNodeStateReady = 0x09,
    kNewData = 0x0A,
    kEnd = 0x0B,
    kNodeAdded105 = 0x0C,
    kNodeAdded = 0x0D,
    kSeekTable = 0x0E
};

enum NodeType : std::uint32_t {
    kDeviceNode = 1,
    kDepthNode = 2,
    kImageNode = 3,
    kInfraredNode = 5
};

constexpr std::uint32_t fourcc(const char (&text)[5]) {
    std::uint32_t code = 0;
    for (int i = 3; i >= 0; --i) code = code << 8 | static_cast<std::uint8_t>(text[i]);
    return code;
}
constexpr std::uint32_t kCodecNone = fourcc("NONE");
constexpr std::uint32_t kCodec16z = fourcc("16zP");
constexpr std::uint32_t kCodec16zTable = fourcc("16zT");
constexpr std::uint32_t kCodecJpeg = fourcc("JPEG");

/// The most a player's buffers hold of one frame.
constexpr std::uint32_t kMaxFrameBytes = 1600 * 1200 * 3;

}  // namespace kino::oni
