#include "tests/skeleton/motion/c3d_reader.h"

#include <cstdint>
#include <cstring>
#include <stdexcept>

namespace kino::test {
namespace {

int byte_at(const std::string& b, std::size_t i) {
    return static_cast<unsigned char>(b.at(i));
}
int signed_byte_at(const std::string& b, std::size_t i) {
    return static_cast<signed char>(b.at(i));
}
int word_at(const std::string& b, std::size_t i) {
    return byte_at(b, i) + 256 * byte_at(b, i + 1);
}
float float_at(const std::string& b, std::size_t i) {
    const std::uint32_t bits = static_cast<std::uint32_t>(word_at(b, i)) |
                               static_cast<std::uint32_t>(word_at(b, i + 2)) << 16;
    float value = 0;
    std::memcpy(&value, &bits, 4);
    return value;
}

void demand(bool fine, const char* what) {
    if (!fine) throw std::runtime_error(what);
}

void read_parameters(const std::string& b, std::size_t start, C3dFile& file) {
    demand(byte_at(b, start + 1) == 0x50, "parameter section's mark");
    demand(byte_at(b, start + 3) == 84, "PC processor");
    const std::size_t end = start + 512 * static_cast<std::size_t>(byte_at(b, start + 2));
    std::map<int, std::string> groups;
    std::vector<std::pair<int, std::pair<std::string, C3dParameter>>> found;
    for (std::size_t at = start + 4;;) {
        demand(at + 2 < end, "parameters run beyond their section");
        const auto name_size = static_cast<std::size_t>(std::abs(signed_byte_at(b, at)));
        demand(name_size > 0, "a record without a name before the end");
        const int id = signed_byte_at(b, at + 1);
        const std::string name = b.substr(at + 2, name_size);
        const std::size_t link = at + 2 + name_size;
        if (id < 0) {
            groups[-id] = name;
        } else {
            C3dParameter p;
            p.type = signed_byte_at(b, link + 2);
            std::size_t size = static_cast<std::size_t>(std::abs(p.type));
            const int dimensions = byte_at(b, link + 3);
            for (int d = 0; d < dimensions; ++d) {
                p.dimensions.push_back(byte_at(b, link + 4 + d));
                size *= static_cast<std::size_t>(p.dimensions.back());
            }
            p.bytes = b.substr(link + 4 + dimensions, size);
            demand(p.bytes.size() == size, "a parameter's data is cut");
            found.push_back({id, {name, p}});
        }
        if (word_at(b, link) == 0) break;
        at = link + word_at(b, link);
    }
    for (auto& [id, named] : found)
        file.parameters[groups.at(id) + ":" + named.first] = named.second;
}

}  // namespace

int C3dParameter::integer(int i) const {
    demand(type == 2, "not an integer");
    return word_at(bytes, static_cast<std::size_t>(2 * i));
}

float C3dParameter::real(int i) const {
    demand(type == 4, "not a real");
    return float_at(bytes, static_cast<std::size_t>(4 * i));
}

std::vector<std::string> C3dParameter::texts() const {
    demand(type == -1, "not text");
    const auto width = static_cast<std::size_t>(dimensions.at(0));
    std::vector<std::string> out;
    for (std::size_t i = 0; i < bytes.size(); i += width) {
        std::string t = bytes.substr(i, width);
        t.resize(t.find_last_not_of(' ') + 1);
        out.push_back(t);
    }
    return out;
}

C3dFile read_c3d(const std::string& b) {
    demand(b.size() % 512 == 0, "whole blocks");
    demand(byte_at(b, 1) == 0x50, "header's mark");
    C3dFile file;
    file.points = word_at(b, 2);
    demand(word_at(b, 4) == 0, "analog data");
    file.first_frame = word_at(b, 6);
    file.last_frame = word_at(b, 8);
    file.scale = float_at(b, 12);
    file.data_block = word_at(b, 16);
    file.rate_hz = float_at(b, 20);
    demand(file.scale < 0, "float data");
    read_parameters(b, 512 * static_cast<std::size_t>(byte_at(b, 0) - 1), file);
    std::size_t at = 512 * static_cast<std::size_t>(file.data_block - 1);
    for (int f = file.first_frame; f <= file.last_frame; ++f) {
        std::vector<C3dPoint> points;
        for (int p = 0; p < file.points; ++p, at += 16) {
            points.push_back(
                {float_at(b, at), float_at(b, at + 4), float_at(b, at + 8), float_at(b, at + 12)});
        }
        file.frames.push_back(std::move(points));
    }
    demand((at + 511) / 512 * 512 == b.size(), "the file ends with the data");
    return file;
}

}  // namespace kino::test
