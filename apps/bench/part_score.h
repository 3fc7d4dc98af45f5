#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "apps/bench/marked_frames.h"
#include "skeleton/forest/coarse_part.h"
#include "skeleton/forest/part_labeller.h"
#include "skeleton/forest/training_images.h"

namespace kino {

/// Pixels of each true part (rows) by the part they were given.
struct PartConfusion {
    std::array<std::array<std::uint64_t, kCoarsePartCount>, kCoarsePartCount> count{};

    /// Share of right pixels.
    [[nodiscard]] double accuracy() const;
    /// Mean over the parts of the share of their pixels that are right.
    [[nodiscard]] double part_accuracy() const;
    [[nodiscard]] std::string csv() const;
    [[nodiscard]] std::string markdown() const;  ///< a table in percent of each row
};

/// A forest with what its labels mean in coarse parts. A label that straddles two parts counts as
/// whichever is right.
class PartJudge {
  public:
    /// Of a forest with the labels of BodyPart.
    [[nodiscard]] static PartJudge ours(const Forest& forest);
    /// Of PCL's, which settles ties by the pixels around; `focal_factor` times the focal length.
    [[nodiscard]] static PartJudge pcl(const Forest& forest, double focal_factor);

    /// Parts that a body's pixels were given, as sets; `body` as cut for this forest.
    void label(const BodyDepth& body, std::vector<CoarsePartSet>& said) const;
    [[nodiscard]] const PartLabeller& labeller() const { return labeller_; }
    [[nodiscard]] double focal_factor() const { return focal_factor_; }

    void add(const TrainingImage& image, PartConfusion& confusion) const;
    /// Pixels within 10 px of the marked joints, and those of them with a right label; by joint.
    struct Around {
        std::uint64_t right = 0, all = 0;
    };
    void add(const MarkedFrame& frame, std::vector<std::pair<std::string, Around>>& joints) const;

  private:
    PartJudge(const Forest& forest, bool settle, double focal_factor)
        : labeller_(forest), settle_(settle), focal_factor_(focal_factor) {}
    PartLabeller labeller_;
    std::vector<CoarsePartSet> meaning_;
    bool settle_;
    double focal_factor_;
};

/// Cuts the body of a training picture or a marked frame.
void cut_body(const TrainingImage& image, double focal_factor, BodyDepth& body, int step = 1);
void cut_body(const MarkedFrame& frame, double focal_factor, BodyDepth& body);

}  // namespace kino
