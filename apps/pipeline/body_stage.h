#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "apps/pipeline/processed_frame.h"
#include "calibration/rig.h"
#include "skeleton/filters/filter_bank.h"
#include "skeleton/gestures/gesture_recognizer.h"
#include "skeleton/tracking/body_tracker.h"

namespace kino {

/// Where bodies come from.
enum class BodyMode : std::uint8_t {
    off,       ///< those of a recording are shown, and its gestures; nothing is computed
    on,        ///< found in the depth
    recorded,  ///< those of the recording, gestures recognised anew
};
[[nodiscard]] const char* body_mode_name(BodyMode mode);

struct BodyOptions {
    BodyMode mode = BodyMode::off;
    std::filesystem::path forest;    ///< empty: default_forest()
    std::filesystem::path gestures;  ///< definitions as JSON; empty: those compiled in
    /// As make_body_filter() takes it; empty: the tracker's own, and none for recorded bodies.
    std::string joint_filter;
    bool seated = false;         ///< ten joints, for people behind desks
    bool moving_sensor = false;  ///< no background is learned
};

/// One picture's bodies, filtered; returns what it took.
using BodyFinder =
    std::function<TrackingTimes(const Image<float>& depth_m, TimeNs time,
                                const std::optional<glm::vec3>& specific_force, BodyFrame& out)>;

/// The last stage of a frame: its bodies, and the gestures they make. One thread at a time.
class BodyStage {
  public:
    /// `rig`: of the pictures that will come. Null for BodyMode::off. Fails for forests,
    /// definitions and filters that cannot be had.
    [[nodiscard]] static Result<std::unique_ptr<BodyStage>> create(const BodyOptions& options,
                                                                   const Rig& rig);

    /// `finder` null: bodies are the recording's.
    BodyStage(BodyFinder finder, std::optional<FilterBank> filter, GestureDefinitions definitions);

    /// Replaces the bodies of the frame's set, and gives it gestures and times. A frame of a
    /// timeline that goes or went back a little has the bodies it had before and no gestures: the
    /// tracker knows no backwards.
    void process(ProcessedFrame& frame);

    [[nodiscard]] std::uint32_t primary_id() const { return recognizer_.primary_id(); }

  private:
    struct Known {
        std::shared_ptr<const BodyFrame> bodies;
        std::uint32_t primary_id = 0;
    };
    [[nodiscard]] const Known* known(std::int64_t index);

    BodyFinder finder_;
    std::optional<FilterBank> filter_;
    GestureRecognizer recognizer_;
    std::map<std::int64_t, Known> known_;  ///< by index, of what was played without a jump
    std::int64_t last_index_ = -1;
};

}  // namespace kino
