#pragma once

#include <cstdint>
#include <string>
#include <utility>
#include <vector>

namespace kino {

/// What a conversion could not keep: each kind once, with the number of times it came.
class Losses {
  public:
    void add(const std::string& what, std::int64_t times = 1) {
        if (times <= 0) return;
        for (auto& [known, count] : entries_) {
            if (known == what) {
                count += times;
                return;
            }
        }
        entries_.emplace_back(what, times);
    }
    /// A loss of the whole conversion, told without a number.
    void state(const std::string& what) {
        for (auto& [known, count] : entries_) {
            if (known == what) return;
        }
        entries_.emplace_back(what, 0);
    }
    /// In the order in which they first came: "text", or "text: n" for counted ones.
    [[nodiscard]] std::vector<std::string> lines() const {
        std::vector<std::string> out;
        for (const auto& [what, count] : entries_) {
            out.push_back(count == 0 ? what : what + ": " + std::to_string(count));
        }
        return out;
    }

  private:
    std::vector<std::pair<std::string, std::int64_t>> entries_;
};

}  // namespace kino
