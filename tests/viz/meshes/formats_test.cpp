#include <bit>
#include <cmath>
#include <glm/gtc/matrix_transform.hpp>
#include <numeric>
#include <random>

#include "mesh_mix.h"
#include "viz/surface/mesh_probe.h"
#include "viz/surface/mesh_shapes.h"

namespace kino::test {
namespace {

struct Fetched {
    glm::vec3 position;
    float known;
    glm::vec3 normal;
    float u;
    glm::vec3 color;
    float v;
};

class FormatsTest : public VizTest {
  protected:
    FormatsTest() : world(device()) {}

    /// What the shader fetches for corners 0 .. corners - 1 of a row; and its count of errors.
    std::pair<std::vector<Fetched>, std::uint32_t> probe(MeshMix& mix, std::uint32_t row,
                                                         std::uint32_t corners) {
        graph::FrameGraph graph(world.executor.history());
        const MeshList list = mix.list(graph, view);
        auto out = gpu::Buffer::create(device(), "fetched", corners * sizeof(Fetched),
                                       gpu::MemoryUse::readback);
        auto errors = gpu::Buffer::create(device(), "errors", 4, gpu::MemoryUse::readback);
        EXPECT_TRUE(out && errors);
        std::memset(errors->mapped(), 0, 4);
        const MeshProbe made = add_fetch_probe(graph, list, row, corners,
                                               {.out = graph.import_buffer("fetched", *out),
                                                .errors = graph.import_buffer("errors", *errors)});
        graph.require(made.out);
        const auto report = world.executor.run(graph, graph::Timing::frame);
        EXPECT_TRUE(report) << (report ? "" : report.error().to_string());
        const auto values = out->read<Fetched>();
        return {{values.begin(), values.begin() + corners}, errors->read<std::uint32_t>()[0]};
    }

    static std::vector<std::uint32_t> upto(std::size_t count) {
        std::vector<std::uint32_t> numbers(count);
        std::iota(numbers.begin(), numbers.end(), 0u);
        return numbers;
    }

