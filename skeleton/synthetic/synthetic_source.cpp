#include "skeleton/synthetic/synthetic_source.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <optional>
#include <utility>

#include "base/check.h"
#include "skeleton/synthetic/color_sensor.h"
#include "skeleton/synthetic/frame_pool.h"

namespace kino {
namespace {

constexpr std::array<StreamKind, 3> kKinds = {StreamKind::depth, StreamKind::color,
                                              StreamKind::bodies};

class SyntheticPlayer final : public SyntheticSource {
  public:
    SyntheticPlayer(SyntheticScene scene, const DepthSensorOptions& sensor, std::string uri)
        : scene_(std::move(scene)),
          depth_sensor_(scene_.rig, sensor),
          frames_(std::max<std::int64_t>(1, std::lround(scene_.seconds * kRateHz))) {
        info_.uri = std::move(uri);
        info_.name = fmt::format("synthetic {}",
                                 scene_.name.empty() ? motion_name(scene_.motion) : scene_.name);
        info_.serial = scene_.rig.serial;
        info_.note = scene_.rig.note;
        info_.licence = "Apache-2.0";
        const CameraModel& depth = scene_.rig.depth;
        info_.streams.push_back({{0, StreamKind::depth},
                                 depth.width,
                                 depth.height,
                                 kRateHz,
                                 "11-bit Kinect disparity"});
        if (scene_.rig.color) {
            info_.streams.push_back({{0, StreamKind::color},
                                     scene_.rig.color->width,
                                     scene_.rig.color->height,
                                     kRateHz,
                                     "rgba 8 bit"});
        }
        if (scene_.tells_joints) {
            info_.streams.push_back({{0, StreamKind::bodies}, 0, 0, kRateHz, "20 true joints"});
        }
    }

    const SyntheticScene& scene() const override { return scene_; }
    const SourceInfo& info() const override { return info_; }
    Result<RigParameters> calibration() const override { return scene_.rig; }
    Timeline* timeline() override { return this; }

    Result<void> subscribe(StreamId id) override {
        for (const StreamInfo& stream : info_.streams) {
            if (stream.id == id) {
                wanted(id.kind) = true;
                return {};
            }
        }
        return fail(fmt::format("the synthetic sensor has no {} stream of device {}",
                                stream_name(id.kind), id.device),
                    info_.uri);
    }
    void unsubscribe(StreamId id) override {
        if (id.device == 0 && std::ranges::find(kKinds, id.kind) != kKinds.end()) {
            wanted(id.kind) = false;
        }
    }

    Result<std::optional<FrameSet>> next(TimeNs) override {
        if (!std::exchange(started_, true)) events_.push_back({EventKind::started, 0, info_.name});
        if (position_ >= frames_) {
            if (!std::exchange(ended_, true)) {
                events_.push_back({EventKind::ended, time_at(frames_), info_.name});
            }
            return std::nullopt;
        }
        return frame_set(position_++);
    }
    std::vector<Event> take_events() override { return std::exchange(events_, {}); }

    std::int64_t frame_count() const override { return frames_; }
    TimeNs time_of(std::int64_t index) const override {
        KINO_CHECK(index >= 0 && index < frames_);
        return time_at(index);
    }
    TimeNs last_frame_duration() const override { return time_at(frames_) - time_at(frames_ - 1); }
    std::int64_t position() const override { return position_; }
    Result<void> seek(std::int64_t index) override {
        if (index < 0 || index >= frames_) {
            return fail(fmt::format("frame {} is outside 0 to {}", index, frames_ - 1), info_.uri);
        }
        position_ = index;
        ended_ = false;
        return {};
    }

    SyntheticTruth truth(std::int64_t index) override {
        const Visibility& seen = look(index);
        const int width = seen.view().width(), height = seen.view().height();
        SyntheticTruth out{seen.z_m(),
                           Image<PartId>(width, height),
                           Image<std::uint8_t>(width, height),
                           {time_of(index), scene_.bodies_at(seconds_at(index))}};
        for (std::size_t i = 0; i < out.part.size(); ++i) {
            const std::int32_t id = seen.id().pixels()[i];
            out.part.pixels()[i] = seen.part_of(id);
            out.lit.pixels()[i] = seen.lit().pixels()[i] != 0;
            if (id < 0) out.depth_m.pixels()[i] = 0;
        }
        return out;
    }

