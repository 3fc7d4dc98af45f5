#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <string>
#include <vector>

#include "apps/bench/framebuffer_lod_depth.h"
#include "apps/bench/framebuffer_lod_fix.h"
#include "apps/bench/lod_stage.h"
#include "apps/bench/registry.h"
#include "viz/quality/edge_band.h"
#include "viz/quality/flip.h"
#include "viz/quality/image_metrics.h"

namespace kino {
namespace {

using bench::Candidate;
using bench::Comparison;
using bench::LodKind;
using bench::LodPlayer;
using bench::LodStage;
using bench::Timing;

struct Way {
    std::string name;
    FramebufferLodOptions options;
};

const std::vector<Way>& ways() {
    static const std::vector<Way> kWays = {
        {"bilinear", {.reconstruction = Reconstruction::bilinear, .fine_grained = false}},
        {"geometry-aware", {.fine_grained = false}},
        {"fine-grained", {}}};
    return kWays;
}

FramebufferLodOptions at(const Way& way, double r) {
    FramebufferLodOptions options = way.options;
    options.r = r;
    return options;
}

std::string number(double r) {
    return fmt::format("{:g}", r);
}

/// What one way at one r loses and costs.
struct Point {
    double psnr_db = 0, flip = 0, band = 0;
    double ms = 0, reconstruction_ms = 0;
};

/// t = K / r^2 + C by least squares of relative errors.
struct TimeModel {
    double k = 0, c = 0, worst = 0;
};

TimeModel fit_time(const std::map<double, Point>& points, double area_of(double)) {
    double a11 = 0, a12 = 0, a22 = 0, b1 = 0, b2 = 0;
    for (const auto& [r, p] : points) {
        const double u = area_of(r) / p.ms;
        const double v = 1 / p.ms;
        a11 += u * u;
        a12 += u * v;
        a22 += v * v;
        b1 += u;
        b2 += v;
    }
    TimeModel model;
    const double det = a11 * a22 - a12 * a12;
    model.k = (b1 * a22 - b2 * a12) / det;
    model.c = (a11 * b2 - a12 * b1) / det;
    for (const auto& [r, p] : points) {
        model.worst = std::max(model.worst, std::abs((model.k * area_of(r) + model.c) / p.ms - 1));
    }
    return model;
}

double inverse_square(double r) {
    return 1 / (r * r);
}

class LodBench {
  public:
    explicit LodBench(BenchContext& context) : context_(context) {}

    void scene(LodPlayer& player) {
        player_ = &player;
        points_.clear();
        const std::string name = player.stage().name;
        rs_ = context_.quick() ? std::vector<double>{1.25, 2, 4}
                               : std::vector<double>{1.25, 1.5, 2, 3, 4, 5.6, 8};
        time(name);
        errors(name);
        if (failed_) return;
        report(name);
    }

  private:
    template <class T>
    void must(const Result<T>& result) {
        if (result || failed_) return;
        failed_ = true;
        context_.fail(result.error());
    }

    double pixels() const { return static_cast<double>(player_->stage().z.size()); }

    void time(const std::string& name) {
        std::vector<Candidate> candidates = {{"direct", [this] { must(player_->direct()); }}};
        for (const Way& way : ways()) {
            for (const double r : rs_) {
                candidates.push_back({way.name + " r " + number(r),
                                      [this, o = at(way, r)] { must(player_->resized(o)); }});
            }
        }
        for (const Way& way : ways()) {
            candidates.push_back({way.name + " alone",
                                  [this, o = at(way, 2)] { must(player_->reconstruction(o)); }});
            candidates.push_back(
                {way.name + " finished", [this, o = at(way, 2)] { must(player_->finished(o)); }});
        }
        candidates.push_back({"last pass", [this] { must(player_->last_pass()); }});
        candidates.push_back(
            {"Gaussian finished", [this] { must(player_->finished(gauss_options())); }});
        const Comparison times = context_.compare(name, candidates, {.repeats = 15});
        direct_ms_ = times["direct"].median_ms();
        context_.add({.case_name = name, .knob = "way", .level = "direct"}, times);
        for (const Way& way : ways()) {
            for (const double r : rs_) {
                const std::string level = way.name + " r " + number(r);
                Point& point = points_[way.name][r];
                point.ms = times[level].median_ms();
                speedup_[way.name][r] = times.speedup(level, "direct");
            }
            rho_ns_[way.name] =
                (times[way.name + " finished"].median_ms() - times["last pass"].median_ms()) * 1e6 /
                pixels();
            apart_ns_[way.name] = times[way.name + " alone"].median_ms() * 1e6 / pixels();
            alone(name, way.name, times[way.name + " alone"]);
            alone(name, way.name + ", finished on the way", times[way.name + " finished"]);
        }
        alone(name, "the last pass alone", times["last pass"]);
        alone(name, "Gaussian 4x4, finished on the way", times["Gaussian finished"]);
        gauss_ns_ = (times["Gaussian finished"].median_ms() - times["last pass"].median_ms()) *
                    1e6 / pixels();
    }

