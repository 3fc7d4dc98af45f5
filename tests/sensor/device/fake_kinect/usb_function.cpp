#include "tests/sensor/device/fake_kinect/usb_function.h"

#include <algorithm>
#include <cerrno>

#include "tests/sensor/device/fake_kinect/bits.h"

namespace kino::fake {
namespace {

enum Descriptor : std::uint8_t {
    device = 1,
    configuration = 2,
    string = 3,
    interface = 4,
    endpoint = 5
};

std::vector<std::uint8_t> device_descriptor(const Identity& who) {
    std::vector<std::uint8_t> bytes = {18, device, 0, 2, 0, 0, 0, 64};
    put_u16(bytes, who.vendor);
    put_u16(bytes, who.product);
    put_u16(bytes, who.release);
    bytes.insert(bytes.end(), {1, 2, static_cast<std::uint8_t>(who.serial.empty() ? 0 : 3), 1});
    return bytes;
}

std::vector<std::uint8_t> configuration_descriptor(const Identity& who) {
    const auto endpoints = static_cast<std::uint8_t>(who.iso_endpoints.size());
    std::vector<std::uint8_t> bytes = {9, configuration};
    put_u16(bytes, 18u + 7u * endpoints);
    bytes.insert(bytes.end(), {1, 1, 0, 0xc0, 50});
    bytes.insert(bytes.end(), {9, interface, 0, 0, endpoints, 0xff, 0xff, 0xff, 0});
    for (const std::uint8_t address : who.iso_endpoints) {
        bytes.insert(bytes.end(), {7, endpoint, address, 1});
        put_u16(bytes, 0x0bc0);  // two packets of 960 bytes in a microframe
        bytes.push_back(1);
    }
    return bytes;
}

std::vector<std::uint8_t> string_descriptor(const Identity& who, int index) {
    if (index == 0) return {4, string, 0x09, 0x04};
    const std::string* texts[] = {&who.maker, &who.name, &who.serial};
    if (index > 3 || texts[index - 1]->empty()) return {};
    const std::string& text = *texts[index - 1];
    std::vector<std::uint8_t> bytes = {static_cast<std::uint8_t>(2 + 2 * text.size()), string};
    for (const char c : text) put_u16(bytes, static_cast<unsigned char>(c));
    return bytes;
}

}  // namespace

Answer stalled() {
    return {.status = -EPIPE, .bytes = {}};
}

Answer standard_request(const Identity& identity, const Setup& setup) {
    enum Request : std::uint8_t {
        get_status = 0,
        get_descriptor = 6,
        get_configuration = 8,
        get_interface = 10
    };
    if (!setup.in()) return {};  // an address, a configuration, a feature: as you like
    Answer answer;
    switch (setup.request) {
        case get_status:
            answer.bytes = {1, 0};
            break;
        case get_configuration:
            answer.bytes = {1};
            break;
        case get_interface:
            answer.bytes = {0};
            break;
        case get_descriptor:
            switch (setup.value >> 8) {
                case device:
                    answer.bytes = device_descriptor(identity);
                    break;
                case configuration:
                    answer.bytes = configuration_descriptor(identity);
                    break;
                case string:
                    answer.bytes = string_descriptor(identity, setup.value & 0xff);
                    break;
                default:
                    break;
            }
            if (answer.bytes.empty()) return stalled();
            break;
        default:
            return stalled();
    }
    answer.bytes.resize(std::min<std::size_t>(answer.bytes.size(), setup.length));
    return answer;
}

}  // namespace kino::fake
