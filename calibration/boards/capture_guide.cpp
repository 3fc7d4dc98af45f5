#include "calibration/boards/capture_guide.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <limits>

#include "base/check.h"
#include "calibration/boards/edge_width.h"
#include "calibration/solve/initial.h"

namespace kino {
namespace {

constexpr int kLostFrames = 3;
constexpr std::size_t kLensViews = 3;
constexpr int kNewFields = 2;
// Leaving rest takes more than coming to rest; creeping away counts, too.
constexpr double kLeaveRest = 2;
constexpr double kCreep = 3;

double median_of(std::vector<double> values) {
    if (values.empty()) return 0;
    const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
    std::nth_element(values.begin(), middle, values.end());
    return *middle;
}

std::vector<ShotCorner> shot_of(const BoardSighting& board) {
    std::vector<ShotCorner> out;
    for (const SeenCorner& corner : board.corners) out.push_back({corner.id, corner.px});
    return out;
}

}  // namespace

const char* words_of(GuideState state) {
    switch (state) {
        case GuideState::no_board:
            return "show the whole board";
        case GuideState::blurred:
            return "blurred: hold it still, or give more light";
        case GuideState::moving:
            return "moving";
        case GuideState::known:
            return "this view is there already";
        case GuideState::holding:
            return "hold still";
        case GuideState::taken:
            return "taken";
        case GuideState::enough:
            return "that is enough";
    }
    return "";
}

CaptureGuide::CaptureGuide(Board board, std::size_t cameras, GuideOptions options)
    : board_(board), options_(options), eyes_(cameras) {
    KINO_CHECK(cameras > 0);
    for (int id = 0; id < board_.corner_count(); ++id) corners_m_.push_back(board_.corner_m(id));
}

const GuideCoverage* CaptureGuide::coverage(std::size_t camera) const {
    return eyes_[camera].coverage ? &*eyes_[camera].coverage : nullptr;
}

std::optional<double> CaptureGuide::expected_focal_percent(std::size_t camera) const {
    if (views_.size() < kLensViews) return std::nullopt;
    const Eye& eye = eyes_[camera];
    return 100 * expected_deviations(eye.seen, eye.lens, options_.noise_px)[0] / eye.lens[0];
}

bool CaptureGuide::enough() const {
    if (taken() >= options_.views) return true;
    return taken() >= options_.least_views &&
           std::all_of(eyes_.begin(), eyes_.end(),
                       [](const Eye& eye) { return eye.coverage && eye.coverage->is_enough(); });
}

std::optional<Pose> CaptureGuide::pose(std::size_t camera, const BoardSighting& board) const {
    const Eye& eye = eyes_[camera];
    const Shots one{corners_m_, {"now"}, {{"", eye.width, 0, {shot_of(board)}}}};
    return initial_pose(one, 0, 0, eye.lens);
}

// Sizes, and where the board stands for each camera.
void CaptureGuide::meet(const Pictures& pictures) {
    const double diagonal = glm::length(corners_m_.back());
    const glm::dvec3 middle(corners_m_.back() / 2.0, 0);
    for (std::size_t c = 0; c < eyes_.size(); ++c) {
        Eye& eye = eyes_[c];
        eye.stand.reset();
        eye.now = {};
        if (!pictures[c]) continue;
        if (!eye.coverage) {
            eye.width = pictures[c]->width;
            eye.coverage.emplace(pictures[c]->width, pictures[c]->height);
            const double width = pictures[c]->width;
            eye.lens = {width, width, (width - 1) / 2, (pictures[c]->height - 1) / 2.0};
        }
        if (!pictures[c]->board || pictures[c]->board->mirrored) continue;
        auto at = pose(c, *pictures[c]->board);
        if (!at) continue;
        eye.now = view_information(corners_m_, shot_of(*pictures[c]->board), eye.lens, *at);
        at->translation = *at * middle;
        eye.stand = eye.coverage->stand(pictures[c]->board->corners, *at, diagonal, eye.lens[0]);
    }
}

bool CaptureGuide::sees_all(const Pictures& pictures) const {
    for (std::size_t c = 0; c < eyes_.size(); ++c) {
        if (!pictures[c] || !eyes_[c].stand) return false;
    }
    return true;
}

bool CaptureGuide::is_blurred(const Pictures& pictures) const {
    for (std::size_t c = 0; c < eyes_.size(); ++c) {
        const BoardSighting& board = *pictures[c]->board;
        if (board.edge_width_px > blur_limit_px(median_of(eyes_[c].edge_widths), board.square_px)) {
            return true;
        }
    }
    return false;
}

double CaptureGuide::moved_px(const Pictures& from, const Pictures& to) const {
    if (from.empty()) return std::numeric_limits<double>::infinity();
    double most = 0;
    for (std::size_t c = 0; c < eyes_.size(); ++c) {
        // In pixels of the first camera, so that one threshold fits all.
        const double scale = static_cast<double>(eyes_[0].width) / eyes_[c].width;
        most = std::max(most, scale * mean_motion_px(*from[c]->board, *to[c]->board));
    }
    return most;
}

bool CaptureGuide::is_different(const Pictures& pictures) const {
    return std::none_of(views_.begin(), views_.end(), [&](const Pictures& view) {
        return moved_px(view, pictures) < options_.different_share * eyes_[0].width;
    });
}

void CaptureGuide::follow_stillness(const Pictures& pictures) {
    const double limit = options_.still_share * eyes_[0].width;
    const double moved = moved_px(last_, pictures);
    last_ = pictures;
    if (still_ > 0 &&
        (moved > kLeaveRest * limit || moved_px(anchor_, pictures) > kCreep * limit)) {
        still_ = 0;
    }
    if (moved > limit) return;
    if (still_ == 0) anchor_ = pictures;
    ++still_;
}

void CaptureGuide::take(const Pictures& pictures) {
    views_.push_back(pictures);
    for (std::size_t c = 0; c < eyes_.size(); ++c) {
        Eye& eye = eyes_[c];
        eye.coverage->add(*eye.stand);
        eye.edge_widths.push_back(pictures[c]->board->edge_width_px);
        if (views_.size() < kLensViews) {
            eye.seen += eye.now;
            continue;
        }
        // A better idea of the lens makes all of them new.
        Shots own{corners_m_, {}, {{"", eye.width, pictures[c]->height, {}}}};
        for (const Pictures& view : views_) {
            own.names.emplace_back();
            own.cameras[0].views.push_back(shot_of(*view[c]->board));
        }
        const Lens guess = initial_lens(own, 0);
        const double share = guess[0] / eye.width;
        if (share > 0.4 && share < 3) eye.lens = guess;
        eye.seen = {};
        for (std::size_t view = 0; view < views_.size(); ++view) {
            const auto at = initial_pose(own, 0, view, eye.lens);
            if (at)
                eye.seen += view_information(corners_m_, own.cameras[0].views[view], eye.lens, *at);
        }
    }
    want_.reset();
}

// What is asked for stays until a view was taken or patience is over; then the next comes.
const std::string& CaptureGuide::wish(TimeNs time) {
    static const std::string kNothing = "show it somewhere else";
    std::vector<GuideCoverage::Want> wants;
    for (const Eye& eye : eyes_) {
        if (!eye.coverage) continue;
        for (GuideCoverage::Want& want : eye.coverage->missing()) wants.push_back(std::move(want));
    }
    std::stable_sort(wants.begin(), wants.end(),
                     [](const auto& a, const auto& b) { return a.missing > b.missing; });
    if (wants.empty()) {
        want_.reset();
        return kNothing;
    }
    if (want_ && time - want_since_ < options_.patience) return want_->words;
    std::size_t next = 0;
    if (want_) {
        for (std::size_t i = 0; i < wants.size(); ++i) {
            if (wants[i].is_same(*want_)) next = (i + 1) % wants.size();
        }
    }
    want_ = wants[next];
    want_since_ = time;
    return want_->words;
}

GuideAnswer CaptureGuide::look(const Pictures& pictures, TimeNs time) {
    KINO_CHECK_EQ(pictures.size(), eyes_.size());
    meet(pictures);
    GuideAnswer answer;
    if (enough()) {
        answer.state = GuideState::enough;
        answer.words = fmt::format("that is enough: {} views", taken());
        return answer;
    }
    if (!sees_all(pictures)) {
        still_ = 0;
        last_.clear();
        const bool lost = ++missed_ >= kLostFrames || last_state_ == GuideState::no_board;
        answer.state = lost ? GuideState::no_board : GuideState::moving;
        last_state_ = answer.state;
        answer.words =
            lost ? fmt::format("show the whole board{}", eyes_.size() > 1 ? " to both cameras" : "")
                 : wish(time);
        return answer;
    }
    missed_ = 0;
    follow_stillness(pictures);
    bool wanted = taken() < static_cast<int>(kLensViews);
    for (const Eye& eye : eyes_) {
        answer.new_fields += eye.coverage->new_fields(*eye.stand);
        answer.fall =
            std::max(answer.fall, expected_fall(eye.seen, eye.now, eye.lens, options_.noise_px));
        wanted = wanted || eye.coverage->is_wanted(*eye.stand);
    }
    const bool worth = is_different(pictures) && (wanted || answer.new_fields >= kNewFields ||
                                                  answer.fall >= options_.least_fall);
    const std::string& asked = wish(time);
    // Turning round looks like rest for one frame.
    if (still_ < std::min(2, options_.still_frames)) {
        answer.state = GuideState::moving;
        answer.words = asked;
    } else if (is_blurred(pictures)) {
        answer.state = GuideState::blurred;
        answer.words = words_of(answer.state);
    } else if (!worth) {
        answer.state = GuideState::known;
        answer.words = asked;
    } else if (still_ < options_.still_frames) {
        answer.state = GuideState::holding;
        answer.words = words_of(answer.state);
    } else {
        take(pictures);
        answer.take = true;
        answer.state = GuideState::taken;
        answer.words = fmt::format("view {} taken", taken());
    }
    last_state_ = answer.state;
    return answer;
}

}  // namespace kino
