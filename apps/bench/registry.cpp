#include "apps/bench/registry.h"

#include <iterator>

namespace kino::bench {

namespace {
void no_entry(BenchContext&) {}

// The last one only keeps the array from being empty in a build without entries.
constexpr Entry kEntries[] = {
#ifdef KINO_BENCH_FILTERS
    {"filters", "depth filters against synthetic truth, real frames and librealsense's defaults",
     &bench_filters},
#endif
#ifdef KINO_BENCH_GESTURES
    {"gestures", "recall and precision of the gestures on scripts, noise and logs of people",
     &bench_gestures},
#endif
#ifdef KINO_BENCH_JOINT_FILTERS
    {"joint-filters", "lag and jitter of the joint filters on logs of body trackers",
     &bench_joint_filters},
#endif
#ifdef KINO_BENCH_CODECS
    {"codecs", "lossless codecs of sessions against zstd, lz4, PNG and RVL", &bench_codecs},
#endif
#ifdef KINO_BENCH_LBVH
    {"lbvh", "rays through the stackless tree against stack, Embree and loops; ray-cast shadows",
     &bench_lbvh},
#endif
#ifdef KINO_BENCH_RASTER
    {"raster", "drawing paths against the hardware path and the double-precision rasteriser",
     &bench_raster},
#endif
#ifdef KINO_BENCH_SKINNING
    {"skinning", "matrices against dual quaternions: times, and what a twisted limb loses",
     &bench_skinning},
#endif
#ifdef KINO_BENCH_VERTEX_PULLING
    {"vertex-pulling", "many draws in one call against one call each and fixed vertex input",
     &bench_vertex_pulling},
#endif
#ifdef KINO_BENCH_FRAMEBUFFER_LOD
    {"framebuffer-lod", "geometry-aware resizing against shading every pixel and bilinear resizing",
     &bench_framebuffer_lod},
#endif
#ifdef KINO_BENCH_LOD_KNOBS
    {"lod-knobs", "guides, kernels and tolerances of geometry-aware resizing, turned one by one",
     &bench_lod_knobs},
#endif
#ifdef KINO_BENCH_MULTIRESOLUTION
    {"multiresolution", "parts of the light at rates of their own, and tiles, against one rate",
     &bench_multiresolution},
#endif
#ifdef KINO_BENCH_REGISTRATION
    {"registration", "depth to colour against the double reference and OpenCV",
     &bench_registration},
#endif
#ifdef KINO_BENCH_CALIBRATION
    {"calibration", "cameras from boards against synthetic truth, OpenCV and published values",
     &bench_calibration},
#endif
#ifdef KINO_BENCH_FOREST
    {"forest", "body parts of our forest and of the pretrained one", &bench_forest},
#endif
#ifdef KINO_BENCH_BODIES
    {"bodies", "joints of tracked bodies: error, jitter, lag and time", &bench_bodies, "skeleton"},
#endif
#ifdef KINO_BENCH_ZOOM
    {"zoom", "coarser pictures enlarged by copies: copies, scenes, and a head before a window",
     &bench_zoom},
#endif
#ifdef KINO_BENCH_FORWARD_PLUS
    {"forward-plus", "lights in lists against deferred, clustered, host lists and brute force",
     &bench_forward_plus},
#endif
#ifdef KINO_BENCH_ONE_BOUNCE
    {"one-bounce", "virtual lights against a double-precision sum over what a torch shines on",
     &bench_one_bounce},
#endif
#ifdef KINO_BENCH_SUPERSAMPLING
    {"supersampling", "edges smoothed from one sample's light against four shaded samples",
     &bench_supersampling},
#endif
#ifdef KINO_BENCH_GOVERNOR
    {"governor", "the frame budget on a stage with disturbances, against fixed settings",
     &bench_governor},
#endif
    {"", "", &no_entry, {}},
};
}  // namespace

std::span<const Entry> entries() {
    return std::span(kEntries).first(std::size(kEntries) - 1);
}

}  // namespace kino::bench
