#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "apps/bench/registry.h"
#include "apps/bench/stage_player.h"
#include "apps/pipeline/stepper.h"
#include "apps/stage/stage.h"
#include "apps/viewer/scene_builder.h"
#include "skeleton/synthetic/synthetic_source.h"
#include "viz/quality/lod_learning.h"

namespace kino {
namespace {

using bench::Candidate;
using bench::Comparison;
using bench::StagePlayer;

const std::vector<double> kGrid = {1, 2, 4, 8};

/// A computed person on a bundled stage, at one moment.
struct MultiStage {
    std::string name;
    std::string first, second;      ///< the two parts that are told apart
    std::uint32_t first_parts = 0;  ///< the others are the second's
    std::vector<ProcessedFrame> person;
    std::unique_ptr<SceneBuilder> builder;
    Scene scene;
    View view;
};

Result<std::unique_ptr<MultiStage>> make_stage(const std::string& name, int width, int height) {
    register_synthetic_source();
    auto made = std::make_unique<MultiStage>();
    KINO_ASSIGN(OpenedSource opened,
                open_for_playing("synthetic:wave?size=320x240",
                                 {.mode = LoopMode::loop, .filters = {}, .bodies = {}}));
    Stepper stepper(std::move(opened));
    made->builder = std::make_unique<SceneBuilder>();
    KINO_ASSIGN(StageSet stage, open_stage(name));
    made->builder->put_on_stage(std::make_unique<Director>(std::move(stage)));
    // Long enough for trails and swarms to be there.
    for (int i = 0; i < 45; ++i) {
        KINO_ASSIGN(auto frame, stepper.next());
        if (!frame) break;
        made->person.push_back(std::move(*frame));
        made->builder->show(made->person.back());
        (void)made->builder->advance(1.0 / 30);
    }
    const Director& director = *made->builder->director();
    const SceneLive& live = director.file().live;
    made->scene =
        made->builder->scene({.style = live.style, .splat_px = live.splat_px, .color = {}});
    // What materials emit is no light on them, and is added after it.
    for (Material& material : made->scene.materials) material.emission = glm::vec3(0);
    made->view = {.width = width,
                  .height = height,
                  .projection = perspective(0.8, width, height),
                  .world_from_view = look_at(director.eye_m(), director.target_m())};
    return made;
}

/// Light painting whose brightest lamps cast shadows by rays, among many that do not.
Result<std::unique_ptr<MultiStage>> shadowed_stage(int width, int height) {
    KINO_ASSIGN(auto made, make_stage("light-painting", width, height));
    made->name = "light-painting, shadows";
    made->first = "shadowed";
    made->second = "plain";
    made->first_parts = kShadowedLights;
    const glm::dvec3 target = made->builder->director()->target_m();
    for (int i = 0; i < 3; ++i) {
        made->scene.lights.push_back({.kind = LightKind::point,
                                      .position = target + glm::dvec3(1.6 * (i - 1), 1.3, 1.2),
                                      .color = glm::vec3(0.9f, 0.8f, 0.7f),
                                      .radius_m = 6,
                                      .shadow = LightShadow::raycast});
    }
    return made;
}

/// A torch on a stage whose light bounces.
Result<std::unique_ptr<MultiStage>> bounced_stage(int width, int height) {
    KINO_ASSIGN(auto made, make_stage("playroom", width, height));
    made->name = "playroom, bounces";
    made->first = "direct";
    made->second = "bounced";
    made->first_parts = kShadowedLights | kPlainLights;
    for (Light& light : made->scene.lights) light.indirect = light.kind == LightKind::spot;
    return made;
}

std::string grid_name(double a, double b) {
    return fmt::format("r {:g} {:g}", a, b);
}

class MultiBench {
  public:
    MultiBench(BenchContext& context, MultiStage& stage, StagePlayer& player)
        : context_(context), stage_(stage), player_(player) {}

    void run() {
        list_candidates();
        measure_times();
        measure_errors();
        if (failed_) return;
        table();
        choices();
        regions();
    }

  private:
    struct Setting {
        std::string name;
        StageOptions options;
        double ms = 0, mse = 0;
    };

    /// A ray for every pixel: what is listed has no neighbours to share one with.
    static StageOptions plain() {
        StageOptions options;
        options.shadows.half_resolution = false;
        return options;
    }

    StageOptions at(double first, double second) const {
        StageOptions options = plain();
        const auto rate = [&](std::uint32_t part) {
            return (stage_.first_parts & part) != 0 ? first : second;
        };
        options.rates = {.shadowed = rate(kShadowedLights),
                         .plain = rate(kPlainLights),
                         .bounced = rate(kBouncedLights)};
        return options;
    }

