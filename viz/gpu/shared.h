// Included by C++ and GLSL: the words both need to declare one struct layout. GLSL files include
// it with GL_EXT_scalar_block_layout, so members follow each other as in C++.
#ifndef KINO_VIZ_GPU_SHARED_H
#define KINO_VIZ_GPU_SHARED_H

#ifdef __cplusplus
#include <cstdint>
#include <glm/mat3x4.hpp>
#include <glm/mat4x4.hpp>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <glm/vec4.hpp>
#define KINO_SHARED_BEGIN namespace kino::shared {
#define KINO_SHARED_END }
namespace kino::shared {
using uint = std::uint32_t;  // NOLINT(readability-identifier-naming): GLSL's name
using glm::ivec2;
using glm::mat4;
using glm::uvec2;
using glm::vec2;
using glm::vec3;
using glm::vec4;
}  // namespace kino::shared
#else
#define KINO_SHARED_BEGIN
#define KINO_SHARED_END
#endif

#endif
