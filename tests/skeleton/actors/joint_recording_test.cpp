#include "skeleton/actors/joint_recording.h"

#include <gtest/gtest.h>

#include <string>

#include "tests/skeleton/actors/fuzz/joint_recording_targets.h"
#include "tests/support/random.h"

namespace kino {
namespace {

std::string line_of(int value) {
    std::string line = std::to_string(value);
    for (int i = 1; i < 60; ++i) line += "," + std::to_string(value + i);
    return line + "\n";
}

const std::string kHeader = "kinoscope joints,1,30\n";

TEST(JointRecording, ReadsWhatIsWritten) {
    const auto read =
        parse_joint_recording(kHeader + "# a note\n\n" + line_of(-20) + line_of(1000), "x");
    ASSERT_TRUE(read);
    EXPECT_EQ(read->rate_hz, 30);
    ASSERT_EQ(read->frames.size(), 2u);
    EXPECT_DOUBLE_EQ(read->frames[0][0].x, -0.020);
    EXPECT_DOUBLE_EQ(read->frames[1][19].z, 1.059);
    EXPECT_DOUBLE_EQ(read->frames[1][2].y, 1.007);
}

TEST(JointRecording, NamesWhatIsWrong) {
    const auto error = [](const std::string& text) {
        const auto read = parse_joint_recording(text, "file");
        return read ? std::string("none") : read.error().to_string();
    };
    EXPECT_NE(error("").find("no joint recording"), std::string::npos);
    EXPECT_NE(error("kinoscope joints,2,30\n" + line_of(0)).find("no joint recording"),
              std::string::npos);
    for (const char* rate : {"0", "1001", "30.5", "x", "", "-3"}) {
        EXPECT_NE(error(std::string("kinoscope joints,1,") + rate + "\n" + line_of(0)).find("rate"),
                  std::string::npos)
            << rate;
    }
    EXPECT_NE(error(kHeader).find("no frames"), std::string::npos);
    EXPECT_NE(error(kHeader + line_of(0) + line_of(19990)).find("line 3"), std::string::npos);
    EXPECT_NE(error(kHeader + "1,2,3\n").find("line 2"), std::string::npos);
    std::string long_line = line_of(0);
    long_line.insert(long_line.size() - 1, ",7");
    EXPECT_NE(error(kHeader + long_line).find("line 2"), std::string::npos);
    EXPECT_NE(error(kHeader + "1.5" + line_of(0)).find("line 2"), std::string::npos);
    EXPECT_FALSE(read_joint_recording("tests/data/motion/none.csv"));
    EXPECT_FALSE(read_joint_recording("/dev/zero")) << "it has no end";
}

TEST(JointRecording, SurvivesMutations) {
    test::Random random(77);
    const std::string seed = kHeader + line_of(-100) + line_of(300) + line_of(5);
    for (int i = 0; i < 3000; ++i) {
        std::string text = seed;
        for (int k = random.integer(1, 5); k > 0; --k) {
            const auto at =
                static_cast<std::size_t>(random.integer(0, static_cast<int>(text.size()) - 1));
            switch (random.integer(0, 3)) {
                case 0:
                    text[at] = static_cast<char>(random.integer(0, 255));
                    break;
                case 1:
                    text[at] = "0123456789,-\n#"[random.integer(0, 13)];
                    break;
                case 2:
                    text.erase(at, static_cast<std::size_t>(random.integer(1, 20)));
                    break;
                default:
                    text.insert(at, text.substr(static_cast<std::size_t>(random.integer(
                                                    0, static_cast<int>(text.size()) - 1)),
                                                30));
            }
            if (text.empty()) text = "k";
        }
        fuzz::joint_recording({reinterpret_cast<const std::uint8_t*>(text.data()), text.size()});
    }
}

}  // namespace
}  // namespace kino