    void list_candidates() {
        for (const double a : kGrid) {
            for (const double b : kGrid) settings_.push_back({grid_name(a, b), at(a, b)});
        }
        settings_.push_back({"r 3 3", at(3, 3)});
        const std::vector<double> finest =
            context_.quick() ? std::vector<double>{1} : std::vector<double>{1, 2};
        for (const double r0 : finest) {
            for (const RegionMeasure measure : {RegionMeasure::gradient, RegionMeasure::bend}) {
                for (const float limit : {0.03f, 0.06f, 0.12f, 0.25f, 0.5f}) {
                    StageOptions options = plain();
                    if (r0 > 1) options.lod = FramebufferLodOptions{.r = r0};
                    options.regions = RegionLodOptions{.measure = measure, .limit = limit};
                    settings_.push_back(
                        {fmt::format("tiles r0 {:g} {} {:g}", r0,
                                     measure == RegionMeasure::bend ? "bend" : "gradient", limit),
                         options});
                }
            }
        }
        // For the costs of both parts: without either.
        for (const bool first : {true, false}) {
            StageOptions options = plain();
            const std::uint32_t gone =
                first ? stage_.first_parts : kAllLights & ~stage_.first_parts;
            options.lists.parts = kAllLights & ~gone;
            if ((gone & kBouncedLights) != 0) options.bounces.cutoff = 1e9f;
            settings_.push_back({first ? "without first" : "without second", options});
        }
    }

    Setting& setting(const std::string& name) {
        return *std::find_if(settings_.begin(), settings_.end(),
                             [&](const Setting& s) { return s.name == name; });
    }

    void measure_times() {
        std::vector<Candidate> candidates;
        for (const Setting& s : settings_) {
            candidates.push_back({s.name, [this, &s] { draw(s.options, false); }});
        }
        const Comparison times =
            context_.compare(stage_.name, candidates, {.repeats = 15, .warm_up = 2});
        for (Setting& s : settings_) s.ms = times[s.name].median_ms();
        speedups_ = [this, times](const std::string& name) {
            return times.speedup(name, grid_name(1, 1));
        };
    }

    StagePlayer::Drawn draw(const StageOptions& options, bool read) {
        auto drawn = player_.draw(stage_.scene, stage_.view, options, read);
        if (drawn) return std::move(*drawn);
        if (!failed_) context_.fail(drawn.error());
        failed_ = true;
        return {};
    }

    void measure_errors() {
        const auto truth =
            StagePlayer::shown(stage_.scene, draw(settings_[0].options, true).linear);
        for (Setting& s : settings_) {
            const auto shown = StagePlayer::shown(stage_.scene, draw(s.options, true).linear);
            if (failed_) return;
            double sum = 0;
            for (std::size_t i = 0; i < shown.size(); ++i) {
                for (int k = 0; k < 3; ++k) {
                    // As the eye sees it: sRGB's curve is nearly a square root.
                    const double d =
                        std::sqrt(shown.pixels()[i][k]) - std::sqrt(truth.pixels()[i][k]);
                    sum += d * d;
                }
            }
            s.mse = sum * 255 * 255 / (3.0 * static_cast<double>(shown.size()));
        }
    }

    void table() {
        for (const Setting& s : settings_) {
            if (s.name.starts_with("without")) continue;
            const bool tiles = s.name.starts_with("tiles");
            context_.add({.case_name = stage_.name,
                          .knob = tiles ? "regions" : "r of " + stage_.first + ", " + stage_.second,
                          .level = s.name,
                          .ms_median = s.ms,
                          .error = s.mse,
                          .metric = "MSE, of 255^2",
                          .baseline = grid_name(1, 1),
                          .speedup = speedups_(s.name)});
        }
    }

    /// Error of one factor for all at this time, straight between its points' logarithms.
    double equal_error(double ms) {
        std::vector<std::pair<double, double>> curve;
        for (const double r : {1.0, 2.0, 3.0, 4.0, 8.0}) {
            const Setting& s = setting(grid_name(r, r));
            curve.emplace_back(s.ms, std::max(s.mse, 1e-3));
        }
        std::sort(curve.begin(), curve.end());
        if (ms <= curve.front().first) return curve.front().second;
        for (std::size_t i = 1; i < curve.size(); ++i) {
            if (ms > curve[i].first) continue;
            const double t = (ms - curve[i - 1].first) / (curve[i].first - curve[i - 1].first);
            return std::exp(std::log(curve[i - 1].second) * (1 - t) +
                            std::log(curve[i].second) * t);
        }
        return curve.back().second;
    }

