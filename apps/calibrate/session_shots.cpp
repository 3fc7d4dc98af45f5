#include "apps/calibrate/session_shots.h"

#include <fmt/format.h>

#include <algorithm>
#include <limits>

#include "apps/calibrate/board_source.h"
#include "apps/interrupt.h"
#include "calibration/boards/edge_width.h"
#include "calibration/boards/gather.h"

namespace kino {
namespace {

class Capture {
  public:
    Capture(BoardSource& source, const Board& board, const SessionShotsOptions& options)
        : source_(source), board_(board), options_(options) {}

    Result<Shots> run(std::vector<ViewDepth>& depth, std::vector<std::string>& notes,
                      const std::function<void(std::string_view)>& progress) {
        Gathering gathering(board_, source_.cameras());
        int frame = 0;
        while (!interrupted() && static_cast<int>(taken_.size()) < options_.views) {
            KINO_ASSIGN(const auto set, source_.next(kNsPerSecond));
            if (!set && source_.ended()) break;
            if (!set) continue;
            ++frame;
            KINO_ASSIGN(const auto pictures, source_.pictures_of(*set));
            const auto quick = source_.look(pictures, true);
            const bool good = worth_taking(quick);
            last_ = quick;
            if (!good) continue;
            const std::string view = fmt::format("frame {}", set->index);
            KINO_TRY(gathering.add(view, source_.look(pictures, false)));
            if (set->depth)
                depth.push_back({view, set->depth, set->color_paired ? set->color : nullptr});
            taken_.push_back(quick);
            if (progress) progress(fmt::format("view {}: frame {}", taken_.size(), set->index));
        }
        if (taken_.empty()) {
            return fail(fmt::format("in {} frames the board {} was never still and whole", frame,
                                    board_text(board_)),
                        source_.source().info().uri, "hold it still for a moment in each place");
        }
        return gathering.shots(notes);
    }

  private:
    using Look = BoardSource::Look;

    static double moved(const Look& a, const Look& b) {
        double most = 0;
        for (std::size_t c = 0; c < a.size(); ++c) {
            const bool both = a[c] && b[c] && a[c]->board && b[c]->board;
            most = std::max(most, both ? mean_motion_px(*a[c]->board, *b[c]->board)
                                       : std::numeric_limits<double>::infinity());
        }
        return most;
    }

    bool worth_taking(const Look& now) const {
        const bool seen =
            std::all_of(now.begin(), now.end(), [](const auto& one) { return one && one->board; });
        if (!seen || last_.empty() || moved(now, last_) > options_.still_px) return false;
        return std::none_of(taken_.begin(), taken_.end(), [&](const Look& before) {
            return moved(now, before) < options_.different_share * now[0]->width;
        });
    }

    BoardSource& source_;
    const Board& board_;
    const SessionShotsOptions& options_;
    Look last_;
    std::vector<Look> taken_;
};

}  // namespace

Result<Shots> shots_of_session(const std::string& uri, const Board& board,
                               const SessionShotsOptions& options, std::vector<ViewDepth>& depth,
                               std::vector<std::string>& notes,
                               const std::function<void(std::string_view)>& progress) {
    KINO_ASSIGN(BoardSource source, BoardSource::open(uri, board, notes));
    return Capture(source, board, options).run(depth, notes, progress);
}

}  // namespace kino
