#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <filesystem>
#include <memory>

#include "apps/commands.h"
#include "apps/exit_codes.h"
#include "apps/tell_error.h"
#include "sensor/session/repair.h"

namespace kino {

Command add_repair(CLI::App& parent) {
    auto file = std::make_shared<std::filesystem::path>();
    CLI::App& app = *parent.add_subcommand(
        "repair", "ends a session that was cut off, so that it opens at once everywhere");
    app.add_option("FILE", *file, "the session")->required();
    app.footer(
        "Sound frames are not touched; an unfinished piece at the end is taken off. A "
        "session that was cut\noff plays without it as well.");
    return [file] {
        const auto report = repair_session(*file);
        if (!report) {
            tell_error(report.error());
            return static_cast<int>(kExitFailed);
        }
        for (const std::string& line : report->lines) fmt::print("{}\n", line);
        fmt::print("{}: {} frames\n", report->was_closed ? "nothing to repair" : "repaired",
                   report->frames);
        return static_cast<int>(kExitDone);
    };
}

}  // namespace kino
