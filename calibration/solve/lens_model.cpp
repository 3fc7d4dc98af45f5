#include "calibration/solve/lens_model.h"

namespace kino {

std::string_view name(LensModel model) {
    switch (model) {
        case LensModel::pinhole:
            return "pinhole";
        case LensModel::brown4:
            return "brown4";
        case LensModel::brown5:
            return "brown5";
        case LensModel::rational8:
            return "rational8";
    }
    return "";
}

int free_numbers(LensModel model) {
    switch (model) {
        case LensModel::pinhole:
            return 4;
        case LensModel::brown4:
            return 8;
        case LensModel::brown5:
            return 9;
        case LensModel::rational8:
            return 12;
    }
    return 0;
}

Lens lens_of(const CameraModel& c) {
    return {c.fx, c.fy, c.cx, c.cy, c.k1, c.k2, c.p1, c.p2, c.k3, c.k4, c.k5, c.k6};
}

CameraModel camera_of(const Lens& lens, int width, int height) {
    return {.width = width,
            .height = height,
            .fx = lens[0],
            .fy = lens[1],
            .cx = lens[2],
            .cy = lens[3],
            .k1 = lens[4],
            .k2 = lens[5],
            .k3 = lens[8],
            .k4 = lens[9],
            .k5 = lens[10],
            .k6 = lens[11],
            .p1 = lens[6],
            .p2 = lens[7]};
}

}  // namespace kino
