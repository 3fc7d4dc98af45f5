#include <fmt/format.h>

#include <array>
#include <cmath>
#include <set>

#include "viz/surface/assets/gltf_document.h"

namespace kino {
namespace {

using nlohmann::json;

constexpr std::uint64_t kWords = std::uint64_t{1} << 32;

/// Copies what is known and sound from the file's JSON, place by place; the first fault ends it.
class Checker {
  public:
    Checker(const GltfDocument& document, std::string where, const GltfLimits& limits,
            std::vector<std::string>& notes)
        : in_(document.json),
          document_(document),
          where_(std::move(where)),
          limits_(limits),
          notes_(notes) {}

    Result<std::string> run() {
        KINO_TRY(asset());
        KINO_TRY(lists());
        KINO_TRY(buffers());
        KINO_TRY(accessors());
        KINO_TRY(materials());
        KINO_TRY(meshes());
        KINO_TRY(nodes());
        KINO_TRY(skins());
        KINO_TRY(animations());
        return out_.dump(-1, ' ', false, json::error_handler_t::replace);
    }

  private:
    [[nodiscard]] tl::unexpected<Error> bad(const std::string& what, const std::string& pointer) {
        return fail(what, where_ + "#" + pointer);
    }

    [[nodiscard]] std::size_t count(const char* list) const {
        const auto found = in_.find(list);
        return found == in_.end() ? 0 : found->size();
    }

    /// A whole number below `limit`.
    Result<void> number(const json& from, json& to, const char* key, const std::string& at,
                        bool wanted, std::uint64_t limit) {
        const auto found = from.find(key);
        if (found == from.end()) {
            if (wanted) return bad(fmt::format("'{}' is missing", key), at);
            return {};
        }
        if (!found->is_number_unsigned() || found->get<std::uint64_t>() >= limit) {
            return bad(fmt::format("'{}' is not a number below {}", key, limit), at);
        }
        to[key] = *found;
        return {};
    }
    /// An index into one of the file's lists.
    Result<void> index(const json& from, json& to, const char* key, const std::string& at,
                       bool wanted, const char* list) {
        return number(from, to, key, at, wanted, count(list));
    }
    /// A list of indices, each once.
    Result<void> indices(const json& from, json& to, const char* key, const std::string& at,
                         const char* list) {
        const auto found = from.find(key);
        if (found == from.end()) return {};
        if (!found->is_array() || found->size() > count(list)) {
            return bad(fmt::format("'{}' is not a list of {}", key, list), at);
        }
        std::set<std::uint64_t> seen;
        for (const json& entry : *found) {
            if (!entry.is_number_unsigned() || entry.get<std::uint64_t>() >= count(list) ||
                !seen.insert(entry.get<std::uint64_t>()).second) {
                return bad(fmt::format("'{}' names what is not there, or twice", key), at);
            }
        }
        to[key] = *found;
        return {};
    }
    Result<void> floats(const json& from, json& to, const char* key, const std::string& at,
                        std::size_t numbers) {
        const auto found = from.find(key);
        if (found == from.end()) return {};
        if (!found->is_array() || found->size() != numbers) {
            return bad(fmt::format("'{}' does not have {} numbers", key, numbers), at);
        }
        for (const json& entry : *found) {
            if (!entry.is_number() || !(std::abs(entry.get<double>()) < 1e30)) {
                return bad(fmt::format("'{}' holds what is not a number", key), at);
            }
        }
        to[key] = *found;
        return {};
    }
    Result<void> kept_if(bool sound, const json& from, json& to, const char* key,
                         const std::string& at) {
        if (!from.contains(key)) return {};
        if (!sound) return bad(fmt::format("'{}' is of another kind", key), at);
        to[key] = from[key];
        return {};
    }
    Result<void> factor(const json& from, json& to, const char* key, const std::string& at) {
        const json value = from.value(key, json());
        return kept_if(value.is_number() && std::abs(value.get<double>()) < 1e30, from, to, key,
                       at);
    }
    Result<void> text(const json& from, json& to, const char* key, const std::string& at) {
        return kept_if(from.value(key, json()).is_string(), from, to, key, at);
    }

