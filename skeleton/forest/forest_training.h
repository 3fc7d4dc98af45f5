#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>

#include "base/error.h"
#include "skeleton/forest/forest.h"
#include "skeleton/forest/training_images.h"

namespace kino {

/// Told after every level.
struct TrainingProgress {
    int tree = 0;
    int level = 0;                ///< -1: the leaves have been filled
    std::size_t nodes_open = 0;   ///< of this level
    std::size_t nodes_total = 0;  ///< of the tree, so far
    std::uint64_t samples = 0;    ///< pixels of the tree, or those that filled the leaves
};

struct ForestTraining {
    int trees = 3;
    int depth = 20;  ///< levels of splits, at most kForestMaxDepth
    std::uint64_t seed = 1;
    int threads = 1;  ///< changes the time and nothing else

    std::int64_t images_per_tree = 0;  ///< each tree takes the next ones in turn; 0: all
    int pixels_per_image = 1000;       ///< drawn without replacement
    /// This share of them is drawn with every label of the picture equally likely, so that hands
    /// are not drowned by the torso.
    double balanced_share = 0;
    /// Pixels of each picture for the final distributions of the leaves; 0: those that grew them.
    int leaf_pixels_per_image = 0;
    double leaf_balanced_share = 0;

    int features = 200;  ///< candidates at each node
    /// Candidates from level `deep_level` on; 0: as many as above.
    int deep_features = 0;
    int deep_level = 10;
    int thresholds = 20;    ///< candidates for each feature, at most 64
    double reach_mm = 600;  ///< longest offset, at the body
    double threshold_range_mm = 400;

    std::uint32_t min_samples = 16;  ///< a node with fewer becomes a leaf
    double min_gain_bits = 1e-4;

    /// A node's split is chosen by about so many of its samples at most, evenly picked.
    std::size_t node_samples = 100000;
    /// Leaves of each tree; the splits that tell least are taken back. 0: no limit.
    std::size_t max_leaves = 0;
    /// Labels with less than so many of a leaf's 255 votes get none, which shortens the file.
    int min_votes = 0;

    std::string note;  ///< for the file
    std::function<void(const TrainingProgress&)> progress;
};

/// Empty, or what is wrong with the settings.
[[nodiscard]] std::string training_defect(const ForestTraining& training);

/// Grows each tree level by level (Shotton et al. 2011, section 3.3): at every node the candidate
/// with the largest gain of information splits it. The same pictures, settings and seed give the
/// same forest on any number of threads. Every picture is asked for once a tree, and once more if
/// leaf_pixels_per_image is set; a tree's pictures and samples are kept meanwhile (TrainingSet).
[[nodiscard]] Result<Forest> train_forest(const TrainingImages& images,
                                          const ForestTraining& training);

}  // namespace kino
