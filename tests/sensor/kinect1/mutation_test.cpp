#include <gtest/gtest.h>

#include "fake_camera.h"
#include "fuzz/kinect1_targets.h"
#include "support/random.h"

/// The fuzz targets on seeded mutations of good inputs, in every ordinary run.
namespace kino {
namespace {

using test::Bytes;

void change(Bytes& bytes, test::Random& random) {
    const auto place = [&] {
        return static_cast<std::size_t>(random.integer(0, static_cast<int>(bytes.size()) - 1));
    };
    const int changes = random.integer(1, 8);
    for (int i = 0; i < changes && !bytes.empty(); ++i) {
        switch (random.integer(0, 3)) {
            case 0:
                bytes[place()] = static_cast<std::uint8_t>(random.bits());
                break;
            case 1:
                bytes[place()] ^= static_cast<std::uint8_t>(1u << random.integer(0, 7));
                break;
            case 2: {
                const auto from = static_cast<std::ptrdiff_t>(place());
                const auto room = static_cast<std::ptrdiff_t>(bytes.size()) - from;
                bytes.erase(
                    bytes.begin() + from,
                    bytes.begin() + from + std::min<std::ptrdiff_t>(room, random.integer(1, 2000)));
                break;
            }
            default:
                bytes.resize(random.chance(0.1) ? place() : bytes.size());
        }
    }
}

TEST(Kinect1Mutation, Packets) {
    test::Random random(31);
    for (int mode = 0; mode < 6; ++mode) {
        Bytes good = {static_cast<std::uint8_t>(mode)};
        std::uint8_t sequence = 9;
        const auto camera_mode = static_cast<kinect1::CameraMode>(mode);
        for (std::uint32_t f = 0; f < 2; ++f) {
            for (const Bytes& packet : test::packets_of(
                     camera_mode, test::random_frame(camera_mode, f), sequence, f * 2'000'000)) {
                good.push_back(static_cast<std::uint8_t>(packet.size() & 0xFF));
                good.push_back(static_cast<std::uint8_t>(packet.size() >> 8));
                good.insert(good.end(), packet.begin(), packet.end());
            }
        }
        fuzz::kinect1_packets(good);
        for (int i = 0; i < 12; ++i) {
            Bytes bad = good;
            change(bad, random);
            fuzz::kinect1_packets(bad);
        }
    }
}

TEST(Kinect1Mutation, Replies) {
    test::Random random(32);
    const Bytes zero_plane = test::zero_plane_block(7.5F, 2.3F, 120, 0.1042F);
    for (const Bytes& data :
         {test::real_registration_block(), zero_plane, Bytes(8, 1), Bytes{0, 0, 200, 0}}) {
        Bytes good = {'R', 'B', static_cast<std::uint8_t>(data.size() / 2), 0, 0x16, 0, 1, 0};
        good.insert(good.end(), data.begin(), data.end());
        fuzz::kinect1_replies(good);
        for (int i = 0; i < 100; ++i) {
            Bytes bad = good;
            change(bad, random);
            fuzz::kinect1_replies(bad);
        }
    }
}

}  // namespace
}  // namespace kino
