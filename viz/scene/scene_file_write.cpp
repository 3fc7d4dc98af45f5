#include <fmt/format.h>

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "viz/scene/scene_fields.h"

namespace kino {
namespace {

using nlohmann::ordered_json;

std::string hex_of(const SceneColor& color) {
    return fmt::format("#{:02x}{:02x}{:02x}", color.r, color.g, color.b);
}

class FieldWriter {
  public:
    template <class T>
    [[nodiscard]] static ordered_json write(const T& value) {
        FieldWriter writer;
        // Visitors of either direction visit the same lines; this one only reads.
        scene_fields::visit(writer, const_cast<T&>(value));
        return std::move(writer.out_);
    }

    void number(const char* key, double value, double, double, const char*) { out_[key] = value; }
    void integer(const char* key, int value, int, int, const char*) { out_[key] = value; }
    void required_integer(const char* key, int value, int, int, const char*) { out_[key] = value; }
    template <class Words, class Value>
    void number_or(const char* key, double value, Value by, const Words& words, double, double,
                   const char*) {
        write_or(key, value, word_of(by, words));
    }
    template <class Words, class Value>
    void integer_or(const char* key, int value, Value by, const Words& words, int, int,
                    const char*) {
        write_or(key, value, word_of(by, words));
    }
    template <class Numbers>
    void one_of(const char* key, int value, const Numbers&, const char*) {
        out_[key] = value;
    }
    void vector(const char* key, const glm::dvec3& v, double, double, const char*) {
        out_[key] = {v.x, v.y, v.z};
    }
    void span(const char* key, const glm::dvec2& v, double, double, const char*) {
        out_[key] = {v.x, v.y};
    }
    void color(const char* key, const SceneColor& value, const char*) { out_[key] = hex_of(value); }
    void flag(const char* key, bool value, const char*) { out_[key] = value; }
    void text(const char* key, const std::string& value, std::size_t, const char*) {
        out_[key] = value;
    }
    template <class Words, class Value>
    void choice(const char* key, Value value, const Words& words, const char*) {
        out_[key] = word_of(value, words);
    }
    template <class T>
    void object(const char* key, const T& value, const char*) {
        out_[key] = write(value);
    }
    template <class T>
    void optional(const char* key, const std::optional<T>& value, const char*) {
        if (value) out_[key] = write(*value);
    }
    template <class T>
    void list(const char* key, const std::vector<T>& values, std::size_t, const char*) {
        ordered_json& items = out_[key] = ordered_json::array();
        for (const T& value : values) items.push_back(write(value));
    }
    void texts(const char* key, const std::vector<std::string>& values, std::size_t, std::size_t,
               const char*) {
        out_[key] = values;
    }
    void colors(const char* key, const std::vector<SceneColor>& values, std::size_t, const char*) {
        ordered_json& items = out_[key] = ordered_json::array();
        for (const SceneColor& value : values) items.push_back(hex_of(value));
    }
    template <class Words, class Value>
    void choices(const char* key, const std::vector<Value>& values, const Words& words, std::size_t,
                 const char*) {
        ordered_json& items = out_[key] = ordered_json::array();
        for (const Value value : values) items.push_back(word_of(value, words));
    }

  private:
    template <class Number>
    void write_or(const char* key, Number number, const std::string& word) {
        if (word.empty()) {
            out_[key] = number;
        } else {
            out_[key] = word;
        }
    }
    template <class Words, class Value>
    static std::string word_of(Value value, const Words& words) {
        for (const auto& [word, meant] : words) {
            if (meant == value) return std::string(word);
        }
        return {};
    }
    ordered_json out_ = ordered_json::object();
};

/// Describes one object as JSON Schema.
class SchemaWriter {
  public:
    template <class T>
    [[nodiscard]] static ordered_json schema() {
        SchemaWriter writer;
        T value;
        scene_fields::visit(writer, value);
        ordered_json out = {{"type", "object"}};
        if (!writer.required_.empty()) out["required"] = writer.required_;
        out["properties"] = std::move(writer.properties_);
        out["additionalProperties"] = false;
        return out;
    }

