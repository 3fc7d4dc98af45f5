#pragma once

#include <array>
#include <string>
#include <vector>

#include "base/body.h"

namespace kino::test {

/// Errors of joints in mm; what is missing or lost counts as 300.
class Score {
  public:
    /// `found` null: nobody.
    void add(const Body& truth, const Body* found);
    void add(const Score& other);
    [[nodiscard]] std::string summary() const;
    [[nodiscard]] std::string by_joint() const;
    [[nodiscard]] std::string by_range() const;
    [[nodiscard]] double mean() const;

  private:
    struct Entry {
        float error_mm;
        float range_m;
        std::uint8_t joint;
        bool visible;
        bool lost;
        std::array<float, 3> offset_mm;
    };
    std::vector<Entry> entries_;
};

}  // namespace kino::test
