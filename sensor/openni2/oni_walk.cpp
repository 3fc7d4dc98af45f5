#include "sensor/openni2/oni_walk.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <set>
#include <string_view>

#include "sensor/openni2/openni_c.h"

namespace kino {
namespace {

constexpr std::uint32_t kMaxNodes = 64;
constexpr std::uint32_t kMaxFieldBytes = 1 << 20;  // the largest known, a depth table, has 20,000
constexpr std::uint32_t kMaxTextBytes = 256;
constexpr int kMaxPixels = 4096;
constexpr std::uint64_t kMaxRequiredBytes = std::uint64_t{1} << 26;

struct RecordHead {
    std::uint64_t position = 0;
    std::uint32_t type = 0;
    std::uint32_t node = 0;
    std::uint32_t field_bytes = 0;
    std::uint32_t payload_bytes = 0;
    std::uint64_t fields_at = 0;
    std::uint64_t next = 0;
};

/// Takes numbers and texts from the front of a record's fields.
class Fields {
  public:
    explicit Fields(std::span<const std::uint8_t> bytes) : bytes_(bytes) {}

    template <class T>
    bool take(T& value) {
        if (bytes_.size() < sizeof(T)) return false;
        std::memcpy(&value, bytes_.data(), sizeof(T));
        bytes_ = bytes_.subspan(sizeof(T));
        return true;
    }
    bool take_position(std::uint64_t& value, bool old) {
        if (!old) return take(value);
        std::uint32_t short_value = 0;
        if (!take(short_value)) return false;
        value = short_value;
        return true;
    }
    bool take_text(std::string& text) {
        std::uint32_t size = 0;
        if (!take(size) || size == 0 || size > kMaxTextBytes || size > bytes_.size()) return false;
        if (bytes_[size - 1] != 0) return false;
        text.assign(reinterpret_cast<const char*>(bytes_.data()));
        bytes_ = bytes_.subspan(size);
        return true;
    }
    [[nodiscard]] std::span<const std::uint8_t> rest() const { return bytes_; }

  private:
    std::span<const std::uint8_t> bytes_;
};

class Walk {
  public:
    explicit Walk(const OniInput& input) : input_(input) {}

    Result<OniRecords> run() {
        KINO_TRY(read_file_head());
        std::uint64_t position = oni::kFileHeadBytes;
        while (!ended_) {
            RecordHead head;
            KINO_TRY(read_head(position, head));
            KINO_TRY(handle(head));
            position = head.next;
        }
        for (std::size_t i = 0; i < records_.nodes.size(); ++i) finish(i);
        return std::move(records_);
    }

  private:
    enum class NodeState : std::uint8_t { absent, added, ready, removed };

    template <class... Args>
    static tl::unexpected<Error> broken(std::uint64_t position, fmt::format_string<Args...> text,
                                        Args&&... args) {
        return fail(
            fmt::format("byte {}: {}", position, fmt::format(text, std::forward<Args>(args)...)),
            {}, "the ONI file is damaged");
    }

    Result<void> read_file_head() {
        std::array<std::uint8_t, oni::kFileHeadBytes> bytes{};
        if (!input_.read(0, bytes)) return fail("too short for an ONI file");
        if (!looks_like_oni(bytes)) return fail("not an ONI file");
        Fields fields(std::span<const std::uint8_t>(bytes).subspan(4));
        std::uint8_t major = 0;
        std::uint8_t minor = 0;
        std::uint16_t maintenance = 0;
        std::uint32_t build = 0;
        std::uint32_t largest_node = 0;
        (void)(fields.take(major) && fields.take(minor) && fields.take(maintenance) &&
               fields.take(build) && fields.take(largest_time_) && fields.take(largest_node));
        const auto version = std::array<std::uint32_t, 4>{major, minor, maintenance, build};
        if (version < std::array<std::uint32_t, 4>{1, 0, 0, 5} ||
            version > std::array<std::uint32_t, 4>{1, 0, 1, 0}) {
            return fail(fmt::format("ONI version {}.{}.{}.{} is not one of 1.0.0.5 to 1.0.1.0",
                                    major, minor, maintenance, build));
        }
        old_ = version < std::array<std::uint32_t, 4>{1, 0, 1, 0};
        if (largest_node >= kMaxNodes) return broken(20, "{} nodes", largest_node);
        states_.assign(largest_node + std::size_t{1}, NodeState::absent);
        index_of_.assign(states_.size(), -1);
        seek_tables_.assign(states_.size(), 0);
        return {};
    }

