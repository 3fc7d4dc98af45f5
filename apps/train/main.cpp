#include <fmt/format.h>
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <chrono>
#include <csignal>
#include <cstdio>
#include <exception>
#include <filesystem>
#include <memory>
#include <string>
#include <utility>

#include "skeleton/actors/actor_images.h"
#include "skeleton/actors/cached_images.h"
#include "skeleton/forest/forest_file.h"
#include "skeleton/forest/forest_training.h"

namespace kino {
namespace {

constexpr int kFailed = 1;
constexpr int kWrongUsage = 2;

struct Options {
    std::string out;
    std::int64_t images = 40000;
    ForestTraining training;
};

/// The settings of the shipped forest.
ForestTraining shipped_training() {
    ForestTraining t;
    t.trees = 3;
    t.depth = 20;
    t.pixels_per_image = 500;
    t.balanced_share = 0.5;
    t.leaf_pixels_per_image = 5000;
    t.leaf_balanced_share = 0.2;
    t.features = 400;
    t.deep_features = 160;
    t.deep_level = 11;
    t.thresholds = 31;
    t.reach_mm = 700;
    t.threshold_range_mm = 500;
    t.node_samples = 50000;
    t.min_samples = 24;
    t.max_leaves = 110000;
    t.min_votes = 3;
    return t;
}

double seconds() {
    return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch())
        .count();
}

/// Lines of progress on standard error with the time since the beginning.
class Teller {
  public:
    void say(const std::string& what) const {
        fmt::print(stderr, "{:7.0f} s  {}\n", seconds() - began_, what);
    }

  private:
    double began_ = seconds();
};

Result<void> train(const Options& options, const Teller& teller) {
    // What stands in the way of writing should be known before an hour of work.
    const std::filesystem::path out = options.out;
    const auto folder = out.has_parent_path() ? out.parent_path() : ".";
    if (access(folder.c_str(), W_OK) != 0)
        return fail("nothing can be written there", folder.string());
    ForestTraining training = options.training;
    training.progress = [&](const TrainingProgress& p) {
        teller.say(p.level < 0
                       ? fmt::format("tree {}: leaves filled from {} pixels", p.tree + 1, p.samples)
                       : fmt::format("tree {} level {}: {} nodes split, {} in all, {} pixels",
                                     p.tree + 1, p.level, p.nodes_open, p.nodes_total, p.samples));
    };
    ActorImagesOptions people;
    people.seed = training.seed;
    people.count = options.images;
    KINO_ASSIGN(std::shared_ptr<const TrainingImages> drawn, ActorImages::create(people));
    const CachedImages images(std::move(drawn));
    teller.say(fmt::format("drawing {} pictures", options.images));
    KINO_ASSIGN(const Forest forest, train_forest(images, training));
    KINO_TRY(write_forest(out, forest));
    std::error_code error;
    teller.say(fmt::format("{}: {} bytes", out.string(), std::filesystem::file_size(out, error)));
    return {};
}

void add_options(CLI::App& app, Options& options) {
    ForestTraining& t = options.training;
    app.add_option("--out", options.out, "the forest's file")->required()->type_name("FILE");
    app.add_option("--images", options.images, "pictures to draw")
        ->check(CLI::Range(1, 10'000'000))
        ->capture_default_str();
    app.add_option("--pixels", t.pixels_per_image, "pixels of each picture that grow a tree")
        ->capture_default_str();
    app.add_option("--trees", t.trees, "trees")->capture_default_str();
    app.add_option("--depth", t.depth, "levels of each tree")->capture_default_str();
    app.add_option("--features", t.features, "candidate features at a node")->capture_default_str();
    app.add_option("--deep-features", t.deep_features, "the same from level --deep-level on")
        ->capture_default_str();
    app.add_option("--deep-level", t.deep_level, "see --deep-features")->capture_default_str();
    app.add_option("--thresholds", t.thresholds, "candidate thresholds of a node")
        ->capture_default_str();
    app.add_option("--reach", t.reach_mm, "longest offset of a feature, mm")->capture_default_str();
    app.add_option("--range", t.threshold_range_mm, "largest threshold, mm")->capture_default_str();
    app.add_option("--balanced", t.balanced_share, "share of the pixels drawn evenly by part")
        ->capture_default_str();
    app.add_option("--leaf-balanced", t.leaf_balanced_share,
                   "the same of the pixels that fill the leaves")
        ->capture_default_str();
    app.add_option("--leaf-pixels", t.leaf_pixels_per_image,
                   "pixels of each picture that fill the leaves; 0: those that grew them")
        ->capture_default_str();
    app.add_option("--node-samples", t.node_samples, "pixels by which a node is split, at most")
        ->capture_default_str();
    app.add_option("--min-samples", t.min_samples, "a node with fewer pixels is not split")
        ->capture_default_str();
    app.add_option("--max-leaves", t.max_leaves, "leaves of a tree after pruning; 0: all")
        ->capture_default_str();
    app.add_option("--min-votes", t.min_votes, "labels with fewer of a leaf's 255 votes get none")
        ->capture_default_str();
    app.add_option("--seed", t.seed, "of the pictures and the trees")->capture_default_str();
    app.add_option("--threads", t.threads, "they change the time only")->capture_default_str();
}

}  // namespace
}  // namespace kino

int main(int argc, char** argv) {
    using namespace kino;
    std::signal(SIGPIPE, SIG_IGN);
    Options options;
    options.training = shipped_training();
    CLI::App app(
        "Trains the forest that gives each pixel of a person a body part, on pictures of computed "
        "people. The same options give the same file. Progress goes to standard error.",
        "kinoscope-train");
    app.footer(
        "The defaults make the forest that is shipped.\n"
        "Exit status: 0 done, 1 the forest could not be made or written, 2 wrong usage.");
    add_options(app, options);
    try {
        app.parse(argc, argv);
    } catch (const CLI::ParseError& error) {
        return app.exit(error) == 0 ? 0 : kWrongUsage;
    }
    if (const std::string defect = training_defect(options.training); !defect.empty()) {
        fmt::print(stderr, "kinoscope-train: {}\n", defect);
        return kWrongUsage;
    }
    // Where it was written and by how many threads is not part of what it is.
    options.training.note = "kinoscope train";
    for (const CLI::Option* option : app.get_options()) {
        const std::string name = option->get_name();
        if (name == "--help" || name == "--out" || name == "--threads") continue;
        const std::string value =
            option->empty() ? option->get_default_str() : option->as<std::string>();
        options.training.note += fmt::format(" {} {}", name, value);
    }
    try {
        const Teller teller;
        if (const auto done = train(options, teller); !done) {
            fmt::print(stderr, "kinoscope-train: {}\n", done.error().to_string());
            return kFailed;
        }
    } catch (const std::exception& thrown) {
        fmt::print(stderr, "kinoscope-train: {}\n", thrown.what());
        return kFailed;
    }
    return 0;
}
