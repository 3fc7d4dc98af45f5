#include "apps/calibrate/session_shots.h"

#include <fmt/format.h>

#include <algorithm>
#include <glm/geometric.hpp>
#include <limits>
#include <memory>

#include "apps/interrupt.h"
#include "calibration/boards/gather.h"
#include "sensor/source.h"

namespace kino {
namespace {

// Mean distance of the corners that both sightings have; infinite where they share none.
double moved_px(const BoardSighting& a, const BoardSighting& b) {
    double sum = 0;
    double count = 0;
    auto other = b.corners.begin();
    for (const SeenCorner& corner : a.corners) {
        while (other != b.corners.end() && other->id < corner.id) ++other;
        if (other == b.corners.end()) break;
        if (other->id != corner.id) continue;
        sum += glm::distance(corner.px, other->px);
        ++count;
    }
    return count > 0 ? sum / count : std::numeric_limits<double>::infinity();
}

class Capture {
  public:
    Capture(Source& source, const Board& board, const SessionShotsOptions& options)
        : source_(source), board_(board), options_(options) {}

    Result<Shots> run(std::vector<ViewDepth>& depth, std::vector<std::string>& notes,
                      const std::function<void(std::string_view)>& progress) {
        KINO_TRY(subscribe());
        Gathering gathering(board_, cameras_);
        int frame = 0;
        while (!interrupted() && static_cast<int>(taken_.size()) < options_.views) {
            KINO_ASSIGN(const auto set, source_.next(kNsPerSecond));
            if (!set) {
                const auto events = source_.take_events();
                if (std::any_of(events.begin(), events.end(),
                                [](const Event& e) { return e.kind == EventKind::ended; })) {
                    break;
                }
                continue;
            }
            ++frame;
            KINO_ASSIGN(const auto pictures, pictures_of(*set));
            const auto quick = look(pictures, true);
            const bool good = worth_taking(quick);
            last_ = quick;
            if (!good) continue;
            const std::string view = fmt::format("frame {}", set->index);
            KINO_TRY(gathering.add(view, look(pictures, false)));
            if (set->depth) depth.push_back({view, set->depth});
            taken_.push_back(quick);
            if (progress) progress(fmt::format("view {}: frame {}", taken_.size(), set->index));
        }
        if (taken_.empty()) {
            return fail(fmt::format("in {} frames the board {} was never still and whole", frame,
                                    board_text(board_)),
                        source_.info().uri, "hold it still for a moment in each place");
        }
        return gathering.shots(notes);
    }

  private:
    using Pictures = std::vector<std::optional<GreyPicture>>;
    using Look = std::vector<std::optional<GatheredPicture>>;

    Result<void> subscribe() {
        for (const StreamKind kind : {StreamKind::infrared, StreamKind::color}) {
            for (const StreamInfo& stream : source_.info().streams) {
                if (stream.id.kind != kind) continue;
                KINO_TRY(source_.subscribe(stream.id));
                cameras_.push_back(stream_name(kind));
                kinds_.push_back(kind);
                break;
            }
        }
        for (const StreamInfo& stream : source_.info().streams) {
            if (stream.id.kind == StreamKind::depth) KINO_TRY(source_.subscribe(stream.id));
        }
        if (cameras_.empty()) {
            return fail("neither infrared nor colour is in this source", source_.info().uri);
        }
        return {};
    }

    Result<Pictures> pictures_of(const FrameSet& set) const {
        Pictures out;
        for (const StreamKind kind : kinds_) {
            auto& picture = out.emplace_back();
            if (kind == StreamKind::infrared && set.infrared) {
                picture = grey_of(set.infrared->raw);
            } else if (kind == StreamKind::color && set.color) {
                KINO_ASSIGN(picture, grey_of(*set.color));
            }
        }
        return out;
    }

    Look look(const Pictures& pictures, bool quick) const {
        Look out;
        for (const auto& picture : pictures) {
            auto& one = out.emplace_back();
            if (!picture) continue;
            one = {picture->width(), picture->height(), find_board(*picture, board_, {quick})};
        }
        return out;
    }

    static double moved(const Look& a, const Look& b) {
        double most = 0;
        for (std::size_t c = 0; c < a.size(); ++c) {
            const bool both = a[c] && b[c] && a[c]->board && b[c]->board;
            most = std::max(most, both ? moved_px(*a[c]->board, *b[c]->board)
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

    Source& source_;
    const Board& board_;
    const SessionShotsOptions& options_;
    std::vector<std::string> cameras_;
    std::vector<StreamKind> kinds_;
    Look last_;
    std::vector<Look> taken_;
};

}  // namespace

Result<Shots> shots_of_session(const std::string& uri, const Board& board,
                               const SessionShotsOptions& options, std::vector<ViewDepth>& depth,
                               std::vector<std::string>& notes,
                               const std::function<void(std::string_view)>& progress) {
    KINO_ASSIGN(const auto source, open_source(uri));
    return Capture(*source, board, options).run(depth, notes, progress);
}

}  // namespace kino
