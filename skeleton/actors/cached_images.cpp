#include "skeleton/actors/cached_images.h"

#include <algorithm>

#include "base/check.h"

namespace kino {

// Runs of body pixels by rows, and their readings and labels one after another.
struct CachedImages::Packed {
    struct Run {
        std::uint16_t x, y, length;
    };
    int width = 0, height = 0;
    double focal_px = 0;
    std::vector<Run> runs;
    std::vector<std::uint16_t> depth_mm;
    std::vector<std::uint8_t> label;
    bool failed = false;
    Error error;

    explicit Packed(const Result<void>& loaded, const TrainingImage& picture) {
        if (!loaded) {
            failed = true;
            error = loaded.error();
            return;
        }
        width = picture.label.width();
        height = picture.label.height();
        focal_px = picture.focal_px;
        KINO_CHECK(width < 65536 && height < 65536);
        for (int y = 0; y < height; ++y) {
            const std::uint8_t* row = picture.label.row(y);
            for (int x = 0; x < width; ++x) {
                if (row[x] == kNotBody) continue;
                const int first = x;
                for (; x < width && row[x] != kNotBody; ++x) {
                    depth_mm.push_back(picture.depth_mm.at(x, y));
                    label.push_back(row[x]);
                }
                runs.push_back({static_cast<std::uint16_t>(first), static_cast<std::uint16_t>(y),
                                static_cast<std::uint16_t>(x - first)});
            }
        }
        runs.shrink_to_fit();
        depth_mm.shrink_to_fit();
        label.shrink_to_fit();
    }

    void unpack(TrainingImage& out) const {
        out.focal_px = focal_px;
        out.depth_mm.resize(width, height);
        out.label.resize(width, height);
        out.depth_mm.fill(0);
        out.label.fill(kNotBody);
        std::size_t at = 0;
        for (const Run& run : runs) {
            const auto from = static_cast<std::ptrdiff_t>(at);
            std::copy_n(depth_mm.begin() + from, run.length, out.depth_mm.row(run.y) + run.x);
            std::copy_n(label.begin() + from, run.length, out.label.row(run.y) + run.x);
            at += run.length;
        }
    }
};

CachedImages::CachedImages(std::shared_ptr<const TrainingImages> from)
    : from_(std::move(from)),
      packed_(static_cast<std::size_t>(from_->count())),
      once_(static_cast<std::size_t>(from_->count())) {}

CachedImages::~CachedImages() = default;

Result<void> CachedImages::load(std::int64_t index, TrainingImage& out) const {
    KINO_CHECK(index >= 0 && index < count());
    const auto i = static_cast<std::size_t>(index);
    std::call_once(once_[i], [&] {
        const Result<void> loaded = from_->load(index, out);
        packed_[i] = std::make_unique<const Packed>(loaded, out);
    });
    if (packed_[i]->failed) return tl::unexpected<Error>(packed_[i]->error);
    packed_[i]->unpack(out);
    return {};
}

std::size_t CachedImages::bytes() const {
    std::size_t sum = 0;
    for (const auto& p : packed_) {
        if (p) {
            sum += sizeof(Packed) + p->runs.size() * sizeof(Packed::Run) + p->label.size() * 3;
        }
    }
    return sum;
}

}  // namespace kino
