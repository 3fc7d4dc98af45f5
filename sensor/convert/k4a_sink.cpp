#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <utility>

#include "sensor/color_conversion.h"
#include "sensor/convert/depth_units.h"
#include "sensor/convert/folder_frames.h"
#include "sensor/convert/k4a_calibration.h"
#include "sensor/convert/k4a_head.h"
#include "sensor/convert/sinks.h"
#include "sensor/convert/staged_output.h"

namespace kino {
namespace {

constexpr double kMillimetre = 0.001;
constexpr TimeNs kTick = 1000;  // ns: TimecodeScale 1000
/// Sets that wait for the first frame of each stream, which says how its track is made.
constexpr std::size_t kMostWaiting = 60;

struct FileClose {
    void operator()(std::FILE* file) const { std::fclose(file); }
};

void put_big_endian_16(std::vector<std::uint8_t>& out, const Image<std::uint16_t>& image) {
    out.resize(image.size() * 2);
    for (std::size_t i = 0; i < image.size(); ++i) {
        const std::uint16_t value = image.data()[i];
        out[2 * i] = static_cast<std::uint8_t>(value >> 8);
        out[2 * i + 1] = static_cast<std::uint8_t>(value);
    }
}

class K4aSink final : public FrameSink {
  public:
    K4aSink(StagedOutput output, std::unique_ptr<std::FILE, FileClose> file, ConvertInput input)
        : output_(std::move(output)), file_(std::move(file)), input_(std::move(input)) {
        for (const StreamInfo& stream : input_.source.streams) {
            if (stream.id.device != 0) continue;
            if (stream.id.kind == StreamKind::color) expects_color_ = true;
            if (stream.id.kind == StreamKind::infrared) expects_infrared_ = true;
            if (stream.id.kind == StreamKind::depth) hz_ = stream.nominal_hz;
        }
        if (!input_.rig.color) expects_color_ = false;
    }

    bool takes_sets() const override { return true; }

    Result<void> put(const FrameSet& set) override {
        if (!set.depth) {
            losses_.add("moments without depth");
            return {};
        }
        if (set.bodies) add_unheld(StreamKind::bodies, losses_);
        if (set.motion) add_unheld(StreamKind::motion, losses_);
        if (set.pose_origin == PoseOrigin::trajectory) losses_.add("poses of the camera");
        if (head_written_) return write(set);
        waiting_.push_back(set);
        seen_color_ = seen_color_ || (set.color && set.color_paired);
        seen_infrared_ = seen_infrared_ || set.infrared;
        const bool complete =
            (seen_color_ || !expects_color_) && (seen_infrared_ || !expects_infrared_);
        if (!complete && waiting_.size() < kMostWaiting) return {};
        return write_waiting();
    }

    Result<void> finish() override {
        if (!head_written_) KINO_TRY(write_waiting());
        if (written(StreamKind::depth) == 0) {
            return fail("there is no depth frame to write", output_.target().string());
        }
        const std::uint64_t cues_at = at_;
        EbmlWriter cues;
        write_k4a_cues(cues, cue_points_);
        KINO_TRY(append(cues.bytes()));
        for (const K4aPatch& patch :
             k4a_patches(head_, cues_at, at_, static_cast<double>(last_time_ - origin_) / kTick)) {
            const bool moved =
                std::fseek(file_.get(), static_cast<long>(patch.offset), SEEK_SET) == 0;
            if (!moved || std::fwrite(patch.bytes.data(), 1, patch.bytes.size(), file_.get()) !=
                              patch.bytes.size()) {
                return disk_error();
            }
        }
        if (std::fflush(file_.get()) != 0) return disk_error();
        file_.reset();
        return output_.commit();
    }

  private:
    struct TrackUnit {
        DepthUnit unit;
        double metres_per_unit;
    };
    struct Cut {
        std::uint64_t track;
        TimeNs time;
        std::vector<std::uint8_t> bytes;
    };

