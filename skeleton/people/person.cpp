#include "skeleton/people/person.h"

#include <cmath>
#include <glm/geometric.hpp>
#include <glm/matrix.hpp>

namespace kino {

glm::mat3 upright_from_camera(const glm::vec3& up) {
    // Looking straight up or down leaves no forward: then the top of the picture is forward.
    const glm::vec3 look = std::abs(up.z) < 0.99f ? glm::vec3(0, 0, 1) : glm::vec3(0, -1, 0);
    const glm::vec3 forward = glm::normalize(look - glm::dot(look, up) * up);
    return glm::transpose(glm::mat3(glm::cross(forward, up), up, -forward));
}

}  // namespace kino
