#include "tests/skeleton/motion/glb_reader.h"

#include <algorithm>
#include <cstdint>
#include <cstring>
#include <glm/gtc/matrix_transform.hpp>
#include <stdexcept>

namespace kino::test {
namespace {

template <class T>
T read_as(const std::string& bytes, std::size_t at) {
    T value;
    if (at + sizeof(T) > bytes.size()) throw std::runtime_error("the file ends too early");
    std::memcpy(&value, bytes.data() + at, sizeof(T));
    return value;
}

void require(bool fine, const char* what) {
    if (!fine) throw std::runtime_error(what);
}

std::size_t components_of(const std::string& type) {
    static const std::map<std::string, std::size_t> counts = {
        {"SCALAR", 1}, {"VEC3", 3}, {"VEC4", 4}, {"MAT4", 16}};
    return counts.at(type);
}

void check_range(const nlohmann::json& accessor, const std::vector<double>& values,
                 std::size_t width) {
    if (!accessor.contains("min")) return;
    for (std::size_t c = 0; c < width; ++c) {
        double low = values[c], high = values[c];
        for (std::size_t i = c; i < values.size(); i += width) {
            low = std::min(low, values[i]);
            high = std::max(high, values[i]);
        }
        require(low == accessor["min"][c].get<double>(), "min is wrong");
        require(high == accessor["max"][c].get<double>(), "max is wrong");
    }
}

}  // namespace

GlbFile read_glb(const std::string& bytes) {
    require(bytes.substr(0, 4) == "glTF", "magic");
    require(read_as<std::uint32_t>(bytes, 4) == 2, "version");
    require(read_as<std::uint32_t>(bytes, 8) == bytes.size(), "length");
    const auto json_size = read_as<std::uint32_t>(bytes, 12);
    require(json_size % 4 == 0 && bytes.substr(16, 4) == "JSON", "first chunk");
    const std::size_t bin = 20 + json_size;
    const auto bin_size = read_as<std::uint32_t>(bytes, bin);
    require(bytes.substr(bin + 4, 4) == std::string("BIN\0", 4), "second chunk");
    require(bin_size % 4 == 0 && bin + 8 + bin_size == bytes.size(), "second chunk's size");
    GlbFile file{nlohmann::json::parse(bytes.substr(20, json_size)), bytes.substr(bin + 8)};
    require(file.json.at("asset").at("version") == "2.0", "asset version");
    require(file.json.at("buffers").at(0).at("byteLength") <= bin_size, "buffer size");
    for (std::size_t i = 0; i < file.json.at("accessors").size(); ++i) (void)file.values(i);
    return file;
}

std::vector<double> GlbFile::values(std::size_t index) const {
    const nlohmann::json& accessor = json.at("accessors").at(index);
    const nlohmann::json& view = json.at("bufferViews").at(accessor.at("bufferView").get<int>());
    const std::size_t width = components_of(accessor.at("type"));
    const int kind = accessor.at("componentType");
    const std::size_t size = kind == 5126 ? 4 : kind == 5123 ? 2 : 1;
    require(kind == 5126 || kind == 5123 || kind == 5121, "component type");
    const std::size_t count = accessor.at("count").get<std::size_t>() * width;
    const std::size_t at = view.at("byteOffset").get<std::size_t>();
    require(count > 0 && at % 4 == 0, "alignment");
    require(count * size <= view.at("byteLength").get<std::size_t>(), "accessor beyond its view");
    std::vector<double> out;
    for (std::size_t i = 0; i < count; ++i) {
        const std::size_t p = at + i * size;
        out.push_back(kind == 5126   ? static_cast<double>(read_as<float>(bin, p))
                      : kind == 5123 ? read_as<std::uint16_t>(bin, p)
                                     : read_as<std::uint8_t>(bin, p));
    }
    check_range(accessor, out, width);
    return out;
}

std::vector<double> GlbFile::times() const {
    return values(json.at("animations").at(0).at("samplers").at(0).at("input"));
}

std::vector<glm::dquat> GlbFile::rotations(std::size_t node) const {
    std::vector<glm::dquat> out;
    const nlohmann::json& animation = json.at("animations").at(0);
    for (const auto& channel : animation.at("channels")) {
        if (channel.at("target").at("node") != node) continue;
        if (channel.at("target").at("path") != "rotation") continue;
        const auto& sampler = animation.at("samplers").at(channel.at("sampler").get<int>());
        require(sampler.at("interpolation") == "LINEAR", "interpolation");
        const std::vector<double> v = values(sampler.at("output"));
        for (std::size_t i = 0; i < v.size(); i += 4) {
            out.emplace_back(v[i + 3], v[i], v[i + 1], v[i + 2]);
        }
    }
    return out;
}

std::vector<glm::dmat4> GlbFile::nodes_at(std::size_t key) const {
    const nlohmann::json& nodes = json.at("nodes");
    std::vector<glm::dvec3> places(nodes.size(), glm::dvec3(0));
    std::vector<glm::dquat> turns(nodes.size(), glm::dquat(1, 0, 0, 0));
    std::vector<int> parents(nodes.size(), -1);
    for (std::size_t n = 0; n < nodes.size(); ++n) {
        if (nodes[n].contains("translation")) {
            for (int i = 0; i < 3; ++i) places[n][i] = nodes[n]["translation"][i];
        }
        if (nodes[n].contains("children")) {
            for (const auto& child : nodes[n]["children"]) {
                require(parents.at(child.get<std::size_t>()) < 0, "two parents");
                parents[child.get<std::size_t>()] = static_cast<int>(n);
            }
        }
        const auto animated = rotations(n);
        if (!animated.empty()) turns[n] = animated.at(key);
    }
    const nlohmann::json& animation = json.at("animations").at(0);
    for (const auto& channel : animation.at("channels")) {
        if (channel.at("target").at("path") != "translation") continue;
        const auto& sampler = animation.at("samplers").at(channel.at("sampler").get<int>());
        const std::vector<double> v = values(sampler.at("output"));
        for (int i = 0; i < 3; ++i) {
            places[channel.at("target").at("node").get<int>()][i] = v.at(3 * key + i);
        }
    }
    std::vector<glm::dmat4> global(nodes.size());
    for (std::size_t n = 0; n < nodes.size(); ++n) {
        glm::dmat4 m(1);
        for (int up = static_cast<int>(n); up >= 0; up = parents[up]) {
            m = glm::translate(glm::dmat4(1), places[up]) * glm::mat4_cast(turns[up]) * m;
        }
        global[n] = m;
    }
    return global;
}

std::map<std::string, glm::dvec3> GlbFile::positions(std::size_t key) const {
    const auto global = nodes_at(key);
    std::map<std::string, glm::dvec3> out;
    for (std::size_t n = 0; n < global.size(); ++n) {
        out[json["nodes"][n].at("name")] = glm::dvec3(global[n][3]);
    }
    return out;
}

std::vector<glm::dvec3> GlbFile::skinned(std::size_t key) const {
    const auto global = nodes_at(key);
    const nlohmann::json& skin = json.at("skins").at(0);
    const std::vector<double> bind = values(skin.at("inverseBindMatrices"));
    const auto& attributes = json.at("meshes").at(0).at("primitives").at(0).at("attributes");
    const std::vector<double> places = values(attributes.at("POSITION"));
    const std::vector<double> joints = values(attributes.at("JOINTS_0"));
    const std::vector<double> weights = values(attributes.at("WEIGHTS_0"));
    std::vector<glm::dvec3> out;
    for (std::size_t v = 0; v < places.size() / 3; ++v) {
        const glm::dvec4 rest(places[3 * v], places[3 * v + 1], places[3 * v + 2], 1);
        glm::dvec3 sum(0);
        for (std::size_t k = 0; k < 4; ++k) {
            const auto joint = static_cast<std::size_t>(joints[4 * v + k]);
            glm::dmat4 inverse;
            for (int i = 0; i < 16; ++i) inverse[i / 4][i % 4] = bind.at(16 * joint + i);
            const auto node = skin.at("joints").at(joint).get<std::size_t>();
            sum += weights[4 * v + k] * glm::dvec3(global[node] * inverse * rest);
        }
        out.push_back(sum);
    }
    return out;
}

}  // namespace kino::test