    MeshWorld world;
    View view = view_from({0, 0, 0}, {0, 0, -1}, 64, 48);
};

std::uint32_t bits(float v) {
    return std::bit_cast<std::uint32_t>(v);
}

/// A mesh with numbers that a fetch in the wrong place would show.
MeshAsset odd_mesh(int vertices) {
    MeshAsset mesh;
    std::mt19937 random(17);
    const auto uniform = [&] { return static_cast<float>(random() % 20001) / 10000.0f - 1; };
    for (int v = 0; v < vertices; ++v) {
        mesh.positions.emplace_back(3 * uniform() + 1, 0.2f * uniform(), 50 * uniform() - 7);
        mesh.normals.push_back(glm::normalize(glm::vec3(uniform(), uniform(), uniform() + 0.01f)));
        mesh.uvs.emplace_back(uniform(), uniform());
        mesh.indices.push_back(static_cast<std::uint32_t>(v));
    }
    return mesh;
}

// Item 2 of the card's proof, on the same fetch code run by a compute shader.
TEST_F(FormatsTest, StaticVerticesAreFetchedExactly) {
    const MeshAsset mesh = odd_mesh(99);
    MeshMix mix(device());
    mix.add(pack_quantized(odd_mesh(7)), upto(6));  // something before it
    mix.draw(mix.add(pack_static(mesh), mesh.indices), glm::dmat4(1.0), 1);
    const auto [fetched, errors] = probe(mix, 0, 99);
    EXPECT_EQ(errors, 0u);
    for (std::size_t v = 0; v < 99; ++v) {
        EXPECT_EQ(fetched[v].known, 1);
        for (int k = 0; k < 3; ++k) {
            ASSERT_EQ(bits(fetched[v].position[k]), bits(mesh.positions[v][k])) << v;
            ASSERT_EQ(bits(fetched[v].normal[k]), bits(mesh.normals[v][k])) << v;
        }
        ASSERT_EQ(bits(fetched[v].u), bits(mesh.uvs[v].x));
        ASSERT_EQ(bits(fetched[v].v), bits(mesh.uvs[v].y));
    }
}

TEST_F(FormatsTest, CloudsAreFetchedExactly) {
    const MeshAsset mesh = odd_mesh(50);
    std::vector<Rgba8> colors;
    for (int v = 0; v < 50; ++v) {
        colors.push_back({static_cast<std::uint8_t>(5 * v), static_cast<std::uint8_t>(255 - v),
                          static_cast<std::uint8_t>(7 * v), 255});
    }
    MeshMix mix(device());
    mix.add(pack_static(odd_mesh(5)), upto(3));
    mix.draw(mix.add(pack_cloud(mesh.positions, colors), upto(48)), glm::dmat4(1.0), 1);
    const auto [fetched, errors] = probe(mix, 0, 50);
    EXPECT_EQ(errors, 0u);
    const auto linear = [](std::uint8_t byte) {
        const double c = byte / 255.0;
        return c <= 0.04045 ? c / 12.92 : std::pow((c + 0.055) / 1.055, 2.4);
    };
    for (std::size_t v = 0; v < 50; ++v) {
        for (int k = 0; k < 3; ++k) {
            ASSERT_EQ(bits(fetched[v].position[k]), bits(mesh.positions[v][k])) << v;
        }
        EXPECT_NEAR(fetched[v].color.r, linear(colors[v].r), 1e-4);
        EXPECT_NEAR(fetched[v].color.g, linear(colors[v].g), 1e-4);
        EXPECT_NEAR(fetched[v].color.b, linear(colors[v].b), 1e-4);
    }
}

TEST_F(FormatsTest, QuantizedVerticesLieWithinHalfAStepOfTheirBox) {
    const MeshAsset mesh = odd_mesh(101);
    const PackedVertices packed = pack_quantized(mesh);
    MeshMix mix(device());
    mix.add(pack_quantized(odd_mesh(6)), upto(6));
    mix.draw(mix.add(packed, upto(99)), glm::dmat4(1.0), 1);
    const auto [fetched, errors] = probe(mix, 0, 101);
    EXPECT_EQ(errors, 0u);
    for (std::size_t v = 0; v < 101; ++v) {
        const glm::vec3 p = packed.center + packed.half * fetched[v].position;
        for (int k = 0; k < 3; ++k) {
            // The card's 2^-15 of the box's size; half a step is half of that.
            EXPECT_LE(std::abs(p[k] - mesh.positions[v][k]), 2 * packed.half[k] / 32768) << v;
        }
        EXPECT_LT(glm::length(glm::dvec3(fetched[v].normal) - glm::dvec3(mesh.normals[v])), 1e-4)
            << v;
    }
}

TEST_F(FormatsTest, DepthGridsAreUnprojectedAndDropWhatHasNoReading) {
    DepthGrid grid{.fx = 30, .fy = 31, .cx = 8.2f, .cy = 5.9f};
    grid.depth.resize(17, 11);
    for (int y = 0; y < 11; ++y) {
        for (int x = 0; x < 17; ++x) {
            grid.depth.at(x, y) = static_cast<std::uint16_t>(2000 + 3 * x + 5 * y);
        }
    }
    // A triangle whose corners all lack a reading has no edge, either.
    grid.depth.at(4, 3) = grid.depth.at(5, 3) = grid.depth.at(4, 4) = 0;
    grid.depth.at(12, 7) = 3000;  // an edge all round
    MeshMix mix(device());
    mix.add(pack_static(odd_mesh(3)), upto(3));
    const PackedVertices packed = pack_grid(grid);
    mix.draw(mix.add(packed, upto(packed.corners)), glm::dmat4(1.0), 1);
    const auto [fetched, errors] = probe(mix, 0, packed.corners);
    EXPECT_EQ(errors, 0u);
    int dropped = 0;
    for (std::size_t i = 0; i < packed.corners; ++i) {
        const int cell = static_cast<int>(i) / 6;
        const int corner = static_cast<int>(i) % 6;
        constexpr std::array<std::array<int, 2>, 6> kSteps = {
            {{0, 0}, {1, 0}, {0, 1}, {1, 0}, {1, 1}, {0, 1}}};
        const auto at = [&](int c) {
            return glm::ivec2(cell % 16 + kSteps[static_cast<std::size_t>(c)][0],
                              cell / 16 + kSteps[static_cast<std::size_t>(c)][1]);
        };
        const auto depth = [&](int c) { return int{grid.depth.at(at(c).x, at(c).y)}; };
        const int first = corner / 3 * 3;
        const int low = std::min({depth(first), depth(first + 1), depth(first + 2)});
        const int high = std::max({depth(first), depth(first + 1), depth(first + 2)});
        const bool joined = low > 0 && high - low <= 75;
        ASSERT_EQ(fetched[i].known > 0, joined) << i;
        dropped += !joined;
        const double z = depth(corner) * 0.001;
        const glm::dvec3 truth(((at(corner).x + 0.0) - 8.2f) / 30.0 * z,
                               -((at(corner).y + 0.0) - 5.9f) / 31.0 * z, -z);
        EXPECT_LT(glm::length(glm::dvec3(fetched[i].position) - truth), 1e-6 * (1 + z)) << i;
    }
    EXPECT_GT(dropped, 2 * 6 * 3);  // six triangles round a single one
}

// Item 1: objects of all static formats in one call, beside separate lists.
TEST_F(FormatsTest, MixedFormatsInOneCallDrawWhatEachDrawsAlone) {
    const auto sphere = make_sphere(0.5f, 16, 8);
    const auto box = make_box({0.7f, 0.7f, 0.7f});
    std::vector<Rgba8> colors(box->positions.size(), Rgba8{200, 80, 20, 255});
    DepthGrid grid{.fx = 30, .fy = 30, .cx = 16, .cy = 12};
    grid.depth.resize(33, 25);
    for (int y = 0; y < 25; ++y) {
        for (int x = 0; x < 33; ++x) {
            grid.depth.at(x, y) = static_cast<std::uint16_t>(4000 + 20 * (x % 3));
        }
    }
    const PackedVertices packed_grid = pack_grid(grid);
    // View space: camera axes.
    const auto place = [](double x, double y, double z) {
        return glm::translate(glm::dmat4(1.0), {x, y, z}) *
               glm::scale(glm::dmat4(1.0), {1, -1, -1});
    };
    const auto fill_mix = [&](MeshMix& mix, bool grid_too) {
        const std::size_t a = mix.add(pack_static(*sphere), sphere->indices);
        const std::size_t b = mix.add(pack_quantized(*sphere), sphere->indices);
        const std::size_t c = mix.add(pack_cloud(box->positions, colors), box->indices);
        mix.draw(a, place(-1, 0.5, 3), 1, {1, 0, 0});
        mix.draw(b, place(1, 0.5, 3), 2, {0, 1, 0});
        mix.draw(c, place(0, -0.6, 3), 3);
        mix.draw(a, place(0.4, 0.3, 2.5), 4, {0, 0, 1});
        if (grid_too) mix.draw(mix.add(packed_grid, upto(packed_grid.corners)), place(0, 0, 0), 5);
    };
    MeshMix mix(device());
    fill_mix(mix, true);
    const MeshPicture together =
        world.draw_list(view, [&](graph::FrameGraph& g) { return mix.list(g, view); });
    std::array<int, 6> pixels{};
    for (const std::uint32_t object : together.object.pixels()) ++pixels[std::min(object, 5u)];
    for (std::size_t object = 1; object < 6; ++object) EXPECT_GT(pixels[object], 20) << object;
    // Carriers and one call each.
    for (const DrawIdCarrier carrier : {DrawIdCarrier::draw_id, DrawIdCarrier::attribute}) {
        EXPECT_TRUE(same(together, world.draw_list(view, [&](graph::FrameGraph& g) {
            return mix.list(g, view, {.carrier = carrier});
        })));
    }
    EXPECT_TRUE(same(together, world.draw_list(view, [&](graph::FrameGraph& g) {
        return mix.list(g, view, {.submit = MeshSubmit::one_call_each});
    })));
    // Item 8: formats that no draw has may be compiled in, or not.
    MeshMix fewer(device());
    fill_mix(fewer, false);
    const MeshPicture needed =
        world.draw_list(view, [&](graph::FrameGraph& g) { return fewer.list(g, view); });
    fewer.formats = 0b11111;
    EXPECT_TRUE(same(
        needed, world.draw_list(view, [&](graph::FrameGraph& g) { return fewer.list(g, view); })));
    // The quantized sphere covers what the exact one would, but for its outline.
    const glm::dvec3 n = unpack_normal(together.normal.at(45, 15));
    EXPECT_NEAR(glm::length(n), 1, 1e-6);
}

// Item 9.
TEST_F(FormatsTest, UnknownFormatsDrawNothingAndAreCounted) {
    const auto box = make_box({1, 1, 1});
    MeshMix mix(device());
    const glm::dmat4 ahead = glm::translate(glm::dmat4(1.0), {0, 0, 3});
    mix.draw(mix.add(pack_static(*box), box->indices), ahead, 1);
    mix.rows[0].id = 9u << KINO_FIRST_VERTEX_BITS;
    EXPECT_EQ(probe(mix, 0, 36).second, 36u);
    const auto draw = [&] {
        return world.draw_list(view, [&](graph::FrameGraph& g) { return mix.list(g, view); });
    };
    const MeshPicture unknown = draw();
    for (const std::uint32_t object : unknown.object.pixels()) ASSERT_EQ(object, 0u);
    // Known, but not compiled in.
    mix.rows[0].id = KINO_FORMAT_STATIC << KINO_FIRST_VERTEX_BITS;
    mix.formats = 1u << KINO_FORMAT_CLOUD;
    EXPECT_EQ(probe(mix, 0, 36).second, 36u);
    const MeshPicture missing = draw();
    for (const std::uint32_t object : missing.object.pixels()) ASSERT_EQ(object, 0u);
}

TEST(DrawId, FieldsThatDoNotFitAreSeen) {
    EXPECT_TRUE(fits_draw_id(KINO_FORMAT_QUANTIZED, (1u << 27) - 1));
    EXPECT_FALSE(fits_draw_id(KINO_FORMAT_STATIC, 1u << 27));
    EXPECT_FALSE(fits_draw_id(32, 0));
}

}  // namespace
}  // namespace kino::test
