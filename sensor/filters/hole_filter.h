#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "base/error.h"
#include "sensor/filters/depth_filter.h"
#include "sensor/filters/filter_kernel.h"
#include "sensor/filters/filter_settings.h"

namespace kino {

struct HoleParameters {
    int gap = 8;             ///< widest hole that is bridged, along a row or column, 1 to 250 px
    double steps = 3;        ///< as in FlyingPixelParameters, over the whole gap, 0 to 50
    double angle_deg = 60;   ///< steepest surface drawn across a hole, 0 to 89
    double focal_px = 0;     ///< of the depth camera, 0 to 100000; 0: 0.893 of the width
    int edge = 3;            ///< holes between two surfaces up to this wide are shared, 0 to 250 px
    bool background = true;  ///< where the sides are two surfaces: the farther one, else nothing

    static std::span<const filters::Setting<HoleParameters>> settings();
};

/// Fills holes that have readings on both sides of a row or column at most `gap` apart. Where the
/// sides can be one surface it goes straight across in inverse depth (exact on planes). Where they
/// cannot, a hole of up to `edge` pixels is what sensors lose on both sides of an edge, so each
/// pixel gets the value of the side it is nearer to, the farther one in the middle; a wider one is
/// a shadow and belongs to the farther side. Of row and column the shorter gap decides, of equal
/// ones the farther value. Holes at the picture's border along both axes stay. Only readings of
/// this frame are evidence, never filled pixels; readings are never changed.
class HoleFilter : public DepthFilter {
  public:
    [[nodiscard]] static Result<std::unique_ptr<HoleFilter>> create(
        const HoleParameters& parameters = {}, FilterOptions options = {});

    [[nodiscard]] std::string_view name() const override { return "holes"; }
    void apply(const Image<float>& in, Image<float>& out) override;

  private:
    HoleFilter(const HoleParameters& parameters, FilterOptions options);

    /// One hole between two readings.
    struct Bridge {
        float from_z, to_z;
        float from_inverse, slope;  // 1/m, 1/m a pixel
        int gap;
        bool one_surface, shared;
        [[nodiscard]] float at(int step) const;
    };
    [[nodiscard]] Bridge bridge(float from_z, float to_z, int gap) const;
    void fill_columns(int y, const std::uint64_t* bits, Image<float>& out);
    void fill_row(int y, const std::uint64_t* bits, Image<float>& out);
    void fill_column(int x, int first, int end, Image<float>& out);
    void fill_span(int y, int first, int end, Image<float>& out);

    HoleParameters parameters_;
    const filters::Functions& run_;
    float step_ = 0, slope_ = 0;
    int words_ = 0;
    std::vector<std::uint64_t> bits_;       // readings, a word is 64 pixels of a row
    std::vector<int> hole_start_;           // per column, -1: open to the top
    std::vector<std::uint8_t> column_gap_;  // of filled pixels, 0 elsewhere
};

}  // namespace kino
