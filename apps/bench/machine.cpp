#include "apps/bench/machine.h"

#include <fmt/format.h>
#include <sys/utsname.h>
#include <unistd.h>

#include <fstream>
#include <thread>

namespace kino::bench {

namespace {

std::string processor_model() {
    std::ifstream info("/proc/cpuinfo");
    for (std::string line; std::getline(info, line);) {
        if (!line.starts_with("model name")) continue;
        const auto colon = line.find(": ");
        if (colon != std::string::npos) return line.substr(colon + 2);
    }
    return "unknown processor";
}

double memory_gib() {
    const double pages = static_cast<double>(sysconf(_SC_PHYS_PAGES));
    const double page_bytes = static_cast<double>(sysconf(_SC_PAGESIZE));
    return pages * page_bytes / (1024.0 * 1024.0 * 1024.0);
}

std::string kernel() {
    utsname name{};
    if (uname(&name) != 0) return "unknown kernel";
    return fmt::format("{} {} {}", name.sysname, name.release, name.machine);
}

}  // namespace

std::string describe_machine() {
#ifdef NDEBUG
    constexpr const char* kBuild = "optimised build";
#else
    constexpr const char* kBuild = "build with assertions: times are not comparable";
#endif
    return fmt::format("{}, {} cores, {:.1f} GiB; {}; compiler {}; {}", processor_model(),
                       std::thread::hardware_concurrency(), memory_gib(), kernel(), __VERSION__,
                       kBuild);
}

}  // namespace kino::bench
