#include "skeleton/forest/forest_file.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <string_view>

#include "base/check.h"
#include "sensor/file_bytes.h"
#include "sensor/session/crc32.h"

namespace kino {
namespace {

constexpr std::string_view kMagic = "KINOFRST";
constexpr unsigned kVersion = 1;
constexpr std::size_t kMaxForestBytes = std::size_t{256} << 20;

class Writer {
  public:
    void number(std::uint64_t value, int bytes) {
        for (int i = 0; i < bytes; ++i) out.push_back(static_cast<std::uint8_t>(value >> (8 * i)));
    }
    void text(std::string_view text) { out.insert(out.end(), text.begin(), text.end()); }
    std::vector<std::uint8_t> out;
};

// Reads past the end give zeros and set `over`, so that callers check once a section.
class Reader {
  public:
    explicit Reader(std::span<const std::uint8_t> in) : in_(in) {}
    std::uint32_t number(int bytes) {
        std::uint32_t value = 0;
        for (int i = 0; i < bytes; ++i) {
            if (at_ < in_.size()) value |= static_cast<std::uint32_t>(in_[at_]) << (8 * i);
            ++at_;
        }
        return value;
    }
    std::int16_t signed16() { return static_cast<std::int16_t>(number(2)); }
    std::span<const std::uint8_t> bytes(std::size_t count) {
        if (count > left()) {
            at_ = in_.size() + 1;
            return {};
        }
        at_ += count;
        return in_.subspan(at_ - count, count);
    }
    std::string text(std::size_t count) {
        const auto raw = bytes(count);
        return {raw.begin(), raw.end()};
    }
    [[nodiscard]] std::size_t left() const { return at_ < in_.size() ? in_.size() - at_ : 0; }
    [[nodiscard]] bool over() const { return at_ > in_.size(); }

