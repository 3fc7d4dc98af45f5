#include <gtest/gtest.h>

#include <algorithm>
#include <random>

#include "viz/graph/graph.h"

namespace kino::graph {
namespace {

// The whole file works without a device: declaring and compiling a frame touches no Vulkan.

std::vector<std::string> names(const FrameGraph& graph, const CompiledGraph& compiled) {
    std::vector<std::string> out;
    for (const CompiledPass& pass : compiled.passes) out.push_back(graph.passes()[pass.pass].name);
    return out;
}

BufferId writer(FrameGraph& graph, const std::string& name, std::vector<BufferId> reads,
                std::uint64_t bytes = 64) {
    BufferId out = graph.create_buffer(name + " out", {bytes});
    graph.add_pass(
        name, "test",
        [&](PassBuilder& b) {
            for (const BufferId id : reads) b.read(id, Use::compute_read);
            out = b.write(out, Use::compute_write);
        },
        nullptr);
    return out;
}

TEST(FrameGraph, PassesThatLeadNowhereAreCulledAndCostNoBytes) {
    HistoryBook history;
    FrameGraph graph(history);
    const BufferId a = writer(graph, "a", {});
    const BufferId unread = writer(graph, "unread", {a}, 1 << 20);
    writer(graph, "reads unread", {unread}, 1 << 20);
    const BufferId b = writer(graph, "b", {a});
    graph.require(b);
    const CompiledGraph compiled = graph.compile();
    EXPECT_EQ(names(graph, compiled), (std::vector<std::string>{"a", "b"}));
    EXPECT_EQ(compiled.transient_bytes, 128u);
}

TEST(FrameGraph, NothingRequiredMeansNothingRuns) {
    HistoryBook history;
    FrameGraph graph(history);
    writer(graph, "a", {});
    const CompiledGraph compiled = graph.compile();
    EXPECT_TRUE(compiled.passes.empty());
    EXPECT_EQ(compiled.transient_bytes, 0u);
}

TEST(FrameGraph, SideEffectsRunUnread) {
    HistoryBook history;
    FrameGraph graph(history);
    graph.add_pass(
        "present", "test", [](PassBuilder& b) { b.side_effect(); }, nullptr);
    EXPECT_EQ(graph.compile().passes.size(), 1u);
}

TEST(FrameGraph, EarlierWritersOfAWantedResourceLive) {
    HistoryBook history;
    FrameGraph graph(history);
    BufferId shared = graph.create_buffer("shared", {64});
    for (const char* name : {"clear", "splat"}) {
        graph.add_pass(
            name, "test", [&](PassBuilder& b) { shared = b.write(shared, Use::compute_write); },
            nullptr);
    }
    graph.require(shared);
    EXPECT_EQ(names(graph, graph.compile()), (std::vector<std::string>{"clear", "splat"}));
}

TEST(FrameGraph, DisjointLifetimesShareMemoryOverlappingOnesDoNot) {
    HistoryBook history;
    FrameGraph graph(history);
    BufferId last = writer(graph, "p0", {}, 1000);
    for (int i = 1; i < 8; ++i) last = writer(graph, "p" + std::to_string(i), {last}, 1000);
    graph.require(last);
    const CompiledGraph compiled = graph.compile();
    // A chain needs two: the one read and the one written.
    EXPECT_EQ(compiled.slots.size(), 2u);
    EXPECT_EQ(compiled.transient_bytes, 2000u);
}

TEST(FrameGraphDeathTest, StaleIdIsFoundWhenThePassIsDeclared) {
    HistoryBook history;
    FrameGraph graph(history);
    const BufferId old = graph.create_buffer("buffer", {64});
    graph.add_pass(
        "write", "test", [&](PassBuilder& b) { (void)b.write(old, Use::compute_write); }, nullptr);
    EXPECT_DEATH(
        graph.add_pass(
            "read", "test", [&](PassBuilder& b) { b.read(old, Use::compute_read); }, nullptr),
        "check failed");
    EXPECT_DEATH(graph.require(old), "check failed");
}

TEST(FrameGraph, ReadAfterWriteWaitsOnceAndOnlyForTheWriter) {
    HistoryBook history;
    FrameGraph graph(history);
    const BufferId a = writer(graph, "a", {});
    const BufferId b = writer(graph, "b", {a});
    const BufferId c = writer(graph, "c", {a, b});
    graph.require(c);
    const CompiledGraph compiled = graph.compile();
    ASSERT_EQ(compiled.passes.size(), 3u);
    const CompiledPass& second = compiled.passes[1];
    EXPECT_TRUE(second.wait_stages & VK_PIPELINE_STAGE_2_COMPUTE_SHADER_BIT);
    EXPECT_TRUE(second.wait_access & VK_ACCESS_2_SHADER_STORAGE_WRITE_BIT);
    EXPECT_TRUE(second.access & VK_ACCESS_2_SHADER_STORAGE_READ_BIT);
}

TEST(FrameGraph, SecondReaderInTheSameStageNeedsNoBarrier) {
    HistoryBook history;
    FrameGraph graph(history);
    BufferId a = graph.import_buffer("a", BufferDesc{64});
    graph.add_pass(
        "write", "t", [&](PassBuilder& b) { a = b.write(a, Use::compute_write); }, nullptr);
    for (const char* name : {"read 1", "read 2"}) {
        graph.add_pass(
            name, "t",
            [&](PassBuilder& b) {
                b.read(a, Use::compute_read);
                b.side_effect();
            },
            nullptr);
    }
    const CompiledGraph compiled = graph.compile();
    ASSERT_EQ(compiled.passes.size(), 3u);
    EXPECT_TRUE(compiled.passes[1].has_barrier());
    EXPECT_FALSE(compiled.passes[2].has_barrier());
}

TEST(FrameGraph, WriteAfterReadWaitsForTheReaders) {
    HistoryBook history;
    FrameGraph graph(history);
    BufferId a = graph.import_buffer("a", BufferDesc{64});
    graph.add_pass(
        "read", "t",
        [&](PassBuilder& b) {
            b.read(a, Use::fragment_read);
            b.side_effect();
        },
        nullptr);
    graph.add_pass(
        "write", "t", [&](PassBuilder& b) { a = b.write(a, Use::transfer_write); }, nullptr);
    graph.require(a);
    const CompiledGraph compiled = graph.compile();
    ASSERT_EQ(compiled.passes.size(), 2u);
    EXPECT_TRUE(compiled.passes[1].wait_stages & VK_PIPELINE_STAGE_2_FRAGMENT_SHADER_BIT);
    EXPECT_TRUE(compiled.passes[1].stages & VK_PIPELINE_STAGE_2_ALL_TRANSFER_BIT);
}

// An independent model of the barrier rules: replays random graphs pass by pass and asks of every
// access whether the barriers so far make the last write of that memory visible to it.
TEST(FrameGraph, RandomGraphsHaveNoHazard) {
    std::mt19937 random(7);
    const std::array<Use, 4> reads = {Use::compute_read, Use::fragment_read, Use::transfer_read,
                                      Use::indirect_read};
    const std::array<Use, 2> writes = {Use::compute_write, Use::transfer_write};
    for (int round = 0; round < 200; ++round) {
        HistoryBook history;
        FrameGraph graph(history);
        std::vector<BufferId> ids;
        for (int i = 0; i < 5; ++i) {
            ids.push_back(i < 2 ? graph.import_buffer("i", BufferDesc{64})
                                : graph.create_buffer("t", {64}));
        }
        for (int pass = 0; pass < 12; ++pass) {
            graph.add_pass(
                "p" + std::to_string(pass), "t",
                [&](PassBuilder& b) {
                    const std::size_t from = random() % ids.size();
                    const std::size_t to = (from + 1 + random() % (ids.size() - 1)) % ids.size();
                    b.read(ids[from], reads[random() % reads.size()]);
                    ids[to] = b.write(ids[to], writes[random() % writes.size()]);
                    if (random() % 3 == 0) b.side_effect();
                },
                nullptr);
        }
        graph.require(ids[0]);
        const CompiledGraph compiled = graph.compile();
        struct Edge {
            std::size_t at;
            VkPipelineStageFlags2 from, to;
        };
        std::vector<Edge> barriers;
        const auto memory_of = [&](std::uint32_t r) {
            const std::uint32_t slot = compiled.slot_of_resource[r];
            return slot == UINT32_MAX ? 1000 + r : slot;
        };
        struct Touch {
            std::size_t pass;
            std::uint32_t memory;
            Access access;
        };
        std::vector<Touch> touches;
        for (std::size_t i = 0; i < compiled.passes.size(); ++i) {
            const CompiledPass& pass = compiled.passes[i];
            barriers.push_back({i, pass.wait_stages, pass.stages});
            for (const ResourceUse& use : graph.passes()[pass.pass].uses) {
                const Touch now{i, memory_of(use.resource), access_of(use.use)};
                for (const Touch& before : touches) {
                    if (before.memory != now.memory || before.pass == i) continue;
                    if (!before.access.writes && !now.access.writes) continue;
                    // Only the latest conflicting access matters; older ones are ordered by it.
                    const bool ordered =
                        std::any_of(barriers.begin(), barriers.end(), [&](const Edge& edge) {
                            const bool all = edge.from & VK_PIPELINE_STAGE_2_ALL_COMMANDS_BIT;
                            return edge.at > before.pass && edge.at <= i &&
                                   (all || (edge.from & before.access.stages));
                        });
                    EXPECT_TRUE(ordered) << "round " << round << " pass " << i;
                }
                touches.push_back(now);
            }
        }
    }
}

TEST(History, ValidFromTheSecondFrameAndVoidAfterACut) {
    HistoryBook book;
    const auto frame = [&](std::uint64_t bytes) {
        book.begin_frame();
        return book.want("effect/0", bytes);
    };
    EXPECT_FALSE(frame(64).valid);
    const auto second = frame(64);
    EXPECT_TRUE(second.valid);
    EXPECT_NE(second.current, frame(64).current);
    book.cut();
    EXPECT_FALSE(frame(64).valid);
    EXPECT_TRUE(frame(64).valid);
    EXPECT_FALSE(frame(128).valid) << "a new size starts afresh";
    EXPECT_EQ(book.total_bytes(), 256u);
}

TEST(History, UnwantedIsForgotten) {
    HistoryBook book;
    book.begin_frame();
    (void)book.want("effect/0", 64);
    book.begin_frame();
    EXPECT_EQ(book.total_bytes(), 0u);
    book.begin_frame();
    EXPECT_FALSE(book.want("effect/0", 64).valid);
}

TEST(FrameGraph, GraphvizNamesEveryPassAndMarksCulledOnes) {
    HistoryBook history;
    FrameGraph graph(history);
    graph.require(writer(graph, "kept", {}));
    writer(graph, "culled", {});
    const std::string dot = graph.to_graphviz();
    EXPECT_NE(dot.find("label=\"kept\"]"), std::string::npos);
    EXPECT_NE(dot.find("label=\"culled\" style=dashed]"), std::string::npos);
}

}  // namespace
}  // namespace kino::graph