    Result<void> write_waiting() {
        if (waiting_.empty()) return fail("there is no depth frame to write");
        KINO_TRY(write_head());
        for (const FrameSet& set : std::exchange(waiting_, {})) KINO_TRY(write(set));
        return {};
    }

    Result<void> write_head() {
        const DepthFrame& depth = *waiting_.front().depth;
        KINO_TRY(check_size("depth", depth.raw.width(), depth.raw.height(), input_.rig.depth));
        clock_.set_by(depth.header);
        origin_ = clock_(depth.header);
        for (const FrameSet& set : waiting_) {
            if (set.color && set.color_paired) {
                origin_ = std::min(origin_, clock_(set.color->header));
            }
            if (set.infrared) origin_ = std::min(origin_, clock_(set.infrared->header));
        }
        origin_ = std::max<TimeNs>(origin_, 0) / kTick * kTick;

        K4aHeadInput head;
        head.rig = input_.rig;
        head.hz = state_rate();
        head.start_offset = origin_;
        const K4aMode* mode = k4a_depth_mode(depth.raw.width(), depth.raw.height());
        head.depth = {depth.raw.width(), depth.raw.height()};
        head.depth_mode = mode ? mode->name : "";
        if (!mode) {
            custom_unit_ = TrackUnit{depth.unit, depth.metres_per_unit};
            head.depth_unit = depth.unit == DepthUnit::linear
                                  ? fmt::format("{}", depth.metres_per_unit)
                                  : "kinect_disparity11";
            losses_.state(fmt::format(
                "an Azure Kinect has no depth mode of {}x{} pixels: depth lies, as it is, in the "
                "custom track KINOSCOPE_DEPTH, which players of k4a recordings do not show",
                depth.raw.width(), depth.raw.height()));
        }
        for (const FrameSet& set : waiting_) {
            if (!head.color && set.color && set.color_paired && expects_color_) {
                head.color = color_track(*set.color);
            }
            if (!head.infrared && set.infrared) {
                head.infrared = {{set.infrared->raw.width(), set.infrared->raw.height()}};
            }
        }
        color_ = head.color;
        infrared_ = head.infrared;
        if (color_ && !k4a_color_mode(color_->size.width, color_->size.height)) {
            losses_.state(
                fmt::format("an Azure Kinect has no colour mode of {}x{} pixels: k4a "
                            "players show the track, but find no calibration",
                            color_->size.width, color_->size.height));
        }
        EbmlWriter bytes;
        KINO_ASSIGN(head_, write_k4a_head(bytes, head));
        head_written_ = true;
        return append(bytes.bytes());
    }

    /// What the format allows: 5, 15 or 30 Hz.
    int state_rate() {
        const double hz = hz_ > 0 ? hz_ : 30;
        int nearest = 30;
        for (const int rate : {5, 15, 30}) {
            if (std::abs(hz - rate) < std::abs(hz - nearest)) nearest = rate;
        }
        if (std::abs(hz - nearest) > 0.05 * nearest) {
            losses_.state(
                fmt::format("{:.1f} frames a second are stated as {}, of 5, 15 and 30 "
                            "the nearest; every frame keeps its own time",
                            hz, nearest));
        }
        return nearest;
    }

    K4aColorTrack color_track(const ColorFrame& frame) {
        K4aColorTrack track{{frame.width, frame.height}, "BGRA"};
        if (frame.format == PixelFormat::mjpeg) track.fourcc = "MJPG";
        if (frame.format == PixelFormat::yuyv || frame.format == PixelFormat::uyvy) {
            track.fourcc = "YUY2";
        }
        if (frame.format == PixelFormat::bayer_grbg8) {
            losses_.state("colour as the camera sent it (Bayer) became BGRA");
        }
        return track;
    }