    Result<void> read_head(std::uint64_t position, RecordHead& head) const {
        const std::uint32_t head_bytes = old_ ? oni::kOldRecordHeadBytes : oni::kRecordHeadBytes;
        std::array<std::uint8_t, oni::kRecordHeadBytes> bytes{};
        if (!input_.read(position, std::span(bytes).first(head_bytes))) {
            return broken(position, "the file ends without its end mark");
        }
        Fields fields(bytes);
        std::uint32_t magic = 0;
        std::uint32_t size = 0;
        (void)(fields.take(magic) && fields.take(head.type) && fields.take(head.node) &&
               fields.take(size) && fields.take(head.payload_bytes));
        if (magic != oni::kRecordMagic) return broken(position, "no record where one must be");
        if (size < head_bytes || size - head_bytes > kMaxFieldBytes) {
            return broken(position, "a record's head of {} bytes", size);
        }
        head.position = position;
        head.field_bytes = size - head_bytes;
        head.fields_at = position + head_bytes;
        head.next = position + size + head.payload_bytes;
        if (head.next > input_.size()) return broken(position, "the file ends within a record");
        return {};
    }

    Result<std::vector<std::uint8_t>> read_fields(const RecordHead& head) const {
        std::vector<std::uint8_t> bytes(head.field_bytes);
        if (!input_.read(head.fields_at, bytes)) return broken(head.position, "cannot be read");
        return bytes;
    }

    Result<void> handle(const RecordHead& head) {
        const bool has_payload = head.type == oni::kNewData || head.type == oni::kSeekTable;
        if (!has_payload && head.payload_bytes != 0) {
            return broken(head.position, "a payload in a record of type {}", head.type);
        }
        if (head.type == oni::kEnd) {
            if (!data_begun_) return broken(head.position, "the end before any data");
            ended_ = true;
            return {};
        }
        if (head.node >= states_.size()) {
            return broken(head.position, "node {} of {}", head.node, states_.size());
        }
        NodeState& state = states_[head.node];
        if (head.type == oni::kNodeAdded || head.type == oni::kNodeAdded105) return add(head);
        if (head.type == oni::kSeekTable) return {};  // read where the node names it
        if (state == NodeState::absent || state == NodeState::removed) {
            return broken(head.position, "a record of node {}, which is not there", head.node);
        }
        switch (head.type) {
            case oni::kIntProperty:
            case oni::kRealProperty:
            case oni::kStringProperty:
            case oni::kGeneralProperty:
                return property(head);
            case oni::kNodeStateReady:
                state = NodeState::ready;
                return {};
            case oni::kNodeRemoved:
                state = NodeState::removed;
                return {};
            case oni::kNodeDataBegin:
                if (index_of_[head.node] < 0 || head.field_bytes < 12) {
                    return broken(head.position, "data begins for node {}", head.node);
                }
                data_begun_ = true;
                return {};
            case oni::kNewData:
                return data(head);
            default:
                return broken(head.position, "a record of unknown type {}", head.type);
        }
    }

    Result<void> add(const RecordHead& head) {
        if (states_[head.node] != NodeState::absent) {
            return broken(head.position, "node {} twice", head.node);
        }
        KINO_ASSIGN(const auto bytes, read_fields(head));
        Fields fields(bytes);
        std::string name;
        OniNode node;
        node.id = head.node;
        std::uint64_t first_time = 0;
        std::uint64_t last_time = 0;
        if (!fields.take_text(name) || !fields.take(node.type) || !fields.take(node.codec) ||
            !fields.take(node.stated_frames) || !fields.take(first_time) ||
            !fields.take(last_time)) {
            return broken(head.position, "a node without its fields");
        }
        if (head.type == oni::kNodeAdded && !fields.take_position(seek_tables_[head.node], old_)) {
            return broken(head.position, "a node without its seek table");
        }
        if (!names_.insert(name).second) return broken(head.position, "two nodes of one name");
        states_[head.node] = NodeState::added;
        if (node.type == oni::kDepthNode || node.type == oni::kImageNode ||
            node.type == oni::kInfraredNode) {
            for (const OniNode& other : records_.nodes) {
                if (other.type == node.type) return broken(head.position, "two nodes of one type");
            }
            index_of_[head.node] = static_cast<int>(records_.nodes.size());
            records_.nodes.push_back(std::move(node));
        }
        return {};
    }

