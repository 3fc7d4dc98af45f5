#include "apps/bench/knobs.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <iterator>
#include <set>
#include <utility>

namespace kino::bench {
namespace {

constexpr std::string_view kPixels = "Depth to pixels";
constexpr std::string_view kFilters = "Depth filters";
constexpr std::string_view kRig = "Calibration and registration";
constexpr std::string_view kCodecs = "Recordings";
constexpr std::string_view kPeople = "People, joints, gestures";
constexpr std::string_view kLight = "Light";
constexpr std::string_view kRays = "Rays and shadows";
constexpr std::string_view kMeshes = "Meshes";
constexpr std::string_view kLod = "Coarse light";
constexpr std::string_view kZoom = "Coarse pictures and heads";
constexpr std::string_view kBudget = "The frame budget";

constexpr std::string_view kExact = "none: exact, it changes the time alone";

constexpr Knob kKnobs[] = {
    {kPixels, "drawing path", "--raster", "compute", "raster", "path"},
    {kPixels, "largest splat", "--splat", "3 px", "raster", "splat cap"},
    {kPixels, "depth pixels drawn", "--filter decimate", "all", "raster", "depth resolution"},
    {kPixels, "where light on the live surface is worked out", "FrameOptions::light_rate",
     "depth pixel", "raster", "light rate"},
    {kPixels, "one-pixel holes between splats closed", "LiveDepth::fill_holes", "yes", "raster",
     "hole filling"},

    {kFilters, "which filters", "--filter", "none", "filters", "chain"},
    {kFilters, "window of the spatial filter", "spatial:radius", "2 px", "filters",
     "spatial radius, px"},
    {kFilters, "edges of the spatial filter", "spatial:sigmas", "6", "filters", "spatial sigmas"},
    {kFilters, "noise that the spatial filter expects", "spatial:noise", "0.0017 1/m", "filters",
     "spatial noise"},
    {kFilters, "weight of a new frame", "temporal:alpha", "0.15", "filters", "temporal alpha"},
    {kFilters, "change that starts anew", "temporal:sigmas", "4.5", "filters", "temporal sigmas"},
    {kFilters, "noise that the temporal filter expects", "temporal:noise", "0.0017 1/m", "filters",
     "temporal noise"},
    {kFilters, "frames that a lost pixel is kept", "temporal:persistence", "1", "filters",
     "temporal persistence"},
    {kFilters, "running mean at first", "temporal:running", "1", "filters", "temporal running"},
    {kFilters, "larger changes weigh more", "temporal:soft", "1", "filters", "temporal soft"},
    {kFilters, "widest hole that is bridged", "holes:gap", "8 px", "filters", "holes gap, px"},
    {kFilters, "steepest surface across a hole", "holes:angle", "60 degrees", "filters",
     "holes angle, degrees"},
    {kFilters, "hole between two surfaces that both share", "holes:edge", "3 px", "filters",
     "holes edge, px"},
    {kFilters, "jump that no hole bridges", "holes:steps", "3", "filters", "holes steps"},
    {kFilters, "wider holes get the farther surface", "holes:background", "1", "filters",
     "holes background"},
    {kFilters, "pixels a side that become one", "decimate:factor", "2", "filters",
     "decimate factor"},
    {kFilters, "farthest from a block's median", "decimate:steps", "3", "filters",
     "decimate steps"},
    {kFilters, "readings that a block must hold", "decimate:readings", "1", "filters",
     "decimate readings"},
    {kFilters, "jump that is no surface", "flying:steps", "3", "filters", "flying steps"},
    {kFilters, "steepest surface that is kept", "flying:angle", "80 degrees", "filters",
     "flying angle, degrees"},
    {kFilters, "neighbours that must agree", "flying:support", "2", "filters", "flying support"},
    {kFilters, "AVX2 or portable code", "FilterOptions::simd", "what the processor has", "filters",
     "code", kExact},

    {kRig, "how a depth pixel becomes colour pixels", "RigOptions::coverage", "nearest",
     "registration", "coverage", "holes closed: RigOptions::fill_holes_px, default 0"},
    {kRig, "every how many pixels a ray is kept", "RigOptions::ray_table_step", "1", "registration",
     "ray every n pixels"},
    {kRig, "depth behind the nearest that loses its colour", "RigOptions::occlusion_margin_m",
     "30 mm", "registration", "occlusion margin, mm"},
    {kRig, "AVX2 or portable code", "RigOptions::simd", "what the processor has", "registration",
     "path", kExact},
    {kRig, "views of the board", "kinoscope calibrate --views", "30", "calibration", "views"},
    {kRig, "model of the lens", "kinoscope calibrate --model", "auto", "calibration", "solver",
     "chosen by held-out error"},
    {kRig, "robust or squared loss", "kinoscope calibrate --squared", "robust, 3 sigmas",
     "calibration", "loss, sigmas"},
    {kRig, "fast or thorough detection", "FindBoardOptions::quick", "thorough", "calibration",
     "detection", "times; the fast one misses boards with squares under 15 px"},

    {kCodecs, "codec of sessions", "--codec", "ffv1", "codecs", "encode",
     "all lossless: size against time"},
    {kCodecs,
     "counts a metre of exported TUM depth",
     "kinoscope convert --scale",
     "the recording's own",
     {},
     {},
     "none: exact as it is; another scale rounds to its own step, 1/N m"},

    {kPeople, "trees of the forest", "BodyTrackerOptions::trees", "3", "skeleton", "trees"},
    {kPeople, "depth of its trees", "BodyTrackerOptions::max_depth", "20", "skeleton", "depth"},
    {kPeople, "pixels that are labelled", "BodyTrackerOptions::step_px", "so that about 1,800 are",
     "skeleton", "step, px"},
    {kPeople, "rounds of the model fit", "BodyTrackerOptions::fit_rounds", "2", "skeleton",
     "fit rounds"},
    {kPeople, "cells in which people are looked for", "PeopleOptions::cell_px",
     "so that 160 make a row", "skeleton", "cell, px"},
    {kPeople, "the forest itself", "--forest", "the shipped one", "forest", "forest",
     "what training it otherwise gives: [forest.md](../forest.md)"},
    {kPeople, "filter of the joints", "--filter-joints", "one-euro:default", "joint-filters",
     "preset"},
    {kPeople, "its strength", "presets of docs/gestures.md", "1", "joint-filters",
     "times the default"},
    {kPeople, "jitter against lag of the whole tracker", "--filter-joints", "one-euro:default",
     "skeleton", "filter"},
    {kPeople, "sizes and times of gestures", "--gestures", "1 times those compiled in", "gestures",
     "thresholds, times the default"},

    {kLight, "tiles of the light lists", "LightListOptions::tile_px", "8", "forward-plus",
     "tile px"},
    {kLight, "depth cells of a tile", "LightListOptions::cell_count", "32", "forward-plus",
     "cells"},
    {kLight, "how cells lie along depth", "LightListOptions::cells", "linear", "forward-plus",
     "cell spacing"},
    {kLight, "macro tiles first", "LightListOptions::two_level", "yes", "forward-plus", "way",
     kExact},
    {kLight, "lights a tile holds", "LightListOptions::capacity", "512", "forward-plus",
     "capacity"},
    {kLight, "brightness at which a light ends", "radius of a scene's lights", "1/256",
     "forward-plus", "1 / cut-off"},
    {kLight, "samples a pixel", "--samples", "1", "forward-plus", "samples"},
    {kLight, "virtual lights of one bounce", "BounceOptions::grid", "8 x 8", "one-bounce",
     "virtual lights"},
    {kLight, "irradiance at which they end", "BounceOptions::cutoff", "0.03", "one-bounce",
     "cut-off of 8 x 8"},

    {kRays, "shadows for one of 2 x 2 pixels", "RayShadowOptions::half_resolution", "yes", "lbvh",
     "mask"},
    {kRays, "shadow rays a pixel", "RayShadowOptions::rays_per_pixel", "32", "lbvh",
     "rays a pixel, half mask"},
    {kRays, "vertices across of the live frame's tree", "RayShadowOptions::live_columns", "80",
     "lbvh", "live frame as occluder"},
    {kRays, "stackless or stack", "Traversal", "bit trail", "lbvh", "traversal", kExact},
    {kRays, "levels of the tree", "BvhOptions::levels", "by the triangles", "lbvh", "levels",
     "the same hits; tests a ray against time"},
    {kRays, "triangles of a leaf", "BvhOptions::leaf_triangles", "4", "lbvh", "leaf triangles",
     "the same hits; tests a ray against time"},
    {kRays, "axis of a cut", "BvhOptions::axes", "longest cell", "lbvh", "axes",
     "the same hits; tests a ray against time"},
    {kRays, "where a ray starts in the tree", "any_hit_from(), closest_hit()", "root", "lbvh",
     "start", "the same hits; tests a ray against time"},

    {kMeshes, "blend of skinned vertices", "SkinBlend", "linear", "skinning", "blend"},
    {kMeshes, "how draws are submitted", "MeshListOptions::submit", "multi-draw, culled",
     "vertex-pulling", "submission", kExact},
    {kMeshes, "culling", "MeshListOptions::culling", "zero instances", "vertex-pulling", "culling",
     kExact},
    {kMeshes, "carrier of the draw's number", "MeshListOptions::carrier", "firstInstance",
     "vertex-pulling", "draw-ID carrier", kExact},
    {kMeshes, "triangles a draw", "cut of meshes at loading", "512", "vertex-pulling",
     "triangles a draw", kExact},

    {kLod, "resizing factor, with and without guides", "--lod", "off", "framebuffer-lod", "r"},
    {kLod, "distance of a pixel from a coarse one", "FramebufferLodOptions::metric", "plane",
     "lod-knobs", "range metric"},
    {kLod, "how far off in depth counts", "FramebufferLodOptions::sigma_z", "0.02", "lod-knobs",
     "sigma of depth"},
    {kLod, "how far off in normals counts", "FramebufferLodOptions::sigma_n", "0.25", "lod-knobs",
     "sigma of normals"},
    {kLod, "kernel along the picture", "FramebufferLodOptions::kernel", "tent", "lod-knobs",
     "kernel"},
    {kLod, "guides in one word or as they are", "FramebufferLodOptions::format", "packed",
     "lod-knobs", "guides"},
    {kLod, "tiles resized without guides", "FramebufferLodOptions::flat_tolerance", "0.5",
     "lod-knobs", "flat tiles, sigmas"},
    {kLod, "pixels shaded anew at most", "--fix", "0", "framebuffer-lod", "cap"},
    {kLod, "which pixels are doubted", "FramebufferLodOptions::fix_confidence", "0.05",
     "framebuffer-lod", "confidence"},
    {kLod, "rate of bounced light", "--bounce-lod", "as --lod", "multiresolution",
     "r of direct, bounced"},
    {kLod, "rate of light without shadows", "--plain-lod", "as --lod", "multiresolution",
     "r of shadowed, plain"},
    {kLod, "change of light from which a tile is finer", "--regions", "off", "multiresolution",
     "regions"},
    {kLod, "edges smoothed from coarse light", "--samples 4 --lod R", "off", "supersampling",
     "samples"},

    {kZoom, "pixels of the screen a drawn one fills", "--zoom", "1", "zoom", "z"},
    {kZoom, "what follows a moving head", "DeflectOptions::form", "pan", "zoom", "way"},

    {kBudget, "fixed settings, or the governor", "--lod auto", "governor", "governor", "setting"},
};

/// (bench, knob): rivals, findings, and the same knob looked at from another side.
constexpr std::pair<std::string_view, std::string_view> kFindings[] = {
    {"codecs", "decode"},
    {"codecs", "size"},
    {"forest", "focal factor of the pretrained"},
    {"forward-plus", "lights"},
    {"framebuffer-lod", "way"},
    {"framebuffer-lod", "reconstruction alone"},
    {"framebuffer-lod", "third pass"},
    {"framebuffer-lod", "depth at the colour's size"},
    {"gestures", "noise, mm"},
    {"governor", "r"},
    {"governor", "r, bilinear"},
    {"governor", "r, z"},
    {"governor", "z"},
    {"lbvh", "build"},
    {"lbvh", "rays a place"},
    {"raster", "timing"},
    {"raster", "what is drawn"},
    {"registration", "sampling"},
    {"skeleton", "joint"},
    {"skeleton", "joints"},
    {"skeleton", "take"},
    {"skeleton", "tracker"},
    {"skeleton", "stage"},
    {"vertex-pulling", "fetch"},
    {"vertex-pulling", "culling shape"},
    {"zoom", "frame takes, ms"},
    {"zoom", "who chooses z"},
};

const PageEntry* entry_of(std::span<const PageEntry> entries, std::string_view bench) {
    const auto found = std::find_if(entries.begin(), entries.end(),
                                    [&](const PageEntry& entry) { return entry.stem == bench; });
    return found == entries.end() ? nullptr : &*found;
}

bool has_rows(std::span<const PageEntry> entries, std::string_view bench, std::string_view column) {
    const PageEntry* entry = entry_of(entries, bench);
    return entry != nullptr && std::any_of(entry->rows.begin(), entry->rows.end(),
                                           [&](const BenchRow& row) { return row.knob == column; });
}

std::string curve_cell(std::span<const PageEntry> entries, const Knob& knob) {
    if (knob.bench.empty()) return std::string(knob.remark);
    std::string cell = "not measured yet";
    if (has_rows(entries, knob.bench, knob.column)) {
        cell = fmt::format("[{0}](index.html#{1}), [table]({0}.md): {2}", knob.bench,
                           plot_id(knob.bench, knob.column), knob.column);
        if (!has_curve(entries, knob.bench, knob.column)) {
            cell = fmt::format("[{0}]({0}.md): {1}", knob.bench, knob.column);
        }
    }
    if (!knob.remark.empty()) cell += fmt::format("; {}", knob.remark);
    return cell;
}

}  // namespace

std::span<const Knob> knobs() {
    return kKnobs;
}

bool is_finding(std::string_view bench, std::string_view column) {
    return std::find(std::begin(kFindings), std::end(kFindings), std::pair(bench, column)) !=
           std::end(kFindings);
}

std::string plot_id(std::string_view bench, std::string_view column) {
    std::string id(bench);
    for (const char c : column) {
        const bool word = std::isalnum(static_cast<unsigned char>(c)) != 0;
        if (word) {
            if (id.size() == bench.size()) id += '-';
            id += static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
        } else if (id.back() != '-') {
            id += '-';
        }
    }
    while (id.back() == '-') id.pop_back();
    return id;
}

bool has_curve(std::span<const PageEntry> entries, std::string_view bench,
               std::string_view column) {
    const PageEntry* entry = entry_of(entries, bench);
    return entry != nullptr &&
           std::any_of(entry->rows.begin(), entry->rows.end(), [&](const BenchRow& row) {
               return row.knob == column && std::isfinite(row.error);
           });
}

std::string knobs_page(std::span<const PageEntry> entries) {
    std::string page =
        "# Accuracy: every knob and its curve\n\n"
        "What the program leaves out to be fast, what that costs in error, and where it was "
        "measured. [index.html](index.html) has all plots on one page (one file: it opens from "
        "disk); the `.md` files have the tables, claims and notes, the `.csv` files the numbers. "
        "All of it is made by `kinoscope bench --all`, this page and the plots alone by "
        "`kinoscope bench --pages`.\n\n"
        "An error is always against a reference that is slow, obvious and written apart from what "
        "it judges ([tests/reference](../../tests/reference), [testing.md](../testing.md)).\n";
    std::string_view area;
    for (const Knob& knob : knobs()) {
        if (knob.area != area) {
            area = knob.area;
            page += fmt::format(
                "\n## {}\n\n| knob | turned by | default | curve |\n|---|---|---|---|\n", area);
        }
        page += fmt::format("| {} | `{}` | {} | {} |\n", knob.name, knob.where, knob.standard,
                            curve_cell(entries, knob));
    }
    std::string others;
    for (const PageEntry& entry : entries) {
        std::set<std::string> seen;
        for (const BenchRow& row : entry.rows) {
            const auto is_it = [&](const Knob& knob) {
                return knob.bench == entry.stem && knob.column == row.knob;
            };
            if (is_finding(entry.stem, row.knob) || !seen.insert(row.knob).second) continue;
            if (std::any_of(std::begin(kKnobs), std::end(kKnobs), is_it)) continue;
            others += fmt::format("- [{0}]({0}.md): {1}\n", entry.stem, row.knob);
        }
    }
    if (!others.empty()) page += "\n## Others in the tables\n\n" + others;
    std::string missed;
    for (const PageEntry& entry : entries) {
        for (const std::string& claim : entry.claims_missed) {
            missed += fmt::format("- [{0}]({0}.md): {1}\n", entry.stem, claim);
        }
    }
    if (!missed.empty()) {
        page += "\n## What does not hold on the machine of the tables\n\n" + missed;
    }
    return page;
}

}  // namespace kino::bench