    Result<void> asset() {
        const auto found = in_.find("asset");
        if (found == in_.end() || !found->is_object() ||
            !found->value("version", json()).is_string()) {
            return bad("not a glTF file: it names no version", "/asset");
        }
        if (!(*found)["version"].get_ref<const std::string&>().starts_with("2.")) {
            return bad("only glTF 2 is read", "/asset/version");
        }
        out_["asset"] = {{"version", "2.0"}};
        const auto required = in_.find("extensionsRequired");
        if (required == in_.end()) return {};
        if (!required->is_array()) return bad("not a list", "/extensionsRequired");
        static const std::set<std::string> kKnown = {"KHR_mesh_quantization",
                                                     "KHR_materials_unlit"};
        for (const json& name : *required) {
            if (!name.is_string() || !kKnown.contains(name.get<std::string>())) {
                return fail(fmt::format("the file needs the extension {}", name.dump()), where_,
                            "export it without compression and extensions");
            }
        }
        return {};
    }

    Result<void> lists() {
        for (const char* list : {"bufferViews", "accessors", "images", "textures", "materials",
                                 "meshes", "nodes", "skins", "animations", "scenes"}) {
            const auto found = in_.find(list);
            if (found == in_.end()) continue;
            if (!found->is_array() || found->size() > limits_.items) {
                return bad("not a list, or too long", fmt::format("/{}", list));
            }
            for (std::size_t i = 0; i < found->size(); ++i) {
                if (!(*found)[i].is_object()) {
                    return bad("not an object", fmt::format("/{}/{}", list, i));
                }
            }
        }
        return {};
    }

    Result<void> buffers() {
        for (std::size_t i = 0; i < document_.buffers.size(); ++i) {
            out_["buffers"].push_back(
                {{"uri", fmt::format("{}", i)}, {"byteLength", document_.buffers[i].size()}});
        }
        for (std::size_t i = 0; i < count("bufferViews"); ++i) {
            const json& from = in_["bufferViews"][i];
            const std::string at = fmt::format("/bufferViews/{}", i);
            json to = json::object();
            KINO_TRY(index(from, to, "buffer", at, true, "buffers"));
            KINO_TRY(number(from, to, "byteOffset", at, false, kWords));
            KINO_TRY(number(from, to, "byteLength", at, true, kWords));
            KINO_TRY(number(from, to, "byteStride", at, false, 253));
            const std::uint64_t size = document_.buffers[to["buffer"].get<std::size_t>()].size();
            const std::uint64_t offset = to.value("byteOffset", std::uint64_t{0});
            const auto length = to["byteLength"].get<std::uint64_t>();
            if (length == 0 || offset > size || length > size - offset) {
                return bad("a view runs past its buffer", at);
            }
            out_["bufferViews"].push_back(std::move(to));
        }
        return {};
    }

