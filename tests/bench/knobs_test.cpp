#include "apps/bench/knobs.h"

#include <fmt/format.h>
#include <gmock/gmock.h>

#include <algorithm>
#include <fstream>
#include <iterator>
#include <map>
#include <span>
#include <string>

#include "apps/bench/page_defaults.h"
#include "calibration/boards/find_board.h"
#include "calibration/rig.h"
#include "calibration/solve/bundle.h"
#include "viz/accel/bvh.h"
#include "viz/frame/renderer.h"
#include "viz/light/indirect.h"
#include "viz/light/light_lists.h"
#include "viz/light/ray_shadows.h"
#include "viz/quality/framebuffer_lod.h"
#include "viz/quality/zoom/deflect.h"
#include "viz/quality/zoom/zoom_options.h"
#include "viz/scene/scene.h"
#include "viz/surface/mesh_drawer.h"

namespace kino::bench {
namespace {

using testing::HasSubstr;

std::vector<PageEntry> committed() {
    auto entries = read_page_entries("docs/accuracy");
    EXPECT_TRUE(entries) << (entries ? "" : entries.error().to_string());
    return entries ? std::move(*entries) : std::vector<PageEntry>();
}

const Knob* knob_at(std::string_view where) {
    const auto all = knobs();
    const auto found =
        std::find_if(all.begin(), all.end(), [&](const Knob& k) { return k.where == where; });
    return found == all.end() ? nullptr : &*found;
}

TEST(Knobs, EveryOneHasACurveOrSaysWhyNot) {
    const auto entries = committed();
    for (const Knob& knob : knobs()) {
        const std::string what = fmt::format("{}: {}", knob.area, knob.name);
        EXPECT_FALSE(knob.where.empty()) << what;
        EXPECT_FALSE(knob.standard.empty()) << what;
        if (knob.bench.empty()) {
            EXPECT_THAT(std::string(knob.remark), testing::StartsWith("none: ")) << what;
            continue;
        }
        const auto entry = std::find_if(entries.begin(), entries.end(),
                                        [&](const PageEntry& e) { return e.stem == knob.bench; });
        ASSERT_NE(entry, entries.end()) << what << ": no table " << knob.bench;
        EXPECT_TRUE(std::any_of(entry->rows.begin(), entry->rows.end(),
                                [&](const BenchRow& row) { return row.knob == knob.column; }))
            << what << ": no rows of \"" << knob.column << "\" in " << knob.bench;
        // Times alone are enough only where nothing is lost, or where it is said what is.
        if (knob.remark.empty()) {
            EXPECT_TRUE(has_curve(entries, knob.bench, knob.column)) << what;
        }
    }
}

TEST(Knobs, WhatATableHasAndTheListDoesNotIsNamed) {
    auto entries = committed();
    for (const PageEntry& entry : entries) {
        const std::string page = knobs_page(std::span(&entry, 1));
        for (const BenchRow& row : entry.rows) {
            if (is_finding(entry.stem, row.knob)) continue;
            const auto named = [&](const char* form) {
                return page.find(fmt::format(fmt::runtime(form), entry.stem, row.knob)) !=
                       std::string::npos;
            };
            EXPECT_TRUE(named("[table]({0}.md): {1}") || named("[{0}]({0}.md): {1}"))
                << entry.stem << ": " << row.knob;
        }
    }
    const auto before = knobs_page(entries);
    EXPECT_EQ(before.find("a knob of tomorrow"), std::string::npos);
    entries[0].rows.push_back({.case_name = "c", .knob = "a knob of tomorrow", .level = "1"});
    const auto after = knobs_page(entries);
    EXPECT_GT(after.find("a knob of tomorrow"), after.find("## Others in the tables"));
    EXPECT_NE(after.find("a knob of tomorrow"), std::string::npos);
}

/// What the list says against what the code does.
TEST(Knobs, DefaultsAreThoseOfTheCode) {
    const auto yes = [](bool value) { return std::string(value ? "yes" : "no"); };
    const LightListOptions lists;
    const RayShadowOptions shadows;
    const RigOptions rig;
    const std::map<std::string_view, std::string> code = {
        {"LightListOptions::tile_px", fmt::format("{}", lists.tile_px)},
        {"LightListOptions::cell_count", fmt::format("{}", lists.cell_count)},
        {"LightListOptions::capacity", fmt::format("{}", lists.capacity)},
        {"LightListOptions::two_level", yes(lists.two_level)},
        {"LightListOptions::cells", lists.cells == DepthCells::linear ? "linear" : "other"},
        {"RayShadowOptions::half_resolution", yes(shadows.half_resolution)},
        {"RayShadowOptions::rays_per_pixel", fmt::format("{}", shadows.rays_per_pixel)},
        {"RayShadowOptions::live_columns", fmt::format("{}", shadows.live_columns)},
        {"BounceOptions::grid", fmt::format("{0} x {0}", BounceOptions().grid)},
        {"BounceOptions::cutoff", fmt::format("{}", BounceOptions().cutoff)},
        {"BvhOptions::leaf_triangles", fmt::format("{}", BvhOptions().leaf_triangles)},
        {"BvhOptions::axes",
         BvhOptions().axes == AxisRule::longest_cell ? "longest cell" : "other"},
        {"FrameOptions::light_rate",
         FrameOptions().light_rate == LightRate::depth_pixel ? "depth pixel" : "other"},
        {"LiveDepth::fill_holes", yes(LiveDepth().fill_holes)},
        {"RigOptions::coverage", rig.coverage == Coverage::nearest ? "nearest" : "other"},
        {"RigOptions::ray_table_step", fmt::format("{}", rig.ray_table_step)},
        {"RigOptions::occlusion_margin_m", fmt::format("{} mm", 1000 * rig.occlusion_margin_m)},
        {"FindBoardOptions::quick", FindBoardOptions().quick ? "fast" : "thorough"},
        {"kinoscope calibrate --squared",
         fmt::format("robust, {} sigmas", BundleOptions().huber_sigmas)},
        {"SkinBlend", MeshNode().skin == SkinBlend::linear ? "linear" : "other"},
        {"MeshListOptions::culling",
         MeshListOptions().culling == MeshCulling::zero_instance ? "zero instances" : "other"},
        {"MeshListOptions::carrier",
         MeshListOptions().carrier == DrawIdCarrier::first_instance ? "firstInstance" : "other"},
        {"FramebufferLodOptions::fix_confidence",
         fmt::format("{}", FramebufferLodOptions().fix_confidence)},
        {"FramebufferLodOptions::metric",
         FramebufferLodOptions().metric == RangeMetric::plane ? "plane" : "other"},
        {"FramebufferLodOptions::sigma_z", fmt::format("{}", FramebufferLodOptions().sigma_z)},
        {"FramebufferLodOptions::sigma_n", fmt::format("{}", FramebufferLodOptions().sigma_n)},
        {"FramebufferLodOptions::kernel",
         FramebufferLodOptions().kernel == LodKernel::tent ? "tent" : "other"},
        {"FramebufferLodOptions::format",
         FramebufferLodOptions().format == LodFormat::packed ? "packed" : "other"},
        {"FramebufferLodOptions::flat_tolerance",
         fmt::format("{}", FramebufferLodOptions().flat_tolerance)},
        {"--fix", fmt::format("{}", FramebufferLodOptions().fix_share)},
        {"--zoom", fmt::format("{}", ZoomOptions().z)},
        {"--samples", fmt::format("{}", FrameOptions().samples)},
        {"DeflectOptions::form", DeflectOptions().form == DeflectForm::pan ? "pan" : "other"},
    };
    for (const auto& [where, value] : code) {
        const Knob* knob = knob_at(where);
        ASSERT_NE(knob, nullptr) << where;
        EXPECT_EQ(knob->standard, value) << where;
    }
    // And those of depth filters against what the ring of their plots says.
    for (const Knob& knob : knobs()) {
        if (knob.bench != "filters" || knob.column == "code" || knob.column == "chain") continue;
        const std::string number(knob.standard.substr(0, knob.standard.find(' ')));
        EXPECT_TRUE(is_default_level("filters", knob.column, number, "")) << knob.name;
    }
}

TEST(Knobs, PageHasEveryOneAndItsLinksLead) {
    const auto entries = committed();
    const std::string page = knobs_page(entries);
    const std::string plots = accuracy_page(entries);
    for (const Knob& knob : knobs()) {
        EXPECT_THAT(page, HasSubstr(fmt::format("| {} | `{}` | {} |", knob.name, knob.where,
                                                knob.standard)));
        if (!has_curve(entries, knob.bench, knob.column)) continue;
        EXPECT_THAT(plots,
                    HasSubstr(fmt::format("<figure id=\"{}\">", plot_id(knob.bench, knob.column))))
            << knob.name;
    }
    std::ifstream file("docs/accuracy/README.md");
    const std::string readme((std::istreambuf_iterator<char>(file)), {});
    // The committed page lists the same; what its tables say may be of another run.
    for (const Knob& knob : knobs()) {
        EXPECT_THAT(readme, HasSubstr(fmt::format("| {} | `{}` | {} |", knob.name, knob.where,
                                                  knob.standard)))
            << "`kinoscope bench --pages` makes the page anew";
    }
}

TEST(PlotId, IsOneWordOfPlainLetters) {
    EXPECT_EQ(plot_id("filters", "spatial radius, px"), "filters-spatial-radius-px");
    EXPECT_EQ(plot_id("forward-plus", "1 / cut-off"), "forward-plus-1-cut-off");
    EXPECT_EQ(plot_id("a", "<\"é'>"), "a");
}

}  // namespace
}  // namespace kino::bench
