#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <csignal>
#include <cstdio>
#include <exception>
#include <filesystem>
#include <string>
#include <vector>

#include "apps/bench/machine.h"
#include "apps/bench/plot.h"
#include "apps/bench/registry.h"
#include "apps/bench/table.h"

namespace kino::bench {
namespace {

constexpr int kFailed = 1;
constexpr int kWrongUsage = 2;

struct Options {
    std::vector<std::string> names;
    bool list = false;
    bool all = false;
    bool quick = false;
    std::string csv_file;
    std::string docs_folder;
    std::string peer;
    std::vector<std::string> marked;
    std::string command;
};

void complain(const Error& error) {
    fmt::print(stderr, "kinoscope-bench: {}\n", error.to_string());
}

std::string command_text(int argc, char** argv) {
    std::string text = std::filesystem::path(argv[0]).filename().string();
    for (int i = 1; i < argc; ++i) text += fmt::format(" {}", argv[i]);
    return text;
}

const Entry* find_entry(const std::string& name) {
    const auto all = entries();
    const auto found = std::find_if(all.begin(), all.end(),
                                    [&](const Entry& entry) { return entry.name == name; });
    return found == all.end() ? nullptr : &*found;
}

Result<void> write_docs(const Entry& entry, const BenchContext& bench, const Options& options) {
    const std::filesystem::path stem =
        std::filesystem::path(options.docs_folder) / (entry.page.empty() ? entry.name : entry.page);
    const auto with = [&](const char* extension) {
        return std::filesystem::path(stem).concat(extension);
    };
    KINO_TRY(write_text(with(".csv"), std::string(csv_header()) + csv_lines(bench)));
    Result<void> plotted = write_plot(bench, with(".svg"));
    const std::string machine = describe_machine();
    KINO_TRY(write_text(with(".md"), markdown_page(bench, {.description = entry.description,
                                                           .machine = machine,
                                                           .command = options.command,
                                                           .with_plot = plotted.has_value(),
                                                           .page = entry.page})));
    for (const auto& file : bench.files())
        KINO_TRY(write_text(stem.parent_path() / file.name, file.bytes));
    return plotted;
}

/// One entry from start to files. False if anything of it failed.
bool run_entry(const Entry& entry, const Options& options, std::string& csv) {
    BenchContext bench(std::string(entry.name), options.quick);
    bench.peer = options.peer;
    bench.marked.assign(options.marked.begin(), options.marked.end());
    try {
        entry.run(bench);
    } catch (const std::exception& thrown) {
        // OpenCV and the standard library throw; the other entries should still run.
        bench.fail({.what = thrown.what(), .where = std::string(entry.name), .hint = {}});
    }
    csv += csv_lines(bench);
    bool good = bench.errors().empty();
    if (good && !options.docs_folder.empty()) {
        if (const auto written = write_docs(entry, bench, options); !written) {
            complain(written.error());
            good = false;
        }
    }
    return good;
}

int run(const Options& options) {
    if (options.list) {
        for (const Entry& entry : entries()) {
            fmt::print("{:<16} {}\n", entry.name, entry.description);
        }
        return 0;
    }
    std::vector<const Entry*> chosen;
    if (options.all) {
        for (const Entry& entry : entries()) chosen.push_back(&entry);
    }
    for (const std::string& name : options.names) {
        const Entry* entry = find_entry(name);
        if (entry == nullptr) {
            complain({"there is no bench of this name", name, "--list shows all"});
            return kWrongUsage;
        }
        if (std::find(chosen.begin(), chosen.end(), entry) == chosen.end()) chosen.push_back(entry);
    }
    if (chosen.empty()) {
        complain({"no bench named", {}, "name one, or use --all or --list"});
        return kWrongUsage;
    }

    bool good = true;
    std::string csv(csv_header());
    for (const Entry* entry : chosen) good = run_entry(*entry, options, csv) && good;
    if (options.csv_file.empty()) {
        fmt::print("{}", csv);
    } else if (const auto written = write_text(options.csv_file, csv); !written) {
        complain(written.error());
        good = false;
    }
    return good ? 0 : kFailed;
}

}  // namespace
}  // namespace kino::bench

int main(int argc, char** argv) {
    using namespace kino::bench;
    // A reader or gnuplot that goes away is an error to report, not the end.
    std::signal(SIGPIPE, SIG_IGN);
    Options options;
    CLI::App app(
        "Measures speed and error against references and rivals. The table goes to standard "
        "output as CSV, progress to standard error.",
        "kinoscope-bench");
    app.footer("Exit status: 0 done, 1 an entry failed or a file could not be written, 2 usage.");
    app.add_option("NAME", options.names, "entries to run");
    app.add_flag("--list", options.list, "name the entries and end");
    app.add_flag("--all", options.all, "run every entry");
    app.add_flag("--quick", options.quick, "fewer repeats and cases");
    app.add_option("--csv", options.csv_file, "write the table to FILE instead")->type_name("FILE");
    app.add_option("--docs", options.docs_folder,
                   "also write NAME.csv, NAME.md and NAME.svg into DIR (docs/accuracy for "
                   "committed figures)")
        ->type_name("DIR");
    app.add_option("--peer", options.peer,
                   "the unpacked trees of PCL's people tracker (forest1_tree_20.txt, ...)")
        ->type_name("DIR");
    app.add_option("--marked", options.marked, "real frames with joints2d.json; may be repeated")
        ->type_name("DIR");
    try {
        app.parse(argc, argv);
    } catch (const CLI::ParseError& error) {
        return app.exit(error) == 0 ? 0 : kWrongUsage;
    }
    options.command = command_text(argc, argv);
    return run(options);
}
