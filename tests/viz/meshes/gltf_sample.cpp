#include "gltf_sample.h"

#include <cstring>
#include <utility>

#include "sensor/png_io.h"

namespace kino::test {
namespace {

template <class T>
int add_values(GltfSample& sample, const std::vector<T>& values, const std::string& type,
               int component) {
    const int parts = type == "SCALAR" ? 1 : type == "MAT4" ? 16 : type.back() - '0';
    while (sample.buffer.size() % 4 != 0) sample.buffer.push_back(0);
    const std::size_t offset = sample.buffer.size();
    const std::size_t bytes = values.size() * sizeof(T);
    sample.buffer.resize(offset + bytes);
    std::memcpy(sample.buffer.data() + offset, values.data(), bytes);
    sample.json["bufferViews"].push_back(
        {{"buffer", 0}, {"byteOffset", offset}, {"byteLength", bytes}});
    sample.json["accessors"].push_back({{"bufferView", sample.json["bufferViews"].size() - 1},
                                        {"componentType", component},
                                        {"count", values.size() / static_cast<std::size_t>(parts)},
                                        {"type", type}});
    sample.json["buffers"][0]["byteLength"] = sample.buffer.size();
    return static_cast<int>(sample.json["accessors"].size()) - 1;
}

void append_word(std::vector<std::uint8_t>& bytes, std::size_t word) {
    for (int shift = 0; shift < 32; shift += 8) {
        bytes.push_back(static_cast<std::uint8_t>(word >> shift));
    }
}

}  // namespace

int GltfSample::add(const std::vector<float>& values, const std::string& type) {
    return add_values(*this, values, type, 5126);
}
int GltfSample::add(const std::vector<std::uint16_t>& values, const std::string& type) {
    return add_values(*this, values, type, 5123);
}

std::string base64(const std::vector<std::uint8_t>& bytes) {
    const char* digits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    std::string text;
    for (std::size_t i = 0; i < bytes.size(); i += 3) {
        std::uint32_t three = 0;
        for (std::size_t k = 0; k < 3; ++k) {
            three = three << 8 | (i + k < bytes.size() ? bytes[i + k] : 0u);
        }
        for (std::size_t k = 0; k < 4; ++k) {
            text += i + k <= bytes.size() ? digits[three >> (18 - 6 * k) & 63] : '=';
        }
    }
    return text;
}

std::vector<std::uint8_t> GltfSample::as_glb() const {
    std::string text = json.dump();
    while (text.size() % 4 != 0) text += ' ';
    std::vector<std::uint8_t> bin = buffer;
    while (bin.size() % 4 != 0) bin.push_back(0);
    std::vector<std::uint8_t> bytes;
    append_word(bytes, 0x46546C67);
    append_word(bytes, 2);
    append_word(bytes, 12 + 8 + text.size() + 8 + bin.size());
    append_word(bytes, text.size());
    append_word(bytes, 0x4E4F534A);
    bytes.insert(bytes.end(), text.begin(), text.end());
    append_word(bytes, bin.size());
    append_word(bytes, 0x004E4942);
    bytes.insert(bytes.end(), bin.begin(), bin.end());
    return bytes;
}

std::vector<std::uint8_t> GltfSample::as_gltf() const {
    nlohmann::json whole = json;
    whole["buffers"][0]["uri"] = "data:application/octet-stream;base64," + base64(buffer);
    const std::string text = whole.dump();
    return {text.begin(), text.end()};
}

GltfSample make_gltf_sample() {
    GltfSample s;
    s.json = nlohmann::json::parse(R"({
      "asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": [3, 0]}],
      "buffers": [{}],
      "nodes": [{"name": "person", "mesh": 0, "skin": 0, "translation": [9, 9, 9]},
                {"name": "tip", "translation": [0, 1, 0]},
                {"name": "root", "children": [1]},
                {"name": "stage", "children": [2], "scale": [2, 2, 2]}],
      "meshes": [{"name": "strip", "primitives": [{
        "attributes": {"POSITION": 0, "NORMAL": 1, "TEXCOORD_0": 2, "JOINTS_0": 4, "WEIGHTS_0": 5},
        "indices": 3, "material": 0}]}],
      "skins": [{"joints": [1, 2], "inverseBindMatrices": 6}],
      "animations": [{"name": "bend", "samplers": [{"input": 7, "output": 8}],
                      "channels": [{"sampler": 0, "target": {"node": 1, "path": "rotation"}}]}],
      "textures": [{"source": 0}],
      "materials": [{"name": "cloth", "alphaMode": "BLEND", "emissiveFactor": [0, 0.5, 0],
        "pbrMetallicRoughness": {"baseColorFactor": [0.5, 0.25, 1, 0.5], "metallicFactor": 0,
                                 "roughnessFactor": 0.3, "baseColorTexture": {"index": 0}}}]})");
    using Floats = std::vector<float>;
    using Words = std::vector<std::uint16_t>;
    // Upright, 0 to 2 m, corners in rows of two.
    s.add(Floats{-1, 0, 0, 1, 0, 0, -1, 1, 0, 1, 1, 0, -1, 2, 0, 1, 2, 0}, "VEC3");
    s.add(Floats{0, 0, 1, 0, 0, 1, 0, 0, 1, 0, 0, 1, 0, 0, 1, 0, 0, 1}, "VEC3");
    s.add(Floats{0, 1, 1, 1, 0, .5f, 1, .5f, 0, 0, 1, 0}, "VEC2");
    s.add(Words{0, 1, 3, 0, 3, 2, 2, 3, 5, 2, 5, 4}, "SCALAR");
    // The file's joint 0 is the tip, 1 the root: ours must be the other way round.
    s.add(Words{1, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0}, "VEC4");
    s.add(Floats{1, 0, 0, 0, 1, 0, 0, 0, .5f, .5f, 0, 0, .5f, .5f, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0},
          "VEC4");
    s.add(Floats{1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, -1, 0, 1,
                 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0,  0, 1},
          "MAT4");
    s.add(Floats{0, 1, 2}, "SCALAR");
    const float half = 0.70710678f;
    s.add(Floats{0, 0, 0, 1, 0, 0, half, half, 0, 0, 0, 1}, "VEC4");
    Image<Rgba8> picture(2, 2);
    picture.at(0, 0) = {255, 0, 0, 255};
    const auto png = encode_png_rgba8(std::as_const(picture).view());
    s.json["images"][0]["uri"] =
        "data:image/png;base64," + base64(png ? *png : std::vector<std::uint8_t>());
    return s;
}

}  // namespace kino::test
