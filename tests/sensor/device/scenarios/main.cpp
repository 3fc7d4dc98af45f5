// Runs inside the guest machine: all scenarios, or those whose names begin with an argument.

#include <algorithm>
#include <iterator>
#include <string>
#include <vector>

#include "tests/sensor/device/scenarios/report.h"
#include "tests/sensor/device/scenarios/udev_relay.h"

int main(int argc, char** argv) {
    using namespace kino::guest;
    std::vector<Scenario> wanted;
    for (auto* group : {freenect_scenarios, kinect1_scenarios, gspca_scenarios, v4l2_scenarios,
                        recording_scenarios}) {
        for (Scenario& scenario : group()) {
            const bool named = std::any_of(argv + 1, argv + argc, [&](const char* begin) {
                return scenario.name.starts_with(begin);
            });
            if (argc == 1 || named) wanted.push_back(std::move(scenario));
        }
    }
    start_udev_relay();
    run_scenarios(wanted);
    Report("all").value("done", 1);
    return 0;
}
