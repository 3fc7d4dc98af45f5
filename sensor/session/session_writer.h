#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "base/camera_model.h"
#include "base/error.h"
#include "sensor/codec/image_codec.h"
#include "sensor/session/cluster_builder.h"
#include "sensor/session/frame_note.h"
#include "sensor/session/recorder.h"
#include "sensor/session/recording_file.h"
#include "sensor/session/session_layout.h"
#include "sensor/session/session_text.h"

namespace kino {

/// What a session file is made of, put together on one thread. Calls take the host's clock as
/// `now`, so that the same calls write the same file. Every error is one of the file; frames that
/// cannot be coded become "refused" events.
class SessionWriter {
  public:
    SessionWriter(std::unique_ptr<RecordingFile> file, SourceInfo source, RigParameters rig,
                  RecorderOptions options, std::int64_t date_ns);

    /// `frame` is of id.kind and not null; `bytes` is what it weighs in memory.
    Result<void> put(StreamId id, const StreamFrame& frame, std::size_t bytes, TimeNs now);
    Result<void> put_event(const SessionEvent& event, TimeNs now);
    Result<void> put_pose(const SessionPose& pose, TimeNs now);
    /// To be called when due(): writes what has waited long enough.
    Result<void> tick(TimeNs now);
    /// When tick() has something to do; none while nothing waits.
    [[nodiscard]] std::optional<TimeNs> due() const;
    /// Cluster, index, head. After an error it saves what can be saved. Nothing may follow.
    Result<void> finish(TimeNs now);

    [[nodiscard]] std::int64_t frames_written() const { return frames_written_; }
    [[nodiscard]] std::int64_t refused() const { return refused_; }
    [[nodiscard]] std::uint64_t file_size() const { return file_->size(); }
    [[nodiscard]] TimeNs duration() const;  ///< from the first frame's time to the last one's

  private:
    struct Waiting {
        StreamId id;
        StreamFrame frame;
    };
    struct Coder {
        StreamFormat wanted;  ///< as the frame and the options ask for it
        StreamFormat format;  ///< as it is coded: raw where the codec has not the layout
        std::unique_ptr<ImageEncoder> encoder;
        int track = 0;  ///< 0: frames bring their format
    };
    struct Picture {
        StreamFormat format;
        const FrameHeader* header = nullptr;
        const std::vector<RowRange>* damaged_rows = nullptr;
        std::span<const std::uint8_t> pixels;
    };

    [[nodiscard]] bool all_seen() const;
    Result<Picture> picture_of(StreamId id, const StreamFrame& frame);
    Result<Coder*> coder_of(const StreamFormat& wanted);
    Result<void> start(TimeNs now);
    Result<void> write_frame(const Waiting& frame, TimeNs now);
    Result<void> write_picture(const Waiting& frame, TimeNs now);
    Result<void> write_text(TrackRole role, int device, TimeNs time, const std::string& text,
                            TimeNs now);
    Result<void> refuse(const Waiting& frame, const std::string& why, TimeNs now);
    Result<void> add(const ClusterBlock& block, bool is_frame, TimeNs now);
    Result<void> flush(TimeNs now);
    Result<void> sync(TimeNs now);
    Result<void> close_file();
    [[nodiscard]] std::int64_t tick_of(TimeNs host_time) const;

    std::unique_ptr<RecordingFile> file_;
    SourceInfo source_;
    RigParameters rig_;
    RecorderOptions options_;
    SessionHead head_;
    bool started_ = false;
    bool failed_ = false;
    std::vector<Waiting> waiting_;  ///< before the head is written
    std::vector<SessionEvent> waiting_events_;
    std::vector<SessionPose> waiting_poses_;
    std::size_t waiting_bytes_ = 0;
    std::optional<TimeNs> waiting_since_;
    std::vector<SessionTrack> tracks_;
    std::vector<Coder> coders_;
    std::vector<std::uint8_t> packed_;
    TimeNs origin_ = 0;
    TimeNs first_time_ = 0;
    TimeNs last_time_ = 0;
    bool any_time_ = false;
    ClusterBuilder cluster_;
    std::optional<SessionCue> cluster_cue_;
    std::int64_t cluster_frames_ = 0;
    TimeNs cluster_since_ = 0;
    std::vector<SessionCue> cues_;
    std::uint64_t good_size_ = 0;  ///< the file up to its last whole cluster
    std::int64_t frames_written_ = 0;
    std::int64_t refused_ = 0;
    bool synced_ = true;
    TimeNs synced_at_ = 0;          ///< host clock
    std::int64_t synced_tick_ = 0;  ///< data time
};

}  // namespace kino
