#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "apps/bench/logged_motions.h"
#include "apps/bench/part_score.h"
#include "apps/bench/registry.h"
#include "sensor/png_io.h"
#include "skeleton/actors/actor_images.h"
#include "skeleton/actors/actor_sequence.h"
#include "skeleton/forest/body_part.h"
#include "skeleton/forest/default_forest.h"
#include "skeleton/forest/forest_file.h"
#include "skeleton/forest/tree_pruning.h"

namespace kino {
namespace {

constexpr int kWidth = 640, kHeight = 480;
constexpr std::uint64_t kSeed = 77;

struct PictureSet {
    std::string name;
    std::vector<TrainingImage> pictures;
};

Result<PictureSet> held_out_pictures(int count) {
    PictureSet set{"held-out people", {}};
    ActorImagesOptions options;
    options.seed = kSeed;
    options.count = count;
    options.width = kWidth;
    options.height = kHeight;
    options.held_out = true;
    KINO_ASSIGN(const auto images, ActorImages::create(options));
    set.pictures.resize(static_cast<std::size_t>(count));
    for (int i = 0; i < count; ++i)
        KINO_TRY(images->load(i, set.pictures[static_cast<std::size_t>(i)]));
    return set;
}

/// Frames of takes in furnished rooms, spread evenly.
Result<PictureSet> take_pictures(int takes, int frames_each) {
    KINO_ASSIGN(const std::vector<std::string> motions, logged_motions());
    PictureSet set{"takes of recorded motion", {}};
    for (int t = 0; t < takes; ++t) {
        ActorTake take;
        take.seed = 9000 + static_cast<std::uint64_t>(t);
        take.motion = motions[static_cast<std::size_t>(t) % motions.size()];
        take.width = kWidth;
        take.height = kHeight;
        KINO_ASSIGN(const auto sequence, ActorSequence::create(take));
        ActorFrame frame;
        for (int i = 0; i < frames_each; ++i) {
            sequence->render((2 * i + 1) * sequence->frames() / (2 * frames_each), frame);
            TrainingImage image;
            image.focal_px = sequence->rig().depth.fx;
            image.depth_mm.resize(kWidth, kHeight);
            image.label.resize(kWidth, kHeight);
            for (std::size_t p = 0; p < image.label.size(); ++p) {
                const float z = frame.depth_m.pixels()[p];
                const bool body = frame.actor.pixels()[p] == 1 && z > 0 &&
                                  frame.part.pixels()[p] < kBodyPartCount;
                image.depth_mm.pixels()[p] =
                    body ? static_cast<std::uint16_t>(1000 * z + 0.5f) : std::uint16_t{0};
                image.label.pixels()[p] = body ? frame.part.pixels()[p] : kNotBody;
            }
            set.pictures.push_back(std::move(image));
        }
    }
    return set;
}

PartConfusion confusion_of(const PartJudge& judge, const std::vector<TrainingImage>& pictures) {
    PartConfusion confusion;
    for (const TrainingImage& picture : pictures) judge.add(picture, confusion);
    return confusion;
}

struct Marked {
    std::string name;
    std::vector<MarkedFrame> frames;
};

using AroundJoints = std::vector<std::pair<std::string, PartJudge::Around>>;

AroundJoints around(const PartJudge& judge, const Marked& marked) {
    AroundJoints joints;
    for (const MarkedFrame& frame : marked.frames) judge.add(frame, joints);
    return joints;
}

double share(const PartJudge::Around& a) {
    return a.all == 0 ? 0 : static_cast<double>(a.right) / static_cast<double>(a.all);
}

PartJudge::Around sum(const AroundJoints& joints) {
    PartJudge::Around all;
    for (const auto& [name, a] : joints) {
        all.right += a.right;
        all.all += a.all;
    }
    return all;
}

std::string percent(double share) {
    return fmt::format("{:.1f} %", 100 * share);
}

Rgba8 color_of(CoarsePartSet said) {
    constexpr std::array<Rgba8, kCoarsePartCount> kColors = {{{235, 215, 190, 255},
                                                              {120, 120, 130, 255},
                                                              {230, 80, 60, 255},
                                                              {240, 150, 50, 255},
                                                              {250, 220, 60, 255},
                                                              {60, 90, 220, 255},
                                                              {70, 160, 240, 255},
                                                              {90, 230, 240, 255},
                                                              {160, 50, 90, 255},
                                                              {220, 90, 150, 255},
                                                              {250, 170, 210, 255},
                                                              {30, 110, 70, 255},
                                                              {70, 170, 80, 255},
                                                              {170, 230, 110, 255}}};
    for (std::size_t p = 0; p < kColors.size(); ++p)
        if ((said & (1u << p)) != 0) return kColors[p];
    return {255, 255, 255, 255};
}

/// Rows of pictures of one size, those of a row beside each other.
class Sheet {
  public:
    static constexpr int kTile = 240;
    explicit Sheet(int columns) : columns_(columns) {}

