#include "apps/viewer/settings.h"

#include <fmt/format.h>

#include <cstdlib>
#include <fstream>
#include <nlohmann/json.hpp>
#include <optional>

#include "sensor/file_bytes.h"

namespace kino {
namespace {

using Json = nlohmann::ordered_json;

constexpr std::size_t kMostBytes = std::size_t{1} << 20;

/// Reads a member if it is there; complains of what does not fit.
class Reader {
  public:
    explicit Reader(const Json& json) : json_(json) {}

    void integer(const char* name, int least, int most, int& out) {
        if (!json_.contains(name)) return;
        const Json& value = json_[name];
        if (value.is_number_integer() && value >= least && value <= most) {
            out = value.get<int>();
        } else {
            complain(name);
        }
    }
    void boolean(const char* name, bool& out) {
        if (!json_.contains(name)) return;
        if (json_[name].is_boolean()) {
            out = json_[name].get<bool>();
        } else {
            complain(name);
        }
    }
    template <class Enum>
    void choice(const char* name, std::initializer_list<std::pair<const char*, Enum>> known,
                Enum& out) {
        if (!json_.contains(name)) return;
        for (const auto& [word, value] : known) {
            if (json_[name] == word) {
                out = value;
                return;
            }
        }
        complain(name);
    }
    [[nodiscard]] const std::string& problems() const { return problems_; }

  private:
    void complain(const char* name) {
        problems_ += fmt::format("{}{}", problems_.empty() ? "not understood: " : ", ", name);
    }
    const Json& json_;
    std::string problems_;
};

const char* style_name(DepthStyle style) {
    return style == DepthStyle::mesh ? "mesh" : "cloud";
}

}  // namespace

std::filesystem::path settings_path() {
    const auto from = [](const char* variable) {
        const char* value = std::getenv(variable);
        return std::filesystem::path(value != nullptr ? value : "");
    };
    std::filesystem::path base = from("XDG_CONFIG_HOME");
    // The standard says that a relative path there is to be ignored.
    if (!base.is_absolute()) {
        const std::filesystem::path home = from("HOME");
        if (home.empty()) return {};
        base = home / ".config";
    }
    return base / "kinoscope" / "settings.json";
}

LoadedSettings load_settings(const std::filesystem::path& path) {
    LoadedSettings out;
    std::error_code error;
    if (!std::filesystem::exists(path, error)) return out;
    const auto text = read_file_text(path, kMostBytes);
    const Json json = text ? Json::parse(*text, nullptr, false) : Json();
    if (!json.is_object()) {
        out.note = fmt::format("{} is damaged; using defaults", path.string());
        return out;
    }
    Settings& s = out.settings;
    Reader reader(json);
    reader.integer("width", 320, 16384, s.width);
    reader.integer("height", 240, 16384, s.height);
    reader.choice("style", {{"mesh", DepthStyle::mesh}, {"cloud", DepthStyle::cloud}}, s.style);
    reader.integer("splat_px", 1, 32, s.splat_px);
    reader.choice(
        "view", {{"sensor", ViewKind::sensor}, {"orbit", ViewKind::orbit}, {"fly", ViewKind::fly}},
        s.view);
    reader.boolean("show_overlay", s.show_overlay);
    reader.boolean("show_panes", s.show_panes);
    if (!reader.problems().empty()) {
        out.note = fmt::format("{}: {}", path.string(), reader.problems());
    }
    return out;
}

Result<void> save_settings(const std::filesystem::path& path, const Settings& settings) {
    if (path.empty()) return {};
    const Json json = {{"width", settings.width},
                       {"height", settings.height},
                       {"style", style_name(settings.style)},
                       {"splat_px", settings.splat_px},
                       {"view", view_name(settings.view)},
                       {"show_overlay", settings.show_overlay},
                       {"show_panes", settings.show_panes}};
    std::error_code error;
    std::filesystem::create_directories(path.parent_path(), error);
    // Written beside and renamed: a full disk must not leave half a file behind.
    const std::filesystem::path fresh = path.string() + ".new";
    {
        std::ofstream file(fresh, std::ios::binary);
        file << json.dump(2) << '\n';
        file.close();
        if (!file) return fail("settings could not be written", fresh.string());
    }
    std::filesystem::rename(fresh, path, error);
    if (error) return fail("settings could not be written: " + error.message(), path.string());
    return {};
}

}  // namespace kino
