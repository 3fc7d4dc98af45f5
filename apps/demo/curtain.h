#pragma once

namespace kino::demo {

/// The dark between two scenes: closes in 0.28 s, stays closed for 0.12 s, opens in 0.3 s.
class Curtain {
  public:
    /// It begins to close at once, by a part that is seen. While it closes, nothing changes; while
    /// it opens, it closes again from where it is.
    void close();
    /// True if the scene is to be changed now: once for each time it was closed.
    [[nodiscard]] bool step(double dt_s);
    void open() { *this = {}; }
    [[nodiscard]] double light() const { return light_; }  ///< 1 open .. 0 closed
    [[nodiscard]] bool moves() const { return closing_ || dark_s_ > 0 || light_ < 1; }
    [[nodiscard]] bool dark() const { return !closing_ && dark_s_ > 0; }

  private:
    double light_ = 1;
    double dark_s_ = 0;
    bool closing_ = false;
};

}  // namespace kino::demo
