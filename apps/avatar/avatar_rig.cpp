#include "apps/avatar/avatar_rig.h"

#include <fmt/format.h>

#include "apps/avatar/bundled_rigs.h"
#include "apps/avatar/mannequin.h"
#include "apps/avatar/rig_file.h"
#include "viz/surface/assets/gltf_loader.h"

namespace kino {

std::string list_of_avatars() {
    std::string text =
        fmt::format("  {:<12}{}\n", "mannequin", "an artist's mannequin with one smooth skin");
    for (const BundledRig& rig : bundled_rigs()) {
        text += fmt::format("  {:<12}{}\n", rig.name, rig.about);
    }
    return text;
}

Result<std::shared_ptr<const AvatarRig>> open_avatar(const std::string& name_or_file) {
    if (name_or_file == "mannequin") return std::make_shared<const AvatarRig>(make_mannequin());
    for (const BundledRig& bundled : bundled_rigs()) {
        if (name_or_file != bundled.name) continue;
        const auto none = [&](const std::string& name, std::size_t) {
            return Result<std::vector<std::uint8_t>>(fail("the rig has no file " + name));
        };
        KINO_ASSIGN(const GltfModel model, parse_gltf(bundled.glb, name_or_file, none));
        KINO_ASSIGN(AvatarRig rig, rig_of_model(model, name_or_file));
        rig.name = name_or_file;
        return std::make_shared<const AvatarRig>(std::move(rig));
    }
    const std::filesystem::path path(name_or_file);
    if (!path.has_extension()) {
        return fail("no avatar of that name", name_or_file,
                    "these are built in:\n" + list_of_avatars() + "or name a .gltf or .glb file");
    }
    KINO_ASSIGN(const GltfModel model, load_gltf(path));
    KINO_ASSIGN(AvatarRig rig, rig_of_model(model, name_or_file));
    rig.name = path.stem().string();
    return std::make_shared<const AvatarRig>(std::move(rig));
}

}  // namespace kino
