#include "tests/sensor/device/scenarios/modules.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <sstream>
#include <thread>

namespace kino::guest {
namespace {

constexpr const char* kModules = "/kino/modules";

/// "…/modules/later/121-gspca_main.ko"; empty if there is none.
std::string file_of(const std::string& module) {
    for (const auto& entry : std::filesystem::recursive_directory_iterator(kModules)) {
        const std::string stem = entry.path().stem().string();
        const std::size_t dash = stem.find('-');
        if (dash != std::string::npos && stem.substr(dash + 1) == module) return entry.path();
    }
    return {};
}

std::string underscored(std::string name) {
    std::ranges::replace(name, '-', '_');
    return name;
}

Result<void> insert(const std::string& module, const std::string& parameters) {
    const std::string path = file_of(module);
    if (path.empty()) return fail("no such module in the guest", module);
    std::ifstream file(path, std::ios::binary);
    const std::string bytes((std::istreambuf_iterator<char>(file)), {});
    const std::string key("\0depends=", 9);
    if (const std::size_t at = bytes.find(key); at != std::string::npos) {
        std::istringstream names(std::string(bytes.c_str() + at + key.size()));
        for (std::string name; std::getline(names, name, ',');) {
            if (!name.empty()) KINO_TRY(insert(underscored(name), ""));
        }
    }
    const int fd = open(path.c_str(), O_RDONLY | O_CLOEXEC);
    if (fd < 0) return fail(std::strerror(errno), path);
    const long status = syscall(SYS_finit_module, fd, parameters.c_str(), 0);
    const int error = errno;
    close(fd);
    if (status != 0 && error != EEXIST) return fail(std::strerror(error), path);
    return {};
}

}  // namespace

Result<void> insert_module(const std::string& name, const std::string& parameters) {
    KINO_TRY(remove_module(name));
    return insert(name, parameters);
}

Result<void> remove_module(const std::string& name) {
    int error = 0;
    // A device that has just left may hold it for a moment.
    for (int tries = 0; tries < 250; ++tries) {
        if (syscall(SYS_delete_module, name.c_str(), O_NONBLOCK) == 0) return {};
        error = errno;
        if (error == ENOENT) return {};
        std::this_thread::sleep_for(std::chrono::milliseconds(20));
    }
    return fail(fmt::format("cannot remove: {}", std::strerror(error)), name);
}

std::string wait_for_video_node(const std::string& name_begin) {
    const std::filesystem::path folder = "/sys/class/video4linux";
    for (int tries = 0; tries < 500; ++tries) {
        std::error_code ignored;
        for (const auto& entry : std::filesystem::directory_iterator(folder, ignored)) {
            std::ifstream file(entry.path() / "name");
            std::string name;
            std::getline(file, name);
            const std::string node = "/dev/" + entry.path().filename().string();
            if (name.starts_with(name_begin) && access(node.c_str(), R_OK | W_OK) == 0) return node;
        }
        std::this_thread::sleep_for(std::chrono::milliseconds(20));
    }
    return {};
}

}  // namespace kino::guest
