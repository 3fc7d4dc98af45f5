#pragma once

#include <cstdint>
#include <map>
#include <string>

namespace kino::graph {

/// The books of what passes keep from frame to frame: which of two buffers is current, and
/// whether the other holds last frame's contents. Knows no device; the executor keeps the memory.
class HistoryBook {
  public:
    struct Entry {
        std::string key;  ///< owner and view, "taa/0"
        std::uint64_t bytes = 0;
        int current = 0;      ///< 0 or 1: which of the two is written this frame
        bool valid = false;   ///< the other one holds the previous frame
        bool wanted = false;  ///< asked for since begin_frame()
        bool cut = false;     ///< what was written before must not be read again
    };

    /// Forgets entries that the last frame did not ask for; their memory goes with them.
    void begin_frame();
    /// The picture cuts (seek, new scene, resize): nothing from before may be read.
    void cut();
    /// Once a frame and key. A changed size starts afresh.
    const Entry& want(const std::string& key, std::uint64_t bytes);

    /// Both buffers of every entry that this frame wants.
    [[nodiscard]] std::uint64_t total_bytes() const;

  private:
    std::map<std::string, Entry> entries_;
};

}  // namespace kino::graph
