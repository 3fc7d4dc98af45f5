#include "apps/bench/table.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <system_error>

namespace kino::bench {

namespace {

std::string csv_field(std::string_view text) {
    if (text.find_first_of(",\"\r\n") == std::string_view::npos) return std::string(text);
    std::string quoted = "\"";
    for (const char c : text) {
        if (c == '"') quoted += '"';
        quoted += c;
    }
    return quoted + '"';
}

std::string markdown_cell(std::string_view text) {
    std::string cell;
    for (const char c : text) {
        if (c == '|') cell += '\\';
        cell += c == '\n' ? ' ' : c;
    }
    return cell;
}

}  // namespace

std::string_view csv_header() {
    return "bench,case,knob,level,ms_median,ms_p95,error,metric,baseline,speedup\n";
}

std::string number_text(double value, int digits) {
    if (std::isnan(value)) return {};
    const double size = std::abs(value);
    if (value == 0 || size < 1e-4 || size >= 1e6 || std::isinf(value)) {
        return fmt::format("{:.{}g}", value, digits);
    }
    const int before_point = static_cast<int>(std::floor(std::log10(size))) + 1;
    const int decimals = std::max(0, digits - before_point);
    return fmt::format("{:.{}f}", value, decimals);
}

std::string csv_lines(const BenchContext& bench) {
    std::string lines;
    for (const BenchRow& row : bench.rows()) {
        lines += fmt::format("{},{},{},{},{},{},{},{},{},{}\n", csv_field(bench.name()),
                             csv_field(row.case_name), csv_field(row.knob), csv_field(row.level),
                             number_text(row.ms_median, 6), number_text(row.ms_p95, 6),
                             number_text(row.error, 6), csv_field(row.metric),
                             csv_field(row.baseline), number_text(row.speedup));
    }
    return lines;
}

std::string claim_lines(const BenchContext& bench) {
    std::string lines;
    for (const BenchContext::Claim& claim : bench.claims()) {
        std::string sentence = claim.sentence;
        std::replace(sentence.begin(), sentence.end(), '\n', ' ');
        lines += fmt::format("{}: {}\n", claim.holds ? "holds" : "missed", sentence);
    }
    return lines;
}

std::string markdown_page(const BenchContext& bench, const PageFacts& facts) {
    std::string page = fmt::format("# {}\n\n{}.\n\n", bench.name(), facts.description);
    const auto missed = std::count_if(bench.claims().begin(), bench.claims().end(),
                                      [](const auto& claim) { return !claim.holds; });
    if (missed > 0) {
        page += fmt::format(
            "**{} of {} claims {} not hold here**, see [below](#what-it-must-show).\n\n", missed,
            bench.claims().size(), missed == 1 ? "does" : "do");
    }
    if (facts.with_plot) {
        const std::string_view stem = facts.page.empty() ? bench.name() : facts.page;
        page += fmt::format("![{}: error against time]({}.svg)\n\n", bench.name(), stem);
    }
    page +=
        "| case | knob | level | ms, median | ms, 95 % | error | metric | baseline | speedup |\n"
        "|---|---|---|---:|---:|---:|---|---|---:|\n";
    for (const BenchRow& row : bench.rows()) {
        page += fmt::format(
            "| {} | {} | {} | {} | {} | {} | {} | {} | {} |\n", markdown_cell(row.case_name),
            markdown_cell(row.knob), markdown_cell(row.level), number_text(row.ms_median, 3),
            number_text(row.ms_p95, 3), number_text(row.error, 3), markdown_cell(row.metric),
            markdown_cell(row.baseline), number_text(row.speedup, 3));
    }
    if (!bench.claims().empty()) page += "\n## What it must show\n\n";
    for (const BenchContext::Claim& claim : bench.claims()) {
        page +=
            fmt::format("- {}: {}\n", claim.holds ? "holds" : "**does not hold**", claim.sentence);
    }
    if (!bench.notes().empty()) page += "\n## Notes\n\n";
    for (const std::string& note : bench.notes()) page += fmt::format("- {}\n", note);
    for (const std::string& section : bench.sections()) page += "\n" + section;
    page += "\n## Machine\n\n";
    page += fmt::format("- {}\n", facts.machine);
    if (!bench.device().empty()) page += fmt::format("- {}\n", bench.device());
    page += fmt::format("- made by `{}`{}\n", facts.command,
                        bench.quick() ? " (few repeats: read the ratios, not the digits)" : "");
    page +=
        "- times are medians over interleaved rounds; a speedup is the median of the ratios "
        "within each round\n";
    return page;
}

Result<void> write_text(const std::filesystem::path& path, std::string_view text) {
    std::error_code code;
    if (path.has_parent_path()) std::filesystem::create_directories(path.parent_path(), code);
    if (code) return fail("cannot create the folder: " + code.message(), path.parent_path());
    std::filesystem::path beside = path;
    beside += ".part";
    {
        std::ofstream file(beside, std::ios::binary);
        file.write(text.data(), static_cast<std::streamsize>(text.size()));
        file.flush();
        if (!file)
            return fail("cannot write", path, "is the folder writable and the disk not full?");
    }
    std::filesystem::rename(beside, path, code);
    if (code) return fail("cannot write: " + code.message(), path);
    return {};
}

}  // namespace kino::bench
