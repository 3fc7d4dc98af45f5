#pragma once

#include <memory>

#include "apps/pipeline/processed_frame.h"
#include "apps/viewer/depth_colors.h"
#include "viz/output/ui/ui_renderer.h"

namespace kino {

/// The sensor's images as small pictures for the user interface.
class Panes {
  public:
    explicit Panes(UiRenderer& ui) : ui_(ui) {}

    /// A new source: sizes and ranges are found afresh.
    void reset();
    /// Only while panes are shown: it costs about a millisecond a frame.
    [[nodiscard]] Result<void> show(const ProcessedFrame& frame);

    [[nodiscard]] UiPicture* depth() const { return depth_.picture.get(); }
    [[nodiscard]] UiPicture* color() const { return color_.picture.get(); }
    [[nodiscard]] UiPicture* infrared() const { return infrared_.picture.get(); }
    [[nodiscard]] UiPicture* legend() const { return legend_.picture.get(); }
    [[nodiscard]] const DepthRange& range() const { return range_; }

    static constexpr int kWidth = 240;  ///< px

  private:
    struct Pane {
        std::unique_ptr<UiPicture> picture;
        Image<Rgba8> pixels;
    };
    Result<void> show_depth(const Image<float>& depth);
    Result<void> fit(Pane& pane, int width, int height);

    UiRenderer& ui_;
    Pane depth_, color_, infrared_, legend_;
    DepthRange range_;
    bool range_known_ = false;
};

}  // namespace kino
