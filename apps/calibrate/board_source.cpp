#include "apps/calibrate/board_source.h"

#include <fmt/format.h>

#include <algorithm>

namespace kino {

Result<BoardSource> BoardSource::open(const std::string& uri, const Board& board,
                                      std::vector<std::string>& notes) {
    KINO_ASSIGN(auto source, open_source(uri));
    BoardSource out(std::move(source), board);
    std::optional<Error> refused;
    for (const StreamKind kind : {StreamKind::infrared, StreamKind::color}) {
        for (const StreamInfo& stream : out.source_->info().streams) {
            if (stream.id.kind != kind) continue;
            if (const auto subscribed = out.source_->subscribe(stream.id)) {
                out.cameras_.push_back(stream_name(kind));
                out.kinds_.push_back(kind);
            } else {
                refused = subscribed.error();
                notes.push_back(
                    fmt::format("{} is left out: {}", stream_name(kind), refused->to_string()));
            }
            break;
        }
    }
    for (const StreamInfo& stream : out.source_->info().streams) {
        if (stream.id.kind != StreamKind::depth) continue;
        if (const auto subscribed = out.source_->subscribe(stream.id); !subscribed) {
            notes.push_back("depth is left out: " + subscribed.error().to_string());
        }
    }
    if (out.cameras_.empty()) {
        if (refused) return fail(*refused);
        return fail("neither infrared nor colour is in this source", out.source_->info().uri);
    }
    return out;
}

Result<std::optional<FrameSet>> BoardSource::next(TimeNs timeout) {
    KINO_ASSIGN(auto set, source_->next(timeout));
    if (!set) {
        const auto events = source_->take_events();
        ended_ = ended_ || std::any_of(events.begin(), events.end(),
                                       [](const Event& e) { return e.kind == EventKind::ended; });
    }
    return set;
}

Result<BoardSource::Pictures> BoardSource::pictures_of(const FrameSet& set) const {
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

BoardSource::Look BoardSource::look(const Pictures& pictures, bool quick) const {
    Look out;
    for (const auto& picture : pictures) {
        auto& one = out.emplace_back();
        if (!picture) continue;
        one = {picture->width(), picture->height(), find_board(*picture, board_, {quick})};
    }
    return out;
}

}  // namespace kino