    Result<void> property(const RecordHead& head) {
        KINO_ASSIGN(const auto bytes, read_fields(head));
        Fields fields(bytes);
        std::string name;
        std::uint32_t size = 0;
        if (!fields.take_text(name) || !fields.take(size) || size != fields.rest().size()) {
            return broken(head.position, "a property whose size does not fit");
        }
        const std::span<const std::uint8_t> value = fields.rest();
        if ((head.type == oni::kIntProperty || head.type == oni::kRealProperty) && size != 8) {
            return broken(head.position, "number {} of {} bytes", name, size);
        }
        if (head.type == oni::kStringProperty && (value.empty() || value.back() != 0)) {
            return broken(head.position, "text {} without an end", name);
        }
        const int index = index_of_[head.node];
        if (index < 0) return {};
        OniNode& node = records_.nodes[static_cast<std::size_t>(index)];
        if (head.type == oni::kIntProperty) return number_property(head, node, name, value);
        if (head.type == oni::kGeneralProperty) return general_property(head, node, name, value);
        return {};
    }

    Result<void> number_property(const RecordHead& head, OniNode& node, const std::string& name,
                                 std::span<const std::uint8_t> bytes) const {
        std::uint64_t value = 0;
        std::memcpy(&value, bytes.data(), sizeof(value));
        if (name == "xnMirror") node.mirrored = value != 0;
        if ((name == "oniRequiredFrameSize" || name == "RequiredDataSize") &&
            value > kMaxRequiredBytes) {
            return broken(head.position, "frames of {} bytes", value);
        }
        int format = node.pixel_format;
        if (name == "oniPixelFormat") {
            format = static_cast<int>(std::min<std::uint64_t>(value, 1000));
        } else if (name == "xnPixelFormat" && node.pixel_format == 0) {
            constexpr std::array<int, 6> kOpenni1Formats = {0,
                                                            openni::kRgb888,
                                                            openni::kYuv422,
                                                            openni::kGray8,
                                                            openni::kGray16,
                                                            openni::kJpeg};
            if (value == 0 || value >= kOpenni1Formats.size()) {
                return broken(head.position, "pixel format {}", value);
            }
            if (node.type != oni::kDepthNode) format = kOpenni1Formats[value];
        }
        if (format != node.pixel_format && data_begun_ && !node.frames.empty()) {
            return fail("the pixel format changes within the file", {}, "this is not supported");
        }
        node.pixel_format = format;
        return {};
    }

    Result<void> general_property(const RecordHead& head, OniNode& node, const std::string& name,
                                  std::span<const std::uint8_t> bytes) const {
        Fields fields(bytes);
        if (name == "xnMapOutputMode") {
            std::array<std::uint32_t, 3> mode{};
            if (bytes.size() != sizeof(mode)) return broken(head.position, "mode of odd size");
            std::memcpy(mode.data(), bytes.data(), sizeof(mode));
            if (mode[0] == 0 || mode[0] > kMaxPixels || mode[1] == 0 || mode[1] > kMaxPixels ||
                mode[2] > 1000) {
                return broken(head.position, "frames of {} x {} at {} Hz", mode[0], mode[1],
                              mode[2]);
            }
            const int width = static_cast<int>(mode[0]);
            const int height = static_cast<int>(mode[1]);
            if (!node.frames.empty() && (width != node.width || height != node.height)) {
                return fail("the frame size changes within the file", {}, "this is not supported");
            }
            node.width = width;
            node.height = height;
            node.fps = static_cast<int>(mode[2]);
        } else if (name == "xnCropping") {
            std::uint32_t enabled = 0;
            if (bytes.size() != 12 || !fields.take(enabled)) {
                return broken(head.position, "cropping of odd size");
            }
            if (enabled) return fail("the frames are cropped", {}, "this is not supported");
            node.has_cropping = true;
        } else if (name == "xnFOV") {
            double horizontal = 0;
            double vertical = 0;
            if (bytes.size() != 16 || !fields.take(horizontal) || !fields.take(vertical)) {
                return broken(head.position, "field of view of odd size");
            }
            const auto sound = [](double angle) { return angle > 0.01 && angle < 3.1; };
            if (sound(horizontal) && sound(vertical)) {
                node.horizontal_fov = horizontal;
                node.vertical_fov = vertical;
            }
        } else if (name == "xnRealWorldTranslationData" && bytes.size() != 24) {
            return broken(head.position, "translation data of odd size");
        } else if (name == "oniOriginalDevice") {
            node.device.assign(reinterpret_cast<const char*>(bytes.data()),
                               strnlen(reinterpret_cast<const char*>(bytes.data()),
                                       std::min<std::size_t>(bytes.size(), kMaxTextBytes)));
        }
        return {};
    }