  private:
    std::span<const std::uint8_t> in_;
    std::size_t at_ = 0;
};

void write_tree(const ForestTree& tree, Writer& w) {
    const auto& nodes = tree.nodes;
    w.number(nodes.size(), 4);
    for (std::size_t i = 0; i < nodes.size(); i += 8) {
        unsigned bits = 0;
        for (std::size_t k = i; k < std::min(i + 8, nodes.size()); ++k)
            bits |= (nodes[k].is_leaf() ? 0u : 1u) << (k - i);
        w.number(bits, 1);
    }
    for (const ForestNode& n : nodes) {
        if (n.is_leaf()) {
            w.number(static_cast<std::uint32_t>(n.leaf), 3);
            continue;
        }
        for (const std::int16_t value :
             {n.feature.u[0], n.feature.u[1], n.feature.v[0], n.feature.v[1], n.threshold_mm})
            w.number(static_cast<std::uint16_t>(value), 2);
    }
}

bool read_tree(Reader& r, ForestTree& tree) {
    const std::size_t count = r.number(4);
    const auto bits = r.bytes(count / 8 + (count % 8 != 0 ? 1 : 0));
    // A leaf takes three bytes, a split more.
    if (r.over() || count == 0 || count > r.left() / 3) return false;
    tree.nodes.resize(count);
    std::int32_t children = 1;
    for (std::size_t i = 0; i < count; ++i) {
        ForestNode& n = tree.nodes[i];
        if ((bits[i / 8] >> (i % 8) & 1) == 0) {
            n.leaf = static_cast<std::int32_t>(r.number(3));
            continue;
        }
        for (std::int16_t* value :
             {&n.feature.u[0], &n.feature.u[1], &n.feature.v[0], &n.feature.v[1], &n.threshold_mm})
            *value = r.signed16();
        n.child = children;
        children += 2;
    }
    const bool padded = count % 8 == 0 || bits.back() >> (count % 8) == 0;
    return padded && !r.over() && static_cast<std::size_t>(children) == count;
}

bool read_distribution(Reader& r, LabelDistribution& row) {
    const std::uint32_t entries = r.number(1);
    int previous = -1;
    for (std::uint32_t e = 0; e < entries; ++e) {
        const auto label = static_cast<int>(r.number(1));
        const auto votes = static_cast<std::uint8_t>(r.number(1));
        if (label <= previous || label >= kForestMaxLabels || votes == 0) return false;
        row[static_cast<std::size_t>(label)] = votes;
        previous = label;
    }
    return !r.over();
}

Result<Forest> read_body(Reader& r, const std::string& where) {
    const auto damaged = [&](const char* part) {
        return fail(fmt::format("the forest's {} are not sound", part), where);
    };
    Forest forest;
    const std::uint32_t labels = r.number(1);
    const std::uint32_t trees = r.number(1);
    const std::uint32_t distributions = r.number(4);
    forest.note = r.text(r.number(2));
    for (std::uint32_t l = 0; l < labels && !r.over(); ++l)
        forest.labels.push_back(r.text(r.number(1)));
    if (r.over() || distributions > r.left() / 3) return damaged("labels");
    forest.distributions.resize(distributions);
    for (LabelDistribution& row : forest.distributions)
        if (!read_distribution(r, row)) return damaged("distributions");
    for (std::uint32_t t = 0; t < trees; ++t)
        if (!read_tree(r, forest.trees.emplace_back())) return damaged("trees");
    if (r.left() != 0) return fail("there is more after the forest's end", where);
    if (const std::string defect = forest_defect(forest); !defect.empty())
        return fail("the forest is not sound: " + defect, where);
    return forest;
}

}  // namespace

std::vector<std::uint8_t> forest_to_bytes(const Forest& forest) {
    KINO_CHECK(forest_defect(forest).empty());
    KINO_CHECK_LT(forest.distributions.size(), std::size_t{1} << 24);
    Writer w;
    w.text(kMagic);
    w.number(kVersion, 2);
    w.number(forest.labels.size(), 1);
    w.number(forest.trees.size(), 1);
    w.number(forest.distributions.size(), 4);
    w.number(forest.note.size(), 2);
    w.text(forest.note);
    for (const std::string& name : forest.labels) {
        w.number(name.size(), 1);
        w.text(name);
    }
    for (const LabelDistribution& row : forest.distributions) {
        w.number(static_cast<std::uint64_t>(row.size() - std::count(row.begin(), row.end(), 0)), 1);
        for (std::size_t l = 0; l < row.size(); ++l) {
            if (row[l] == 0) continue;
            w.number(l, 1);
            w.number(row[l], 1);
        }
    }
    for (const ForestTree& tree : forest.trees) write_tree(tree, w);
    w.number(crc32(w.out), 4);
    return std::move(w.out);
}

Result<Forest> forest_from_bytes(std::span<const std::uint8_t> bytes, const std::string& where) {
    Reader head(bytes);
    if (head.text(kMagic.size()) != kMagic) return fail("not a forest file", where);
    if (const unsigned version = head.number(2); head.over() || version != kVersion)
        return fail(fmt::format("forest file of version {}", version), where,
                    fmt::format("this program reads version {}", kVersion));
    if (head.left() < 4) return fail("the forest file is cut short", where);
    const std::size_t end = bytes.size() - 4;
    Reader tail(bytes.subspan(end));
    if (tail.number(4) != crc32(bytes.first(end)))
        return fail("the forest file is damaged: its checksum is wrong", where);
    const std::size_t start = kMagic.size() + 2;
    Reader body(bytes.subspan(start, end - start));
    return read_body(body, where);
}

Result<Forest> read_forest(const std::filesystem::path& path) {
    KINO_ASSIGN(const std::vector<std::uint8_t> bytes, read_file_bytes(path, kMaxForestBytes));
    return forest_from_bytes(bytes, path.string());
}

Result<void> write_forest(const std::filesystem::path& path, const Forest& forest) {
    const std::vector<std::uint8_t> bytes = forest_to_bytes(forest);
    return write_file_bytes(path, bytes.data(), bytes.size());
}

}  // namespace kino
