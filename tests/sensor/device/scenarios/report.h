#pragma once

#include <functional>
#include <string>
#include <vector>

namespace kino::guest {

/// What a scenario found, as lines for the host: "= scenario key number" and "! scenario text".
/// The scenarios measure; the host's test says what must hold.
class Report {
  public:
    explicit Report(std::string scenario) : scenario_(std::move(scenario)) {}
    void value(const std::string& key, double number) const;
    /// Something that must not happen at all.
    void failure(const std::string& text) const;

  private:
    std::string scenario_;
};

struct Scenario {
    std::string name;
    std::function<void(const Report&)> run;
};

/// Runs each in a process of its own, so that none can take the others down: a crash or more than
/// two minutes is a failure of that scenario. Between two the virtual bus is empty again.
///
/// A whole guest may be held up (its host sleeps, or stops it), and then every timeout of every
/// driver in it runs out at once, which proves nothing: a scenario during which the guest got no
/// time for more than a second is run again, twice at most, and says so ("held_up").
void run_scenarios(const std::vector<Scenario>& scenarios);

// Each group of scenarios, in a file of its own.
[[nodiscard]] std::vector<Scenario> freenect_scenarios();
[[nodiscard]] std::vector<Scenario> kinect1_scenarios();
[[nodiscard]] std::vector<Scenario> gspca_scenarios();
[[nodiscard]] std::vector<Scenario> v4l2_scenarios();
[[nodiscard]] std::vector<Scenario> recording_scenarios();

}  // namespace kino::guest
