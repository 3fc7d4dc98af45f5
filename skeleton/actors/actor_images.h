#pragma once

#include <cstdint>
#include <memory>

#include "skeleton/forest/training_images.h"

namespace kino {

struct ActorImagesOptions {
    std::uint64_t seed = 1;
    std::int64_t count = 20000;
    int width = 320, height = 240;  ///< of the whole picture that the body is cut from
    /// People, clothes and poses that no training set has, whatever its seed.
    bool held_out = false;
};

/// Varied people before a computed Kinect v1, cut out, each pixel labelled with its BodyPart. No
/// two pictures share a body. Hidden pixels, and those of others, are kNotBody without a reading.
class ActorImages : public TrainingImages {
  public:
    /// Fails for counts below 1 and sizes that are not multiples of 8 in [64, 2048].
    [[nodiscard]] static Result<std::unique_ptr<ActorImages>> create(
        const ActorImagesOptions& options);

    [[nodiscard]] std::vector<std::string> labels() const override;
    [[nodiscard]] std::int64_t count() const override { return options_.count; }
    [[nodiscard]] Result<void> load(std::int64_t index, TrainingImage& out) const override;

  private:
    explicit ActorImages(const ActorImagesOptions& options) : options_(options) {}
    ActorImagesOptions options_;
};

}  // namespace kino
