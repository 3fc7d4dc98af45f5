#include "apps/demo/act.h"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>

#include "apps/demo/players.h"
#include "apps/stage/bundled.h"

namespace kino::demo {
namespace {

/// A role that lights as many joints is the demo's own aura.
constexpr std::size_t kManyJoints = 8;

void adapt(SceneFile& file) {
    for (SceneRole& role : file.roles) {
        role.trail.reset();
        // Two may play; but shadows and bounces of light for two would be slow.
        const bool dear = role.light && (role.light->shadow || role.light->indirect);
        if (!dear) role.people = std::max(role.people, static_cast<int>(Players::kMost));
        const bool many = role.joints.empty() || role.joints.size() >= kManyJoints;
        if (many && role.light && role.light->kind == LightKind::point) role.light.reset();
    }
    std::erase_if(file.roles, [](const SceneRole& role) { return !role.light && !role.prop; });
    for (SceneSwarm& swarm : file.swarms) {
        swarm.fill_to = swarm.fill_to > 0 ? std::min(swarm.fill_to, kDemoLights) : kDemoLights;
    }
}

Result<StageSet> open_adapted(const std::string& name_or_file) {
    // A first look tells apart what is bundled, what is a file, and what is neither.
    KINO_ASSIGN(StageSet stage, open_stage(name_or_file));
    SceneFile file = std::move(stage.file);
    adapt(file);
    const auto folder = bundled_scene(name_or_file)
                            ? std::filesystem::path()
                            : std::filesystem::path(name_or_file).parent_path();
    return make_stage(std::move(file), folder);
}

}  // namespace

Result<Act> open_act(const std::string& name_or_file, std::size_t more_materials) {
    KINO_ASSIGN(StageSet stage, open_adapted(name_or_file));
    const std::size_t materials = stage.materials.size() + more_materials;
    if (materials > kMaxMaterials - 1) {
        return fail(fmt::format("needs {} materials in the demo, at most {} are possible",
                                materials, kMaxMaterials - 1),
                    name_or_file, "a scene or an avatar with fewer materials");
    }
    Act act{.name = stage.file.name.empty() ? name_or_file : stage.file.name};
    act.solids = solids_of(stage.file);
    act.room = room_of(stage.file);
    act.director = std::make_unique<Director>(std::move(stage));
    return act;
}

std::vector<std::string> acts_or_default(std::vector<std::string> names) {
    if (!names.empty()) return names;
    for (const char* name : {"light-painting", "playroom", "colonnade", "glass", "torch"}) {
        if (bundled_scene(name)) names.emplace_back(name);
    }
    return names;
}

}  // namespace kino::demo
