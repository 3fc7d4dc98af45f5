#pragma once

#include <cstdint>
#include <glm/vec2.hpp>
#include <optional>

#include "viz/graph/executor.h"
#include "viz/quality/zoom/deflect.h"
#include "viz/quality/zoom/zoom_options.h"

namespace kino {

/// True where the host enlarges: on a CPU device its copy is several times faster than any of
/// Vulkan's (docs/zoom-rendering.md).
[[nodiscard]] bool enlarges_on_host(const gpu::Device& device, ZoomPath path);

/// A picture as it was drawn, on its way to the size and the pose that it is shown in.
struct ZoomInput {
    graph::TextureId picture;
    View view;                ///< it was drawn for; larger than the blocks shown by a guard band
    graph::TextureId view_z;  ///< of the same size; invalid: nothing is known of depths
    int guard_px = 0;         ///< small pixels beyond each side
};

/// What became of the last picture.
struct ZoomReport {
    std::optional<View> shown;    ///< deflected pictures: the view that it was brought to
    std::int64_t clamped_px = 0;  ///< pixels that would have needed more guard band
};

/// The enlarging copy as passes of a frame, and the mapped memory that it takes on the host.
class ZoomPass {
  public:
    explicit ZoomPass(gpu::Device& device) : device_(device) {}

    /// Adds the copy of `small`, enlarged options.z times, into `target`, both RGBA8 or BGRA8;
    /// `shown` is the target's view. With `deflect` it is brought to a newer pose meanwhile; forms
    /// other than pan are made on the host whatever the path. On the host the target must take
    /// copies (TRANSFER_DST). What is passed must live until the frame is executed.
    [[nodiscard]] Result<graph::TextureId> add(graph::FrameGraph& graph, const ZoomInput& small,
                                               graph::TextureId target, const View& shown,
                                               const ZoomOptions& options,
                                               const DeflectOptions* deflect = nullptr);
    /// Gives the memory back.
    void clear();
    /// Bytes of mapped memory.
    [[nodiscard]] std::uint64_t bytes() const {
        return small_.bytes() + depth_.bytes() + large_.bytes();
    }
    [[nodiscard]] const ZoomReport& report() const { return report_; }

  private:
    struct Copy;
    graph::TextureId add_fragment_copy(graph::FrameGraph& graph, const Copy& copy,
                                       graph::TextureId target);
    [[nodiscard]] glm::ivec2 newest_offset(const Copy& copy, double inverse_z);
    void enlarge_mapped(const Copy& copy);

    gpu::Device& device_;
    gpu::Buffer small_;
    gpu::Buffer depth_;
    gpu::Buffer large_;
    Image<float> inverse_z_;
    ZoomReport report_;
};

}  // namespace kino
