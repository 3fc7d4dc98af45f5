#pragma once

#include <condition_variable>
#include <map>
#include <mutex>
#include <string>
#include <thread>
#include <vector>

#include "sensor/source.h"

namespace kino {

/// A device's knobs for a user interface that must not wait: a thread of its own asks and sets
/// them, and knobs() tells what it last knew.
class ControlsDesk {
  public:
    struct Knob {
        Control control;
        double value = 0;   ///< what the user set, until the device has answered
        std::string error;  ///< of the last try; empty while all is well
    };

    /// `controls` outlives the desk.
    explicit ControlsDesk(Controls& controls);
    ~ControlsDesk();
    ControlsDesk(const ControlsDesk&) = delete;
    ControlsDesk& operator=(const ControlsDesk&) = delete;

    [[nodiscard]] std::vector<Knob> knobs() const;
    /// Returns at once; of several values for one knob the last is set.
    void set(const std::string& id, double value);

  private:
    void run();
    void ask_all();

    Controls& controls_;
    mutable std::mutex mutex_;
    std::condition_variable changed_;
    std::vector<Knob> knobs_;
    std::map<std::string, double> wanted_;
    bool stopping_ = false;
    std::thread thread_;
};

}  // namespace kino