    Result<void> accessors() {
        for (std::size_t i = 0; i < count("accessors"); ++i) {
            const json& from = in_["accessors"][i];
            const std::string at = fmt::format("/accessors/{}", i);
            if (from.contains("sparse")) return bad("sparse accessors are not read", at);
            json to = json::object();
            KINO_TRY(index(from, to, "bufferView", at, true, "bufferViews"));
            KINO_TRY(number(from, to, "byteOffset", at, false, kWords));
            KINO_TRY(number(from, to, "count", at, true, kWords));
            KINO_TRY(number(from, to, "componentType", at, true, 5127));
            KINO_TRY(text(from, to, "type", at));
            KINO_TRY(
                kept_if(from.value("normalized", json()).is_boolean(), from, to, "normalized", at));
            static constexpr std::array<std::pair<const char*, std::uint64_t>, 5> kTypes = {
                {{"SCALAR", 1}, {"VEC2", 2}, {"VEC3", 3}, {"VEC4", 4}, {"MAT4", 16}}};
            std::uint64_t parts = 0;
            for (const auto& [name, number_of] : kTypes) {
                if (to.value("type", std::string()) == name) parts = number_of;
            }
            const auto component = to["componentType"].get<std::uint64_t>();
            const bool known = component >= 5120 && component != 5124;
            const std::uint64_t bytes = component < 5122 ? 1 : component < 5124 ? 2 : 4;
            if (parts == 0 || !known) return bad("an unknown kind of numbers", at);
            const json& view = out_["bufferViews"][to["bufferView"].get<std::size_t>()];
            const std::uint64_t element = parts * bytes;
            const std::uint64_t stride = view.value("byteStride", element);
            const std::uint64_t offset = to.value("byteOffset", std::uint64_t{0});
            const auto length = view["byteLength"].get<std::uint64_t>();
            const auto number_of = to["count"].get<std::uint64_t>();
            if (stride < element) return bad("elements overlap", at);
            // All below 2^40: nothing overflows.
            if (number_of == 0 || offset + (number_of - 1) * stride + element > length) {
                return bad("an accessor runs past its view", at);
            }
            out_["accessors"].push_back(std::move(to));
        }
        return {};
    }

    Result<void> texture(const json& from, json& to, const char* key, const std::string& at) {
        const auto found = from.find(key);
        if (found == from.end()) return {};
        if (!found->is_object()) return bad(fmt::format("'{}' is no object", key), at);
        KINO_TRY(index(*found, to[key], "index", at, true, "textures"));
        return {};
    }

    Result<void> materials() {
        for (std::size_t i = 0; i < count("textures"); ++i) {
            json to = json::object();
            KINO_TRY(index(in_["textures"][i], to, "source", fmt::format("/textures/{}", i), false,
                           "images"));
            out_["textures"].push_back(std::move(to));
        }
        for (std::size_t i = 0; i < count("materials"); ++i) {
            const json& from = in_["materials"][i];
            const std::string at = fmt::format("/materials/{}", i);
            json to = json::object();
            KINO_TRY(text(from, to, "name", at));
            KINO_TRY(text(from, to, "alphaMode", at));
            KINO_TRY(floats(from, to, "emissiveFactor", at, 3));
            const auto pbr = from.find("pbrMetallicRoughness");
            if (pbr != from.end()) {
                if (!pbr->is_object()) return bad("'pbrMetallicRoughness' is no object", at);
                json& out = to["pbrMetallicRoughness"];
                out = json::object();
                KINO_TRY(floats(*pbr, out, "baseColorFactor", at, 4));
                KINO_TRY(factor(*pbr, out, "metallicFactor", at));
                KINO_TRY(factor(*pbr, out, "roughnessFactor", at));
                KINO_TRY(texture(*pbr, out, "baseColorTexture", at));
            }
            out_["materials"].push_back(std::move(to));
        }
        return {};
    }

    [[nodiscard]] std::size_t elements(const json& accessor) const {
        return out_["accessors"][accessor.get<std::size_t>()]["count"].get<std::size_t>();
    }

