#include "bag_bytes.h"

#include <bzlib.h>
#include <lz4frame.h>

#include <cstring>
#include <map>

#include "base/check.h"

namespace kino::test {
namespace {

using Bytes = std::vector<std::uint8_t>;

/// Bytes that are put together from little-endian values.
struct Put {
    Bytes bytes;

    Put& raw(const Bytes& more) {
        // One by one: g++ 12 sees an overflow in insert() that is not there.
        for (const std::uint8_t byte : more) bytes.push_back(byte);
        return *this;
    }
    Put& number(std::uint64_t value, int size) {
        for (int i = 0; i < size; ++i) bytes.push_back(static_cast<std::uint8_t>(value >> (8 * i)));
        return *this;
    }
    Put& real(double value) {
        std::uint64_t bits = 0;
        std::memcpy(&bits, &value, 8);
        return number(bits, 8);
    }
    Put& text(const std::string& value) {
        number(value.size(), 4);
        return raw(Bytes(value.begin(), value.end()));
    }
    Put& counted(const Bytes& more) { return number(more.size(), 4).raw(more); }
};

Bytes field(const std::string& name, const Bytes& value) {
    Put content;
    content.raw(Bytes(name.begin(), name.end())).number('=', 1).raw(value);
    return Put().counted(content.bytes).bytes;
}

Bytes ros_number(std::uint64_t value, int size) {
    return Put().number(value, size).bytes;
}

Bytes stamp(TimeNs time) {
    return Put()
        .number(static_cast<std::uint64_t>(time / kNsPerSecond), 4)
        .number(static_cast<std::uint64_t>(time % kNsPerSecond), 4)
        .bytes;
}

Bytes record(const std::vector<Bytes>& fields, const Bytes& data) {
    Put header;
    for (const Bytes& entry : fields) header.raw(entry);
    return Put().counted(header.bytes).counted(data).bytes;
}

Bytes connection(std::uint32_t id, const std::string& topic) {
    const Bytes name(topic.begin(), topic.end());
    return record(
        {field("conn", ros_number(id, 4)), field("op", ros_number(7, 1)), field("topic", name)},
        field("topic", name));
}

Bytes pack(const Bytes& content, BagPacking packing) {
    if (packing == BagPacking::lz4) {
        Bytes out(LZ4F_compressFrameBound(content.size(), nullptr));
        const std::size_t size =
            LZ4F_compressFrame(out.data(), out.size(), content.data(), content.size(), nullptr);
        KINO_CHECK(!LZ4F_isError(size));
        out.resize(size);
        return out;
    }
    if (packing == BagPacking::bz2) {
        Bytes out(content.size() * 2 + 1000);
        auto size = static_cast<unsigned>(out.size());
        Bytes in = content;
        const int code = BZ2_bzBuffToBuffCompress(reinterpret_cast<char*>(out.data()), &size,
                                                  reinterpret_cast<char*>(in.data()),
                                                  static_cast<unsigned>(in.size()), 9, 0, 0);
        KINO_CHECK_EQ(code, BZ_OK);
        out.resize(size);
        return out;
    }
    return content;
}

Bytes image_message(int sequence, TimeNs time, int width, int height, const std::string& encoding,
                    const Bytes& pixels) {
    return Put()
        .number(static_cast<std::uint64_t>(sequence), 4)
        .raw(stamp(time))
        .text("0")
        .number(static_cast<std::uint64_t>(height), 4)
        .number(static_cast<std::uint64_t>(width), 4)
        .text(encoding)
        .number(0, 1)
        .number(pixels.size() / static_cast<std::size_t>(height), 4)
        .counted(pixels)
        .bytes;
}

Bytes camera_message(int width, int height, double focal, const std::string& model) {
    Put out;
    out.number(0, 4).number(0, 8).text("");
    out.number(static_cast<std::uint64_t>(height), 4).number(static_cast<std::uint64_t>(width), 4);
    out.text(model).number(5, 4);
    for (const double d : {0.1, -0.2, 0.003, 0.004, 0.05}) out.real(d);
    for (const double k :
         {focal, 0.0, width / 2.0 - 0.25, 0.0, focal + 1, height / 2.0, 0.0, 0.0, 1.0}) {
        out.real(k);
    }
    for (int i = 0; i < 9 + 12; ++i) out.real(0);
    out.number(0, 8).raw(Bytes(17, 0));
    return out.bytes;
}

/// Collects messages into chunks.
class Writer {
  public:
    explicit Writer(const BagBytes& bag) : bag_(bag) {}

    void put(const std::string& topic, TimeNs time, const Bytes& data) {
        auto known = ids_.find(topic);
        if (known == ids_.end()) {
            const auto id = static_cast<std::uint32_t>(ids_.size());
            known = ids_.emplace(topic, id).first;
            append(connection(id, topic));
        }
        index_[known->second].push_back({time, chunk_.size()});
        append(record({field("conn", ros_number(known->second, 4)), field("op", ros_number(2, 1)),
                       field("time", stamp(time))},
                      data));
    }