    Result<void> write(const FrameSet& set) {
        std::vector<Cut> cuts;
        const DepthFrame& depth = *set.depth;
        KINO_TRY(check_size("depth", depth.raw.width(), depth.raw.height(), input_.rig.depth));
        Cut& first = cuts.emplace_back(Cut{kK4aDepthTrack, clock_(depth.header), {}});
        if (custom_unit_) {
            if (depth.unit != custom_unit_->unit ||
                depth.metres_per_unit != custom_unit_->metres_per_unit) {
                return fail("the unit of depth changes within the recording");
            }
            put_big_endian_16(first.bytes, depth.raw);
        } else {
            KINO_ASSIGN(const auto raw,
                        depth_in_units(depth, kMillimetre, *input_.geometry, losses_));
            put_big_endian_16(first.bytes, raw);
        }
        if (!depth.damaged_rows.empty()) {
            losses_.add("depth frames whose damaged rows are no longer marked");
        }
        if (set.color && (!set.color_paired || !color_)) {
            losses_.add("colour frames that belong to no depth frame");
        } else if (set.color && color_repeats_.is_new(set.color->header)) {
            Cut cut{kK4aColorTrack, clock_(set.color->header), {}};
            KINO_TRY(color_bytes(*set.color, cut.bytes));
            cuts.push_back(std::move(cut));
        }
        if (set.infrared && infrared_ && infrared_repeats_.is_new(set.infrared->header)) {
            if (set.infrared->raw.width() != infrared_->width ||
                set.infrared->raw.height() != infrared_->height) {
                return fail("the size of infrared changes within the recording");
            }
            Cut cut{kK4aInfraredTrack, clock_(set.infrared->header), {}};
            put_big_endian_16(cut.bytes, set.infrared->raw);
            cuts.push_back(std::move(cut));
        }
        return write_cluster(std::move(cuts));
    }

    Result<void> color_bytes(const ColorFrame& frame, std::vector<std::uint8_t>& out) {
        if (frame.width != color_->size.width || frame.height != color_->size.height ||
            color_track(frame).fourcc != color_->fourcc) {
            return fail("size or format of colour change within the recording");
        }
        if (frame.format == PixelFormat::mjpeg) {
            out = frame.bytes;
            return {};
        }
        if (color_->fourcc == "YUY2") {
            const auto row = static_cast<std::size_t>(frame.width) * 2;
            const auto pitch = static_cast<std::size_t>(frame.pitch);
            const auto height = static_cast<std::size_t>(frame.height);
            if (pitch < row || frame.bytes.size() < pitch * (height - 1) + row) {
                return fail("a colour frame has too few bytes");
            }
            for (std::size_t y = 0; y < height; ++y) {
                const auto from = frame.bytes.begin() + static_cast<std::ptrdiff_t>(y * pitch);
                out.insert(out.end(), from, from + static_cast<std::ptrdiff_t>(row));
            }
            if (frame.format == PixelFormat::uyvy) {
                for (std::size_t i = 0; i + 1 < out.size(); i += 2) std::swap(out[i], out[i + 1]);
            }
            return {};
        }
        KINO_TRY(to_rgba8(frame, image_));
        out.resize(image_.size() * 4);
        for (std::size_t i = 0; i < image_.size(); ++i) {
            const Rgba8 pixel = image_.data()[i];
            out[4 * i] = pixel.b;
            out[4 * i + 1] = pixel.g;
            out[4 * i + 2] = pixel.r;
            out[4 * i + 3] = pixel.a;
        }
        return {};
    }

