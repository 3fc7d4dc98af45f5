#include <CLI/CLI.hpp>
#include <memory>
#include <string>

#include "apps/commands.h"
#include "apps/exit_codes.h"
#include "apps/sources.h"
#include "apps/tell_error.h"
#include "apps/view_options.h"

namespace kino {
namespace {

int run_live(ReplayOptions options) {
    register_sources();
    if (options.uris.empty()) {
        auto device = first_device();
        if (!device) {
            tell_error(device.error());
            return kExitFailed;
        }
        options.uris.push_back(std::move(*device));
    }
    return run_view(options);
}

}  // namespace

Command add_live(CLI::App& parent) {
    auto options = std::make_shared<ReplayOptions>();
    CLI::App& app = *parent.add_subcommand(
        "live", "shows what a sensor sees: depth, colour, infrared, in 3D; records it");
    app.add_option_function<std::string>(
        "URI", [options](const std::string& uri) { options->uris = {uri}; },
        "kinect1:, openni2:, v4l2:/dev/video0 or A+B; the first sensor there is by default "
        "(`kinoscope devices` lists them)");
    CLI::Option* record =
        app.add_option("--record", options->record,
                       "write a session from the start; key K starts and ends others")
            ->type_name("FILE");
    add_codec_option(app, options->codec);
    add_view_options(app, options);
    record->excludes(app.get_option("--headless"));
    app.footer(
        "A sensor that is pulled out and plugged in again goes on by itself, in a recording "
        "too.\nTo record without a window: `kinoscope record`.\n\n" +
        view_footer());
    return [options] { return run_live(*options); };
}

}  // namespace kino
