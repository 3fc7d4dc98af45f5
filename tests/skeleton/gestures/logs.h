#pragma once

#include <fstream>
#include <sstream>
#include <string>
#include <vector>

#include "base/body.h"

namespace kino::test {

/// A log of tests/data/motion as bodies of person 1 in depth-camera space, all joints tracked.
/// Empty where the file cannot be read.
inline std::vector<BodyFrame> motion_log(const std::string& name, double start_s = 100) {
    std::ifstream file("tests/data/motion/" + name + ".csv");
    std::vector<BodyFrame> out;
    std::string line;
    while (std::getline(file, line)) {
        if (line.empty() || line[0] == '#' || line[0] == 'k') continue;
        for (char& c : line) {
            if (c == ',') c = ' ';
        }
        std::istringstream numbers(line);
        Body body;
        body.id = 1;
        for (JointPosition& joint : body.joints) {
            float x = 0, y = 0, z = 0;
            numbers >> x >> y >> z;
            // The logs' x goes to the left of what the sensor sees, their y up.
            joint = {{-x / 1000, -y / 1000, z / 1000}, JointState::tracked, 1.f};
        }
        const double t = start_s + static_cast<double>(out.size()) / 30;
        out.push_back({from_seconds(t), {body}});
    }
    return out;
}

}  // namespace kino::test