    Result<void> data(const RecordHead& head) {
        const int index = index_of_[head.node];
        if (index < 0 || !data_begun_ || states_[head.node] != NodeState::ready) {
            return broken(head.position, "data of node {} before it begins", head.node);
        }
        OniNode& node = records_.nodes[static_cast<std::size_t>(index)];
        if (node.width == 0) return broken(head.position, "data before the frame's size");
        if (head.field_bytes != 12 || head.payload_bytes == 0 ||
            head.payload_bytes > oni::kMaxFrameBytes) {
            return broken(head.position, "a frame of {} bytes", head.payload_bytes);
        }
        std::array<std::uint8_t, 12> bytes{};
        if (!input_.read(head.fields_at, bytes)) return broken(head.position, "cannot be read");
        OniData data;
        Fields fields(bytes);
        (void)(fields.take(data.time_us) && fields.take(data.number));
        if (data.number == 0 || data.number > node.stated_frames) {
            return broken(head.position, "frame {} of {}", data.number, node.stated_frames);
        }
        if (data.time_us > largest_time_ || data.time_us > (std::uint64_t{1} << 53)) {
            return broken(head.position, "a frame at {} us, after the end", data.time_us);
        }
        data.position = head.position;
        data.next = head.next;
        data.payload_bytes = head.payload_bytes;
        data.node = static_cast<std::size_t>(index);
        node.frames.push_back(records_.data.size());
        records_.data.push_back(data);
        return {};
    }

    /// Reads the node's seek table; leaves it empty unless it names this node's frames one by one.
    void finish(std::size_t index) {
        OniNode& node = records_.nodes[index];
        const std::uint64_t position = seek_tables_[node.id];
        const std::size_t entry_bytes = old_ ? oni::kOldSeekEntryBytes : oni::kSeekEntryBytes;
        RecordHead head;
        if (position == 0 || !read_head(position, head)) return;
        if (head.type != oni::kSeekTable || head.node != node.id ||
            node.frames.size() != node.stated_frames ||
            head.payload_bytes != (node.frames.size() + 1) * entry_bytes) {
            return;
        }
        std::vector<std::uint8_t> bytes(head.payload_bytes);
        if (!input_.read(head.next - head.payload_bytes, bytes)) return;
        std::vector<OniSeekEntry> table(node.frames.size() + 1);
        Fields fields(bytes);
        for (std::size_t i = 0; i < table.size(); ++i) {
            OniSeekEntry& entry = table[i];
            (void)(fields.take(entry.time_us) && fields.take(entry.configuration) &&
                   fields.take_position(entry.position, old_));
            if (i == 0) continue;
            const OniData& data = records_.data[node.frames[i - 1]];
            if (data.number != i || entry.position != data.position ||
                entry.time_us != data.time_us) {
                return;
            }
        }
        node.seek_table = std::move(table);
    }

    const OniInput& input_;
    OniRecords records_;
    bool old_ = false;  ///< 32-bit positions
    std::uint64_t largest_time_ = 0;
    std::vector<NodeState> states_;
    std::vector<int> index_of_;  ///< of a node's id in records_.nodes; -1 for other kinds
    std::vector<std::uint64_t> seek_tables_;
    std::set<std::string> names_;
    bool data_begun_ = false;
    bool ended_ = false;
};

}  // namespace

Result<OniRecords> walk_oni(const OniInput& input) {
    return Walk(input).run();
}

}  // namespace kino
