#include <gtest/gtest.h>

#include <random>

#include "fuzz/gltf_target.h"
#include "gltf_sample.h"

namespace kino::test {
namespace {

using Bytes = std::vector<std::uint8_t>;

void mutate_bytes(Bytes& bytes, std::mt19937& random) {
    for (unsigned i = 0; i < 1 + random() % 5; ++i) {
        if (bytes.empty()) return;
        const std::size_t at = random() % bytes.size();
        switch (random() % 5) {
            case 0:
                bytes[at] = static_cast<std::uint8_t>(random());
                break;
            case 1:
                bytes[at] ^= static_cast<std::uint8_t>(1u << random() % 8);
                break;
            case 2:
                if (random() % 4 == 0) bytes.resize(at);
                break;
            case 3: {
                static constexpr char kDigits[] = "0123456789-e,[]{}\"";
                bytes[at] = static_cast<std::uint8_t>(kDigits[random() % 18]);
                break;
            }
            default:
                bytes.erase(bytes.begin() + static_cast<std::ptrdiff_t>(at));
                break;
        }
    }
}

/// Changes a value somewhere in the JSON: what survives the parser and meets the checks.
void mutate_json(nlohmann::json& json, std::mt19937& random) {
    nlohmann::json* at = &json;
    while (at->is_structured() && !at->empty()) {
        auto next = at->begin();
        std::advance(next, static_cast<std::ptrdiff_t>(random() % at->size()));
        if (random() % 12 == 0) {
            if (at->is_array()) {
                at->push_back(*next);
            } else {
                at->erase(next);
            }
            return;
        }
        at = &*next;
    }
    static const std::vector<nlohmann::json> kValues = {0,
                                                        1,
                                                        2,
                                                        -1,
                                                        5121,
                                                        5123,
                                                        5125,
                                                        5126,
                                                        4294967295u,
                                                        1u << 31,
                                                        1e300,
                                                        0.5,
                                                        "VEC3",
                                                        "x",
                                                        "MAT4",
                                                        true,
                                                        nullptr,
                                                        nlohmann::json::array(),
                                                        nlohmann::json::object(),
                                                        3,
                                                        7};
    *at = kValues[random() % kValues.size()];
}

TEST(GltfMutations, WhateverIsAcceptedIsSound) {
    const GltfSample sample = make_gltf_sample();
    std::mt19937 random(5);
    int accepted = 0;
    for (int round = 0; round < 1500; ++round) {
        GltfSample changed = sample;
        if (round % 2 == 0) {
            for (unsigned i = 0; i < 1 + random() % 2; ++i) mutate_json(changed.json, random);
        }
        Bytes bytes = round % 4 < 2 ? changed.as_glb() : changed.as_gltf();
        if (round % 2 == 1) mutate_bytes(bytes, random);
        accepted += fuzz::gltf(bytes);
    }
    // Some mutations are harmless; a reader that refuses everything would prove nothing.
    EXPECT_GT(accepted, 100);
    EXPECT_LT(accepted, 1400);
}

}  // namespace
}  // namespace kino::test
