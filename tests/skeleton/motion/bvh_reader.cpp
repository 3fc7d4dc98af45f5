#include "tests/skeleton/motion/bvh_reader.h"

#include <cmath>
#include <glm/gtc/matrix_transform.hpp>
#include <glm/mat4x4.hpp>
#include <sstream>
#include <stdexcept>

namespace kino::test {
namespace {

class Words {
  public:
    explicit Words(const std::string& text) : in_(text) {}
    std::string word() {
        std::string w;
        if (!(in_ >> w)) throw std::runtime_error("the file ends too early");
        return w;
    }
    void expect(const std::string& wanted) {
        const std::string w = word();
        if (w != wanted) throw std::runtime_error("expected " + wanted + ", got " + w);
    }
    double number() {
        const std::string w = word();
        std::size_t used = 0;
        const double value = std::stod(w, &used);
        if (used != w.size() || !std::isfinite(value)) throw std::runtime_error("bad number " + w);
        return value;
    }
    bool at_end() { return (in_ >> std::ws).eof(); }

  private:
    std::istringstream in_;
};

void read_joint(Words& words, BvhFile& file, int parent, const std::string& kind) {
    BvhJoint joint;
    joint.parent = parent;
    joint.end_site = kind == "End";
    joint.name = words.word();
    words.expect("{");
    const int self = static_cast<int>(file.joints.size());
    if (joint.end_site) joint.name = file.joints[parent].name + " end";
    file.joints.push_back(joint);
    for (std::string w = words.word(); w != "}"; w = words.word()) {
        if (w == "OFFSET") {
            for (int i = 0; i < 3; ++i) file.joints[self].offset[i] = words.number();
        } else if (w == "CHANNELS") {
            const double count = words.number();
            for (int i = 0; i < count; ++i) file.joints[self].channels.push_back(words.word());
        } else if (w == "JOINT" || w == "End") {
            read_joint(words, file, self, w);
        } else {
            throw std::runtime_error("unknown word " + w);
        }
    }
}

}  // namespace

BvhFile read_bvh(const std::string& text) {
    BvhFile file;
    Words words(text);
    words.expect("HIERARCHY");
    words.expect("ROOT");
    read_joint(words, file, -1, "ROOT");
    words.expect("MOTION");
    words.expect("Frames:");
    const double frames = words.number();
    words.expect("Frame");
    words.expect("Time:");
    file.frame_time_s = words.number();
    std::size_t channels = 0;
    for (const BvhJoint& j : file.joints) channels += j.channels.size();
    for (int f = 0; f < frames; ++f) {
        std::vector<double> values(channels);
        for (double& v : values) v = words.number();
        file.frames.push_back(std::move(values));
    }
    if (!words.at_end()) throw std::runtime_error("there is more than the frames");
    return file;
}

std::map<std::string, glm::dvec3> BvhFile::positions(std::size_t frame) const {
    std::vector<glm::dmat4> world;
    std::map<std::string, glm::dvec3> out;
    std::size_t next = 0;
    for (const BvhJoint& joint : joints) {
        glm::dvec3 place = joint.offset;
        glm::dmat4 turn(1);
        bool moved = false;
        for (const std::string& channel : joint.channels) {
            const double value = frames[frame][next++];
            const int axis = channel[0] - 'X';
            glm::dvec3 unit(0);
            unit[axis] = 1;
            if (channel.substr(1) == "position") {
                if (!moved) place = glm::dvec3(0);
                moved = true;
                place[axis] = value;
            } else if (channel.substr(1) == "rotation") {
                turn = glm::rotate(turn, value * std::acos(-1.0) / 180, unit);
            } else {
                throw std::runtime_error("unknown channel " + channel);
            }
        }
        const glm::dmat4 above = joint.parent < 0 ? glm::dmat4(1) : world[joint.parent];
        world.push_back(above * glm::translate(glm::dmat4(1), place) * turn);
        out[joint.name] = glm::dvec3(world.back()[3]);
    }
    return out;
}

}  // namespace kino::test
