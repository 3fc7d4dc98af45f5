#include "skeleton/actors/actor_body.h"

#include "skeleton/actors/actor_clothes.h"
#include "skeleton/actors/actor_shape.h"

namespace kino {

ActorBody make_actor_body(const ActorLook& look) {
    const BaseMesh& mesh = base_mesh();
    const ActorShape shape = shape_body(look);
    const ClothesOffset clothes = clothes_offset(look);
    const std::vector<glm::dvec3> normals = mesh_normals(shape.vertex_m, mesh.triangles);
    ActorBody body;
    body.weights = mesh.weights;
    body.triangles = mesh.triangles;
    body.part = base_mesh_parts();
    body.head_m = shape.head_m;
    body.joint_m = shape.joint_m;
    body.vertex_m.reserve(mesh.vertex_m.size() + 1024);
    for (std::size_t i = 0; i < mesh.vertex_m.size(); ++i) {
        body.vertex_m.emplace_back(shape.vertex_m[i] + normals[i] * clothes.out_m[i] -
                                   glm::dvec3(0, clothes.down_m[i], 0));
    }
    body.first_two_sided = body.triangles.size();
    add_skirt(look, shape, body);
    add_long_hair(look, shape, body);
    return body;
}

}  // namespace kino
