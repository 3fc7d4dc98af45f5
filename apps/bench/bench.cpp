#include "apps/bench/bench.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <utility>

namespace kino::bench {

namespace {
double now_s() {
    return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch())
        .count();
}
}  // namespace

BenchContext::BenchContext(std::string bench_name, bool quick)
    : name_(std::move(bench_name)), quick_(quick), started_s_(now_s()) {}

RepeatOptions BenchContext::repeats(RepeatOptions full) const {
    if (quick_) {
        full.repeats = std::max(5, full.repeats / 5);
        full.warm_up = std::min(full.warm_up, 1);
        full.max_seconds /= 5;
    }
    return full;
}

void BenchContext::progress(std::string_view what) const {
    fmt::print(stderr, "{:7.1f} s  {}: {}\n", now_s() - started_s_, name_, what);
}

Comparison BenchContext::compare(std::string_view what, std::span<const Candidate> candidates,
                                 RepeatOptions full) const {
    progress(what);
    Comparison comparison = bench::compare(candidates, repeats(full));
    for (const Timing& timing : comparison.timings()) {
        progress(fmt::format("  {} {:.3f} ms (95 %: {:.3f})", timing.name, timing.median_ms(),
                             timing.p95_ms()));
    }
    return comparison;
}

void BenchContext::add(BenchRow row) {
    rows_.push_back(std::move(row));
}

void BenchContext::add(BenchRow row, const Comparison& comparison) {
    row.ms_median = comparison[row.level].median_ms();
    row.ms_p95 = comparison[row.level].p95_ms();
    if (!row.baseline.empty()) row.speedup = comparison.speedup(row.level, row.baseline);
    add(std::move(row));
}

void BenchContext::note(std::string sentence) {
    notes_.push_back(std::move(sentence));
}

void BenchContext::claim(std::string sentence, bool holds) {
    progress(fmt::format("{}: {}", holds ? "holds" : "DOES NOT HOLD", sentence));
    claims_.push_back({std::move(sentence), holds});
}

void BenchContext::section(std::string markdown) {
    sections_.push_back(std::move(markdown));
}

void BenchContext::file(std::string name, std::string bytes) {
    files_.push_back({std::move(name), std::move(bytes)});
}

void BenchContext::set_device(std::string description) {
    device_ = std::move(description);
}

void BenchContext::fail(Error error) {
    progress(error.to_string());
    errors_.push_back(std::move(error));
}

}  // namespace kino::bench