    /// `paint(x, y)` is asked for the pixels of a square round the body.
    template <class Paint>
    void add(const BodyDepth& body, Paint&& paint) {
        Image<Rgba8> tile(kTile, kTile);
        tile.fill({24, 26, 30, 255});
        if (body.count() > 0) {
            int x0 = body.x(0), x1 = x0, y0 = body.y(0), y1 = y0;
            for (std::size_t i = 0; i < body.count(); ++i) {
                x0 = std::min(x0, body.x(i));
                x1 = std::max(x1, body.x(i));
                y0 = std::min(y0, body.y(i));
                y1 = std::max(y1, body.y(i));
            }
            const double size = std::max({x1 - x0, y1 - y0, 1}) * 1.05;
            for (int y = 0; y < kTile; ++y)
                for (int x = 0; x < kTile; ++x) {
                    const int px =
                        static_cast<int>((x0 + x1) / 2.0 + (x - kTile / 2.0) * size / kTile);
                    const int py =
                        static_cast<int>((y0 + y1) / 2.0 + (y - kTile / 2.0) * size / kTile);
                    if (body.depth_mm(px, py) == kForestBackgroundMm) continue;
                    if (const std::optional<Rgba8> c = paint(px, py)) tile.at(x, y) = *c;
                }
        }
        tiles_.push_back(std::move(tile));
    }

    [[nodiscard]] Result<std::string> png() const {
        const int rows = static_cast<int>(tiles_.size()) / columns_;
        Image<Rgba8> all(columns_ * kTile, rows * kTile);
        for (int y = 0; y < all.height(); ++y)
            for (int x = 0; x < all.width(); ++x)
                all.at(x, y) =
                    tiles_[static_cast<std::size_t>(y / kTile * columns_ + x / kTile)].at(
                        x % kTile, y % kTile);
        KINO_ASSIGN(const auto bytes, encode_png_rgba8(std::as_const(all).view(), {9}));
        return std::string(bytes.begin(), bytes.end());
    }

