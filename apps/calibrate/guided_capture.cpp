#include "apps/calibrate/guided_capture.h"

#include <fmt/format.h>

#include <chrono>
#include <thread>

#include "apps/interrupt.h"

namespace kino {
namespace {

constexpr TimeNs kLookForScreen = 30 * kNsPerMs;

// A recording's frame is due as long after the first one as it was recorded.
class Pace {
  public:
    void wait_for(TimeNs recorded) {
        if (!first_) {
            first_ = recorded;
            began_ = now_ns();
        }
        const TimeNs early = recorded - *first_ - (now_ns() - began_);
        if (early > 0) std::this_thread::sleep_for(std::chrono::nanoseconds(early));
    }

  private:
    std::optional<TimeNs> first_;
    TimeNs began_ = 0;
};

}  // namespace

Result<bool> GuideLinesScreen::show(const GuidedFrame& frame) {
    const std::string words =
        frame.answer.take ? fmt::format("view {}: frame {}", frame.guide.taken(), frame.set.index)
                          : frame.answer.words;
    if (words != last_) say_(words);
    last_ = words;
    return true;
}

Result<Shots> guided_shots(const std::string& uri, const Board& board,
                           const GuidedCaptureOptions& options, GuideScreen& screen,
                           std::vector<ViewDepth>& depth, std::vector<std::string>& notes) {
    KINO_ASSIGN(BoardSource source, BoardSource::open(uri, board, notes));
    Gathering gathering(board, source.cameras());
    CaptureGuide guide(board, source.cameras().size(), options.guide);
    const bool paced = screen.wants_real_time() && source.source().timeline() != nullptr;
    Pace pace;
    const TimeNs began = now_ns();
    std::int64_t frames = 0;
    bool goes_on = true;
    while (goes_on && frames < options.frames && now_ns() - began < options.duration &&
           !guide.enough() && !interrupted()) {
        KINO_ASSIGN(const auto set, source.next(kLookForScreen));
        if (!set) {
            if (source.ended()) break;
            KINO_ASSIGN(goes_on, screen.idle());
            continue;
        }
        ++frames;
        if (paced) pace.wait_for(set->time);
        KINO_ASSIGN(const auto pictures, source.pictures_of(*set));
        const TimeNs looks = now_ns();
        const auto look = source.look(pictures, true);
        const TimeNs detection = now_ns() - looks;
        const GuideAnswer answer = guide.look(look, set->time);
        if (answer.take) {
            const std::string view = fmt::format("frame {}", set->index);
            KINO_TRY(gathering.add(view, source.look(pictures, false)));
            if (set->depth)
                depth.push_back({view, set->depth, set->color_paired ? set->color : nullptr});
        }
        KINO_ASSIGN(goes_on, screen.show({*set, source.cameras(), pictures, look, guide, answer,
                                          detection}));
    }
    if (guide.taken() == 0) {
        return fail(fmt::format("in {} frames the board {} was never still, sharp and whole",
                                frames, board_text(board)),
                    source.source().info().uri, "hold it still for a moment in each place");
    }
    for (std::size_t c = 0; c < source.cameras().size() && !guide.enough(); ++c) {
        const auto missing = guide.coverage(c)->missing();
        for (std::size_t i = 0; i < missing.size() && i < 3; ++i) {
            notes.push_back(
                fmt::format("{}: still missing: {}", source.cameras()[c], missing[i].words));
        }
    }
    return gathering.shots(notes);
}

}  // namespace kino
