#include "sensor/kinect1/kinect1_address.h"

#include <fmt/format.h>

#include <string_view>

namespace kino::kinect1 {
namespace {

constexpr const char* kHint =
    "kinect1:[serial][?color=bayer|bayer-high|yuv&depth=11|10]; \"kinoscope devices\" lists "
    "serials";

Result<void> apply(Address& address, std::string_view option, const std::string& text) {
    if (option == "depth=11") {
        address.depth = CameraMode::depth_11bit;
    } else if (option == "depth=10") {
        address.depth = CameraMode::depth_10bit;
    } else if (option == "color=bayer") {
        address.color = CameraMode::color_bayer;
    } else if (option == "color=bayer-high") {
        address.color = CameraMode::color_bayer_high;
    } else if (option == "color=yuv") {
        address.color = CameraMode::color_yuv;
    } else {
        return fail(fmt::format("there is no option \"{}\"", option), "kinect1:" + text, kHint);
    }
    return {};
}

}  // namespace

Result<Address> parse_address(const std::string& text) {
    Address address;
    const std::size_t question = text.find('?');
    address.serial = text.substr(0, question);
    if (question == std::string::npos) return address;
    std::string_view rest = std::string_view(text).substr(question + 1);
    while (true) {
        const std::size_t end = rest.find('&');
        KINO_TRY(apply(address, rest.substr(0, end), text));
        if (end == std::string_view::npos) return address;
        rest.remove_prefix(end + 1);
    }
}

std::string to_text(const Address& address) {
    std::string options;
    const auto add = [&options](const char* option) {
        options += (options.empty() ? "?" : "&") + std::string(option);
    };
    if (address.color == CameraMode::color_bayer_high) add("color=bayer-high");
    if (address.color == CameraMode::color_yuv) add("color=yuv");
    if (address.depth == CameraMode::depth_10bit) add("depth=10");
    return address.serial + options;
}

}  // namespace kino::kinect1
