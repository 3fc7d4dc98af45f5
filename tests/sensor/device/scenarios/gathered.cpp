#include "tests/sensor/device/scenarios/gathered.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <span>
#include <thread>
#include <utility>
#include <variant>

#include "base/check.h"
#include "tests/sensor/device/scenarios/truth.h"

namespace kino::guest {
namespace {

/// A frame of any kind in one shape.
struct Plain {
    FrameHeader header;
    std::vector<std::uint16_t> pixels;
    std::vector<RowRange> damaged_rows;
};

/// Bytes are compared in the same way as words: a row is a row.
std::vector<std::uint16_t> widened(std::span<const std::uint8_t> bytes) {
    return {bytes.begin(), bytes.end()};
}

struct Origin {
    const fake::SentFrame* sent = nullptr;
    std::vector<std::uint16_t> pixels;
};

/// The frame that most of the pixels are of, as a sample tells: stale ones are few, and of the
/// noise feed no two frames share any.
const Origin* origin_of(const Plain& frame, const std::vector<Origin>& origins) {
    const std::size_t stride = 97;
    for (const Origin& origin : origins) {
        if (frame.pixels.size() != origin.pixels.size()) continue;
        std::size_t wrong = 0;
        for (std::size_t i = 0; i < frame.pixels.size(); i += stride) {
            if (frame.pixels[i] != origin.pixels[i]) ++wrong;
        }
        if (wrong * stride < frame.pixels.size() / 2) return &origin;
    }
    return nullptr;
}

std::int64_t count_stale(const Plain& frame, const Origin& origin, std::size_t rows,
                         int no_reading) {
    std::vector<bool> marked(rows);
    for (const RowRange& range : frame.damaged_rows) {
        for (int row = range.first; row < range.first + range.count; ++row) {
            marked.at(static_cast<std::size_t>(row)) = true;
        }
    }
    const std::size_t width = frame.pixels.size() / rows;
    std::int64_t count = 0;
    for (std::size_t i = 0; i < frame.pixels.size(); ++i) {
        if (frame.pixels[i] == origin.pixels[i]) continue;
        if (!marked[i / width] || frame.pixels[i] != no_reading) ++count;
    }
    return count;
}

void compare_plain(const Report& report, const std::string& prefix,
                   const std::vector<Plain>& frames, const StreamTruth& truth) {
    std::vector<Origin> origins;
    for (const fake::SentFrame& sent : truth.sent) {
        origins.push_back({.sent = &sent, .pixels = truth.pixels(sent.number)});
    }
    double equal = 0, marked = 0, wrong_rows = 0, stale = 0, unknown = 0, order = 0, lost = 0;
    double missing = 0;
    std::vector<double> clock_us;
    const Origin* last = nullptr;
    TimeNs last_time = 0;
    for (const Plain& frame : frames) {
        const Origin* origin = origin_of(frame, origins);
        if (origin == nullptr) {
            ++unknown;
            continue;
        }
        const auto expected = spoilt_rows(*origin->sent, truth.row_bytes);
        if (frame.damaged_rows.empty() && frame.pixels == origin->pixels) ++equal;
        if (!frame.damaged_rows.empty()) ++marked;
        if (frame.damaged_rows != expected) ++wrong_rows;
        int packed = 0;
        for (const auto& packet : origin->sent->packets) packed += packet.bytes;
        stale += static_cast<double>(count_stale(
            frame, *origin, static_cast<std::size_t>(packed / truth.row_bytes), truth.no_reading));
        if (last != nullptr) {
            const int step = origin->sent->number - last->sent->number;
            if (step <= 0) ++order;
            lost += static_cast<double>(frame.header.lost_before);
            missing += static_cast<double>(step - 1 - frame.header.lost_before);
            const std::uint32_t ticks = origin->sent->ticks - last->sent->ticks;
            const double took = static_cast<double>(frame.header.device_time - last_time) * 1e-3;
            clock_us.push_back(std::abs(took - ticks / 60.0));
        }
        last = origin;
        last_time = frame.header.device_time;
    }
    report.value(prefix + "_frames", static_cast<double>(frames.size()));
    report.value(prefix + "_equal", equal);
    report.value(prefix + "_marked", marked);
    report.value(prefix + "_wrong_rows", wrong_rows);
    report.value(prefix + "_stale_pixels", stale);
    report.value(prefix + "_unknown", unknown);
    report.value(prefix + "_order", order);
    report.value(prefix + "_lost", lost);
    report.value(prefix + "_missing", missing);
    if (!clock_us.empty()) {
        std::ranges::sort(clock_us);
        report.value(prefix + "_clock_us", clock_us[clock_us.size() / 2]);
    }
}

template <class Frame, class Pixels>
std::vector<Plain> plain(const std::vector<std::shared_ptr<const Frame>>& frames, Pixels pixels) {
    std::vector<Plain> result;
    for (const auto& frame : frames) {
        result.push_back({.header = frame->header,
                          .pixels = pixels(*frame),
                          .damaged_rows = frame->damaged_rows});
    }
    return result;
}

}  // namespace

Gathered::Gathered(Source& source, FrameTap also) : source_(source) {
    const bool has_tap = source_.set_tap([this, also](StreamId id, const StreamFrame& frame) {
        if (also) also(id, frame);
        {
            const std::scoped_lock lock(mutex_);
            frames_.emplace_back(id.kind, frame);
        }
        came_.notify_all();
    });
    KINO_CHECK(has_tap);
}

Gathered::~Gathered() {
    stop();
}

void Gathered::stop() {
    if (std::exchange(stopped_, true)) return;
    (void)source_.set_tap(nullptr);
}

std::size_t Gathered::count(StreamKind kind) const {
    const std::scoped_lock lock(mutex_);
    return static_cast<std::size_t>(
        std::ranges::count_if(frames_, [&](const auto& entry) { return entry.first == kind; }));
}

bool Gathered::wait_for(StreamKind kind, std::size_t count_wanted) {
    std::size_t before = count(kind);
    for (int idle = 0; idle < 200;) {
        if (before >= count_wanted) return true;
        {
            std::unique_lock lock(mutex_);
            came_.wait_for(lock, std::chrono::milliseconds(100));
        }
        const std::size_t now = count(kind);
        idle = now == before ? idle + 1 : 0;
        before = now;
    }
    return false;
}

bool Gathered::wait_for(EventKind kind) {
    for (int round = 0; round < 600; ++round) {
        for (Event& event : source_.take_events()) events_.push_back(std::move(event));
        if (std::ranges::find(events_, kind, &Event::kind) != events_.end()) return true;
        std::this_thread::sleep_for(std::chrono::milliseconds(50));
    }
    return false;
}

template <class Frame>
std::vector<std::shared_ptr<const Frame>> Gathered::all_of() const {
    const std::scoped_lock lock(mutex_);
    std::vector<std::shared_ptr<const Frame>> result;
    for (const auto& [kind, frame] : frames_) {
        if (const auto* held = std::get_if<std::shared_ptr<const Frame>>(&frame)) {
            result.push_back(*held);
        }
    }
    return result;
}

std::vector<std::shared_ptr<const DepthFrame>> Gathered::depth() const {
    return all_of<DepthFrame>();
}
std::vector<std::shared_ptr<const ColorFrame>> Gathered::color() const {
    return all_of<ColorFrame>();
}
std::vector<std::shared_ptr<const InfraredFrame>> Gathered::infrared() const {
    return all_of<InfraredFrame>();
}
std::vector<std::shared_ptr<const MotionFrame>> Gathered::motion() const {
    return all_of<MotionFrame>();
}

std::vector<std::uint16_t> depth_truth(const fake::Feed& feed, int number, int bits) {
    auto depth = feed.depth(number);
    if (bits == 11) return depth;
    for (auto& value : depth) {
        const int ten = value >> 1;
        value = static_cast<std::uint16_t>(ten == 1023 ? 2047 : 2 * ten);
    }
    return depth;
}

void compare(const Report& report, const std::string& prefix,
             const std::vector<std::shared_ptr<const DepthFrame>>& frames,
             const StreamTruth& truth) {
    compare_plain(report, prefix,
                  plain(frames,
                        [](const DepthFrame& frame) {
                            const auto pixels = frame.raw.pixels();
                            return std::vector<std::uint16_t>(pixels.begin(), pixels.end());
                        }),
                  truth);
}

void compare(const Report& report, const std::string& prefix,
             const std::vector<std::shared_ptr<const InfraredFrame>>& frames,
             const StreamTruth& truth) {
    compare_plain(report, prefix,
                  plain(frames,
                        [](const InfraredFrame& frame) {
                            const auto pixels = frame.raw.pixels();
                            return std::vector<std::uint16_t>(pixels.begin(), pixels.end());
                        }),
                  truth);
}

void compare(const Report& report, const std::string& prefix,
             const std::vector<std::shared_ptr<const ColorFrame>>& frames,
             const StreamTruth& truth) {
    compare_plain(report, prefix,
                  plain(frames, [](const ColorFrame& frame) { return widened(frame.bytes); }),
                  truth);
}

StreamTruth depth_stream(const fake::Feed& feed, std::vector<fake::SentFrame> sent, int bits) {
    return {.sent = std::move(sent),
            .row_bytes = 640 * bits / 8,
            .no_reading = 2047,
            .pixels = [&feed, bits](int n) { return depth_truth(feed, n, bits); }};
}

StreamTruth byte_stream(std::vector<fake::SentFrame> sent, int row_bytes,
                        std::function<std::vector<std::uint8_t>(int)> bytes) {
    return {.sent = std::move(sent),
            .row_bytes = row_bytes,
            .no_reading = 0,
            .pixels = [bytes = std::move(bytes)](int n) { return widened(bytes(n)); }};
}

StreamTruth infrared_stream(const fake::Feed& feed, std::vector<fake::SentFrame> sent) {
    return {.sent = std::move(sent), .row_bytes = 800, .no_reading = 0, .pixels = [&feed](int n) {
                return feed.infrared(n, 640, 488);
            }};
}

bool subscribe(const Report& report, Source& source, StreamKind kind) {
    const auto done = source.subscribe({.device = 0, .kind = kind});
    if (!done) report.failure(done.error().to_string());
    return done.has_value();
}

}  // namespace kino::guest
