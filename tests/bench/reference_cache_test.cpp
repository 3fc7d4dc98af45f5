#include "apps/bench/reference_cache.h"

#include <gmock/gmock.h>
#include <unistd.h>

#include <algorithm>
#include <bit>
#include <chrono>
#include <cstring>
#include <glm/vec3.hpp>
#include <limits>
#include <set>
#include <string>
#include <thread>
#include <vector>

#include "tests/support/random.h"
#include "tests/support/temp_dir.h"

namespace kino::bench {
namespace {

using testing::HasSubstr;
using testing::IsEmpty;
using testing::SizeIs;
using Counts = ReferenceCache::Counts;

/// Doubles of all sorts, those that are equal to nothing among them.
Image<glm::dvec3> hard_picture(std::uint64_t seed, int width, int height) {
    test::Random random(seed);
    Image<glm::dvec3> picture(width, height);
    const double hard[] = {0.0, -0.0, std::numeric_limits<double>::infinity(),
                           std::numeric_limits<double>::quiet_NaN(),
                           std::numeric_limits<double>::denorm_min()};
    for (glm::dvec3& pixel : picture.pixels()) {
        for (int k = 0; k < 3; ++k) {
            pixel[k] = random.chance(0.2) ? hard[random.integer(0, 4)] : random.real(-9, 9);
        }
    }
    return picture;
}

bool same_bits(const Image<glm::dvec3>& a, const Image<glm::dvec3>& b) {
    return a.width() == b.width() && a.height() == b.height() &&
           std::memcmp(a.data(), b.data(), a.size() * sizeof(glm::dvec3)) == 0;
}

ReferenceKey key_of(int number) {
    return ReferenceKey("some-picture", "1").add(number);
}

std::vector<std::filesystem::path> files_of(const std::filesystem::path& folder) {
    std::vector<std::filesystem::path> files;
    for (const auto& file : std::filesystem::directory_iterator(folder)) files.push_back(file);
    std::sort(files.begin(), files.end());
    return files;
}

/// What a fresh program would get.
struct Asked {
    Image<glm::dvec3> picture;
    Counts counts;
    std::vector<std::string> said;
};
Asked ask(const std::filesystem::path& folder, const ReferenceKey& key,
          const Image<glm::dvec3>& truth, std::uint64_t most_bytes = 1 << 20) {
    Asked asked;
    ReferenceCache cache({.folder = folder, .most_bytes = most_bytes, .say = [&](auto sentence) {
                              asked.said.push_back(std::move(sentence));
                          }});
    auto got = cache.image<glm::dvec3>(key, [&] { return truth; });
    if (got) asked.picture = std::move(*got);
    asked.counts = cache.counts();
    return asked;
}

TEST(ContentHash, PublishedValues) {
    const auto of = [](std::string_view text) {
        return ContentHash().bytes(std::as_bytes(std::span(text.data(), text.size()))).hex();
    };
    EXPECT_EQ(of(""), "6c62272e07bb014262b821756295c58d");
    EXPECT_EQ(of("a"), "d228cb696f1a8caf78912b704e4a8964");
    EXPECT_EQ(of("foobar"), "343e1662793c64bf6f0d3597ba446f18");
}

TEST(ContentHash, TellsApartWhatLooksAlike) {
    std::set<std::string> seen;
    const auto add = [&](const ContentHash& hash) { return seen.insert(hash.hex()).second; };
    EXPECT_TRUE(add(ContentHash()));
    EXPECT_TRUE(add(ContentHash().text("")));
    EXPECT_TRUE(add(ContentHash().text("ab").text("c")));
    EXPECT_TRUE(add(ContentHash().text("a").text("bc")));
    EXPECT_TRUE(add(ContentHash().value(1.5)));
    EXPECT_TRUE(add(ContentHash().value(1.5f)));
    EXPECT_TRUE(add(ContentHash().value(-0.0)));
    EXPECT_NE(ContentHash().value(0.0), ContentHash().value(-0.0));
    EXPECT_TRUE(add(ContentHash().values(std::vector<int>{1, 2}).values(std::vector<int>{3})));
    EXPECT_TRUE(add(ContentHash().values(std::vector<int>{1}).values(std::vector<int>{2, 3})));
    // Pictures of the same pixels in other shapes.
    const Image<float> wide(6, 2), high(2, 6);
    EXPECT_NE(ReferenceKey("a", "").add(wide).file_name(),
              ReferenceKey("a", "").add(high).file_name());
    // Every bit of a megabyte counts: one is turned at random places.
    test::Random random(4);
    std::vector<std::uint8_t> bytes(1 << 16);
    for (int i = 0; i < 200; ++i) {
        bytes[static_cast<std::size_t>(random.integer(0, (1 << 16) - 1))] ^=
            static_cast<std::uint8_t>(1 << random.integer(0, 7));
        EXPECT_TRUE(add(ContentHash().values(bytes)));
    }
}

TEST(ReferenceKey, ChangesWithEverythingAdded) {
    const auto key = [](const char* name, const char* code, double sigma, int frame) {
        return ReferenceKey(name, code).add(sigma).add(frame).add(glm::dvec3(sigma)).file_name();
    };
    const std::set<std::string> names = {key("a", "1", 0.5, 1), key("b", "1", 0.5, 1),
                                         key("a", "2", 0.5, 1), key("a", "1", 0.25, 1),
                                         key("a", "1", 0.5, 2)};
    EXPECT_THAT(names, SizeIs(5));
    EXPECT_EQ(key("a", "1", 0.5, 1), key("a", "1", 0.5, 1));
    EXPECT_DEATH(ReferenceKey("../a", ""), "check");
    EXPECT_DEATH(ReferenceKey("", ""), "check");
}

TEST(ReferenceCache, SameKeySameBitsOtherKeyOtherFile) {
    const test::TempDir temp;
    const auto folder = temp / "a/b";
    const auto first = hard_picture(1, 31, 7), second = hard_picture(2, 31, 7);
    const Asked made = ask(folder, key_of(1), first);
    EXPECT_TRUE(same_bits(made.picture, first));
    EXPECT_EQ(made.counts, (Counts{.found = 0, .made = 1}));
    // What is kept counts, not what would be made now.
    const Asked found = ask(folder, key_of(1), second);
    EXPECT_TRUE(same_bits(found.picture, first));
    EXPECT_EQ(found.counts, (Counts{.found = 1, .made = 0}));
    EXPECT_TRUE(same_bits(ask(folder, key_of(2), second).picture, second));
    EXPECT_TRUE(same_bits(ask(folder, key_of(1), second).picture, first));
    EXPECT_THAT(files_of(folder), SizeIs(2));

    ReferenceCache cache({.folder = folder});
    const std::vector<float> numbers = {1, -0.0f, 3};
    for (int round = 0; round < 2; ++round) {
        const auto got = cache.values<float>(key_of(3), [&] { return numbers; });
        ASSERT_TRUE(got);
        EXPECT_EQ(*got, numbers);
        const auto none = cache.values<float>(key_of(4), [] { return std::vector<float>(); });
        ASSERT_TRUE(none);
        EXPECT_THAT(*none, IsEmpty());
    }
    EXPECT_EQ(cache.counts(), (Counts{.found = 2, .made = 2}));
}

TEST(ReferenceCache, WithoutAFolderNothingIsKept) {
    ReferenceCache cache;
    for (int round = 0; round < 3; ++round) {
        const auto got = cache.values<int>(key_of(1), [&] { return std::vector<int>{round}; });
        ASSERT_TRUE(got);
        EXPECT_EQ(*got, std::vector<int>{round});
    }
    EXPECT_EQ(cache.counts(), (Counts{.found = 0, .made = 3}));
}

TEST(ReferenceCache, AnErrorIsPassedOnAndNotKept) {
    const test::TempDir temp;
    ReferenceCache cache({.folder = temp.path()});
    const auto broken = cache.values<int>(
        key_of(1), []() -> Result<std::vector<int>> { return kino::fail("no device"); });
    ASSERT_FALSE(broken);
    EXPECT_EQ(broken.error().what, "no device");
    EXPECT_THAT(files_of(temp.path()), IsEmpty());
}

TEST(ReferenceCache, WhateverIsBrokenIsMadeAnewAndSaid) {
    const test::TempDir temp;
    const auto truth = hard_picture(3, 2, 1);
    ask(temp.path(), key_of(1), truth);
    ASSERT_THAT(files_of(temp.path()), SizeIs(1));
    const auto path = files_of(temp.path())[0];
    const std::string good = test::read_bytes(path);
    const auto expect_made_anew = [&](const std::string& bytes, const std::string& what) {
        temp.write(path.filename().string(), bytes);
        const Asked asked = ask(temp.path(), key_of(1), truth);
        EXPECT_TRUE(same_bits(asked.picture, truth)) << what;
        EXPECT_EQ(asked.counts, (Counts{.found = 0, .made = 1, .broken = 1})) << what;
        ASSERT_THAT(asked.said, SizeIs(1)) << what;
        EXPECT_THAT(asked.said[0], HasSubstr("made anew"));
        EXPECT_EQ(test::read_bytes(path), good) << what << ": mended";
    };
    // Cut at every length, longer, and every byte turned: sizes, keys, checksums, elements.
    for (std::size_t size = 0; size < good.size(); size += size < 70 ? 1 : 13) {
        expect_made_anew(good.substr(0, size), "cut at " + std::to_string(size));
    }
    expect_made_anew(good + "x", "longer");
    expect_made_anew(std::string(1 << 12, '\0'), "zeros");
    test::Random random(5);
    for (std::size_t at = 0; at < good.size(); ++at) {
        std::string bad = good;
        bad[at] = static_cast<char>(bad[at] ^ (1 << random.integer(0, 7)));
        expect_made_anew(bad, "byte " + std::to_string(at));
    }
    // Another key's file under this name, and elements of another size.
    ask(temp.path(), key_of(2), truth);
    for (const auto& file : files_of(temp.path())) {
        if (file != path) expect_made_anew(test::read_bytes(file), "another's");
    }
    temp.write(path.filename().string(), good);
    ReferenceCache cache({.folder = temp.path()});
    EXPECT_EQ(cache.values<float>(key_of(1), [] { return std::vector<float>{2}; })->size(), 1u);
    EXPECT_EQ(cache.counts().broken, 1);
}

TEST(ReferenceCache, AFolderThatCannotBeWrittenIsSaidAndDoesNoHarm) {
    const test::TempDir temp;
    temp.write("file", "in the way");
    const auto truth = hard_picture(4, 3, 3);
    const Asked asked = ask(temp / "file/below", key_of(1), truth);
    EXPECT_TRUE(same_bits(asked.picture, truth));
    ASSERT_THAT(asked.said, SizeIs(1));
    EXPECT_THAT(asked.said[0], HasSubstr("not kept"));
}

TEST(ReferenceCache, StaysBelowItsSizeByWhatWasNotUsedForLong) {
    const test::TempDir temp;
    const auto truth = hard_picture(5, 10, 10);
    const std::uint64_t one = 64 + 2400, room = 3 * one + 10;
    const auto age = [&](const ReferenceKey& key, int hours) {
        std::filesystem::last_write_time(
            temp / key.file_name(),
            std::filesystem::file_time_type::clock::now() - std::chrono::hours(hours));
    };
    for (int i = 0; i < 3; ++i) {
        ask(temp.path(), key_of(i), truth, room);
        age(key_of(i), 10 - i);
    }
    // Used again, the oldest is the newest.
    EXPECT_EQ(ask(temp.path(), key_of(0), truth, room).counts.found, 1);
    ask(temp.path(), key_of(3), truth, room);
    EXPECT_THAT(files_of(temp.path()), SizeIs(3));
    EXPECT_TRUE(std::filesystem::exists(temp / key_of(0).file_name()));
    EXPECT_FALSE(std::filesystem::exists(temp / key_of(1).file_name()));
    // What would not fit alone is not kept, and drives nobody out.
    EXPECT_TRUE(same_bits(ask(temp.path(), key_of(4), truth, one - 1).picture, truth));
    EXPECT_THAT(files_of(temp.path()), SizeIs(3));
    // What a writer that died left behind goes after an hour; what somebody writes now stays.
    temp.write("old.part", "x");
    temp.write("new.part", "x");
    temp.write("somebody.txt", "x");
    std::filesystem::last_write_time(
        temp / "old.part", std::filesystem::file_time_type::clock::now() - std::chrono::hours(2));
    ask(temp.path(), key_of(5), truth, room);
    EXPECT_FALSE(std::filesystem::exists(temp / "old.part"));
    EXPECT_TRUE(std::filesystem::exists(temp / "new.part"));
    EXPECT_TRUE(std::filesystem::exists(temp / "somebody.txt"));
}

TEST(ReferenceCache, WritersAtOnceNeverSeeHalfAFile) {
    const test::TempDir temp;
    std::vector<Image<glm::dvec3>> truths;
    for (int k = 0; k < 4; ++k) truths.push_back(hard_picture(10 + k, 40, 30));
    std::vector<Counts> counts(4);
    std::vector<int> wrong(4);
    std::vector<std::thread> threads;
    for (int t = 0; t < 4; ++t) {
        threads.emplace_back([&, t] {
            test::Random random(100 + static_cast<std::uint64_t>(t));
            // Room for two of four, so that files also go while others read them.
            ReferenceCache cache({.folder = temp.path(), .most_bytes = 2 * (64 + 24 * 1200)});
            for (int i = 0; i < 100; ++i) {
                const int k = random.integer(0, 3);
                const auto& truth = truths[static_cast<std::size_t>(k)];
                const auto got = cache.image<glm::dvec3>(key_of(k), [&] { return truth; });
                wrong[static_cast<std::size_t>(t)] += !got || !same_bits(*got, truth);
            }
            counts[static_cast<std::size_t>(t)] = cache.counts();
        });
    }
    for (std::thread& thread : threads) thread.join();
    int found = 0;
    for (std::size_t t = 0; t < 4; ++t) {
        EXPECT_EQ(wrong[t], 0);
        EXPECT_EQ(counts[t].broken, 0);
        EXPECT_EQ(counts[t].found + counts[t].made, 100);
        found += counts[t].found;
    }
    EXPECT_GT(found, 0);
}

TEST(DefaultCacheFolder, FollowsTheStandard) {
    const char* before = std::getenv("XDG_CACHE_HOME");
    const std::string kept = before != nullptr ? before : "";
    setenv("XDG_CACHE_HOME", "/some/where", 1);
    EXPECT_EQ(default_cache_folder(), "/some/where/kinoscope/bench");
    setenv("XDG_CACHE_HOME", "relative", 1);
    EXPECT_NE(default_cache_folder(), "relative/kinoscope/bench");
    before != nullptr ? setenv("XDG_CACHE_HOME", kept.c_str(), 1) : unsetenv("XDG_CACHE_HOME");
}

}  // namespace
}  // namespace kino::bench
