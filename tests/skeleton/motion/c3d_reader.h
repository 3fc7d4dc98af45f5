#pragma once

#include <array>
#include <map>
#include <string>
#include <vector>

namespace kino::test {

/// A slow reader of C3D files with float points in the PC's byte order, after the format's public
/// user guide; shares nothing with the writer. Throws std::runtime_error.
struct C3dParameter {
    int type = 0;  ///< -1 text, 1 bytes, 2 integers, 4 reals
    std::vector<int> dimensions;
    std::string bytes;
    [[nodiscard]] int integer(int i = 0) const;
    [[nodiscard]] float real(int i = 0) const;
    [[nodiscard]] std::vector<std::string> texts() const;  ///< without trailing spaces
};

struct C3dPoint {
    float x, y, z, residual;
};

struct C3dFile {
    int points = 0, first_frame = 0, last_frame = 0, data_block = 0;
    float scale = 0, rate_hz = 0;
    std::map<std::string, C3dParameter> parameters;  ///< "GROUP:NAME"
    std::vector<std::vector<C3dPoint>> frames;
};

[[nodiscard]] C3dFile read_c3d(const std::string& bytes);

}  // namespace kino::test
