#pragma once

#include <filesystem>
#include <limits>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "apps/bench/reference_cache.h"
#include "apps/bench/timing.h"
#include "base/error.h"

namespace kino::bench {

constexpr double kNotMeasured = std::numeric_limits<double>::quiet_NaN();

/// One line of the table, in the order of the CSV columns. A number that was not measured is NaN
/// and stays empty in the file.
struct BenchRow {
    std::string case_name{};  ///< what was worked on, e.g. "orbit 1280x720"
    std::string knob{};       ///< what is turned, e.g. "path" or "iterations"
    std::string level{};      ///< its setting in this row, e.g. "compute splat" or "3"
    double ms_median = kNotMeasured;
    double ms_p95 = kNotMeasured;
    double error = kNotMeasured;    ///< against the reference, in the unit `metric` names
    std::string metric{};           ///< e.g. "px RMS", "m max", "share of pixels"
    std::string baseline{};         ///< level that `speedup` refers to; may be empty
    double speedup = kNotMeasured;  ///< median of paired ratios, over 1 = faster than baseline
};

/// What an entry is handed: how long it may take, and where its findings go.
class BenchContext {
  public:
    BenchContext(std::string bench_name, bool quick);

    /// True with --quick: fewer repeats, the smallest cases that still show the point.
    [[nodiscard]] bool quick() const { return quick_; }
    /// The given options, or a fifth of the repeats (at least five) with --quick.
    [[nodiscard]] RepeatOptions repeats(RepeatOptions full = {}) const;

    /// Folders given on the command line: the pretrained trees of the Point Cloud Library, and real
    /// frames with joints2d.json. Empty where not given.
    std::filesystem::path peer;
    std::vector<std::filesystem::path> marked;
    /// For references that take long: context.references.image<glm::dvec3>(key, [&] { ... }).
    /// Keeps nothing unless the program was given a folder.
    ReferenceCache references;

    /// One line on stderr with the time since the entry began.
    void progress(std::string_view what) const;

    /// Interleaved timing with this run's number of repeats, told on stderr under `what`.
    [[nodiscard]] Comparison compare(std::string_view what, std::span<const Candidate> candidates,
                                     RepeatOptions full = {}) const;

    void add(BenchRow row);
    /// Adds `row` with the times of the candidate named by row.level and, if row.baseline names
    /// one, the speedup over it.
    void add(BenchRow row, const Comparison& comparison);

    /// A sentence for the page under the table: what a reader must know to judge the numbers.
    void note(std::string sentence);
    /// Whether what we promise holds on this machine; told on the page and on stderr.
    void claim(std::string sentence, bool holds);
    /// Markdown for the page, after the notes.
    void section(std::string markdown);
    /// A file beside the page; `name` is relative to the page's folder.
    void file(std::string name, std::string bytes);
    /// Device and driver used, for the page's description of the machine.
    void set_device(std::string description);
    /// The entry could not do its work: the program ends with an error after the other entries.
    void fail(Error error);

    struct Claim {
        std::string sentence;
        bool holds = false;
    };
    [[nodiscard]] const std::string& name() const { return name_; }
    [[nodiscard]] std::span<const BenchRow> rows() const { return rows_; }
    [[nodiscard]] std::span<const std::string> notes() const { return notes_; }
    [[nodiscard]] std::span<const Claim> claims() const { return claims_; }
    struct File {
        std::string name, bytes;
    };
    [[nodiscard]] std::span<const std::string> sections() const { return sections_; }
    [[nodiscard]] std::span<const File> files() const { return files_; }
    [[nodiscard]] const std::string& device() const { return device_; }
    [[nodiscard]] std::span<const Error> errors() const { return errors_; }

  private:
    std::string name_;
    bool quick_;
    double started_s_;
    std::vector<BenchRow> rows_;
    std::vector<std::string> notes_;
    std::vector<Claim> claims_;
    std::vector<std::string> sections_;
    std::vector<File> files_;
    std::string device_;
    std::vector<Error> errors_;
};

}  // namespace kino::bench

namespace kino {
using bench::BenchContext;
using bench::BenchRow;
}  // namespace kino
