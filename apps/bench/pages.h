#pragma once

#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "apps/bench/bench.h"

namespace kino::bench {

/// One committed bench: its table, and what its Markdown page says.
struct PageEntry {
    std::string stem;         ///< of its files, "raster"
    std::string description;  ///< first sentence of the page
    std::string machine;
    std::string device;
    std::string command;
    int claims_hold = 0;
    std::vector<std::string> claims_missed;
    std::vector<BenchRow> rows;
};

/// Reads NAME.csv and NAME.md of every bench in the folder, by name. Tables that are no bench's
/// (of other columns) are left out. Fails where a table is broken or its page is missing.
[[nodiscard]] Result<std::vector<PageEntry>> read_page_entries(const std::filesystem::path& folder);

/// docs/accuracy/index.html: everything in one file, without script and without network.
[[nodiscard]] std::string accuracy_page(std::span<const PageEntry> entries);

/// Both, and writes FOLDER/index.html and FOLDER/README.md (see knobs.h).
[[nodiscard]] Result<void> write_pages(const std::filesystem::path& folder);

}  // namespace kino::bench
