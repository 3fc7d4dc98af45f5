#include "tests/sensor/device/fake_kinect/usbip_port.h"

#include <arpa/inet.h>
#include <fcntl.h>
#include <fmt/format.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <mutex>
#include <sstream>

#include "tests/sensor/device/fake_kinect/bits.h"

namespace kino::fake {
namespace {

constexpr const char* kBus = "/sys/devices/platform/vhci_hcd.0";

enum Command : std::uint32_t {
    submit_command = 1,
    unlink_command = 2,
    submit_reply = 3,
    unlink_reply = 4
};
constexpr std::size_t kHeaderWords = 12;

void put_big(std::vector<std::uint8_t>& bytes, std::uint32_t value) {
    for (int shift = 24; shift >= 0; shift -= 8) {
        bytes.push_back(static_cast<std::uint8_t>(value >> shift));
    }
}

std::vector<std::uint8_t> reply_header(std::uint32_t command, std::uint32_t number, int status,
                                       std::uint32_t length, std::uint32_t packets,
                                       std::uint32_t errors) {
    std::vector<std::uint8_t> bytes;
    for (const std::uint32_t word :
         {command, number, 0u, 0u, 0u, static_cast<std::uint32_t>(status), length, 0u, packets,
          errors, 0u, 0u}) {
        put_big(bytes, word);
    }
    return bytes;
}

/// A line of the bus's own table.
struct PortLine {
    int port = -1;
    int state = -1;      ///< of the kernel's enum usbip_device_status
    std::string device;  ///< "1-2"; "0-0" if there is none
};
constexpr int kFree = 4;
constexpr int kInUse = 6;

/// The ports that take full and high speed.
std::vector<PortLine> port_table() {
    std::vector<PortLine> table;
    std::ifstream file(std::string(kBus) + "/status");
    std::string line;
    std::getline(file, line);
    while (std::getline(file, line)) {
        std::istringstream fields(line);
        std::string hub;
        std::string skipped;
        PortLine entry;
        fields >> hub >> entry.port >> entry.state >> skipped >> skipped >> skipped >> entry.device;
        if (fields && hub == "hs") table.push_back(std::move(entry));
    }
    return table;
}

int free_port() {
    for (const PortLine& line : port_table()) {
        if (line.state == kFree) return line.port;
    }
    return -1;
}

template <class Condition>
bool wait_for(Condition condition) {
    for (int tries = 0; tries < 500; ++tries) {
        if (condition()) return true;
        std::this_thread::sleep_for(std::chrono::milliseconds(20));
    }
    return false;
}

std::filesystem::path device_folder(const std::string& device) {
    return std::filesystem::path("/sys/bus/usb/devices") / device;
}

Result<void> tell_bus(const std::string& file, const std::string& text) {
    const std::string path = std::string(kBus) + "/" + file;
    const int fd = open(path.c_str(), O_WRONLY | O_CLOEXEC);
    if (fd < 0) return fail(fmt::format("cannot open: {}", std::strerror(errno)), path);
    const ssize_t written = write(fd, text.data(), text.size());
    const int error = errno;
    close(fd);
    if (written < 0) return fail(fmt::format("refused: {}", std::strerror(error)), path);
    return {};
}

}  // namespace

Result<std::unique_ptr<UsbIpPort>> UsbIpPort::plug(UsbFunction& function, std::uint64_t cut_after) {
    // A port is chosen and then taken: not two at a time.
    static std::mutex choosing;
    const std::scoped_lock lock(choosing);
    int ends[2] = {-1, -1};
    if (socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, ends) != 0) {
        return fail(fmt::format("no socket pair: {}", std::strerror(errno)));
    }
    const int port = free_port();
    if (port < 0) {
        close(ends[0]);
        close(ends[1]);
        return fail("no free port on the virtual USB bus", kBus, "insert vhci_hcd");
    }
    std::unique_ptr<UsbIpPort> result(new UsbIpPort(function, ends[0], port, cut_after));
    const auto attached = tell_bus(
        "attach",
        fmt::format("{} {} {} {}", port, ends[1], 0x10001 + port, function.identity().speed));
    close(ends[1]);  // the kernel has its own reference
    if (!attached) return tl::unexpected<Error>(attached.error());
    if (!result->wait_until_configured()) {
        return fail("the kernel does not take the device", function.identity().name);
    }
    return result;
}