    void end_chunk() {
        if (chunk_.empty()) return;
        const bool died = bag_.frames_a_chunk == 0;
        const std::string name = bag_.packing == BagPacking::lz4   ? "lz4"
                                 : bag_.packing == BagPacking::bz2 ? "bz2"
                                                                   : "none";
        Put header;
        header.raw(field("compression", Bytes(name.begin(), name.end())));
        header.raw(field("op", ros_number(5, 1)));
        header.raw(field("size", ros_number(died ? 0 : chunk_.size(), 4)));
        const Bytes packed = pack(chunk_, bag_.packing);
        Put whole;
        whole.counted(header.bytes).number(died ? 0 : packed.size(), 4).raw(packed);
        out_.raw(whole.bytes);
        if (bag_.with_index_records && !died) {
            for (const auto& [id, entries] : index_) {
                Put data;
                for (const auto& [time, offset] : entries) {
                    data.raw(stamp(time)).number(offset, 4);
                }
                out_.raw(record({field("conn", ros_number(id, 4)),
                                 field("count", ros_number(entries.size(), 4)),
                                 field("op", ros_number(4, 1)), field("ver", ros_number(1, 4))},
                                data.bytes));
            }
        }
        chunk_.clear();
        index_.clear();
    }

    Bytes finish() {
        end_chunk();
        const std::string magic = "#ROSBAG V2.0\n";
        Put head;
        head.raw(Bytes(magic.begin(), magic.end()));
        const std::size_t header_size = 4096;
        const std::uint64_t tables =
            bag_.indexed ? magic.size() + header_size + out_.bytes.size() : 0;
        const Bytes fields = Put()
                                 .raw(field("chunk_count", ros_number(1, 4)))
                                 .raw(field("conn_count", ros_number(ids_.size(), 4)))
                                 .raw(field("index_pos", ros_number(tables, 8)))
                                 .raw(field("op", ros_number(3, 1)))
                                 .bytes;
        head.counted(fields).counted(Bytes(header_size - fields.size() - 8, ' '));
        head.raw(out_.bytes);
        if (bag_.indexed) {
            for (const auto& [topic, id] : ids_) head.raw(connection(id, topic));
        }
        return head.bytes;
    }

  private:
    void append(const Bytes& more) { chunk_.insert(chunk_.end(), more.begin(), more.end()); }

    const BagBytes& bag_;
    std::map<std::string, std::uint32_t> ids_;
    std::map<std::uint32_t, std::vector<std::pair<TimeNs, std::size_t>>> index_;
    Bytes chunk_;
    Put out_;
};

}  // namespace

std::uint16_t bag_depth(std::size_t pixel, int frame) {
    return static_cast<std::uint16_t>(pixel * 17 % 4000 + static_cast<std::size_t>(frame));
}

std::uint8_t bag_color(std::size_t byte, int frame) {
    return static_cast<std::uint8_t>(byte * 5 + static_cast<std::size_t>(frame) * 3);
}

TimeNs bag_depth_time(int frame) {
    return 1'500 + frame * 33'333'345LL;
}

TimeNs bag_depth_stamp(int frame) {
    return 360'815'089'000 + frame * 33'333'000LL;
}

std::vector<std::uint8_t> make_bag(const BagBytes& bag) {
    Writer writer(bag);
    const auto key_value = [](const char* key, const char* value) {
        return Put().text(key).text(value).bytes;
    };
    const std::string depth = "/device_0/sensor_0/Depth_0";
    const std::string color = "/device_0/sensor_1/Color_0";
    writer.put("/file_version", 1, ros_number(3, 4));
    writer.put("/device_0/info", 1, key_value("Name", "Hand-made D435"));
    writer.put("/device_0/info", 1, key_value("Serial Number", "728"));
    writer.put(depth + "/info/camera_info", 1,
               camera_message(bag.width, bag.height, 20, bag.model));
    writer.put(color + "/info/camera_info", 1,
               camera_message(bag.color_width, bag.color_height, 15, bag.model));
    std::uint32_t unit = 0;
    std::memcpy(&unit, &bag.depth_unit, 4);
    writer.put("/device_0/sensor_0/option/Depth Units/value", 1, ros_number(unit, 4));
    // A quarter turn about z, and 15 mm to the right.
    Put place;
    for (const double value :
         {0.015, 0.0, -0.001, 0.0, 0.0, 0.70710678118654757, 0.70710678118654757}) {
        place.real(value);
    }
    writer.put(color + "/tf/0", 1, place.bytes);
    const std::size_t pixel = bag.color_encoding == "YUYV"     ? 2
                              : bag.color_encoding.size() == 5 ? 4
                                                               : 3;
    for (int i = 0; i < bag.frames; ++i) {
        Put depth_pixels;
        for (std::size_t p = 0; p < static_cast<std::size_t>(bag.width * bag.height); ++p) {
            depth_pixels.number(bag_depth(p, i), 2);
        }
        writer.put(depth + "/image/data", bag_depth_time(i),
                   image_message(169 + i, bag_depth_stamp(i), bag.width, bag.height, "mono16",
                                 depth_pixels.bytes));
        Bytes color_pixels(static_cast<std::size_t>(bag.color_width * bag.color_height) * pixel);
        for (std::size_t b = 0; b < color_pixels.size(); ++b) color_pixels[b] = bag_color(b, i);
        writer.put(color + "/image/data", bag_depth_time(i) + 5'000'000,
                   image_message(40 + i, bag_depth_stamp(i), bag.color_width, bag.color_height,
                                 bag.color_encoding, color_pixels));
        writer.put(depth + "/image/metadata", bag_depth_time(i), key_value("Gain Level", "16"));
        if (bag.frames_a_chunk > 0 && i % bag.frames_a_chunk == bag.frames_a_chunk - 1) {
            writer.end_chunk();
        }
    }
    return writer.finish();
}

}  // namespace kino::test
