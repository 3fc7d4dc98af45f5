#include "apps/pipeline/controls_desk.h"

#include <algorithm>
#include <chrono>

namespace kino {
namespace {
/// How often the device is asked for what it may have changed by itself (automatic exposure).
constexpr std::chrono::milliseconds kAskAgain(1000);
}  // namespace

ControlsDesk::ControlsDesk(Controls& controls) : controls_(controls) {
    thread_ = std::thread([this] { run(); });
}

ControlsDesk::~ControlsDesk() {
    {
        const std::lock_guard lock(mutex_);
        stopping_ = true;
    }
    changed_.notify_all();
    thread_.join();
}

std::vector<ControlsDesk::Knob> ControlsDesk::knobs() const {
    const std::lock_guard lock(mutex_);
    return knobs_;
}

void ControlsDesk::set(const std::string& id, double value) {
    {
        const std::lock_guard lock(mutex_);
        wanted_[id] = value;
        for (Knob& knob : knobs_) {
            if (knob.control.id == id) knob.value = value;
        }
    }
    changed_.notify_all();
}

void ControlsDesk::ask_all() {
    std::vector<Knob> knobs;
    for (Control& control : controls_.list()) {
        {
            const std::lock_guard lock(mutex_);
            if (stopping_) return;
        }
        Knob knob{.control = std::move(control)};
        const auto value = controls_.get(knob.control.id);
        if (value) {
            knob.value = *value;
        } else {
            knob.error = value.error().to_string();
        }
        knobs.push_back(std::move(knob));
    }
    const std::lock_guard lock(mutex_);
    for (Knob& knob : knobs) {
        // What is on its way to the device is newer than what the device said.
        if (const auto found = wanted_.find(knob.control.id); found != wanted_.end()) {
            knob.value = found->second;
        }
    }
    knobs_ = std::move(knobs);
}

void ControlsDesk::run() {
    ask_all();
    std::unique_lock lock(mutex_);
    while (!stopping_) {
        if (wanted_.empty()) {
            if (!changed_.wait_for(lock, kAskAgain,
                                   [&] { return stopping_ || !wanted_.empty(); })) {
                lock.unlock();
                ask_all();
                lock.lock();
            }
            continue;
        }
        const auto [id, value] = *wanted_.begin();
        wanted_.erase(wanted_.begin());
        lock.unlock();
        const auto done = controls_.set(id, value);
        lock.lock();
        for (Knob& knob : knobs_) {
            if (knob.control.id == id) knob.error = done ? "" : done.error().to_string();
        }
    }
}

}  // namespace kino
