#include "calibration/boards/picture_pairs.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <map>
#include <system_error>
#include <utility>

namespace kino {
namespace {

namespace fs = std::filesystem;

bool is_digit(char c) {
    return c >= '0' && c <= '9';
}

// "img10" after "img9": runs of digits compare as numbers.
bool natural_less(const std::string& a, const std::string& b) {
    std::size_t i = 0;
    std::size_t j = 0;
    while (i < a.size() && j < b.size()) {
        if (is_digit(a[i]) && is_digit(b[j])) {
            const auto run = [](const std::string& text, std::size_t& at) {
                while (at < text.size() && text[at] == '0') ++at;
                const std::size_t from = at;
                while (at < text.size() && is_digit(text[at])) ++at;
                return text.substr(from, at - from);
            };
            const std::string x = run(a, i);
            const std::string y = run(b, j);
            if (x.size() != y.size()) return x.size() < y.size();
            if (x != y) return x < y;
        } else {
            if (a[i] != b[j]) return a[i] < b[j];
            ++i;
            ++j;
        }
    }
    if (a.size() - i != b.size() - j) return a.size() - i < b.size() - j;
    return a < b;
}

bool is_picture(const fs::path& path) {
    std::string extension = path.extension().string();
    for (char& c : extension) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
    return extension == ".png" || extension == ".jpg" || extension == ".jpeg";
}

Result<std::vector<fs::path>> list(const fs::path& folder) {
    std::error_code error;
    std::vector<fs::path> files;
    fs::directory_iterator entry(folder, error);
    if (error) return fail(error.message(), folder.string());
    for (; entry != fs::directory_iterator(); entry.increment(error)) {
        std::error_code ignored;
        if (is_picture(entry->path()) && entry->is_regular_file(ignored)) {
            files.push_back(entry->path());
        }
    }
    if (error) return fail(error.message(), folder.string());
    return files;
}

struct NaturalLess {
    bool operator()(const std::string& a, const std::string& b) const { return natural_less(a, b); }
};
using Views = std::map<std::string, PictureView, NaturalLess>;

void take(Views& views, const std::string& name, std::size_t camera, const fs::path& file) {
    PictureView& view = views[name];
    view.name = name;
    view.files[camera] = file;
}

std::size_t pair_count(const Views& views) {
    return static_cast<std::size_t>(std::count_if(views.begin(), views.end(), [](const auto& v) {
        return !v.second.files[0].empty() && !v.second.files[1].empty();
    }));
}

// "_01" and "-01" are called 01; so is a half-size twin "01_half".
std::string rest_of(const fs::path& file, const std::string& prefix) {
    std::string rest = file.stem().string().substr(prefix.size());
    while (!rest.empty() && (rest.front() == '-' || rest.front() == '_')) rest.erase(0, 1);
    return rest;
}

Result<Views> views_of(const fs::path& folder, const std::vector<fs::path>& files,
                       const std::array<std::string, 2>& names) {
    Views views;
    for (std::size_t camera = 0; camera < 2; ++camera) {
        std::error_code error;
        if (fs::is_directory(folder / names[camera], error)) {
            KINO_ASSIGN(const auto own, list(folder / names[camera]));
            for (const fs::path& file : own) take(views, file.stem().string(), camera, file);
            continue;
        }
        for (const fs::path& file : files) {
            if (file.filename().string().starts_with(names[camera])) {
                take(views, rest_of(file, names[camera]), camera, file);
            }
        }
    }
    return views;
}

PictureSet set_of(const std::vector<std::string>& cameras, const Views& views) {
    PictureSet out{cameras, {}};
    for (const auto& [name, view] : views) out.views.push_back(view);
    return out;
}

}  // namespace

Result<PictureSet> pictures_in(const fs::path& folder) {
    KINO_ASSIGN(const auto files, list(folder));
    if (files.empty()) return fail("no PNG or JPEG picture is in this folder", folder.string());
    Views views;
    for (const fs::path& file : files) take(views, file.filename().string(), 0, file);
    const std::string name = fs::path(folder / "").parent_path().filename().string();
    return set_of({name.empty() ? "camera" : name}, views);
}

Result<PictureSet> picture_pairs_in(const fs::path& folder, const std::string& names) {
    KINO_ASSIGN(const auto files, list(folder));
    std::vector<std::array<std::string, 2>> tried = {{"infrared", "color"},
                                                     {"ir", "color"},
                                                     {"depth", "color"},
                                                     {"ir", "rgb"},
                                                     {"left", "right"}};
    if (!names.empty()) {
        const std::size_t comma = names.find(',');
        if (comma == std::string::npos || comma == 0 || comma + 1 == names.size()) {
            return fail(fmt::format("\"{}\" are not two names", names), "--names",
                        "as in --names left,right");
        }
        tried = {{names.substr(0, comma), names.substr(comma + 1)}};
    }
    for (const auto& pair : tried) {
        KINO_ASSIGN(const Views views, views_of(folder, files, pair));
        if (pair_count(views) > 0) return set_of({pair[0], pair[1]}, views);
    }
    return fail("no pairs of pictures are in this folder", folder.string(),
                "call them left01.png and right01.png, or infrared01 and color01, or say --names");
}

}  // namespace kino
