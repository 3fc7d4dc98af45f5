#include "tests/skeleton/tracking/eval/score.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <glm/geometric.hpp>

namespace kino::test {
namespace {

struct Figures {
    std::size_t n = 0;
    double mean = 0, median = 0, p90 = 0, p97 = 0, within100 = 0, within150 = 0;
};

Figures figures(std::vector<float> errors) {
    Figures f;
    f.n = errors.size();
    if (errors.empty()) return f;
    std::ranges::sort(errors);
    for (const float e : errors) {
        f.mean += static_cast<double>(e);
        f.within100 += e <= 100 ? 1 : 0;
        f.within150 += e <= 150 ? 1 : 0;
    }
    const auto n = static_cast<double>(f.n);
    f.mean /= n;
    f.within100 *= 100 / n;
    f.within150 *= 100 / n;
    const auto at = [&](double q) {
        return static_cast<double>(errors[static_cast<std::size_t>(q * (n - 1))]);
    };
    f.median = at(0.5);
    f.p90 = at(0.9);
    f.p97 = at(0.97);
    return f;
}

std::string line(const std::string& name, const Figures& f) {
    return fmt::format(
        "{:<18} n {:7} mean {:6.1f} median {:6.1f} p90 {:6.1f} p97 {:6.1f} <=100 {:5.1f}% <=150 "
        "{:5.1f}%\n",
        name, f.n, f.mean, f.median, f.p90, f.p97, f.within100, f.within150);
}

}  // namespace

void Score::add(const Body& truth, const Body* found) {
    for (std::size_t j = 0; j < kJointCount; ++j) {
        const JointPosition& t = truth.joints[j];
        Entry entry{
            300,  t.position_m.z, static_cast<std::uint8_t>(j), t.state == JointState::tracked,
            true, {0, 0, 0}};
        if (found && found->joints[j].state != JointState::lost) {
            const glm::vec3 d = (found->joints[j].position_m - t.position_m) * 1000.0f;
            entry.error_mm = glm::length(d);
            entry.lost = false;
            entry.offset_mm = {d.x, d.y, d.z};
        }
        entries_.push_back(entry);
    }
}

void Score::add(const Score& other) {
    entries_.insert(entries_.end(), other.entries_.begin(), other.entries_.end());
}

double Score::mean() const {
    double sum = 0;
    for (const Entry& e : entries_) sum += static_cast<double>(e.error_mm);
    return entries_.empty() ? 0 : sum / static_cast<double>(entries_.size());
}

std::string Score::summary() const {
    const auto of = [&](const std::function<bool(const Entry&)>& wanted) {
        std::vector<float> errors;
        for (const Entry& e : entries_) {
            if (wanted(e)) errors.push_back(e.error_mm);
        }
        return figures(std::move(errors));
    };
    return line("all", of([](const Entry&) { return true; })) +
           line("visible", of([](const Entry& e) { return e.visible; })) +
           line("hidden", of([](const Entry& e) { return !e.visible; })) +
           line("lost", of([](const Entry& e) { return e.lost; }));
}

std::string Score::by_joint() const {
    std::string out;
    for (std::size_t j = 0; j < kJointCount; ++j) {
        std::vector<float> errors;
        std::array<std::vector<float>, 3> offsets;
        for (const Entry& e : entries_) {
            if (e.joint != j) continue;
            errors.push_back(e.error_mm);
            for (std::size_t k = 0; k < 3; ++k) offsets[k].push_back(e.offset_mm[k]);
        }
        if (errors.empty()) continue;
        std::array<float, 3> median{};
        for (std::size_t k = 0; k < 3; ++k) {
            const auto middle = offsets[k].begin() + static_cast<long>(offsets[k].size() / 2);
            std::nth_element(offsets[k].begin(), middle, offsets[k].end());
            median[k] = *middle;
        }
        std::string text = line(joint_name(static_cast<Joint>(j)), figures(std::move(errors)));
        text.pop_back();
        out += text + fmt::format("  median offset {:5.0f} {:5.0f} {:5.0f}\n", median[0], median[1],
                                  median[2]);
    }
    return out;
}

std::string Score::by_range() const {
    std::string out;
    for (int m = 0; m < 8; ++m) {
        std::vector<float> errors;
        for (const Entry& e : entries_) {
            if (static_cast<int>(e.range_m) == m) errors.push_back(e.error_mm);
        }
        if (!errors.empty()) {
            out += line(fmt::format("{} to {} m", m, m + 1), figures(std::move(errors)));
        }
    }
    return out;
}

}  // namespace kino::test