  private:
    int columns_;
    std::vector<Image<Rgba8>> tiles_;
};

/// A row: depth, ours, truth (where known), peer's (where given).
template <class Picture, class Truth>
void add_row(Sheet& sheet, const Picture& picture, const PartJudge& ours, const PartJudge* peer,
             const Truth& truth) {
    BodyDepth body;
    cut_body(picture, 1, body);
    int near = kForestBackgroundMm, far = 0;
    for (std::size_t i = 0; i < body.count(); ++i) {
        near = std::min(near, body.depth_mm(body.x(i), body.y(i)));
        far = std::max(far, body.depth_mm(body.x(i), body.y(i)));
    }
    sheet.add(body, [&](int x, int y) -> std::optional<Rgba8> {
        const double t = static_cast<double>(body.depth_mm(x, y) - near) / std::max(far - near, 1);
        const auto grey = static_cast<std::uint8_t>(250 - 200 * t);
        return Rgba8{grey, grey, grey, 255};
    });
    const auto add_labels = [&](const PartJudge& judge) {
        BodyDepth cut;
        cut_body(picture, judge.focal_factor(), cut);
        std::vector<CoarsePartSet> said;
        judge.label(cut, said);
        Image<CoarsePartSet> at(picture.depth_mm.width(), picture.depth_mm.height());
        at.fill(0);
        for (std::size_t i = 0; i < said.size(); ++i) at.at(cut.x(i), cut.y(i)) = said[i];
        sheet.add(body,
                  [&](int x, int y) -> std::optional<Rgba8> { return color_of(at.at(x, y)); });
    };
    add_labels(ours);
    sheet.add(body, truth);
    if (peer != nullptr) add_labels(*peer);
}

Result<std::string> part_sheet(const std::vector<TrainingImage>& pictures,
                               const std::vector<Marked>& marked, const PartJudge& ours,
                               const PartJudge* peer) {
    Sheet sheet(peer != nullptr ? 4 : 3);
    for (std::size_t i = 0; i < std::min<std::size_t>(pictures.size(), 5); ++i) {
        const TrainingImage& picture = pictures[i * 7 % pictures.size()];
        add_row(sheet, picture, ours, peer, [&](int x, int y) -> std::optional<Rgba8> {
            const std::uint8_t label = picture.label.at(x, y);
            if (label == kNotBody) return std::nullopt;
            return color_of(coarse_set(coarse_part_of(static_cast<BodyPart>(label))));
        });
    }
    for (const Marked& set : marked)
        for (std::size_t i = 0; i < std::min<std::size_t>(set.frames.size(), 3); ++i) {
            const MarkedFrame& frame = set.frames[i * 2 % set.frames.size()];
            add_row(sheet, frame, ours, peer, [&](int x, int y) -> std::optional<Rgba8> {
                for (const MarkedJoint& j : frame.joints) {
                    const double dx = x - j.x, dy = y - j.y;
                    if (dx * dx + dy * dy <= 100) return color_of(j.right);
                }
                return std::nullopt;
            });
        }
    return sheet.png();
}

void compare_times(BenchContext& context, const std::vector<TrainingImage>& pictures,
                   const PartJudge& ours, const PartJudge* peer) {
    // The body with a usual number of pixels.
    std::vector<std::pair<std::size_t, const TrainingImage*>> by_size;
    for (const TrainingImage& p : pictures) {
        BodyDepth body;
        cut_body(p, 1, body);
        by_size.emplace_back(body.count(), &p);
    }
    std::sort(by_size.begin(), by_size.end());
    const TrainingImage& usual = *by_size[by_size.size() / 2].second;
    BodyDepth body, coarse, wide;
    cut_body(usual, 1, body);
    cut_body(usual, 1, coarse, 2);
    PartLabels labels;
    std::vector<bench::Candidate> candidates = {
        {"ours", [&] { ours.labeller().label(body, labels); }},
        {"ours, every 2nd pixel", [&] { ours.labeller().label(coarse, labels); }},
    };
    if (peer != nullptr) {
        cut_body(usual, peer->focal_factor(), wide);
        candidates.push_back({"pretrained", [&] { peer->labeller().label(wide, labels); }});
    }
    const auto times = context.compare("labels of one body", candidates);
    for (const bench::Candidate& c : candidates) {
        BenchRow row;
        row.case_name = fmt::format("one body, {} px", body.count());
        row.knob = "forest";
        row.level = c.name;
        row.baseline = peer != nullptr ? "pretrained" : "ours";
        context.add(row, times);
    }
    if (peer != nullptr)
        context.claim("ours takes at most the pretrained one's time for the same pixels",
                      times.speedup("ours", "pretrained") >= 1);
    const std::vector<double>& ms = times["ours, every 2nd pixel"].ms;
    const double fastest = *std::min_element(ms.begin(), ms.end());
    context.claim(fmt::format("a body of usual size takes {:.1f} ms, fastest round, with every 2nd "
                              "pixel of every 2nd row (at most 3)",
                              fastest),
                  fastest <= 3);
}

Result<std::optional<Forest>> peer_forest(const std::filesystem::path& folder) {
    if (folder.empty()) return std::optional<Forest>();
    std::vector<std::filesystem::path> trees;
    for (int t = 1; t <= 3; ++t) trees.push_back(folder / fmt::format("forest{}_tree_20.txt", t));
    KINO_ASSIGN(Forest forest, read_pcl_forest(trees));
    return std::optional<Forest>(std::move(forest));
}

void add_accuracy(BenchContext& context, const std::string& set, const std::string& who,
                  const PartConfusion& confusion) {
    BenchRow row;
    row.case_name = set;
    row.knob = "forest";
    row.level = who;
    row.error = 1 - confusion.accuracy();
    row.metric = "share of wrong pixels";
    context.add(row);
    row.error = 1 - confusion.part_accuracy();
    row.metric = "share of wrong pixels, mean of the parts";
    context.add(row);
}

/// What fewer or shallower trees would cost in accuracy, and save in bytes.
void add_sizes(BenchContext& context, const PictureSet& set, const Forest& forest) {
    std::string table =
        "| trees | depth | MB | right pixels | mean of the parts |\n|---:|---:|---:|---:|---:|\n";
    int deepest = 0;
    for (const ForestTree& tree : forest.trees) deepest = std::max(deepest, tree_depth(tree));
    const auto add = [&](const Forest& f, int depth) {
        const PartConfusion c = confusion_of(PartJudge::ours(f), set.pictures);
        table += fmt::format("| {} | {} | {:.2f} | {} | {} |\n", f.trees.size(), depth,
                             1e-6 * static_cast<double>(forest_to_bytes(f).size()),
                             percent(c.accuracy()), percent(c.part_accuracy()));
    };
    for (const int depth : {8, 10, 12, 14, 16, 18})
        if (depth < deepest) add(shallower(forest, depth), depth);
    for (std::size_t trees = 1; trees <= forest.trees.size(); ++trees) {
        Forest f = forest;
        f.trees.resize(trees);
        // Distributions of the other trees would be counted.
        add(shallower(f, deepest), deepest);
    }
    context.section(fmt::format("## {}: size against accuracy\n\n{}", set.name, table));
}

Result<void> run(BenchContext& context) {
    KINO_ASSIGN(const auto forest, default_forest());
    KINO_ASSIGN(const auto peer, peer_forest(context.peer));
    context.progress("drawing pictures");
    std::vector<PictureSet> sets(2);
    KINO_ASSIGN(sets[0], held_out_pictures(context.quick() ? 40 : 300));
    KINO_ASSIGN(sets[1], take_pictures(context.quick() ? 6 : 27, 8));
    std::vector<Marked> marked;
    for (const auto& folder : context.marked) {
        KINO_ASSIGN(auto frames, read_marked_frames(folder));
        marked.push_back({folder.filename().string(), std::move(frames)});
    }
    const PartJudge ours = PartJudge::ours(*forest);
    // The factor that is best for the pretrained forest on each set; swept on the set itself, which
    // favours it.
    std::vector<double> factors;
    for (int i = 0; i <= 14; ++i) factors.push_back(1.0 + 0.1 * i);
    const double usual_factor = 1.8;
    for (const PictureSet& set : sets) {
        context.progress(set.name);
        const PartConfusion mine = confusion_of(ours, set.pictures);
        add_accuracy(context, set.name, "ours", mine);
        const std::string stem = &set == &sets[0] ? "forest_held_out" : "forest_takes";
        context.file(stem + "_ours.csv", mine.csv());
        context.section(fmt::format("## {}: where the pixels of a part went, ours\n\n{}", set.name,
                                    mine.markdown()));
        if (!peer) continue;
        std::optional<PartConfusion> best;
        double best_factor = 0;
        for (const double factor : factors) {
            const PartConfusion c = confusion_of(PartJudge::pcl(*peer, factor), set.pictures);
            BenchRow row;
            row.case_name = set.name;
            row.knob = "focal factor of the pretrained";
            row.level = fmt::format("{:.1f}", factor);
            row.error = 1 - c.accuracy();
            row.metric = "share of wrong pixels";
            context.add(row);
            if (best && c.accuracy() <= best->accuracy()) continue;
            best = c;
            best_factor = factor;
        }
        add_accuracy(context, set.name, fmt::format("pretrained, x {:.1f}", best_factor), *best);
        context.file(stem + "_pretrained.csv", best->csv());
        context.section(
            fmt::format("## {}: the same, pretrained at {:.1f} times the focal length"
                        "\n\n{}",
                        set.name, best_factor, best->markdown()));
        context.claim(fmt::format("{}: {} of our pixels are right, {} of the pretrained one's",
                                  set.name, percent(mine.accuracy()), percent(best->accuracy())),
                      mine.accuracy() > best->accuracy());
    }
    for (const Marked& set : marked) {
        context.progress(set.name);
        const AroundJoints mine = around(ours, set);
        AroundJoints theirs;
        double best_factor = 0;
        if (peer)
            for (const double factor : factors) {
                const AroundJoints now = around(PartJudge::pcl(*peer, factor), set);
                if (!theirs.empty() && share(sum(now)) <= share(sum(theirs))) continue;
                theirs = now;
                best_factor = factor;
            }
        const auto add = [&](const std::string& who, const AroundJoints& joints) {
            BenchRow row;
            row.case_name = set.name;
            row.knob = "forest";
            row.level = who;
            row.error = 1 - share(sum(joints));
            row.metric =
                fmt::format("share of wrong pixels around {} frames' joints", set.frames.size());
            context.add(row);
            for (const auto& [joint, a] : joints) {
                row.level = who + ", " + joint;
                row.error = 1 - share(a);
                context.add(row);
            }
        };
        add("ours", mine);
        if (!peer) continue;
        add(fmt::format("pretrained, x {:.1f}", best_factor), theirs);
        context.claim(fmt::format("{}: {} of our pixels around marked joints are right, {} of the "
                                  "pretrained one's",
                                  set.name, percent(share(sum(mine))), percent(share(sum(theirs)))),
                      share(sum(mine)) >= share(sum(theirs)));
    }
    add_sizes(context, sets[0], *forest);
    std::optional<PartJudge> usual_peer;
    if (peer) usual_peer = PartJudge::pcl(*peer, usual_factor);
    const PartJudge* peer_judge = usual_peer ? &*usual_peer : nullptr;
    compare_times(context, sets[0].pictures, ours, peer_judge);
    KINO_ASSIGN(const std::string sheet, part_sheet(sets[0].pictures, marked, ours, peer_judge));
    context.file("../pictures/forest.png", sheet);
    const std::size_t bytes = forest_to_bytes(*forest).size();
    context.claim(fmt::format("the file is {:.2f} MB (at most 12)", 1e-6 * double(bytes)),
                  bytes < 12'000'000);
    context.note("made by `" + forest->note + "`");
    context.note(
        "parts are the 14 coarse ones; labels of the pretrained forest that straddle two count as "
        "whichever is right, its ties are settled by the pixels around as PCL does, and the factor "
        "on its focal length is the one that is best on the very pictures it is judged on");
    context.note(
        "around a marked joint: pixels of the person within 10 px; right are, of the right side: "
        "head: head; neck: head, torso; shoulder: upper arm, torso; elbow: both arms' halves; "
        "hand: hand, lower arm; torso: torso");
    return {};
}

}  // namespace

void bench_forest(BenchContext& context) {
    if (auto done = run(context); !done) context.fail(done.error());
}

}  // namespace kino
