#pragma once

#include <span>
#include <string_view>

#include "apps/bench/bench.h"

namespace kino {

// The entries; each is defined in the file of its name.
void bench_filters(BenchContext& context);
void bench_gestures(BenchContext& context);
void bench_joint_filters(BenchContext& context);
void bench_codecs(BenchContext& context);
void bench_lbvh(BenchContext& context);
void bench_raster(BenchContext& context);
void bench_skinning(BenchContext& context);
void bench_forward_plus(BenchContext& context);
void bench_one_bounce(BenchContext& context);
void bench_supersampling(BenchContext& context);
void bench_vertex_pulling(BenchContext& context);
void bench_framebuffer_lod(BenchContext& context);
void bench_lod_knobs(BenchContext& context);
void bench_registration(BenchContext& context);
void bench_calibration(BenchContext& context);
void bench_forest(BenchContext& context);
void bench_bodies(BenchContext& context);
void bench_zoom(BenchContext& context);
void bench_governor(BenchContext& context);
void bench_multiresolution(BenchContext& context);

namespace bench {

struct Entry {
    std::string_view name;
    std::string_view description;
    void (*run)(BenchContext&);
    std::string_view page{};  ///< name of the page and its files, where not that of the entry
};

/// All entries of this build, by name.
[[nodiscard]] std::span<const Entry> entries();

}  // namespace bench
}  // namespace kino