    void number(const char* key, double value, double least, double most, const char* about) {
        add(key, about, {{"type", "number"}, {"minimum", least}, {"maximum", most}}, value);
    }
    void integer(const char* key, int value, int least, int most, const char* about) {
        add(key, about, {{"type", "integer"}, {"minimum", least}, {"maximum", most}}, value);
    }
    void required_integer(const char* key, int value, int least, int most, const char* about) {
        integer(key, value, least, most, about);
        required_.push_back(key);
    }
    template <class Words, class Value>
    void number_or(const char* key, double value, Value, const Words& words, double least,
                   double most, const char* about) {
        add_or(key, about, {{"type", "number"}, {"minimum", least}, {"maximum", most}}, words,
               value);
    }
    template <class Words, class Value>
    void integer_or(const char* key, int value, Value, const Words& words, int least, int most,
                    const char* about) {
        add_or(key, about, {{"type", "integer"}, {"minimum", least}, {"maximum", most}}, words,
               value);
    }
    template <class Numbers>
    void one_of(const char* key, int value, const Numbers& numbers, const char* about) {
        add(key, about, {{"enum", numbers}}, value);
    }
    void vector(const char* key, const glm::dvec3& v, double least, double most,
                const char* about) {
        add(key, about, numbers(3, least, most), {v.x, v.y, v.z});
    }
    void span(const char* key, const glm::dvec2& v, double least, double most, const char* about) {
        add(key, about, numbers(2, least, most), {v.x, v.y});
    }
    void color(const char* key, const SceneColor& value, const char* about) {
        add(key, about, color_schema(), hex_of(value));
    }
    void flag(const char* key, bool value, const char* about) {
        add(key, about, {{"type", "boolean"}}, value);
    }
    void text(const char* key, const std::string&, std::size_t longest, const char* about) {
        add(key, about, {{"type", "string"}, {"maxLength", longest}});
    }
    template <class Words, class Value>
    void choice(const char* key, Value value, const Words& words, const char* about) {
        ordered_json of_default;
        for (const auto& [word, meant] : words) {
            if (meant == value) of_default = word;
        }
        add(key, about, word_schema(words), of_default);
    }
    template <class T>
    void object(const char* key, const T&, const char* about) {
        add(key, about, schema<T>());
    }
    template <class T>
    void optional(const char* key, const std::optional<T>&, const char* about) {
        add(key, about, schema<T>());
    }
    template <class T>
    void list(const char* key, const std::vector<T>&, std::size_t most, const char* about) {
        add_list(key, about, schema<T>(), most);
    }
    void texts(const char* key, const std::vector<std::string>&, std::size_t most,
               std::size_t longest, const char* about) {
        add_list(key, about, {{"type", "string"}, {"maxLength", longest}}, most);
    }
    void colors(const char* key, const std::vector<SceneColor>&, std::size_t most,
                const char* about) {
        add_list(key, about, color_schema(), most);
    }
    template <class Words, class Value>
    void choices(const char* key, const std::vector<Value>&, const Words& words, std::size_t most,
                 const char* about) {
        add_list(key, about, word_schema(words), most);
    }

  private:
    static ordered_json color_schema() {
        return {{"type", "string"}, {"pattern", "^#[0-9a-fA-F]{6}$"}};
    }
    static ordered_json numbers(int count, double least, double most) {
        return {{"type", "array"},
                {"minItems", count},
                {"maxItems", count},
                {"items", {{"type", "number"}, {"minimum", least}, {"maximum", most}}}};
    }
    template <class Words>
    static ordered_json word_schema(const Words& words) {
        ordered_json allowed = ordered_json::array();
        for (const auto& [word, meant] : words) allowed.push_back(word);
        return {{"enum", allowed}};
    }
    template <class Words>
    void add_or(const char* key, const char* about, const ordered_json& number, const Words& words,
                const ordered_json& of_default) {
        add(key, about, {{"anyOf", {number, word_schema(words)}}}, of_default);
    }
    void add_list(const char* key, const char* about, ordered_json items, std::size_t most) {
        add(key, about, {{"type", "array"}, {"maxItems", most}, {"items", std::move(items)}});
    }
    void add(const char* key, const char* about, ordered_json schema,
             const ordered_json& of_default = nullptr) {
        if (*about != '\0') schema["description"] = about;
        if (!of_default.is_null()) schema["default"] = of_default;
        properties_[key] = std::move(schema);
    }

    ordered_json properties_ = ordered_json::object();
    std::vector<std::string> required_;
};

}  // namespace

std::string scene_file_to_json(const SceneFile& file) {
    // Names from a program may hold bytes that are no UTF-8; those of files never do.
    return FieldWriter::write(file).dump(2, ' ', false, ordered_json::error_handler_t::replace) +
           "\n";
}

std::string scene_file_schema() {
    ordered_json out = {{"$schema", "https://json-schema.org/draft/2020-12/schema"},
                        {"title", "Kinoscope scene file"}};
    out.update(SchemaWriter::schema<SceneFile>());
    return out.dump(2) + "\n";
}

}  // namespace kino
