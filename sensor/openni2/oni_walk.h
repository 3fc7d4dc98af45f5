#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "base/error.h"
#include "sensor/openni2/oni_format.h"

namespace kino {

/// Bytes that can be read anywhere.
class OniInput {
  public:
    virtual ~OniInput() = default;
    [[nodiscard]] virtual std::uint64_t size() const = 0;
    /// Fills `out` from `position`; false where the range leaves the file or cannot be read.
    [[nodiscard]] virtual bool read(std::uint64_t position, std::span<std::uint8_t> out) const = 0;
};

[[nodiscard]] Result<std::unique_ptr<OniInput>> open_oni_input(const std::filesystem::path& file);

/// One frame's record.
struct OniData {
    std::uint64_t position = 0;       ///< of the record
    std::uint64_t next = 0;           ///< of the record after it
    std::uint32_t payload_bytes = 0;  ///< right before `next`
    std::uint64_t time_us = 0;
    std::uint32_t number = 0;  ///< as stated; 1 is a node's first frame
    std::size_t node = 0;      ///< index into OniRecords::nodes
};

struct OniSeekEntry {
    std::uint64_t time_us = 0;
    std::uint32_t configuration = 0;
    std::uint64_t position = 0;
};

/// One stream of a recording.
struct OniNode {
    std::uint32_t id = 0;
    std::uint32_t type = 0;  ///< oni::NodeType
    std::uint32_t codec = 0;
    std::uint32_t stated_frames = 0;
    std::string device;
    int width = 0;   ///< px
    int height = 0;  ///< px
    int fps = 0;
    int pixel_format = 0;  ///< openni::k...; 0 if not stated
    bool mirrored = false;
    bool has_cropping = false;  ///< the property is there
    double horizontal_fov = 0;  ///< radians; 0 if not stated
    double vertical_fov = 0;
    std::vector<std::size_t> frames;  ///< indices into OniRecords::data, in file order
    /// Empty where it is missing or does not fit; else one entry more than there are frames.
    std::vector<OniSeekEntry> seek_table;
};

/// What the file holds, found without looking into a payload.
struct OniRecords {
    std::vector<OniNode> nodes;  ///< depth, image and infrared nodes
    std::vector<OniData> data;   ///< in file order
};

/// Follows the records from the head to the end mark, and checks every size, name, node, number and
/// time on the way (the library's player trusts what it reads, and crashes or hangs). Fails at the
/// first record that breaks a rule, with its position, and where the end mark is missing (a
/// truncated file).
[[nodiscard]] Result<OniRecords> walk_oni(const OniInput& input);

/// The first four bytes of an ONI file.
[[nodiscard]] bool looks_like_oni(std::span<const std::uint8_t> head);

/// A frame's payload. Fails where the file has shrunk since the walk.
[[nodiscard]] Result<std::vector<std::uint8_t>> read_payload(const OniInput& input,
                                                             const OniData& data);

}  // namespace kino
