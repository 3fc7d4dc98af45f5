#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <csignal>
#include <cstdio>
#include <exception>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "apps/bench/machine.h"
#include "apps/bench/pages.h"
#include "apps/bench/plot.h"
#include "apps/bench/reference_cache.h"
#include "apps/bench/registry.h"
#include "apps/bench/run_all.h"
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
    bool pages = false;
    std::string csv_file;
    std::string docs_folder;
    std::string peer;
    std::vector<std::string> marked;
    std::string cache_folder = default_cache_folder().string();
    bool no_cache = false;
    std::string claims_file;
    std::string command;
};

void complain(const Error& error) {
    fmt::print(stderr, "kinoscope-bench: {}\n", error.to_string());
}

std::string command_text(int argc, char** argv) {
    std::string text = std::filesystem::path(argv[0]).filename().string();
    for (int i = 1; i < argc; ++i) {
        // Where the rows go besides says nothing about them, and references are the same wherever
        // they come from.
        const std::string_view word = argv[i];
        if (word == "--csv" || word == "--claims" || word == "--cache") {
            ++i;
            continue;
        }
        if (word == "--no-cache") continue;
        text += fmt::format(" {}", argv[i]);
    }
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
bool run_entry(const Entry& entry, const Options& options, std::string& csv, std::string& claims) {
    BenchContext bench(std::string(entry.name), options.quick);
    bench.peer = options.peer;
    bench.marked.assign(options.marked.begin(), options.marked.end());
    if (!options.no_cache && !options.cache_folder.empty()) {
        bench.references = ReferenceCache(
            {.folder = options.cache_folder,
             .say = [&bench](const std::string& sentence) { bench.progress(sentence); }});
    }
    try {
        entry.run(bench);
    } catch (const std::exception& thrown) {
        // OpenCV and the standard library throw; the other entries should still run.
        bench.fail({.what = thrown.what(), .where = std::string(entry.name), .hint = {}});
    }
    csv += csv_lines(bench);
    claims += claim_lines(bench);
    const ReferenceCache::Counts& references = bench.references.counts();
    if (references.found + references.made > 0) {
        bench.progress(fmt::format("{} references kept from before, {} made", references.found,
                                   references.made));
    }
    bool good = bench.errors().empty();
    if (good && !options.docs_folder.empty()) {
        if (const auto written = write_docs(entry, bench, options); !written) {
            complain(written.error());
            good = false;
        }
    }
    return good;
}

/// The folder of committed figures, and another for quick ones, which are not to be committed.
constexpr const char* kDocs = "docs/accuracy";
constexpr const char* kQuickDocs = "out/accuracy";
constexpr double kMostMinutes = 40;
constexpr double kMostQuickMinutes = 3;

int finish(const Options& options, const std::string& csv, bool good,
           const std::string& claims = {}) {
    if (!options.claims_file.empty()) {
        if (const auto written = write_text(options.claims_file, claims); !written) {
            complain(written.error());
            good = false;
        }
    }
    if (options.csv_file.empty()) {
        fmt::print("{}", csv);
    } else if (const auto written = write_text(options.csv_file, csv); !written) {
        complain(written.error());
        good = false;
    }
    return good ? 0 : kFailed;
}

int make_pages(const Options& options) {
    const std::string folder = options.docs_folder.empty() ? kDocs : options.docs_folder;
    if (const auto written = write_pages(folder); !written) {
        complain(written.error());
        return kFailed;
    }
    fmt::print(stderr, "written: {}/index.html\n", folder);
    return 0;
}

int run_everything(Options options) {
    if (options.docs_folder.empty()) options.docs_folder = options.quick ? kQuickDocs : kDocs;
    std::error_code error;
    std::filesystem::create_directories(options.docs_folder, error);
    if (error) {
        complain({"could not be made: " + error.message(), options.docs_folder, {}});
        return kFailed;
    }
    const std::filesystem::path self = std::filesystem::read_symlink("/proc/self/exe", error);
    if (error) {
        complain({"does not know its own file: " + error.message(), {}, {}});
        return kFailed;
    }
    AllOptions all{.program = self.string(),
                   .arguments = {"--docs", options.docs_folder},
                   .most_minutes = options.quick ? kMostQuickMinutes : kMostMinutes,
                   .quick = options.quick};
    if (options.quick) all.arguments.push_back("--quick");
    if (options.no_cache) {
        all.arguments.push_back("--no-cache");
    } else if (!options.cache_folder.empty()) {
        all.arguments.insert(all.arguments.end(), {"--cache", options.cache_folder});
    }
    if (!options.peer.empty()) all.arguments.insert(all.arguments.end(), {"--peer", options.peer});
    for (const std::string& folder : options.marked) {
        all.arguments.insert(all.arguments.end(), {"--marked", folder});
    }
    std::vector<std::string_view> names;
    for (const Entry& entry : entries()) names.push_back(entry.name);
    const AllReport report = run_all(names, all);
    const bool paged = make_pages(options) == 0;
    const int status = finish(options, report.csv, paged && report.failures() == 0);
    fmt::print(stderr, "\n{}", summary_table(report));
    return status;
}

int run(const Options& options) {
    if (options.list) {
        for (const Entry& entry : entries()) {
            fmt::print("{:<16} {}\n", entry.name, entry.description);
        }
        return 0;
    }
    if (options.all) return run_everything(options);
    if (options.pages && options.names.empty()) return make_pages(options);
    std::vector<const Entry*> chosen;
    for (const std::string& name : options.names) {
        const Entry* entry = find_entry(name);
        if (entry == nullptr) {
            complain({"there is no bench of this name", name, "--list shows all"});
            return kWrongUsage;
        }
        if (std::find(chosen.begin(), chosen.end(), entry) == chosen.end()) chosen.push_back(entry);
    }
    if (chosen.empty()) {
        complain({"no bench named", {}, "name one, or use --all, --pages or --list"});
        return kWrongUsage;
    }

    bool good = true;
    std::string csv(csv_header()), claims;
    for (const Entry* entry : chosen) good = run_entry(*entry, options, csv, claims) && good;
    // The page beside the figures goes with them.
    const bool has_page =
        !options.docs_folder.empty() &&
        std::filesystem::exists(std::filesystem::path(options.docs_folder) / "index.html");
    if (options.pages || has_page) good = make_pages(options) == 0 && good;
    return finish(options, csv, good, claims);
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
    app.footer(
        "Exit status: 0 done, 1 an entry failed or a file could not be written, 2 usage. A claim "
        "that does not hold on this machine is a finding: it is told on the pages and at the end, "
        "and is no failure.");
    app.add_option("NAME", options.names, "entries to run");
    app.add_flag("--list", options.list, "name the entries and end");
    app.add_flag("--all", options.all,
                 "run every entry, each on its own, in 40 minutes at most (--quick: 3), and make "
                 "the page of all; --docs is docs/accuracy if not given (--quick: out/accuracy)");
    app.add_flag("--pages", options.pages,
                 "make index.html of the tables in --docs (docs/accuracy) anew");
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
    app.add_option("--cache", options.cache_folder,
                   "where references that take long are kept, by what they depend on")
        ->type_name("DIR")
        ->capture_default_str();
    app.add_flag("--no-cache", options.no_cache, "make all references anew and keep none");
    app.add_option("--claims", options.claims_file,
                   "also write a line a claim, \"holds: ...\" or \"missed: ...\", into FILE")
        ->type_name("FILE");
    try {
        app.parse(argc, argv);
    } catch (const CLI::ParseError& error) {
        return app.exit(error) == 0 ? 0 : kWrongUsage;
    }
    options.command = command_text(argc, argv);
    return run(options);
}
