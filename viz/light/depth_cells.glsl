// Cells of a tile's depths. The same function places pixels and lights; where lights are concerned
// a thousandth of a cell is added on either side, so that rounding loses none.
layout(constant_id = 1) const uint kCells = 1u;  // as DepthCells: 0 none, 1 linear, 2 logarithmic
layout(constant_id = 2) const uint kCellCount = 32u;

float cell_scale(float min_z, float max_z) {
    // All at one depth: one cell.
    if (max_z - min_z <= 1e-6 * max_z) return 0.0;
    return float(kCellCount) / (kCells == 2u ? log2(max_z / min_z) : max_z - min_z);
}
float cell_of(float z, float min_z, float scale) {
    return (kCells == 2u ? log2(max(z / min_z, 1.0)) : z - min_z) * scale;
}
uint as_cell(float cell) { return uint(clamp(cell, 0.0, float(kCellCount - 1u))); }
uint cells_between(float from, float to) {
    uint low = as_cell(from - 0.001);
    uint high = max(as_cell(to + 0.001), low);
    return (0xFFFFFFFFu << low) & (0xFFFFFFFFu >> (31u - high));
}