    /// One moment a cluster: block times are 16 bits of microseconds, so at most 32 ms apart.
    Result<void> write_cluster(std::vector<Cut> cuts) {
        std::vector<Cut> kept;
        for (Cut& cut : cuts) {
            const TimeNs ticks = (cut.time - origin_) / kTick;
            if (cut.time % kTick != 0) losses_.state("times are whole microseconds");
            TimeNs& last = last_ticks_[static_cast<std::size_t>(cut.track)];
            if (cut.time < origin_ || ticks <= last) {
                losses_.add("frames whose time does not rise");
                continue;
            }
            last = ticks;
            last_time_ = std::max(last_time_, cut.time);
            cut.time = ticks;
            kept.push_back(std::move(cut));
        }
        std::stable_sort(kept.begin(), kept.end(),
                         [](const Cut& a, const Cut& b) { return a.time < b.time; });
        constexpr TimeNs kReach = 32'000;
        while (!kept.empty()) {
            const TimeNs start = kept.front().time;
            const auto end = std::find_if(kept.begin(), kept.end(), [&](const Cut& cut) {
                return cut.time - start > kReach;
            });
            EbmlWriter content;
            content.put_unsigned(ebml::kTimestamp, static_cast<std::uint64_t>(start));
            for (auto cut = kept.begin(); cut != end; ++cut) {
                content.put_head(ebml::kSimpleBlock, cut->bytes.size() + 4);
                content.put_byte(static_cast<std::uint8_t>(0x80 | cut->track));
                content.put_big_endian(static_cast<std::uint64_t>(cut->time - start), 2);
                content.put_byte(0x80);
                content.put_raw(cut->bytes);
                if (cut->track == kK4aDepthTrack) count(StreamKind::depth);
                if (cut->track == kK4aColorTrack) count(StreamKind::color);
                if (cut->track == kK4aInfraredTrack) count(StreamKind::infrared);
            }
            constexpr TimeNs kCueDistance = 1'000'000;
            if (cue_points_.empty() ||
                start - static_cast<TimeNs>(cue_points_.back().time) >= kCueDistance) {
                cue_points_.push_back({static_cast<std::uint64_t>(start), kept.front().track,
                                       at_ - head_.segment_content});
            }
            EbmlWriter cluster;
            cluster.put_master(ebml::kCluster, content);
            KINO_TRY(append(cluster.bytes()));
            kept.erase(kept.begin(), end);
        }
        return {};
    }

    Result<void> append(std::span<const std::uint8_t> bytes) {
        if (std::fwrite(bytes.data(), 1, bytes.size(), file_.get()) != bytes.size()) {
            return disk_error();
        }
        at_ += bytes.size();
        return {};
    }

    tl::unexpected<Error> disk_error() const {
        return fail(std::strerror(errno), output_.target().string());
    }

    StagedOutput output_;
    std::unique_ptr<std::FILE, FileClose> file_;
    ConvertInput input_;
    double hz_ = 0;
    bool expects_color_ = false;
    bool expects_infrared_ = false;
    bool seen_color_ = false;
    bool seen_infrared_ = false;
    std::vector<FrameSet> waiting_;
    bool head_written_ = false;
    std::optional<TrackUnit> custom_unit_;
    K4aHeadPlaces head_;
    std::optional<K4aColorTrack> color_;
    std::optional<PixelSize> infrared_;
    FileClock clock_;
    TimeNs origin_ = 0;
    TimeNs last_time_ = 0;
    std::array<TimeNs, 4> last_ticks_{-1, -1, -1, -1};
    std::vector<K4aCuePoint> cue_points_;
    std::uint64_t at_ = 0;
    Repeats color_repeats_;
    Repeats infrared_repeats_;
    Image<Rgba8> image_;
};

}  // namespace

Result<std::unique_ptr<FrameSink>> make_k4a_sink(const std::filesystem::path& file,
                                                 const ConvertInput& input,
                                                 const SinkOptions& options) {
    KINO_ASSIGN(StagedOutput output, StagedOutput::file(file, options.replace));
    std::unique_ptr<std::FILE, FileClose> opened(std::fopen(output.path().c_str(), "wbx"));
    if (!opened) return fail(std::strerror(errno), output.path().string());
    return std::make_unique<K4aSink>(std::move(output), std::move(opened), input);
}

}  // namespace kino
