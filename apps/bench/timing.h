#pragma once

#include <cstddef>
#include <functional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace kino::bench {

/// One way of doing the work that is compared.
struct Candidate {
    std::string name;
    std::function<void()> run;        ///< what is timed; for the GPU: submit and wait for the fence
    std::function<void()> prepare{};  ///< not timed, before every run; may be empty
};

struct RepeatOptions {
    int repeats = 31;  ///< timed rounds; each candidate runs once a round
    int warm_up = 3;   ///< rounds before them that nobody reads
    /// The rounds end early once they have taken this long, but not before five rounds.
    double max_seconds = 30.0;
};

/// Wall times of one candidate in milliseconds, in the order of the rounds.
struct Timing {
    std::string name;
    std::vector<double> ms;

    [[nodiscard]] double median_ms() const;
    [[nodiscard]] double p95_ms() const;
};

/// Times of all candidates from the same rounds, so that a slow moment of the machine hits all.
class Comparison {
  public:
    explicit Comparison(std::vector<Timing> timings) : timings_(std::move(timings)) {}

    [[nodiscard]] std::span<const Timing> timings() const { return timings_; }
    /// KINO_CHECKs that the name is one of the candidates.
    [[nodiscard]] const Timing& operator[](std::string_view name) const;
    /// Median over the rounds of baseline time / candidate time: 2 = twice as fast.
    [[nodiscard]] double speedup(std::string_view candidate, std::string_view baseline) const;

  private:
    std::vector<Timing> timings_;
};

/// Runs the candidates interleaved, A B A B ...; every other round goes backwards, so that none
/// always profits from its neighbour's caches.
[[nodiscard]] Comparison compare(std::span<const Candidate> candidates, RepeatOptions options = {});

/// Linear interpolation between order statistics at rank q (n - 1) (type 7 of Hyndman & Fan,
/// Sample quantiles in statistical packages, 1996); NaN for no samples. q in [0, 1].
[[nodiscard]] double quantile(std::span<const double> samples, double q);

}  // namespace kino::bench
