#include "skeleton/forest/pcl_forest.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cstdlib>

#include "base/check.h"
#include "sensor/file_bytes.h"

namespace kino {
namespace {

constexpr int kMaxTextDepth = 20;
constexpr int kMaxOffsetMm = 8191;
constexpr std::size_t kMaxPclBytes = std::size_t{128} << 20;

constexpr std::array<const char*, kPclPartCount> kPclNames = {
    "left_foot",         "left_leg",      "left_knee",      "left_thigh",
    "right_foot",        "right_leg",     "right_knee",     "right_thigh",
    "right_hips",        "left_hips",     "neck",           "right_arm",
    "right_elbow",       "right_forearm", "right_hand",     "left_arm",
    "left_elbow",        "left_forearm",  "left_hand",      "face_left_bottom",
    "face_right_bottom", "face_left_top", "face_right_top", "right_chest",
    "left_chest",
};

class Numbers {
  public:
    explicit Numbers(std::string_view text) : at_(text.data()), end_(text.data() + text.size()) {}

    // False at the end of the text, at anything but a number, and outside [low, high].
    bool next(int low, int high, int& out) {
        skip_space();
        const auto [after, error] = std::from_chars(at_, end_, out);
        if (error != std::errc{} || out < low || out > high) return false;
        at_ = after;
        return true;
    }
    bool finished() {
        skip_space();
        return at_ == end_;
    }

  private:
    void skip_space() {
        while (at_ != end_ && (*at_ == ' ' || *at_ == '\n' || *at_ == '\r' || *at_ == '\t')) ++at_;
    }
    const char* at_;
    const char* end_;
};

bool read_split(Numbers& numbers, ForestNode& node) {
    for (std::int16_t* offset :
         {&node.feature.u[0], &node.feature.u[1], &node.feature.v[0], &node.feature.v[1]}) {
        int mm = 0;
        if (!numbers.next(-kMaxOffsetMm, kMaxOffsetMm, mm)) return false;
        *offset = static_cast<std::int16_t>(mm * kForestOffsetsPerMm);
    }
    int threshold = 0;
    if (!numbers.next(-32768, 32767, threshold)) return false;
    node.threshold_mm = static_cast<std::int16_t>(threshold);
    return true;
}

// Bottom up, so that whole subtrees of one label fold into one leaf.
void fold(std::vector<ForestNode>& nodes, std::size_t splits) {
    for (std::size_t i = splits; i-- > 0;) {
        const ForestNode& a = nodes[2 * i + 1];
        const ForestNode& b = nodes[2 * i + 2];
        if (a.is_leaf() && b.is_leaf() && a.leaf == b.leaf) {
            const std::int32_t label = a.leaf;
            nodes[i] = {};
            nodes[i].leaf = label;
        } else {
            nodes[i].child = static_cast<std::int32_t>(2 * i + 1);
        }
    }
}

}  // namespace

Result<ForestTree> parse_pcl_tree(std::string_view text, const std::string& where) {
    Numbers numbers(text);
    int depth = 0;
    if (!numbers.next(1, kMaxTextDepth, depth))
        return fail("not a tree of PCL: no depth of 1..20 at its start", where);
    const std::size_t splits = (std::size_t{1} << depth) - 1;
    // A number and what parts it from the next take two bytes.
    if (text.size() / 2 < 5 * splits + splits)
        return fail(fmt::format("too short for a tree of depth {}", depth), where);
    std::vector<ForestNode> nodes(2 * splits + 1);
    for (std::size_t i = 0; i < splits; ++i)
        if (!read_split(numbers, nodes[i]))
            return fail(fmt::format("node {} is not five numbers in range", i), where);
    for (std::size_t i = splits; i < nodes.size(); ++i) {
        int label = 0;
        if (!numbers.next(0, kPclPartCount - 1, label))
            return fail(fmt::format("leaf {} has no label of 0..24", i - splits), where);
        nodes[i].leaf = label;
    }
    if (!numbers.finished()) return fail("there is more after the last label", where);
    fold(nodes, splits);
    return breadth_first(nodes, 0);
}

Forest pcl_forest(std::vector<ForestTree> trees) {
    Forest forest;
    forest.labels.assign(kPclNames.begin(), kPclNames.end());
    forest.distributions.resize(kPclPartCount);
    for (std::size_t l = 0; l < forest.distributions.size(); ++l)
        forest.distributions[l][l] = kForestVotes;
    forest.trees = std::move(trees);
    forest.note = "Point Cloud Library people trees, BSD 3-clause";
    KINO_CHECK(forest_defect(forest).empty());
    return forest;
}

Result<Forest> read_pcl_forest(std::span<const std::filesystem::path> paths) {
    if (paths.empty() || paths.size() > kForestMaxTrees)
        return fail(fmt::format("{} trees for a forest", paths.size()), {}, "give 1 to 16");
    std::vector<ForestTree> trees;
    for (const auto& path : paths) {
        KINO_ASSIGN(const std::string text, read_file_text(path, kMaxPclBytes));
        KINO_ASSIGN(ForestTree tree, parse_pcl_tree(text, path.string()));
        trees.push_back(std::move(tree));
    }
    return pcl_forest(std::move(trees));
}

void settle_pcl_ties(const BodyDepth& body, PartLabels& labels) {
    const forest::WalkImage image = body.image();
    const auto place = [&](int x, int y) {
        return static_cast<std::size_t>(y) * static_cast<std::size_t>(image.pitch) +
               static_cast<std::size_t>(x);
    };
    const forest::WalkPixels pixels = body.pixels();
    std::vector<std::int32_t> listed(place(0, image.max_y + 1), -1);
    for (std::size_t i = 0; i < pixels.count; ++i)
        listed[place(static_cast<int>(pixels.xy[i] & 0xFFFF),
                     static_cast<int>(pixels.xy[i] >> 16))] = static_cast<std::int32_t>(i);
    for (std::size_t i = 0; i < pixels.count; ++i) {
        std::array<int, kPclPartCount> votes{};
        const auto add = [&](std::size_t pixel) {
            for (const auto& leaf : labels.leaf) ++votes.at(static_cast<std::size_t>(leaf[pixel]));
        };
        add(i);
        const int most = *std::max_element(votes.begin(), votes.end());
        if (std::count(votes.begin(), votes.end(), most) == 1) continue;
        const int x = static_cast<int>(pixels.xy[i] & 0xFFFF);
        const int y = static_cast<int>(pixels.xy[i] >> 16);
        const int own = image.depth[place(x, y)];
        for (int dy = -1; dy <= 1; ++dy)
            for (int dx = -1; dx <= 1; ++dx) {
                const std::size_t at = place(x + dx, y + dy);
                if (listed[at] < 0 || std::abs(image.depth[at] - own) >= 50) continue;
                add(static_cast<std::size_t>(listed[at]));
            }
        const auto best = std::max_element(votes.begin(), votes.end());
        labels.label[i] = static_cast<std::uint8_t>(best - votes.begin());
    }
}

}  // namespace kino
