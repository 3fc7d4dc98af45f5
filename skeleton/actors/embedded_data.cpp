#include "skeleton/actors/embedded_data.h"

// The assembler pastes the files in; KINO_ACTOR_DATA is their folder.
#define KINO_EMBED(symbol, file)              \
    __asm__(                                  \
        ".section .rodata\n"                  \
        ".balign 16\n"                        \
        ".global kino_embedded_" symbol       \
        "\n"                                  \
        "kino_embedded_" symbol               \
        ":\n"                                 \
        ".incbin \"" KINO_ACTOR_DATA "/" file \
        "\"\n"                                \
        ".global kino_embedded_" symbol       \
        "_end\n"                              \
        "kino_embedded_" symbol               \
        "_end:\n"                             \
        ".byte 0\n"                           \
        ".previous\n")

KINO_EMBED("actor_body", "actor_body.bin");
KINO_EMBED("cmu_01_01", "cmu_01_01.csv");
KINO_EMBED("makehuman_walk1", "makehuman_walk1.csv");
KINO_EMBED("makehuman_dance1", "makehuman_dance1.csv");
KINO_EMBED("makehuman_tpose", "makehuman_tpose.csv");

#define KINO_EMBEDDED(name)                       \
    extern "C" const char kino_embedded_##name[]; \
    extern "C" const char kino_embedded_##name##_end[]

KINO_EMBEDDED(actor_body);
KINO_EMBEDDED(cmu_01_01);
KINO_EMBEDDED(makehuman_walk1);
KINO_EMBEDDED(makehuman_dance1);
KINO_EMBEDDED(makehuman_tpose);

namespace kino {

std::span<const std::byte> actor_body_file() {
    return std::as_bytes(std::span(kino_embedded_actor_body, kino_embedded_actor_body_end));
}

std::string_view actor_motion_file(std::string_view name) {
    const auto text = [](const char* begin, const char* end) {
        return std::string_view(begin, static_cast<std::size_t>(end - begin));
    };
    if (name == "cmu_01_01") return text(kino_embedded_cmu_01_01, kino_embedded_cmu_01_01_end);
    if (name == "makehuman_walk1") {
        return text(kino_embedded_makehuman_walk1, kino_embedded_makehuman_walk1_end);
    }
    if (name == "makehuman_dance1") {
        return text(kino_embedded_makehuman_dance1, kino_embedded_makehuman_dance1_end);
    }
    if (name == "makehuman_tpose") {
        return text(kino_embedded_makehuman_tpose, kino_embedded_makehuman_tpose_end);
    }
    return {};
}

}  // namespace kino