bool UsbIpPort::wait_until_configured() {
    return wait_for([&] {
        for (const PortLine& line : port_table()) {
            if (line.port == port_ && line.state == kInUse) device_ = line.device;
        }
        std::error_code ignored;
        return !device_.empty() &&
               std::filesystem::exists(device_folder(device_ + ":1.0"), ignored);
    });
}

void UsbIpPort::wait_until_forgotten() const {
    if (device_.empty()) return;
    (void)wait_for([&] {
        std::error_code ignored;
        return !std::filesystem::exists(device_folder(device_), ignored);
    });
}

UsbIpPort::UsbIpPort(UsbFunction& function, int socket, int port, std::uint64_t cut_after)
    : function_(function), socket_(socket), port_(port), cut_after_(cut_after) {
    if (pipe2(wake_, O_CLOEXEC) != 0) wake_[0] = wake_[1] = -1;
    thread_ = std::thread([this] { serve(); });
}

UsbIpPort::~UsbIpPort() {
    unplug();
    if (thread_.joinable()) thread_.join();
    close(socket_);
    close(wake_[0]);
    close(wake_[1]);
}

void UsbIpPort::unplug() {
    if (!gone_.exchange(true)) {
        (void)tell_bus("detach", std::to_string(port_));
        const char byte = 0;
        (void)!write(wake_[1], &byte, 1);
    }
    wait_until_forgotten();
}

int UsbIpPort::milliseconds_to_wait() const {
    Clock::time_point soonest = Clock::time_point::max();
    for (const auto& [endpoint, requests] : waiting_) {
        if (!requests.empty()) {
            soonest = std::min(soonest, function_.wake_at(static_cast<int>(endpoint)));
        }
    }
    if (soonest == Clock::time_point::max()) return -1;
    const auto left = std::chrono::ceil<std::chrono::milliseconds>(std::max(soonest, Clock::now()) -
                                                                   Clock::now());
    return std::max<int>(0, static_cast<int>(std::min<std::int64_t>(left.count(), 1000)));
}

void UsbIpPort::serve() {
    while (!gone_) {
        pollfd ready[2] = {{socket_, POLLIN, 0}, {wake_[0], POLLIN, 0}};
        if (poll(ready, 2, milliseconds_to_wait()) < 0 && errno != EINTR) break;
        if (ready[1].revents != 0) break;
        // All that waits: orders must not stand in line behind the packets they are about.
        bool open = true;
        while (open && ready[0].revents != 0) {
            open = read_request() && poll(ready, 1, 0) >= 0;
        }
        if (!open) break;
        if (!pump()) break;
    }
    shutdown(socket_, SHUT_RDWR);
    gone_ = true;
}

bool UsbIpPort::read_request() {
    std::uint32_t words[kHeaderWords];
    if (!read_all(words, sizeof words)) return false;
    std::vector<std::uint32_t> header;
    for (const std::uint32_t word : words) header.push_back(ntohl(word));
    if (header[0] == unlink_command) return unlink(header);
    const auto* raw = reinterpret_cast<const std::uint8_t*>(&words[10]);
    const std::span<const std::uint8_t> bytes(raw, 8);
    return submit(header, {.type = bytes[0],
                           .request = bytes[1],
                           .value = get_u16(bytes, 2),
                           .index = get_u16(bytes, 4),
                           .length = get_u16(bytes, 6)});
}

