#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string_view>

#include "base/check.h"
#include "skeleton/forest/forest_file.h"
#include "skeleton/forest/part_labeller.h"
#include "skeleton/forest/pcl_forest.h"

/// What the parsers promise for any bytes: no crash, errors that say something, and whatever they
/// accept is sound and runs.
namespace kino::fuzz {

inline void run_forest(const Forest& forest) {
    KINO_CHECK(forest_defect(forest).empty());
    Image<std::uint16_t> depth(19, 11, 900);
    depth.at(3, 4) = 2000;
    const Image<std::uint8_t> body(19, 11, 1);
    BodyDepth cut;
    cut.set(std::as_const(depth).view(), body.view(), 1, 500);
    PartLabels labels;
    PartLabeller(forest).label(cut, labels);
    for (const std::uint8_t label : labels.label) KINO_CHECK_LT(label, forest.labels.size());
}

inline void forest(std::span<const std::uint8_t> bytes) {
    const auto forest = forest_from_bytes(bytes, "fuzz");
    if (!forest) {
        KINO_CHECK(!forest.error().what.empty() && forest.error().where == "fuzz");
        return;
    }
    run_forest(*forest);
    const std::vector<std::uint8_t> again = forest_to_bytes(*forest);
    KINO_CHECK(std::equal(again.begin(), again.end(), bytes.begin(), bytes.end()));
}

inline void pcl_tree(std::span<const std::uint8_t> bytes) {
    const std::string_view text(reinterpret_cast<const char*>(bytes.data()), bytes.size());
    auto tree = parse_pcl_tree(text, "fuzz");
    if (!tree) {
        KINO_CHECK(!tree.error().what.empty() && tree.error().where == "fuzz");
        return;
    }
    run_forest(pcl_forest({std::move(*tree)}));
}

}  // namespace kino::fuzz
