#include "apps/bench/part_score.h"

#include <fmt/format.h>

#include <algorithm>
#include <bit>

#include "skeleton/forest/body_part.h"

namespace kino {
namespace {

constexpr double kAroundPx = 10;

double share(std::uint64_t part, std::uint64_t all) {
    return all == 0 ? 0 : static_cast<double>(part) / static_cast<double>(all);
}

}  // namespace

double PartConfusion::accuracy() const {
    std::uint64_t right = 0, all = 0;
    for (std::size_t t = 0; t < count.size(); ++t) {
        right += count[t][t];
        for (const std::uint64_t n : count[t]) all += n;
    }
    return share(right, all);
}

double PartConfusion::part_accuracy() const {
    double sum = 0;
    int parts = 0;
    for (std::size_t t = 0; t < count.size(); ++t) {
        std::uint64_t all = 0;
        for (const std::uint64_t n : count[t]) all += n;
        if (all == 0) continue;
        sum += share(count[t][t], all);
        ++parts;
    }
    return parts == 0 ? 0 : sum / parts;
}

std::string PartConfusion::csv() const {
    std::string text = "truth";
    for (int p = 0; p < kCoarsePartCount; ++p)
        text += fmt::format(",{}", coarse_part_name(static_cast<CoarsePart>(p)));
    text += '\n';
    for (std::size_t t = 0; t < count.size(); ++t) {
        text += coarse_part_name(static_cast<CoarsePart>(t));
        for (const std::uint64_t n : count[t]) text += fmt::format(",{}", n);
        text += '\n';
    }
    return text;
}

std::string PartConfusion::markdown() const {
    std::string text = "| % |";
    for (int p = 0; p < kCoarsePartCount; ++p)
        text += fmt::format(" {} |", coarse_part_name(static_cast<CoarsePart>(p)));
    text += "\n|---|";
    for (int p = 0; p < kCoarsePartCount; ++p) text += "---:|";
    text += '\n';
    for (std::size_t t = 0; t < count.size(); ++t) {
        text += fmt::format("| {} |", coarse_part_name(static_cast<CoarsePart>(t)));
        std::uint64_t all = 0;
        for (const std::uint64_t n : count[t]) all += n;
        for (const std::uint64_t n : count[t])
            text += fmt::format(" {:.1f} |", 100 * share(n, all));
        text += '\n';
    }
    return text;
}

PartJudge PartJudge::ours(const Forest& forest) {
    PartJudge judge(forest, false, 1);
    for (int l = 0; l < kBodyPartCount; ++l)
        judge.meaning_.push_back(coarse_set(coarse_part_of(static_cast<BodyPart>(l))));
    return judge;
}

PartJudge PartJudge::pcl(const Forest& forest, double focal_factor) {
    PartJudge judge(forest, true, focal_factor);
    for (int l = 0; l < kPclPartCount; ++l)
        judge.meaning_.push_back(coarse_parts_of(static_cast<PclPart>(l)));
    return judge;
}

void PartJudge::label(const BodyDepth& body, std::vector<CoarsePartSet>& said) const {
    PartLabels labels;
    labeller_.label(body, labels);
    if (settle_) settle_pcl_ties(body, labels);
    said.resize(labels.label.size());
    std::transform(labels.label.begin(), labels.label.end(), said.begin(),
                   [&](std::uint8_t l) { return meaning_.at(l); });
}

void PartJudge::add(const TrainingImage& image, PartConfusion& confusion) const {
    BodyDepth body;
    cut_body(image, focal_factor_, body);
    std::vector<CoarsePartSet> said;
    label(body, said);
    for (std::size_t i = 0; i < said.size(); ++i) {
        const CoarsePart truth =
            coarse_part_of(static_cast<BodyPart>(image.label.at(body.x(i), body.y(i))));
        const bool right = (said[i] & coarse_set(truth)) != 0;
        const auto given =
            right ? static_cast<std::size_t>(truth)
                  : static_cast<std::size_t>(std::countr_zero(static_cast<unsigned>(said[i])));
        ++confusion.count[static_cast<std::size_t>(truth)][given];
    }
}

void PartJudge::add(const MarkedFrame& frame,
                    std::vector<std::pair<std::string, Around>>& joints) const {
    BodyDepth body;
    cut_body(frame, focal_factor_, body);
    std::vector<CoarsePartSet> said;
    label(body, said);
    for (const MarkedJoint& joint : frame.joints) {
        // Both sides of a joint are one kind.
        const std::string kind =
            joint.name.substr(joint.name.starts_with("i") && joint.name[2] == '_' ? 3 : 0);
        auto at = std::find_if(joints.begin(), joints.end(),
                               [&](const auto& entry) { return entry.first == kind; });
        if (at == joints.end()) at = joints.insert(joints.end(), {kind, {}});
        for (std::size_t i = 0; i < said.size(); ++i) {
            const double dx = body.x(i) - joint.x, dy = body.y(i) - joint.y;
            if (dx * dx + dy * dy > kAroundPx * kAroundPx) continue;
            ++at->second.all;
            at->second.right += (said[i] & joint.right) != 0 ? 1 : 0;
        }
    }
}

void cut_body(const TrainingImage& image, double focal_factor, BodyDepth& body, int step) {
    Image<std::uint8_t> mask(image.label.width(), image.label.height());
    std::transform(image.label.pixels().begin(), image.label.pixels().end(), mask.pixels().begin(),
                   [](std::uint8_t l) { return static_cast<std::uint8_t>(l != kNotBody); });
    body.set(std::as_const(image.depth_mm).view(), std::as_const(mask).view(), 1,
             image.focal_px * focal_factor, step);
}

void cut_body(const MarkedFrame& frame, double focal_factor, BodyDepth& body) {
    body.set(frame.depth_mm.view(), frame.body.view(), 1, kMarkedFocalPx * focal_factor);
}

}  // namespace kino