bool UsbIpPort::submit(const std::vector<std::uint32_t>& header, const Setup& setup) {
    Request request{
        .number = header[1], .endpoint = header[4], .length = header[6], .packet_lengths = {}};
    const bool to_host = header[3] != 0;
    std::vector<std::uint8_t> out(to_host ? 0 : request.length);
    if (!read_all(out.data(), out.size())) return false;
    if (request.endpoint != 0) {
        // The packets' places and lengths follow: four words each, of which the second counts.
        std::vector<std::uint32_t> places(std::size_t{header[8]} * 4);
        if (!read_all(places.data(), places.size() * 4)) return false;
        for (std::size_t i = 0; i < header[8]; ++i) {
            request.packet_lengths.push_back(ntohl(places[4 * i + 1]));
        }
        waiting_[request.endpoint].push_back(std::move(request));
        return true;
    }
    const bool vendor = (setup.type & 0x60) == 0x40;
    Answer answer = vendor ? function_.vendor_request(setup, out)
                           : standard_request(function_.identity(), setup);
    const auto length = to_host ? answer.bytes.size() : out.size();
    auto reply = reply_header(submit_reply, request.number, answer.status,
                              answer.status < 0 ? 0 : static_cast<std::uint32_t>(length), 0, 0);
    if (to_host && answer.status == 0) {
        reply.insert(reply.end(), answer.bytes.begin(), answer.bytes.end());
    }
    return write_all(reply);
}

bool UsbIpPort::unlink(const std::vector<std::uint32_t>& header) {
    int status = 0;
    for (auto& [endpoint, requests] : waiting_) {
        const auto count = std::erase_if(
            requests, [&](const Request& request) { return request.number == header[5]; });
        if (count > 0) status = -ECONNRESET;
    }
    return write_all(reply_header(unlink_reply, header[1], status, 0, 0, 0));
}

bool UsbIpPort::pump() {
    for (auto& [endpoint, requests] : waiting_) {
        // One transfer an endpoint, then a look at the socket: an order to stop must not wait
        // behind a whole queue.
        if (requests.empty()) continue;
        std::vector<WirePacket> packets;
        const std::size_t wanted = requests.front().packet_lengths.size();
        while (packets.size() < wanted) {
            auto packet = function_.next_packet(static_cast<int>(endpoint), Clock::now());
            if (!packet) break;
            packets.push_back(std::move(*packet));
        }
        if (packets.empty()) continue;
        const Request request = std::move(requests.front());
        requests.pop_front();
        if (!complete(request, std::move(packets))) return false;
    }
    return true;
}

bool UsbIpPort::complete(const Request& request, std::vector<WirePacket> packets) {
    packets.resize(request.packet_lengths.size());  // the rest of the time the device says nothing
    std::uint32_t total = 0;
    std::uint32_t errors = 0;
    for (const WirePacket& packet : packets) {
        total += static_cast<std::uint32_t>(packet.bytes.size());
        if (packet.status != 0) ++errors;
    }
    auto reply = reply_header(submit_reply, request.number, 0, total,
                              static_cast<std::uint32_t>(packets.size()), errors);
    for (const WirePacket& packet : packets) {
        reply.insert(reply.end(), packet.bytes.begin(), packet.bytes.end());
    }
    std::uint32_t offset = 0;
    for (std::size_t i = 0; i < packets.size(); ++i) {
        put_big(reply, offset);
        put_big(reply, request.packet_lengths[i]);
        put_big(reply, static_cast<std::uint32_t>(packets[i].bytes.size()));
        put_big(reply, static_cast<std::uint32_t>(packets[i].status));
        offset += request.packet_lengths[i];
    }
    return write_all(reply);
}

bool UsbIpPort::read_all(void* to, std::size_t size) {
    auto* at = static_cast<char*>(to);
    while (size > 0) {
        const ssize_t got = recv(socket_, at, size, 0);
        if (got < 0 && errno == EINTR) continue;
        if (got <= 0) return false;
        at += got;
        size -= static_cast<std::size_t>(got);
    }
    return true;
}

bool UsbIpPort::write_all(const std::vector<std::uint8_t>& bytes) {
    std::size_t size = bytes.size();
    bool cut = false;
    if (cut_after_ > 0 && written_ + size >= cut_after_) {
        size = static_cast<std::size_t>(cut_after_ - written_);
        cut = true;
    }
    for (std::size_t at = 0; at < size;) {
        const ssize_t sent = send(socket_, bytes.data() + at, size - at, MSG_NOSIGNAL);
        if (sent < 0 && errno == EINTR) continue;
        if (sent <= 0) return false;
        at += static_cast<std::size_t>(sent);
    }
    written_ += size;
    return !cut;
}

}  // namespace kino::fake
