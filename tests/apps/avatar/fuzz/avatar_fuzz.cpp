#include <cstddef>
#include <cstdint>

#include "apps/avatar/avatar.h"
#include "apps/avatar/rig_file.h"
#include "viz/surface/assets/gltf_loader.h"

/// A glTF file as an avatar: an error, or a rig that can be stepped. Small limits keep runs fast.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    const auto none = [](const std::string& name, std::size_t) {
        return kino::Result<std::vector<std::uint8_t>>(kino::fail("no file " + name));
    };
    const auto model = kino::parse_gltf({data, size}, "fuzzed", none,
                                        {.vertices = 4096, .indices = 16384, .items = 512});
    if (!model) return 0;
    auto rig = kino::rig_of_model(*model, "fuzzed");
    if (!rig) return 0;
    kino::AvatarTroupe troupe(std::make_shared<const kino::AvatarRig>(std::move(*rig)),
                              {.idle_after_s = 0});
    kino::AvatarMoment nobody;
    nobody.dt_s = 0.05;
    for (int i = 0; i < 3; ++i) troupe.step(nobody);
    kino::Scene scene;
    troupe.fill(scene, 1);
    return 0;
}
