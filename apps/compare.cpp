#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <cmath>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>

#include "apps/commands.h"
#include "apps/exit_codes.h"
#include "apps/tell_error.h"
#include "sensor/png_io.h"
#include "viz/quality/edge_band.h"
#include "viz/quality/flip.h"
#include "viz/quality/image_metrics.h"
#include "viz/quality/ssim.h"

namespace kino {
namespace {

struct CompareRequest {
    std::string a, b, out, map;
    int tolerance = 0;
    int shift_radius = 0;
    bool json = false;
};

int fail_with(const Error& error) {
    tell_error(error);
    return kExitFailed;
}

/// How far apart the pictures look.
struct Perceived {
    double ssim = 1;
    double flip = 0;
    BandError band;  ///< near edges of A's luma
};

Result<Perceived> perceive(const Image<Rgba8>& a, const Image<Rgba8>& b, const std::string& map) {
    Perceived out;
    KINO_ASSIGN(out.ssim, ssim(a, b));
    KINO_ASSIGN(const FlipResult flip, flip_error(a, b));
    out.flip = flip.mean;
    KINO_ASSIGN(out.band, band_error(a, b, luma_edge_band(a)));
    if (map.empty()) return out;
    const Image<Rgba8> picture = flip_picture(flip);
    KINO_TRY(write_png_rgba8(map, picture.view()));
    return out;
}

void print_json(const ImageDifference& difference, const Perceived& seen, bool same) {
    const nlohmann::ordered_json out = {
        {"same", same},
        {"max_abs", difference.max_abs},
        {"failing_pixels", difference.failing_pixels},
        {"failing_fraction", difference.failing_fraction},
        {"rmse", difference.rmse},
        // JSON has no infinity: equal pictures have no ratio.
        {"psnr_db", std::isfinite(difference.psnr_db) ? nlohmann::ordered_json(difference.psnr_db)
                                                      : nlohmann::ordered_json()},
        {"ssim", seen.ssim},
        {"flip", seen.flip},
        {"edge_band_mse", seen.band.mse},
        {"edge_band_pixels", seen.band.pixels}};
    fmt::print("{}\n", out.dump(2));
}

int run_compare(const CompareRequest& request) {
    const auto a = read_png_rgba8(request.a);
    if (!a) return fail_with(a.error());
    const auto b = read_png_rgba8(request.b);
    if (!b) return fail_with(b.error());
    if (!request.out.empty()) {
        const Image<Rgba8> picture = difference_picture(*a, *b);
        const auto written = write_png_rgba8(request.out, picture.view());
        if (!written) return fail_with(written.error());
    }
    const auto difference = compare_images(
        *a, *b, {.tolerance = request.tolerance, .shift_radius = request.shift_radius});
    if (!difference) return fail_with(difference.error());
    const auto seen = perceive(*a, *b, request.map);
    if (!seen) return fail_with(seen.error());
    const bool same = difference->failing_pixels == 0;
    if (request.json) {
        print_json(*difference, *seen, same);
    } else {
        fmt::print("{}: {}\n", same ? "same" : "different", difference->to_string());
        fmt::print("SSIM {:.5f}, FLIP {:.5f}, MSE near edges {:.3f} ({} pixels)\n", seen->ssim,
                   seen->flip, seen->band.mse, seen->band.pixels);
    }
    return same ? kExitDone : kExitDiffer;
}

}  // namespace

Command add_compare(CLI::App& parent) {
    auto request = std::make_shared<CompareRequest>();
    CLI::App& app = *parent.add_subcommand("compare", "says how two PNG pictures differ");
    app.add_option("A", request->a, "a PNG")->required();
    app.add_option("B", request->b, "a PNG of the same size")->required();
    app.add_option("--out", request->out, "write a picture of the differences")->type_name("PNG");
    app.add_option("--map", request->map, "write a picture of the seen error (FLIP)")
        ->type_name("PNG");
    app.add_option("--tolerance", request->tolerance, "a channel may differ by N of 255, default 0")
        ->check(CLI::Range(0, 255))
        ->type_name("N");
    app.add_option("--shift", request->shift_radius,
                   "a pixel may match a neighbour this far away, default 0")
        ->check(CLI::Range(0, 8))
        ->type_name("PX");
    app.add_flag("--json", request->json, "print the figures as JSON");
    return [request] { return run_compare(*request); };
}

}  // namespace kino