    Result<void> meshes() {
        std::size_t vertices = 0;
        std::size_t corners = 0;
        std::size_t primitives_seen = 0;
        bool morphs = false;
        for (std::size_t i = 0; i < count("meshes"); ++i) {
            const json& from = in_["meshes"][i];
            json to = json::object();
            KINO_TRY(text(from, to, "name", fmt::format("/meshes/{}", i)));
            to["primitives"] = json::array();
            const json primitives = from.value("primitives", json());
            if (!primitives.is_array()) {
                return bad("a mesh without primitives", fmt::format("/meshes/{}", i));
            }
            primitives_seen += primitives.size();
            if (primitives_seen > limits_.items) return bad("too many primitives", "/meshes");
            for (std::size_t k = 0; k < primitives.size(); ++k) {
                const json& primitive = primitives[k];
                const std::string at = fmt::format("/meshes/{}/primitives/{}", i, k);
                if (!primitive.is_object()) return bad("not an object", at);
                json out = json::object();
                KINO_TRY(number(primitive, out, "mode", at, false, 7));
                KINO_TRY(index(primitive, out, "material", at, false, "materials"));
                KINO_TRY(index(primitive, out, "indices", at, false, "accessors"));
                const json attributes = primitive.value("attributes", json());
                if (!attributes.is_object()) return bad("a primitive without attributes", at);
                out["attributes"] = json::object();
                for (const char* name : {"POSITION", "NORMAL", "TEXCOORD_0", "JOINTS_0",
                                         "WEIGHTS_0", "JOINTS_1", "WEIGHTS_1"}) {
                    KINO_TRY(index(attributes, out["attributes"], name, at, false, "accessors"));
                }
                const json& kept = out["attributes"];
                if (!kept.contains("POSITION")) return bad("vertices without positions", at);
                const std::size_t number_of = elements(kept["POSITION"]);
                for (const json& attribute : kept) {
                    if (elements(attribute) != number_of) {
                        return bad("attributes differ in number", at);
                    }
                }
                for (const char* set : {"0", "1"}) {
                    if (kept.contains(fmt::format("JOINTS_{}", set)) !=
                        kept.contains(fmt::format("WEIGHTS_{}", set))) {
                        return bad("joints without weights, or weights without joints", at);
                    }
                }
                // Strips and fans become lists, three corners for each of theirs.
                const std::size_t named =
                    out.contains("indices") ? elements(out["indices"]) : number_of;
                vertices += kept.contains("NORMAL") ? number_of : 3 * named;
                corners += out.value("mode", 4u) == 4 ? named : 3 * named;
                if (vertices > limits_.vertices || corners > limits_.indices) {
                    return fail("the meshes are too large", where_,
                                fmt::format("at most {} vertices and {} corners", limits_.vertices,
                                            limits_.indices));
                }
                if (primitive.contains("targets")) morphs = true;
                to["primitives"].push_back(std::move(out));
            }
            out_["meshes"].push_back(std::move(to));
        }
        if (morphs) notes_.emplace_back("morph targets are not drawn");
        return {};
    }

    Result<void> nodes() {
        const std::size_t total = count("nodes");
        std::vector<int> parents(total, -1);
        for (std::size_t i = 0; i < total; ++i) {
            const json& from = in_["nodes"][i];
            const std::string at = fmt::format("/nodes/{}", i);
            json to = json::object();
            KINO_TRY(text(from, to, "name", at));
            KINO_TRY(indices(from, to, "children", at, "nodes"));
            KINO_TRY(index(from, to, "mesh", at, false, "meshes"));
            KINO_TRY(index(from, to, "skin", at, false, "skins"));
            for (const auto& [key, numbers] : {std::pair("matrix", 16), std::pair("translation", 3),
                                               std::pair("rotation", 4), std::pair("scale", 3)}) {
                KINO_TRY(floats(from, to, key, at, static_cast<std::size_t>(numbers)));
            }
            for (const json& child : to.value("children", json::array())) {
                int& parent = parents[child.get<std::size_t>()];
                if (parent >= 0) return bad("a node has two parents", at);
                parent = static_cast<int>(i);
            }
            out_["nodes"].push_back(std::move(to));
        }
        // With one parent each, nodes form trees unless some run in a circle.
        std::vector<char> sound(total, 0);
        for (std::size_t i = 0; i < total; ++i) {
            std::vector<std::size_t> path;
            for (auto n = static_cast<int>(i); n >= 0 && sound[static_cast<std::size_t>(n)] == 0;
                 n = parents[static_cast<std::size_t>(n)]) {
                path.push_back(static_cast<std::size_t>(n));
                if (path.size() > total) return bad("nodes run in a circle", "/nodes");
            }
            for (const std::size_t n : path) sound[n] = 1;
        }
        KINO_TRY(number(in_, out_, "scene", "", false, std::max<std::size_t>(count("scenes"), 1)));
        for (std::size_t i = 0; i < count("scenes"); ++i) {
            json to = json::object();
            KINO_TRY(indices(in_["scenes"][i], to, "nodes", fmt::format("/scenes/{}", i), "nodes"));
            out_["scenes"].push_back(std::move(to));
        }
        return {};
    }

