#include <fmt/format.h>

#include <chrono>
#include <thread>
#include <utility>

#include "sensor/convert/sinks.h"
#include "sensor/convert/staged_output.h"

namespace kino {
namespace {

class SessionSink final : public FrameSink {
  public:
    SessionSink(StagedOutput output, std::unique_ptr<Recorder> recorder)
        : output_(std::move(output)), recorder_(std::move(recorder)) {}

    bool takes_sets() const override { return false; }

    Result<void> put(StreamId id, const StreamFrame& frame,
                     const std::optional<Pose>& pose) override {
        wait_for_disk();
        const auto* depth = std::get_if<std::shared_ptr<const DepthFrame>>(&frame);
        const bool posed = pose && depth && id.device == 0;
        if (posed) {
            FrameSet set;
            set.depth = *depth;
            set.world_from_depth = *pose;
            set.pose_origin = PoseOrigin::trajectory;
            recorder_->put(set);
        } else {
            recorder_->put(id, frame);
        }
        count(id.kind);
        const std::string error = recorder_->status().error;
        if (!error.empty()) return fail(error);
        return {};
    }

    void put_event(const Event& event) override { recorder_->put_event(event); }

    Result<void> finish() override {
        KINO_ASSIGN(const RecorderStatus status, recorder_->close());
        if (!status.error.empty()) return fail(status.error);
        if (status.frames == 0)
            return fail("there is no frame to write", output_.target().string());
        losses_.add("frames that could not be written", status.dropped);
        return output_.commit();
    }

  private:
    /// The recorder never waits; a conversion may, and so loses nothing.
    void wait_for_disk() const {
        constexpr double kFull = 0.5;
        while (recorder_->status().queue_fill > kFull && recorder_->status().error.empty()) {
            std::this_thread::sleep_for(std::chrono::milliseconds(1));
        }
    }

    StagedOutput output_;
    std::unique_ptr<Recorder> recorder_;  // last: it closes the file before that is taken away
};

}  // namespace

Result<std::unique_ptr<FrameSink>> make_session_sink(const std::filesystem::path& file,
                                                     const ConvertInput& input,
                                                     const SinkOptions& options) {
    KINO_ASSIGN(StagedOutput output, StagedOutput::file(file, options.replace));
    KINO_ASSIGN(auto recorder,
                Recorder::create(output.path(), input.source, input.rig, {.codec = options.codec}));
    return std::make_unique<SessionSink>(std::move(output), std::move(recorder));
}

}  // namespace kino
