#pragma once

#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "base/frame.h"
#include "sensor/openni2/oni_walk.h"

namespace kino {

/// The frames of an ONI file in any order. They are decoded here and not by OpenNI2's player: in
/// Debian's build its seek hands the player a structure that has left its scope, which crashes; in
/// any build it waits for ever for a frame whose neighbours in other streams it looks up wrongly;
/// and its manual mode drops frames. Played from the start it gives the same bits, which the tests
/// compare. Belongs to one thread.
class OniFrames {
  public:
    /// Walks the whole file; remark() names what is left out.
    [[nodiscard]] static Result<std::unique_ptr<OniFrames>> open(const std::filesystem::path& file);

    [[nodiscard]] const OniRecords& records() const { return records_; }
    [[nodiscard]] const std::string& remark() const { return remark_; }
    [[nodiscard]] bool has_color() const { return color_node_ >= 0; }
    [[nodiscard]] int depth_format() const;  ///< openni::k...
    [[nodiscard]] int color_format() const;
    [[nodiscard]] TimeNs depth_time(std::size_t frame) const;

    /// Frame `frame` (from 0) of the node. Fails for a payload that is damaged.
    [[nodiscard]] Result<DepthFrame> depth(std::size_t frame);
    [[nodiscard]] Result<ColorFrame> color(std::size_t frame);

  private:
    OniFrames() = default;
    [[nodiscard]] const OniNode& node(int index) const;
    [[nodiscard]] Result<std::vector<std::uint8_t>> pixels(int node, std::size_t frame);

    std::filesystem::path file_;
    std::unique_ptr<OniInput> input_;
    OniRecords records_;
    std::string remark_;
    int depth_node_ = -1;
    int color_node_ = -1;
};

}  // namespace kino