    void alone(const std::string& name, const std::string& level, const Timing& timing) {
        context_.add({.case_name = name,
                      .knob = "reconstruction alone",
                      .level = level,
                      .ms_median = timing.median_ms(),
                      .ms_p95 = timing.p95_ms()});
    }

    static FramebufferLodOptions gauss_options() { return {.kernel = LodKernel::gauss}; }

    void gauss_error(const Image<Rgba8>& truth) {
        const FramebufferLodOptions options = gauss_options();
        const auto picture = player_->picture(&options);
        must(picture);
        if (!failed_) gauss_psnr_db_ = compare_images(*picture, truth)->psnr_db;
    }

    void errors(const std::string& name) {
        const auto truth = player_->picture();
        must(truth);
        if (failed_) return;
        gauss_error(*truth);
        if (failed_) return;
        const Image<std::uint8_t> band = depth_edge_band(player_->stage().z);
        for (const Way& way : ways()) {
            for (auto& [r, point] : points_[way.name]) {
                context_.progress(fmt::format("{}: {} at r = {}", name, way.name, r));
                const FramebufferLodOptions options = at(way, r);
                const auto picture = player_->picture(&options);
                must(picture);
                if (failed_) return;
                const auto difference = compare_images(*picture, *truth);
                const auto flip = flip_error(*picture, *truth);
                const auto near_edges = band_error(*picture, *truth, band);
                point.psnr_db = difference->psnr_db;
                point.flip = flip->mean;
                point.band = near_edges->mse;
                const auto row = [&](double error, const char* metric) {
                    context_.add({.case_name = name + ", " + way.name,
                                  .knob = "r",
                                  .level = number(r),
                                  .ms_median = point.ms,
                                  .error = error,
                                  .metric = metric,
                                  .baseline = "direct",
                                  .speedup = speedup_[way.name][r]});
                };
                row(point.flip, "mean FLIP");
                row(point.psnr_db, "dB PSNR");
                row(point.band, "MSE near edges");
            }
        }
    }

    /// Value of a curve over r at any r, straight in log r.
    static double along(const std::map<double, Point>& curve, double r, double Point::*what) {
        auto above = curve.lower_bound(r);
        if (above == curve.end()) return std::prev(above)->second.*what;
        if (above == curve.begin()) return above->second.*what;
        const auto below = std::prev(above);
        const double t = std::log(r / below->first) / std::log(above->first / below->first);
        return below->second.*what * (1 - t) + above->second.*what * t;
    }

    /// Shading cost (ns a pixel) from which `way` has the better PSNR in the time that bilinear
    /// resizing takes at r = 2; negative where it never does up to 2000 ns.
    double crossing(const std::string& way) const {
        const double bilinear = points_.at("bilinear").at(2).psnr_db;
        for (double k = 5; k <= 2000; k *= 1.02) {
            const double time = k / 4 + rho_ns_.at("bilinear");
            const double left = time - rho_ns_.at(way);
            if (left <= 0) continue;
            const double r = std::max(1.25, std::sqrt(k / left));
            if (r > rs_.back()) continue;
            if (along(points_.at(way), r, &Point::psnr_db) >= bilinear) return k;
        }
        return -1;
    }

