#include "sensor/convert/staged_output.h"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <string_view>
#include <system_error>
#include <utility>

namespace kino {
namespace {

namespace fs = std::filesystem;

constexpr const char* kForceHint = "--force replaces it";

bool is_ours(const fs::directory_entry& entry) {
    constexpr std::array<std::string_view, 5> kFiles = {"rgb.txt", "depth.txt", "groundtruth.txt",
                                                        "calibration.json", "kinoscope.json"};
    constexpr std::array<std::string_view, 4> kFolders = {"rgb", "depth", "color", "infrared"};
    std::error_code error;
    const std::string name = entry.path().filename().string();
    if (entry.is_symlink(error)) return false;
    if (entry.is_regular_file(error)) {
        return entry.path().extension() == ".ply" ||
               std::find(kFiles.begin(), kFiles.end(), name) != kFiles.end();
    }
    if (!entry.is_directory(error) ||
        std::find(kFolders.begin(), kFolders.end(), name) == kFolders.end()) {
        return false;
    }
    for (fs::directory_iterator at(entry.path(), error); at != fs::directory_iterator();
         at.increment(error)) {
        if (error || !at->is_regular_file(error) || at->path().extension() != ".png") return false;
    }
    return !error;
}

/// Nothing of a user's goes because a path was mistyped.
Result<void> check_replaceable(const fs::path& folder) {
    std::error_code error;
    for (fs::directory_iterator at(folder, error); at != fs::directory_iterator();
         at.increment(error)) {
        if (error) break;
        if (!is_ours(*at)) {
            return fail(fmt::format("the folder holds \"{}\", which no conversion writes: it is "
                                    "not replaced",
                                    at->path().filename().string()),
                        folder.string(), "name another folder");
        }
    }
    if (error) return fail(error.message(), folder.string());
    return {};
}

fs::path without_slash(fs::path path) {
    return path.has_filename() ? path : path.parent_path();
}

}  // namespace

StagedOutput::StagedOutput(fs::path target, bool replace)
    : target_(without_slash(std::move(target))), partial_(target_), replace_(replace) {
    partial_ += fmt::format(".{}.partial", ::getpid());
}

StagedOutput::StagedOutput(StagedOutput&& other) noexcept
    : target_(std::move(other.target_)),
      partial_(std::move(other.partial_)),
      replace_(other.replace_),
      owns_(std::exchange(other.owns_, false)) {}

StagedOutput::~StagedOutput() {
    if (!owns_) return;
    std::error_code ignored;
    fs::remove_all(partial_, ignored);
}

Result<StagedOutput> StagedOutput::file(const fs::path& target, bool replace) {
    std::error_code error;
    const fs::file_status status = fs::symlink_status(target, error);
    if (fs::exists(status)) {
        if (fs::is_directory(status))
            return fail("there is a folder of this name", target.string());
        if (!replace) return fail("the file exists already", target.string(), kForceHint);
    }
    const fs::path parent = target.has_parent_path() ? target.parent_path() : fs::path(".");
    if (!fs::is_directory(parent, error)) {
        return fail("there is no such folder", parent.string(), "make it first");
    }
    return StagedOutput(target, replace);
}

Result<StagedOutput> StagedOutput::folder(const fs::path& target, bool replace) {
    StagedOutput out(target, replace);
    out.owns_ = false;
    std::error_code error;
    const fs::file_status status = fs::symlink_status(out.target_, error);
    if (fs::exists(status)) {
        if (!fs::is_directory(status)) return fail("not a folder", target.string());
        if (!fs::is_empty(out.target_, error) || error) {
            if (!replace) {
                return fail("the folder exists already and is not empty", target.string(),
                            kForceHint);
            }
            KINO_TRY(check_replaceable(out.target_));
        }
    }
    if (!fs::create_directory(out.partial_, error)) {
        return fail(error ? error.message() : "an earlier conversion is in the way",
                    out.partial_.string());
    }
    out.owns_ = true;
    return out;
}

Result<void> StagedOutput::commit() {
    std::error_code error;
    fs::path old;
    if (fs::exists(fs::symlink_status(target_, error))) {
        const bool empty_folder = fs::is_directory(target_, error) && fs::is_empty(target_, error);
        if (!replace_ && !empty_folder) {
            return fail("the name was taken meanwhile", target_.string(), kForceHint);
        }
        if (fs::is_directory(target_, error) && !empty_folder) {
            KINO_TRY(check_replaceable(target_));
            old = target_;
            old += fmt::format(".{}.old", ::getpid());
            fs::rename(target_, old, error);
            if (error) return fail(error.message(), target_.string());
        }
    }
    fs::rename(partial_, target_, error);
    if (error) {
        const std::string reason = error.message();
        if (!old.empty()) fs::rename(old, target_, error);
        return fail(reason, target_.string());
    }
    owns_ = false;
    if (!old.empty()) fs::remove_all(old, error);
    return {};
}

}  // namespace kino
