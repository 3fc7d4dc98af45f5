#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "base/error.h"
#include "base/frame.h"
#include "calibration/boards/gather.h"
#include "sensor/source.h"

namespace kino {

/// A session or device as pictures of a board.
class BoardSource {
  public:
    using Pictures = std::vector<std::optional<GreyPicture>>;
    using Look = std::vector<std::optional<GatheredPicture>>;

    /// Infrared and colour where the source gives both, else the one it gives; depth beside them.
    /// What a device refuses beside another stream (a Kinect v1 sends colour or infrared) is told
    /// in `notes`. Fails where neither is to be had.
    [[nodiscard]] static Result<BoardSource> open(const std::string& uri, const Board& board,
                                                  std::vector<std::string>& notes);

    [[nodiscard]] Source& source() { return *source_; }
    [[nodiscard]] const std::vector<std::string>& cameras() const { return cameras_; }
    /// The next frame set; empty: nothing within `timeout`, or the end.
    [[nodiscard]] Result<std::optional<FrameSet>> next(TimeNs timeout);
    [[nodiscard]] bool ended() const { return ended_; }

    /// One grey picture a camera.
    [[nodiscard]] Result<Pictures> pictures_of(const FrameSet& set) const;
    /// The board in each of them.
    [[nodiscard]] Look look(const Pictures& pictures, bool quick) const;

  private:
    BoardSource(std::unique_ptr<Source> source, Board board)
        : source_(std::move(source)), board_(board) {}

    std::unique_ptr<Source> source_;
    Board board_;
    std::vector<std::string> cameras_;
    std::vector<StreamKind> kinds_;
    bool ended_ = false;
};

}  // namespace kino