    Result<void> skins() {
        for (std::size_t i = 0; i < count("skins"); ++i) {
            const json& from = in_["skins"][i];
            const std::string at = fmt::format("/skins/{}", i);
            json to = json::object();
            KINO_TRY(indices(from, to, "joints", at, "nodes"));
            if (!to.contains("joints") || to["joints"].empty() || to["joints"].size() > 65535) {
                return bad("a skin without joints", at);
            }
            KINO_TRY(index(from, to, "inverseBindMatrices", at, false, "accessors"));
            if (to.contains("inverseBindMatrices")) {
                const json& accessor =
                    out_["accessors"][to["inverseBindMatrices"].get<std::size_t>()];
                if (accessor["type"] != "MAT4" ||
                    elements(to["inverseBindMatrices"]) < to["joints"].size()) {
                    return bad("a skin with fewer matrices than joints", at);
                }
            }
            out_["skins"].push_back(std::move(to));
        }
        return {};
    }

    Result<void> animations() {
        std::size_t keys = 0;
        std::size_t channels_seen = 0;
        for (std::size_t i = 0; i < count("animations"); ++i) {
            const json& from = in_["animations"][i];
            const std::string at = fmt::format("/animations/{}", i);
            json to = {{"channels", json::array()}, {"samplers", json::array()}};
            KINO_TRY(text(from, to, "name", at));
            for (const char* list : {"channels", "samplers"}) {
                if (!from.contains(list) || !from[list].is_array()) {
                    return bad(fmt::format("an animation without {}", list), at);
                }
                channels_seen += from[list].size();
                if (channels_seen > 8 * limits_.items) return bad("too many channels", at);
            }
            for (const json& sampler : from["samplers"]) {
                if (!sampler.is_object()) return bad("not an object", at + "/samplers");
                json out = json::object();
                KINO_TRY(index(sampler, out, "input", at, true, "accessors"));
                KINO_TRY(index(sampler, out, "output", at, true, "accessors"));
                KINO_TRY(text(sampler, out, "interpolation", at));
                to["samplers"].push_back(std::move(out));
            }
            for (const json& channel : from["channels"]) {
                if (!channel.is_object() || !channel.contains("target") ||
                    !channel["target"].is_object()) {
                    return bad("a channel without a target", at + "/channels");
                }
                json out = json::object();
                KINO_TRY(number(channel, out, "sampler", at, true, from["samplers"].size()));
                KINO_TRY(index(channel["target"], out["target"], "node", at, false, "nodes"));
                KINO_TRY(text(channel["target"], out["target"], "path", at));
                // Extensions animate other things than nodes.
                if (!out["target"].is_object() || !out["target"].contains("node")) continue;
                keys += elements(to["samplers"][out["sampler"].get<std::size_t>()]["output"]);
                if (keys > limits_.keys) return fail("the animations are too long", where_);
                to["channels"].push_back(std::move(out));
            }
            out_["animations"].push_back(std::move(to));
        }
        return {};
    }

    const json& in_;
    json out_ = json::object();
    const GltfDocument& document_;
    std::string where_;
    const GltfLimits& limits_;
    std::vector<std::string>& notes_;
};

}  // namespace

Result<std::string> check_gltf(const GltfDocument& document, const std::string& where,
                               const GltfLimits& limits, std::vector<std::string>& notes) {
    return Checker(document, where, limits, notes).run();
}

}  // namespace kino