    void report(const std::string& name) {
        const bool room = player_->stage().kind == LodKind::room;
        const double k_ns = direct_ms_ * 1e6 / pixels();
        const auto& fine = points_.at("fine-grained");
        const auto& aware = points_.at("geometry-aware");
        const auto& bilinear = points_.at("bilinear");

        const TimeModel model = fit_time(fine, &inverse_square);
        context_.claim(
            fmt::format("{}: time is {:.2f} ms / r^2 + {:.2f} ms within {:.1f} % for r "
                        "from {:g} to {:g} (limit 10 %)",
                        name, model.k, model.c, 100 * model.worst, rs_.front(), rs_.back()),
            model.worst <= 0.10);
        const double gain = speedup_.at("fine-grained").at(2);
        const double wanted = k_ns >= 400 ? 3.0 : k_ns >= 200 ? 2.5 : 1.0;
        context_.claim(fmt::format("{}: shading costs {:.0f} ns a pixel; fine-grained at r = 2 is "
                                   "{:.2f}x as fast (at least {:g})",
                                   name, k_ns, gain, wanted),
                       gain >= wanted);
        const double limit = room ? 16 : 10;
        context_.claim(
            fmt::format("{}: picking and reconstruction at r = 2 cost {:.1f} ns a pixel "
                        "fine-grained, {:.1f} without, {:.1f} bilinear, beyond the last pass that "
                        "they do on the way (limit {:g})",
                        name, rho_ns_.at("fine-grained"), rho_ns_.at("geometry-aware"),
                        rho_ns_.at("bilinear"), limit),
            rho_ns_.at("fine-grained") <= limit);
        context_.note(fmt::format(
            "{}: where something is drawn between, reconstruction cannot finish the picture and "
            "costs {:.1f} ns a pixel fine-grained, {:.1f} without, {:.1f} bilinear. The Gaussian "
            "over 4x4 costs {:.1f} ns, {:.1f} times the tent with its tiles, and makes {:.1f} dB "
            "at r = 2 "
            "where the tent makes {:.1f}.",
            name, apart_ns_.at("fine-grained"), apart_ns_.at("geometry-aware"),
            apart_ns_.at("bilinear"), gauss_ns_, gauss_ns_ / rho_ns_.at("fine-grained"),
            gauss_psnr_db_, fine.at(2).psnr_db));
        bool ordered = true;
        for (const double r : rs_) {
            ordered = ordered && aware.at(r).psnr_db > bilinear.at(r).psnr_db &&
                      fine.at(r).psnr_db > aware.at(r).psnr_db;
        }
        context_.claim(name + ": at every r, PSNR of bilinear < geometry-aware < fine-grained",
                       ordered);
        const double ratio = fine.at(2).band / bilinear.at(2).band;
        context_.claim(fmt::format("{}: near edges at r = 2 the squared error is {:.2f} of "
                                   "bilinear's, {:.2f} without fine grain (limit 0.5)",
                                   name, ratio, aware.at(2).band / bilinear.at(2).band),
                       ratio <= 0.5);
        const auto from = [&](const std::string& way) {
            const double k = crossing(way);
            return k < 0 ? std::string("never") : fmt::format("from {:.0f} ns a pixel on", k);
        };
        context_.note(
            fmt::format("{}: against bilinear resizing at r = 2 in equal time, PSNR is higher {} "
                        "geometry-aware and {} fine-grained.",
                        name, from("geometry-aware"), from("fine-grained")));
    }

    BenchContext& context_;
    LodPlayer* player_ = nullptr;
    std::vector<double> rs_;
    std::map<std::string, std::map<double, Point>> points_;
    std::map<std::string, std::map<double, double>> speedup_;
    std::map<std::string, double> rho_ns_;    ///< beyond the last pass, done on the way
    std::map<std::string, double> apart_ns_;  ///< without it
    double gauss_ns_ = 0, gauss_psnr_db_ = 0;
    double direct_ms_ = 0;
    bool failed_ = false;
};

/// Why bilinear resizing is no worse on the chess board: the texture, not the geometry.
Result<void> note_one_albedo(BenchContext& context, gpu::Device& device, LodStage stage) {
    for (Rgba8& texel : stage.albedo.pixels()) {
        if (texel.a != 0) texel = {188, 188, 188, 255};
    }
    KINO_ASSIGN(const auto player, LodPlayer::create(device, stage));
    KINO_ASSIGN(const Image<Rgba8> truth, player->picture());
    std::map<std::string, double> psnr_db;
    for (const Way& way : ways()) {
        const FramebufferLodOptions options = at(way, 2);
        KINO_ASSIGN(const Image<Rgba8> picture, player->picture(&options));
        psnr_db[way.name] = compare_images(picture, truth)->psnr_db;
    }
    context.claim(fmt::format("{} with one albedo everywhere, r = 2: {:.1f} dB geometry-aware, "
                              "{:.1f} dB bilinear",
                              stage.name, psnr_db["geometry-aware"], psnr_db["bilinear"]),
                  psnr_db["geometry-aware"] > psnr_db["bilinear"]);
    return {};
}

}  // namespace

void bench_framebuffer_lod(BenchContext& context) {
    auto device = gpu::Device::create({});
    if (!device) return context.fail(device.error());
    context.set_device((*device)->info().name + ", " + (*device)->info().driver);
    const int width = context.quick() ? 640 : 1280;
    const int height = context.quick() ? 360 : 720;
    LodBench bench(context);
    std::vector<LodStage> stages;
    for (const LodKind kind : {LodKind::car, LodKind::dragon, LodKind::chess}) {
        stages.push_back(bench::made_stage(kind, width, height));
    }
    auto room = bench::room_stage(**device, width, height);
    if (!room) return context.fail(room.error());
    stages.push_back(std::move(*room));
    for (const LodStage& stage : stages) {
        const auto player = LodPlayer::create(**device, stage);
        if (!player) return context.fail(player.error());
        bench.scene(**player);
    }
    const auto grey = note_one_albedo(context, **device, stages[2]);
    if (!grey) return context.fail(grey.error());
    bench::bench_lod_fixes(context, **device);
    bench::bench_guided_depth(context, **device);
    context.note(fmt::format(
        "{}x{}; the reference is the same shading at every pixel. Car: soft shadow of 9x9 taps; "
        "dragon: ten octaves of noise and a highlight; chess: ambient occlusion by 32 rays; room: "
        "the office of the recordings as a mesh, 16 point lights.",
        width, height));
}

}  // namespace kino
