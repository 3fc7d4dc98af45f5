#include "apps/bench/framebuffer_lod_depth.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "tests/scenes/depth_scene.h"
#include "tests/viz/host_copies.h"
#include "viz/graph/executor.h"
#include "viz/quality/edge_band.h"
#include "viz/quality/guided_depth.h"

namespace kino::bench {
namespace {

using graph::FrameGraph;
using graph::TextureId;

/// Every `factor`-th reading along both sides, none made up.
Image<float> reduced(const Image<float>& depth, int factor) {
    Image<float> out(depth.width() / factor, depth.height() / factor);
    for (int y = 0; y < out.height(); ++y) {
        for (int x = 0; x < out.width(); ++x) {
            out.at(x, y) = depth.at(factor * x + factor / 2, factor * y + factor / 2);
        }
    }
    return out;
}

/// The rivals: the nearest reading, or the mean of what readings the tent finds.
Image<float> plain(const Image<float>& coarse, int width, int height, bool bilinear) {
    Image<float> out(width, height, 0.0f);
    const double scale_x = static_cast<double>(coarse.width()) / width;
    const double scale_y = static_cast<double>(coarse.height()) / height;
    for (int y = 0; y < height; ++y) {
        for (int x = 0; x < width; ++x) {
            const double u = x * scale_x - 0.5;  // readings are half a pixel right of the middle
            const double v = y * scale_y - 0.5;
            double sum = 0;
            double weights = 0;
            double most = 0;
            for (int k = 0; k < 4; ++k) {
                const double left = std::floor(u) + k % 2;
                const double top = std::floor(v) + k / 2;
                const float z =
                    coarse.at(std::clamp(static_cast<int>(left), 0, coarse.width() - 1),
                              std::clamp(static_cast<int>(top), 0, coarse.height() - 1));
                const double tent = (1 - std::abs(u - left)) * (1 - std::abs(v - top));
                if (!bilinear && tent > most) out.at(x, y) = z;
                most = std::max(most, tent);
                if (!(z > 0)) continue;
                sum += tent * z;
                weights += tent;
            }
            if (bilinear && weights > 0) out.at(x, y) = static_cast<float>(sum / weights);
        }
    }
    return out;
}

struct DepthLoss {
    double rmse_mm = 0;   ///< where there is a reading in all pictures
    double edges_mm = 0;  ///< the same within two pixels of depth edges
    double between = 0;   ///< share of pixels near edges more than 5 % of depth off
};

DepthLoss loss(const Image<float>& got, const Image<float>& truth, const Image<float>& guided,
               const Image<std::uint8_t>& band) {
    DepthLoss out;
    std::int64_t all = 0;
    std::int64_t edges = 0;
    for (std::size_t i = 0; i < truth.size(); ++i) {
        const double z = truth.pixels()[i];
        if (!(z > 0 && got.pixels()[i] > 0 && guided.pixels()[i] > 0)) continue;
        const double d = 1000 * (got.pixels()[i] - z);
        out.rmse_mm += d * d;
        ++all;
        if (band.pixels()[i] == 0) continue;
        out.edges_mm += d * d;
        out.between += std::abs(d) > 50 * z;
        ++edges;
    }
    out.rmse_mm = std::sqrt(out.rmse_mm / static_cast<double>(std::max<std::int64_t>(all, 1)));
    const auto count = static_cast<double>(std::max<std::int64_t>(edges, 1));
    out.edges_mm = std::sqrt(out.edges_mm / count);
    out.between /= count;
    return out;
}

Result<void> run_guided_depth(BenchContext& context, gpu::Device& device) {
    KINO_ASSIGN(const test::RecordedScene recorded, test::load_recording("recordings/office"));
    if (!recorded.scene.live) return fail("the recording shows no depth", "recordings/office");
    const Image<float>& truth = recorded.scene.live->surface->depth_m;
    const Image<Rgba8>& colors = recorded.scene.live->surface->color;
    const auto extent = [](int width, int height) {
        return VkExtent2D{static_cast<std::uint32_t>(width), static_cast<std::uint32_t>(height)};
    };
    KINO_ASSIGN(const gpu::Texture color,
                test::filled_texture(device, "colors", extent(colors.width(), colors.height()),
                                     VK_FORMAT_R8G8B8A8_UNORM, colors.data(), colors.size() * 4));
    KINO_ASSIGN(
        const gpu::Buffer host,
        gpu::Buffer::create(device, "guided depth", truth.size() * 4, gpu::MemoryUse::readback));
    const Image<std::uint8_t> band = depth_edge_band(truth);
    gpu::Pipelines pipelines(device);
    graph::Executor executor(device, pipelines);
    bool better = true;
    for (const int factor : {2, 4}) {
        const Image<float> coarse = reduced(truth, factor);
        KINO_ASSIGN(const gpu::Texture depth,
                    test::filled_texture(device, "depth", extent(coarse.width(), coarse.height()),
                                         VK_FORMAT_R32_SFLOAT, coarse.data(), coarse.size() * 4));
        const auto draw = [&](bool reading) -> Result<void> {
            FrameGraph graph(executor.history());
            const auto import = [&](const gpu::Texture& t) {
                return graph.import_texture("imported", t.image(), t.view(),
                                            {t.extent().width, t.extent().height, t.format()});
            };
            const TextureId out =
                add_guided_depth(graph, import(depth), import(color), {.offset_px = 0.5f});
            graph.require(out);
            if (reading) test::read_back(graph, out, host);
            const auto report = executor.run(graph, graph::Timing::frame);
            if (!report) return fail(report.error());
            return {};
        };
        KINO_TRY(draw(true));
        Image<float> guided(truth.width(), truth.height());
        const auto bits = host.read<float>();
        std::copy(bits.begin(), bits.begin() + static_cast<std::ptrdiff_t>(guided.size()),
                  guided.data());
        const Image<float> nearest = plain(coarse, truth.width(), truth.height(), false);
        const Image<float> bilinear = plain(coarse, truth.width(), truth.height(), true);
        const std::string name = fmt::format("office depth, reduced {}x", factor);
        const std::vector<Candidate> candidates = {{"guided", [&] { (void)draw(false); }}};
        const Comparison times = context.compare(name, candidates, {.repeats = 15});
        const auto row = [&](const char* level, const Image<float>& picture, double ms) {
            const DepthLoss lost = loss(picture, truth, guided, band);
            for (const auto& [value, metric] : {std::pair(lost.rmse_mm, "mm RMSE"),
                                                {lost.edges_mm, "mm RMSE near edges"},
                                                {100 * lost.between, "% off by 5 % near edges"}}) {
                context.add({.case_name = name,
                             .knob = "depth at the colour's size",
                             .level = level,
                             .ms_median = ms,
                             .error = value,
                             .metric = metric});
            }
            return lost;
        };
        const DepthLoss by_color = row("guided", guided, times["guided"].median_ms());
        const DepthLoss by_nearest = row("nearest", nearest, kNotMeasured);
        const DepthLoss by_tent = row("bilinear", bilinear, kNotMeasured);
        better = better && by_color.between < std::min(by_nearest.between, by_tent.between);
    }
    context.claim(
        "office depth, reduced 2 and 4 times: guided by colour, fewer pixels near edges are off by "
        "5 % than by the nearest reading or bilinear",
        better);
    return {};
}

}  // namespace

void bench_guided_depth(BenchContext& context, gpu::Device& device) {
    const auto done = run_guided_depth(context, device);
    if (!done) context.fail(done.error());
}

}  // namespace kino::bench
