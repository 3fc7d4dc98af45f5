#include "tests/sensor/device/scenarios/udev_relay.h"

#include <arpa/inet.h>
#include <linux/netlink.h>
#include <sys/prctl.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <csignal>
#include <cstdint>
#include <cstring>
#include <string>
#include <string_view>

namespace kino::guest {
namespace {

constexpr std::uint32_t kKernelGroup = 1;
constexpr std::uint32_t kUdevGroup = 2;

/// What stands before a message of the udev daemon (systemd, sd-device-monitor.c). Numbers that
/// filters in the kernel read are big endian.
struct MessageHeader {
    char prefix[8] = "libudev";
    std::uint32_t magic = htonl(0xfeedcafe);
    std::uint32_t header_bytes = sizeof(MessageHeader);
    std::uint32_t properties_at = sizeof(MessageHeader);
    std::uint32_t properties_bytes = 0;
    std::uint32_t subsystem_hash = 0;
    std::uint32_t devtype_hash = 0;
    std::uint32_t tags[2] = {0, 0};
};

/// MurmurHash2 of A. Appleby, which udev's filters compare names by; seed 0.
std::uint32_t hash(std::string_view text) {
    constexpr std::uint32_t kMultiplier = 0x5bd1e995;
    auto h = static_cast<std::uint32_t>(text.size());
    while (text.size() >= 4) {
        std::uint32_t k = 0;
        std::memcpy(&k, text.data(), 4);
        k *= kMultiplier;
        k ^= k >> 24;
        h = (h * kMultiplier) ^ (k * kMultiplier);
        text.remove_prefix(4);
    }
    if (!text.empty()) {
        std::uint32_t rest = 0;
        std::memcpy(&rest, text.data(), text.size());
        h = (h ^ rest) * kMultiplier;
    }
    h = (h ^ (h >> 13)) * kMultiplier;
    return h ^ (h >> 15);
}

/// The value of "KEY=" among strings that end in zeros; empty if there is none.
std::string_view property(std::string_view properties, std::string_view key) {
    while (!properties.empty()) {
        const std::string_view line = properties.substr(0, properties.find('\0'));
        if (line.starts_with(key)) return line.substr(key.size());
        properties.remove_prefix(std::min(line.size() + 1, properties.size()));
    }
    return {};
}

void relay() {
    const int fd = socket(AF_NETLINK, SOCK_DGRAM | SOCK_CLOEXEC, NETLINK_KOBJECT_UEVENT);
    sockaddr_nl address{};
    address.nl_family = AF_NETLINK;
    address.nl_groups = kKernelGroup;
    if (bind(fd, reinterpret_cast<sockaddr*>(&address), sizeof address) != 0) return;
    address.nl_groups = kUdevGroup;
    std::string buffer(16384, '\0');
    for (;;) {
        const ssize_t got = recv(fd, buffer.data(), buffer.size(), 0);
        if (got <= 0) continue;
        // The first string is "add@/devices/...": what follows are the properties.
        const std::string_view message(buffer.data(), static_cast<std::size_t>(got));
        const std::size_t first = message.find('\0');
        if (first == std::string_view::npos) continue;
        const std::string_view properties = message.substr(first + 1);
        MessageHeader header;
        header.properties_bytes = static_cast<std::uint32_t>(properties.size());
        header.subsystem_hash = htonl(hash(property(properties, "SUBSYSTEM=")));
        if (const auto type = property(properties, "DEVTYPE="); !type.empty()) {
            header.devtype_hash = htonl(hash(type));
        }
        std::string out(reinterpret_cast<const char*>(&header), sizeof header);
        out += properties;
        (void)sendto(fd, out.data(), out.size(), 0, reinterpret_cast<sockaddr*>(&address),
                     sizeof address);
    }
}

}  // namespace

void start_udev_relay() {
    if (fork() != 0) return;
    prctl(PR_SET_PDEATHSIG, SIGKILL);
    relay();
    _exit(0);
}

}  // namespace kino::guest
