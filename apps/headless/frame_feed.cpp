#include "apps/headless/frame_feed.h"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

namespace kino {
namespace {

/// A stepper waits a second for a device; this often at most.
constexpr int kMostSilentWaits = 10;

}  // namespace

FrameFeed::FrameFeed(Stepper stepper, std::int64_t most, Hooks hooks)
    : stepper_(std::move(stepper)), most_(most), hooks_(std::move(hooks)) {}

Result<std::optional<ProcessedFrame>> FrameFeed::next() {
    const std::string& uri = stepper_.opened().source->info().uri;
    while (taken_ < most_ && !hooks_.interrupted()) {
        auto frame = stepper_.next();
        if (!frame) {
            ++taken_;
            hooks_.on_unreadable(frame.error());
            // With every frame of a round unreadable, there is nothing to show.
            if (++unreadable_in_a_row_ >= std::max<std::int64_t>(1, stepper_.round())) {
                return fail(std::move(frame).error(), uri);
            }
            continue;
        }
        if (*frame) {
            ++taken_;
            unreadable_in_a_row_ = 0;
            silent_waits_ = 0;
            return frame;
        }
        if (stepper_.round() > 0) break;
        // A device: it may be slow to start, or away for a while.
        if (++silent_waits_ >= kMostSilentWaits) {
            return fail(fmt::format("nothing came for {} s", kMostSilentWaits), uri);
        }
    }
    return std::nullopt;
}

}  // namespace kino
