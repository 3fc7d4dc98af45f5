#include "apps/bench/page_defaults.h"

#include <algorithm>
#include <array>

namespace kino::bench {
namespace {

constexpr std::array kDefaultLevels = {
    DefaultLevel{"calibration", "loss, sigmas", "3"},
    DefaultLevel{"calibration", "detection", "thorough"},
    DefaultLevel{"codecs", "encode", "FFV1"},
    DefaultLevel{"codecs", "decode", "FFV1"},
    DefaultLevel{"filters", "spatial radius, px", "2"},
    DefaultLevel{"filters", "spatial sigmas", "6"},
    DefaultLevel{"filters", "spatial noise", "0.0017"},
    DefaultLevel{"filters", "temporal alpha", "0.15"},
    DefaultLevel{"filters", "temporal noise", "0.0017"},
    DefaultLevel{"filters", "temporal running", "1"},
    DefaultLevel{"filters", "temporal soft", "1"},
    DefaultLevel{"filters", "temporal sigmas", "4.5"},
    DefaultLevel{"filters", "temporal persistence", "1"},
    DefaultLevel{"filters", "holes gap, px", "8"},
    DefaultLevel{"filters", "holes angle, degrees", "60"},
    DefaultLevel{"filters", "holes edge, px", "3"},
    DefaultLevel{"filters", "holes steps", "3"},
    DefaultLevel{"filters", "holes background", "1"},
    DefaultLevel{"filters", "decimate factor", "2"},
    DefaultLevel{"filters", "decimate steps", "3"},
    DefaultLevel{"filters", "decimate readings", "1"},
    DefaultLevel{"filters", "flying steps", "3"},
    DefaultLevel{"filters", "flying angle, degrees", "80"},
    DefaultLevel{"filters", "flying support", "2"},
    DefaultLevel{"filters", "chain", "none"},
    DefaultLevel{"forward-plus", "way", "Forward+ 8 px 2.5D"},
    DefaultLevel{"forward-plus", "tile px", "8"},
    DefaultLevel{"forward-plus", "cells", "32"},
    DefaultLevel{"forward-plus", "cell spacing", "linear"},
    DefaultLevel{"forward-plus", "samples", "1 sample"},
    DefaultLevel{"framebuffer-lod", "r", "2", "fine-grained"},
    DefaultLevel{"gestures", "thresholds, times the default", "1"},
    DefaultLevel{"governor", "setting", "governor"},
    DefaultLevel{"joint-filters", "preset", "one-euro:default"},
    DefaultLevel{"joint-filters", "times the default", "1"},
    DefaultLevel{"lbvh", "traversal", "bit trail"},
    DefaultLevel{"lbvh", "leaf triangles", "4"},
    DefaultLevel{"lbvh", "axes", "longest cell"},
    DefaultLevel{"lbvh", "start", "root"},
    DefaultLevel{"lbvh", "mask", "half"},
    DefaultLevel{"lbvh", "live frame as occluder", "80 across"},
    DefaultLevel{"lbvh", "rays a pixel, half mask", "32"},
    DefaultLevel{"lod-knobs", "range metric", "plane"},
    DefaultLevel{"lod-knobs", "sigma of depth", "0.02"},
    DefaultLevel{"lod-knobs", "sigma of normals", "0.25"},
    DefaultLevel{"lod-knobs", "kernel", "tent"},
    DefaultLevel{"lod-knobs", "guides", "packed"},
    DefaultLevel{"lod-knobs", "flat tiles, sigmas", "0.5"},
    DefaultLevel{"one-bounce", "virtual lights", "8 x 8"},
    DefaultLevel{"one-bounce", "cut-off of 8 x 8", "0.03"},
    DefaultLevel{"raster", "path", "compute splat"},
    DefaultLevel{"raster", "path", "compute mesh"},
    DefaultLevel{"raster", "splat cap", "3 px"},
    DefaultLevel{"raster", "hole filling", "on"},
    DefaultLevel{"raster", "depth resolution", "640x480"},
    DefaultLevel{"raster", "light rate", "depth pixel"},
    DefaultLevel{"registration", "path", "rig"},
    DefaultLevel{"registration", "coverage", "nearest"},
    DefaultLevel{"registration", "ray every n pixels", "1"},
    DefaultLevel{"registration", "occlusion margin, mm", "30"},
    DefaultLevel{"skeleton", "filter", "one-euro:default"},
    DefaultLevel{"skeleton", "trees", "3"},
    DefaultLevel{"skeleton", "depth", "20"},
    DefaultLevel{"skeleton", "cell, px", "4"},
    DefaultLevel{"skeleton", "fit rounds", "2"},
    DefaultLevel{"skeleton", "tracker", "as shipped"},
    DefaultLevel{"skinning", "blend", "linear"},
    DefaultLevel{"vertex-pulling", "submission", "multi-draw, culled"},
    DefaultLevel{"vertex-pulling", "culling", "zero instances"},
    DefaultLevel{"vertex-pulling", "draw-ID carrier", "firstInstance"},
    DefaultLevel{"zoom", "z", "1"},
};

}  // namespace

std::span<const DefaultLevel> default_levels() {
    return kDefaultLevels;
}

bool is_default_level(std::string_view bench, std::string_view knob, std::string_view level,
                      std::string_view case_name) {
    return std::any_of(kDefaultLevels.begin(), kDefaultLevels.end(), [&](const DefaultLevel& d) {
        return d.bench == bench && d.knob == knob && d.level == level &&
               case_name.find(d.only_case) != std::string_view::npos;
    });
}

}  // namespace kino::bench
