// Draws contact sheets of actors to look at: docs/actors.md says how.
#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdlib>
#include <memory>
#include <string>

#include "base/check.h"
#include "sensor/png_io.h"
#include "skeleton/actors/actor_images.h"
#include "skeleton/actors/actor_sequence.h"

namespace {

using namespace kino;

Rgba8 shade(float z_m, float near, float far) {
    if (!(z_m > 0)) return {0, 0, 0, 255};
    const float t = std::clamp((z_m - near) / (far - near), 0.0f, 1.0f);
    const auto v = static_cast<std::uint8_t>(240 - 190 * t);
    return {v, v, v, 255};
}

// Far apart for neighbours; the person's left is warm, the right cold.
Rgba8 part_color(int part) {
    if (part == kNotBody) return {0, 0, 0, 255};
    constexpr Rgba8 kColors[kBodyPartCount] = {
        {250, 230, 180, 255}, {160, 120, 60, 255},  {255, 150, 40, 255},  {200, 80, 20, 255},
        {60, 150, 255, 255},  {30, 70, 190, 255},   {255, 80, 80, 255},   {170, 20, 40, 255},
        {255, 190, 200, 255}, {230, 60, 150, 255},  {255, 255, 60, 255},  {60, 220, 220, 255},
        {10, 120, 130, 255},  {150, 235, 170, 255}, {30, 150, 70, 255},   {200, 120, 255, 255},
        {250, 120, 120, 255}, {150, 60, 60, 255},   {255, 200, 120, 255}, {190, 140, 50, 255},
        {255, 60, 220, 255},  {120, 170, 255, 255}, {60, 80, 140, 255},   {120, 240, 255, 255},
        {40, 160, 190, 255},  {120, 60, 220, 255}};
    return kColors[part];
}

void put(Image<Rgba8>& sheet, int x, int y, Rgba8 c) {
    if (sheet.contains(x, y)) sheet.at(x, y) = c;
}

int images_sheet(std::uint64_t seed, int first, int columns, int rows, const std::string& path) {
    constexpr int kCell = 180;
    auto images = ActorImages::create(
                      {.seed = seed, .count = first + columns * rows, .width = 640, .height = 480})
                      .value();
    Image<Rgba8> sheet(columns * kCell * 2, rows * kCell, {40, 40, 40, 255});
    TrainingImage picture;
    for (int i = 0; i < columns * rows; ++i) {
        KINO_CHECK(images->load(first + i, picture));
        const int w = picture.label.width(), h = picture.label.height();
        const int step = std::max(1, (std::max(w, h) + kCell - 1) / kCell);
        float near = 100, far = 0;
        for (const std::uint16_t mm : picture.depth_mm.pixels()) {
            if (mm == 0) continue;
            near = std::min(near, static_cast<float>(mm) / 1000);
            far = std::max(far, static_cast<float>(mm) / 1000);
        }
        for (int y = 0; y < h; y += step) {
            for (int x = 0; x < w; x += step) {
                const int px = (i % columns) * kCell * 2 + x / step,
                          py = (i / columns) * kCell + y / step;
                put(sheet, px, py,
                    shade(static_cast<float>(picture.depth_mm.at(x, y)) / 1000, near, far));
                put(sheet, px + kCell, py, part_color(picture.label.at(x, y)));
            }
        }
    }
    return write_png_rgba8(path, sheet, {.compression = 9}) ? 0 : 1;
}

int take_sheet(const ActorTake& take, int columns, int rows, const std::string& path) {
    auto sequence = ActorSequence::create(take);
    if (!sequence) {
        fmt::print("{}\n", sequence.error().to_string());
        return 1;
    }
    const int w = take.width, h = take.height;
    Image<Rgba8> sheet(columns * w, rows * h, {40, 40, 40, 255});
    ActorFrame frame;
    const CameraModel camera = (*sequence)->rig().depth;
    for (int i = 0; i < columns * rows; ++i) {
        (*sequence)->render((*sequence)->frames() * i / (columns * rows), frame);
        const int left = (i % columns) * w, top = (i / columns) * h;
        for (int y = 0; y < h; ++y) {
            for (int x = 0; x < w; ++x) {
                Rgba8 c = shade(frame.depth_m.at(x, y), 0.6f, 6.0f);
                if (frame.part.at(x, y) != kNotBody) {
                    const Rgba8 p = part_color(frame.part.at(x, y));
                    c = {static_cast<std::uint8_t>((c.r + p.r) / 2),
                         static_cast<std::uint8_t>((c.g + p.g) / 2),
                         static_cast<std::uint8_t>((c.b + p.b) / 2), 255};
                }
                put(sheet, left + x, top + y, c);
            }
        }
        for (const Body& body : frame.truth.bodies) {
            for (const JointPosition& j : body.joints) {
                const int x = static_cast<int>(
                    std::lround(camera.fx * double(j.position_m.x / j.position_m.z) + camera.cx));
                const int y = static_cast<int>(
                    std::lround(camera.fy * double(j.position_m.y / j.position_m.z) + camera.cy));
                const Rgba8 c = j.state == JointState::tracked ? Rgba8{255, 255, 255, 255}
                                                               : Rgba8{255, 0, 0, 255};
                for (int d = -2; d <= 2; ++d) {
                    if (x >= 0 && x < w && y >= 0 && y < h) {
                        put(sheet, left + std::clamp(x + d, 0, w - 1), top + y, c);
                        put(sheet, left + x, top + std::clamp(y + d, 0, h - 1), c);
                    }
                }
            }
        }
    }
    return write_png_rgba8(path, sheet) ? 0 : 1;
}

int time_all() {
    using Clock = std::chrono::steady_clock;
    const auto seconds = [](Clock::time_point since) {
        return std::chrono::duration<double>(Clock::now() - since).count();
    };
    auto images = ActorImages::create({.seed = 5, .count = 200}).value();
    TrainingImage picture;
    auto start = Clock::now();
    std::size_t pixels = 0;
    for (int i = 0; i < 200; ++i) {
        KINO_CHECK(images->load(i, picture));
        pixels += picture.label.size();
    }
    fmt::print("training pictures: {:.1f} ms each, {} px\n", seconds(start) * 5, pixels / 200);
    auto sequence = ActorSequence::create({.seed = 5, .motion = "dance"}).value();
    ActorFrame frame;
    start = Clock::now();
    for (int i = 0; i < 100; ++i) sequence->render(i, frame);
    fmt::print("take of one person at 320x240: {:.1f} ms a frame\n", seconds(start) * 10);
    return 0;
}

}  // namespace

// actors_sheet images SEED FIRST COLUMNS ROWS OUT.png | take SEED MOTION ACTORS COLUMNS ROWS
// OUT.png | time
int main(int argc, char** argv) {
    const auto number = [&](int i) { return std::atoi(argv[i]); };
    if (argc == 7 && std::string(argv[1]) == "images") {
        return images_sheet(static_cast<std::uint64_t>(number(2)), number(3), number(4), number(5),
                            argv[6]);
    }
    if (argc == 8 && std::string(argv[1]) == "take") {
        ActorTake take;
        take.seed = static_cast<std::uint64_t>(number(2));
        take.motion = argv[3];
        take.actors = number(4);
        return take_sheet(take, number(5), number(6), argv[7]);
    }
    if (argc == 2 && std::string(argv[1]) == "time") return time_all();
    fmt::print("see the source for the arguments\n");
    return 2;
}
