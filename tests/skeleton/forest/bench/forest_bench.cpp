#include <fmt/format.h>
#include <time.h>

#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <string>
#include <vector>

#include "skeleton/forest/coarse_part.h"
#include "skeleton/forest/forest_file.h"
#include "skeleton/forest/forest_training.h"
#include "skeleton/forest/part_labeller.h"
#include "skeleton/synthetic/depth_sensor.h"
#include "skeleton/synthetic/scene.h"
#include "skeleton/synthetic/visibility.h"

// forest_bench train OUT [IMAGES [FEATURES [DEPTH]]]: a small training on the default person.
// forest_bench try FOREST|TREE.txt...: accuracy and time, at several focal lengths.

namespace kino {
namespace {

// Of this thread only, so that a busy machine disturbs less; trainings run on one thread here.
double seconds() {
    timespec now{};
    clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
    return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

/// The default person in the default room, noise and all; labels are the coarse parts.
class DefaultPerson : public TrainingImages {
  public:
    DefaultPerson(std::int64_t count, double phase_s) : count_(count), phase_s_(phase_s) {
        for (const Motion m : all_motions()) scenes_.push_back(make_scene(m));
    }
    [[nodiscard]] std::vector<std::string> labels() const override {
        std::vector<std::string> names;
        for (int i = 0; i < kCoarsePartCount; ++i)
            names.emplace_back(coarse_part_name(static_cast<CoarsePart>(i)));
        return names;
    }
    [[nodiscard]] std::int64_t count() const override { return count_; }
    [[nodiscard]] Result<void> load(std::int64_t index, TrainingImage& out) const override {
        const auto which = static_cast<std::size_t>(index) % scenes_.size();
        const SyntheticScene& scene = scenes_[which];
        const double t = phase_s_ + static_cast<double>(index) * 0.377;
        // Drawing the room anew costs most of the time; a real source would keep it.
        Visibility seen(scene, CastView(scene.rig.depth, inverse(scene.world_from_depth)),
                        scene.emitter_x_m());
        std::vector<Primitive> person;
        scene.person_at(t, person);
        seen.draw(person);
        DepthSensor sensor(scene.rig);
        Image<std::uint16_t> raw;
        sensor.measure(seen, index, raw);
        const PosedBody body = pose_body(pose_at(scene.motion, t));
        const int w = raw.width(), h = raw.height();
        out.depth_mm.resize(w, h);
        out.label.resize(w, h);
        out.focal_px = scene.rig.depth.fx;
        for (int y = 0; y < h; ++y)
            for (int x = 0; x < w; ++x) {
                const double z = sensor.disparity().metres(raw.at(x, y)).value_or(0);
                out.depth_mm.at(x, y) = static_cast<std::uint16_t>(z > 0 ? 1000 * z + 0.5 : 0);
                const PartId part = seen.part_of(seen.id().at(x, y));
                out.label.at(x, y) = kNotBody;
                if (!is_body_part(part)) continue;
                const glm::dvec3 ray(seen.view().ray_x().at(x, y), seen.view().ray_y().at(x, y), 1);
                const glm::dvec3 point =
                    scene.world_from_depth * (ray * static_cast<double>(seen.z_m().at(x, y)));
                out.label.at(x, y) = static_cast<std::uint8_t>(
                    coarse_part_at(static_cast<Joint>(part - 1), point, body.joint_m));
            }
        return {};
    }

  private:
    std::int64_t count_;
    double phase_s_;
    std::vector<SyntheticScene> scenes_;
};

void cut(const TrainingImage& image, double focal_px, BodyDepth& body) {
    Image<std::uint8_t> mask(image.label.width(), image.label.height());
    for (std::size_t i = 0; i < mask.size(); ++i)
        mask.pixels()[i] = image.label.pixels()[i] == kNotBody ? 0 : 1;
    body.set(std::as_const(image.depth_mm).view(), std::as_const(mask).view(), 1, focal_px);
}

double right_share(const PartLabeller& labeller, bool pcl, const std::vector<TrainingImage>& images,
                   double focal_factor, bool mirror) {
    std::size_t right = 0, all = 0;
    for (const TrainingImage& image : images) {
        BodyDepth body;
        cut(image, image.focal_px * focal_factor, body);
        PartLabels labels;
        labeller.label(body, labels);
        for (std::size_t i = 0; i < body.count(); ++i) {
            auto truth = static_cast<CoarsePart>(image.label.at(body.x(i), body.y(i)));
            if (mirror) truth = mirrored(truth);
            const CoarsePartSet said = pcl ? coarse_parts_of(static_cast<PclPart>(labels.label[i]))
                                           : coarse_set(static_cast<CoarsePart>(labels.label[i]));
            right += (said & coarse_set(truth)) != 0 ? 1 : 0;
        }
        all += body.count();
    }
    return static_cast<double>(right) / static_cast<double>(all);
}

void time_one(const Forest& forest, const forest::Functions& functions, const BodyDepth& body) {
    const PartLabeller labeller(forest, functions);
    PartLabels labels;
    std::vector<double> ms;
    for (int i = 0; i < 60; ++i) {
        const double start = seconds();
        labeller.label(body, labels);
        ms.push_back(1000 * (seconds() - start));
    }
    std::sort(ms.begin(), ms.end());
    fmt::print("{:9} {} pixels, {} trees: median {:.2f} ms, least {:.2f} ms, {:.1f} MB\n",
               functions.name, body.count(), labeller.tree_count(), ms[ms.size() / 2], ms[0],
               static_cast<double>(labeller.memory_bytes()) * 1e-6);
}

Result<void> train(int argc, char** argv) {
    ForestTraining training;
    const DefaultPerson images(argc > 3 ? std::stol(argv[3]) : 60, 0);
    training.features = argc > 4 ? std::stoi(argv[4]) : 100;
    training.depth = argc > 5 ? std::stoi(argv[5]) : 12;
    training.trees = argc > 6 ? std::stoi(argv[6]) : 1;
    training.pixels_per_image = argc > 7 ? std::stoi(argv[7]) : 1000;
    training.threads = 1;
    double last = seconds();
    training.progress = [&](const TrainingProgress& p) {
        fmt::print("tree {} level {}: {} open, {} nodes, {} samples, {:.2f} s\n", p.tree, p.level,
                   p.nodes_open, p.nodes_total, p.samples, seconds() - last);
        last = seconds();
    };
    TrainingImage image;
    for (int i = 0; i < 5; ++i) KINO_TRY(images.load(i, image));
    fmt::print("one picture: {:.1f} ms\n", 200 * (seconds() - last));
    last = seconds();
    KINO_ASSIGN(const Forest forest, train_forest(images, training));
    return write_forest(argv[2], forest);
}

Result<void> try_out(int argc, char** argv) {
    std::vector<std::filesystem::path> paths(argv + 2, argv + argc);
    const bool pcl = paths.at(0).extension() == ".txt";
    const double start = seconds();
    KINO_ASSIGN(const Forest forest, pcl ? read_pcl_forest(paths) : read_forest(paths[0]));
    fmt::print("read in {:.2f} s\n", seconds() - start);
    for (const ForestTree& tree : forest.trees)
        fmt::print("{} nodes, depth {}\n", tree.nodes.size(), tree_depth(tree));
    const DefaultPerson source(20, 3.3);
    std::vector<TrainingImage> images(20);
    for (std::int64_t i = 0; i < 20; ++i)
        KINO_TRY(source.load(i, images[static_cast<std::size_t>(i)]));
    BodyDepth body;
    cut(images[1], images[1].focal_px * (pcl ? 1.6 : 1), body);
    time_one(forest, forest::portable_functions(), body);
    if (const auto* avx2 = forest::avx2_functions()) time_one(forest, *avx2, body);
    const PartLabeller labeller(forest);
    for (const double factor : {0.8, 1.0, 1.2, 1.4, 1.6, 1.8, 2.0, 2.2})
        fmt::print("focal x {:.1f}: {:.3f} right, {:.3f} with sides swapped\n", factor,
                   right_share(labeller, pcl, images, factor, false),
                   right_share(labeller, pcl, images, factor, true));
    return {};
}

}  // namespace
}  // namespace kino

int main(int argc, char** argv) {
    const std::string mode = argc > 2 ? argv[1] : "";
    if (mode != "train" && mode != "try") {
        std::puts("forest_bench train OUT [IMAGES [FEATURES [DEPTH [TREES]]]]");
        std::puts("forest_bench try FOREST|TREE.txt...");
        return 2;
    }
    const auto done = mode == "train" ? kino::train(argc, argv) : kino::try_out(argc, argv);
    if (!done) std::puts(done.error().to_string().c_str());
    return done ? 0 : 1;
}