  private:
    static TimeNs time_at(std::int64_t index) {
        return from_seconds(static_cast<double>(index) / kRateHz);
    }
    static double seconds_at(std::int64_t index) { return static_cast<double>(index) / kRateHz; }

    bool& wanted(StreamKind kind) {
        const auto at = std::find(kKinds.begin(), kKinds.end(), kind);
        KINO_CHECK(at != kKinds.end());
        return wanted_[static_cast<std::size_t>(at - kKinds.begin())];
    }

    // The still part of each picture is made when a stream is first asked for.
    const Visibility& look(std::int64_t index) {
        if (!depth_view_) {
            depth_view_.emplace(scene_,
                                CastView(scene_.rig.depth, inverse(scene_.world_from_depth)),
                                scene_.emitter_x_m());
        }
        scene_.person_at(seconds_at(index), person_);
        depth_view_->draw(person_);
        return *depth_view_;
    }

    FrameSet frame_set(std::int64_t index) {
        FrameSet set;
        set.index = index;
        set.time = time_of(index);
        set.world_from_depth = scene_.world_from_depth;
        set.pose_origin = PoseOrigin::floor;
        const FrameHeader header{set.time, set.time, index, 0};
        const std::vector<Body> bodies = scene_.bodies_at(seconds_at(index));
        if (wanted(StreamKind::depth)) {
            auto frame = depth_frames_.take();
            frame->header = header;
            frame->unit = DepthUnit::kinect_disparity11;
            depth_sensor_.measure(look(index), index, frame->raw);
            set.depth = std::move(frame);
        }
        if (wanted(StreamKind::color)) {
            set.color = color_frame(index, header, bodies);
            set.color_paired = true;
        }
        if (wanted(StreamKind::bodies)) {
            set.bodies = std::make_shared<const BodyFrame>(BodyFrame{set.time, bodies});
        }
        return set;
    }

    std::shared_ptr<const ColorFrame> color_frame(std::int64_t index, const FrameHeader& header,
                                                  const std::vector<Body>& bodies) {
        if (!color_sensor_) color_sensor_.emplace(scene_);
        scene_.person_at(seconds_at(index), person_);
        const CameraModel& camera = *scene_.rig.color;
        rgba_.resize(static_cast<std::size_t>(camera.width) *
                     static_cast<std::size_t>(camera.height));
        color_sensor_->draw(person_, bodies.empty() ? nullptr : &bodies.front(), rgba_);
        auto frame = color_frames_.take();
        frame->header = header;
        frame->format = PixelFormat::rgba8;
        frame->width = camera.width;
        frame->height = camera.height;
        frame->pitch = camera.width * 4;
        frame->bytes.resize(rgba_.size() * 4);
        std::memcpy(frame->bytes.data(), rgba_.data(), frame->bytes.size());
        return frame;
    }

    SyntheticScene scene_;
    SourceInfo info_;
    DepthSensor depth_sensor_;
    std::int64_t frames_;
    std::array<bool, kKinds.size()> wanted_{};
    std::vector<Event> events_;
    std::int64_t position_ = 0;
    bool started_ = false, ended_ = false;

    std::optional<Visibility> depth_view_;
    std::optional<ColorSensor> color_sensor_;
    std::vector<Primitive> person_;
    std::vector<std::uint32_t> rgba_;
    FramePool<DepthFrame> depth_frames_;
    FramePool<ColorFrame> color_frames_;
};

}  // namespace

Result<std::unique_ptr<SyntheticSource>> SyntheticSource::create(SyntheticScene scene,
                                                                 const DepthSensorOptions& sensor,
                                                                 std::string uri) {
    KINO_TRY(validate(scene));
    if (scene.rig.depth.width % 8 != 0 || (scene.rig.color && scene.rig.color->width % 8 != 0)) {
        return fail("picture widths must be multiples of 8", uri);
    }
    return std::make_unique<SyntheticPlayer>(std::move(scene), sensor, std::move(uri));
}

}  // namespace kino
