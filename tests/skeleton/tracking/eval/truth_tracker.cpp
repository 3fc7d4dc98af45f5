#include "tests/skeleton/tracking/eval/truth_tracker.h"

#include <algorithm>
#include <cmath>

#include "skeleton/forest/training_images.h"
#include "skeleton/tracking/stage_clock.h"

namespace kino::test {

void TruthTracker::add_labelled(const TakeFrame& frame, std::uint8_t id, int step) {
    Image<std::uint16_t> mm(rays_.width(), rays_.height());
    for (std::size_t i = 0; i < mm.size(); ++i) {
        mm.data()[i] = static_cast<std::uint16_t>(
            std::clamp(frame.depth_m.data()[i] * 1000 + 0.5f, 0.0f, 32000.0f));
    }
    const Image<std::uint16_t>& depth = mm;
    body_depth_.set(depth.view(), frame.actor.view(), id, static_cast<double>(camera_.fx), step);
    labeller_->label(body_depth_, labels_);
    std::array<float, kBodyPartCount> share{};
    for (std::size_t i = 0; i < body_depth_.count(); ++i) {
        const int x = body_depth_.x(i), y = body_depth_.y(i);
        const float z = frame.depth_m.at(x, y);
        labeller_->shares(labels_, i, share);
        points_.add({rays_.at(x, y).x * z, rays_.at(x, y).y * z, z}, share);
    }
}

BodyFrame TruthTracker::track(const TakeFrame& frame, const FloorPlane& floor) {
    BodyFrame out;
    out.time = frame.time;
    modes_ms = fit_ms = 0;
    for (const Body& truth : frame.truth.bodies) {
        const auto id = static_cast<std::uint8_t>(truth.id);
        PixelBox box{rays_.width(), rays_.height(), 0, 0};
        int pixels = 0;
        double depth = 0;
        for (int y = 0; y < rays_.height(); ++y) {
            for (int x = 0; x < rays_.width(); ++x) {
                if (frame.actor.at(x, y) != id || !(frame.depth_m.at(x, y) > 0)) continue;
                box = {std::min(box.x0, x), std::min(box.y0, y), std::max(box.x1, x + 1),
                       std::max(box.y1, y + 1)};
                ++pixels;
                depth += static_cast<double>(frame.depth_m.at(x, y));
            }
        }
        if (pixels == 0) continue;
        const int step =
            std::clamp(static_cast<int>(std::lround(std::sqrt(pixels / 1800.0))), 1, 8);
        points_.clear();
        if (labeller_) add_labelled(frame, id, step);
        std::array<float, kBodyPartCount> share{};
        for (int y = box.y0; !labeller_ && y < box.y1; y += step) {
            for (int x = box.x0; x < box.x1; x += step) {
                const float z = frame.depth_m.at(x, y);
                const std::uint8_t part = frame.part.at(x, y);
                if (frame.actor.at(x, y) != id || !(z > 0) || part == kNotBody) continue;
                share.fill(0);
                share[part] = 1;
                points_.add({rays_.at(x, y).x * z, rays_.at(x, y).y * z, z}, share);
            }
        }
        StageClock clock;
        const float tangent = static_cast<float>(step) / camera_.fx;
        modes_.find(points_, tangent);
        modes_ms += static_cast<double>(clock.lap()) * 1e-6;
        space_.set(frame.depth_m, frame.actor, id, box, std::max(2, step),
                   static_cast<float>(depth / pixels));
        PersonView view;
        view.points = &points_;
        view.modes = &modes_;
        view.space = &space_;
        view.camera = camera_;
        view.floor = floor;
        view.cell_tangent = tangent;
        PersonSkeleton& skeleton = skeletons_.try_emplace(truth.id, options_).first->second;
        if (skeleton.update(view, frame.time)) {
            Body body;
            body.id = truth.id;
            body.joints = skeleton.joints();
            out.bodies.push_back(body);
        }
        fit_ms += static_cast<double>(clock.lap()) * 1e-6;
    }
    return out;
}

}  // namespace kino::test