    void choices() {
        const double pixels = static_cast<double>(stage_.view.width) * stage_.view.height;
        const double full = setting(grid_name(1, 1)).ms;
        const auto ns = [&](double ms) { return std::max(0.0, ms) * 1e6 / pixels; };
        const std::vector<double> r = {2, 4, 8};
        std::vector<LodComponent> parts;
        std::vector<double> chain;
        for (const bool first : {true, false}) {
            const std::vector<double> with = {full};
            const std::vector<double> without = {
                setting(first ? "without first" : "without second").ms};
            std::vector<double> mse;
            for (const double f : r) {
                mse.push_back(setting(first ? grid_name(f, 1) : grid_name(1, f)).mse);
            }
            parts.push_back(learn_lod_component({.name = first ? stage_.first : stage_.second,
                                                 .ms_with = with,
                                                 .ms_without = without,
                                                 .pixels = pixels,
                                                 .r = r,
                                                 .mse = mse}));
            for (const double f : r) {
                const double resized = setting(first ? grid_name(f, 1) : grid_name(1, f)).ms;
                chain.push_back(parts.back().cost_ns * (1 - 1 / (f * f)) - ns(full - resized));
            }
        }
        std::sort(chain.begin(), chain.end());
        const double rho = std::max(0.0, chain[chain.size() / 2]);
        const double all = parts[0].cost_ns + parts[1].cost_ns;
        context_.note(fmt::format(
            "{}: {} costs {:.0f} ns a pixel and loses {:.3g} r^{:.2f}, {} {:.0f} ns and {:.3g} "
            "r^{:.2f}; a further level costs {:.0f} ns.",
            stage_.name, parts[0].name, parts[0].cost_ns, parts[0].error, parts[0].exponent,
            parts[1].name, parts[1].cost_ns, parts[1].error, parts[1].exponent, rho));
        double worst_grid = 1;
        double worst_equal = 0;
        std::string said;
        for (const double share : {0.15, 0.25, 0.35, 0.5, 0.7, 0.85}) {
            const LodPlan plan = plan_lod(parts, share * all, rho, kGrid, LodChain::nested);
            const Setting& chosen = setting(grid_name(plan.r[0], plan.r[1]));
            double best = chosen.mse;
            for (const double a : kGrid) {
                for (const double b : kGrid) {
                    const Setting& other = setting(grid_name(a, b));
                    if (other.ms <= 0.97 * chosen.ms) best = std::min(best, other.mse);
                }
            }
            const double equal = equal_error(chosen.ms);
            if (chosen.mse > 1e-3) {
                worst_grid = std::max(worst_grid, chosen.mse / std::max(best, 1e-3));
                worst_equal = std::max(worst_equal, chosen.mse / equal);
            }
            said +=
                fmt::format("| {:.0f} % | {:g}, {:g} | {:.2f} | {:.3g} | {:.3g} | {:.3g} |\n",
                            100 * share, plan.r[0], plan.r[1], chosen.ms, chosen.mse, best, equal);
        }
        context_.section(fmt::format(
            "## What is chosen: {}\n\n| budget | r of {}, {} | ms | MSE | best of the grid in that "
            "time | one factor in that time |\n|---|---|---|---|---|---|\n{}",
            stage_.name, stage_.first, stage_.second, said));
        context_.claim(fmt::format("{}: the choice loses at most 10 % more than the best of all "
                                   "pairs in its time ({:.2f} times)",
                                   stage_.name, worst_grid),
                       worst_grid <= 1.1);
        context_.claim(fmt::format("{}: the choice loses at most what one factor for all light "
                                   "loses in its time ({:.2f} times)",
                                   stage_.name, worst_equal),
                       worst_equal <= 1.02);
    }

    void regions() {
        const double full = setting(grid_name(1, 1)).ms;
        double best = std::numeric_limits<double>::infinity();
        std::string best_name;
        for (const Setting& s : settings_) {
            // What is no quicker than shading all of it says nothing.
            if (!s.name.starts_with("tiles") || s.ms > 0.95 * full) continue;
            const double ratio = s.mse / equal_error(s.ms);
            if (ratio >= best) continue;
            best = ratio;
            best_name = s.name;
        }
        if (best_name.empty()) {
            context_.note(fmt::format(
                "{}: no resizing by tiles is quicker than shading every pixel.", stage_.name));
            return;
        }
        context_.note(fmt::format(
            "{}: resizing by tiles is at its best with \"{}\", {:.2f} times the error of one "
            "factor everywhere in the same time{}",
            stage_.name, best_name, best, best < 1 ? "." : ": on this stage it does not pay."));
    }

    BenchContext& context_;
    MultiStage& stage_;
    StagePlayer& player_;
    std::vector<Setting> settings_;
    std::function<double(const std::string&)> speedups_;
    bool failed_ = false;
};

}  // namespace

void bench_multiresolution(BenchContext& context) {
    auto device = gpu::Device::create({});
    if (!device) return context.fail(device.error());
    context.set_device(fmt::format("{}, {}", (*device)->info().name, (*device)->info().driver));
    StagePlayer player(**device);
    const int width = context.quick() ? 320 : 640;
    const int height = context.quick() ? 180 : 360;
    for (const auto make : {&shadowed_stage, &bounced_stage}) {
        auto stage = make(width, height);
        if (!stage) return context.fail(stage.error());
        MultiBench(context, **stage, player).run();
    }
}

}  // namespace kino
