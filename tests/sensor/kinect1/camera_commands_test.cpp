#include "sensor/kinect1/camera_commands.h"

#include <gtest/gtest.h>

#include <array>

#include "fake_kinect.h"

namespace kino::kinect1 {
namespace {

using test::FakeKinect;
using test::ReplySpoiler;
using usb::Failure;

class CameraCommandsTest : public testing::Test {
  protected:
    void SetUp() override {
        device_ = FakeKinect::make();
        auto devices = device_->list(0x045e);
        ASSERT_TRUE(devices);
        auto handle = device_->open(devices->front());
        ASSERT_TRUE(handle);
        handle_ = std::move(*handle);
        // As patient as the real one in attempts, not in time.
        commands_.emplace(
            *handle_, CommandPatience{std::chrono::milliseconds(5), std::chrono::milliseconds(20),
                                      std::chrono::milliseconds(2000), 3});
    }
    std::shared_ptr<FakeKinect> device_;
    std::unique_ptr<usb::Handle> handle_;
    std::optional<CameraCommands> commands_;
};

TEST_F(CameraCommandsTest, WhatIsWrittenIsRead) {
    ASSERT_TRUE(commands_->write_register(0x12, 3));
    EXPECT_EQ(device_->camera.camera_register(0x12), 3);
    EXPECT_EQ(commands_->read_register(0x12).value(), 3);
    ASSERT_TRUE(commands_->write_color_register(0x106, 0x4321));
    EXPECT_EQ(device_->camera.color_register(0x106), 0x4321);
    EXPECT_EQ(commands_->read_color_register(0x106).value(), 0x4321);
}

TEST_F(CameraCommandsTest, TagsWrap) {
    for (int i = 0; i < 66000; ++i) ASSERT_TRUE(commands_->write_register(0x12, 1)) << i;
}

TEST_F(CameraCommandsTest, EverySpoiltAnswerIsOvercomeOnce) {
    for (const auto spoiler :
         {ReplySpoiler::wrong_magic, ReplySpoiler::wrong_command, ReplySpoiler::wrong_tag,
          ReplySpoiler::wrong_length, ReplySpoiler::odd_length, ReplySpoiler::cut_header,
          ReplySpoiler::empty_thrice, ReplySpoiler::empty_for_ever, ReplySpoiler::late_one_first}) {
        device_->camera.spoil({spoiler});
        const auto got = commands_->read_register(0x15);
        ASSERT_TRUE(got) << static_cast<int>(spoiler);
        EXPECT_EQ(*got, 30);
    }
}

TEST_F(CameraCommandsTest, EveryLastingFlawEndsInAReadableFault) {
    const std::array<std::pair<ReplySpoiler, const char*>, 7> cases = {
        {{ReplySpoiler::wrong_magic, "without its mark"},
         {ReplySpoiler::wrong_command, "for another command"},
         {ReplySpoiler::wrong_tag, "for an earlier command"},
         {ReplySpoiler::wrong_length, "of another length"},
         {ReplySpoiler::odd_length, "of another length"},
         {ReplySpoiler::cut_header, "too short"},
         {ReplySpoiler::empty_for_ever, "no answer"}}};
    for (const auto& [spoiler, words] : cases) {
        device_->camera.spoil({}, spoiler);
        const auto got = commands_->read_register(0x15);
        ASSERT_FALSE(got) << words;
        EXPECT_NE(got.error().what.find("camera register 0x15"), std::string::npos);
        EXPECT_NE(got.error().what.find("3 attempts"), std::string::npos) << got.error().what;
        EXPECT_NE(got.error().what.find(words), std::string::npos) << got.error().what;
    }
    // And nothing of it sticks.
    device_->camera.spoil({});
    EXPECT_TRUE(commands_->read_register(0x15));
}

TEST_F(CameraCommandsTest, PassingTransferFailuresAreOvercome) {
    for (const auto failure : {Failure::timeout, Failure::stall, Failure::io, Failure::overflow,
                               Failure::interrupted, Failure::busy, Failure::no_memory}) {
        device_->camera.fail_out({failure});
        EXPECT_TRUE(commands_->read_register(0x15)) << usb::describe(failure);
        device_->camera.fail_in({failure, failure});
        EXPECT_TRUE(commands_->read_register(0x15)) << usb::describe(failure);
    }
}

TEST_F(CameraCommandsTest, LastingTransferFailuresKeepTheirKind) {
    for (const auto failure :
         {Failure::timeout, Failure::stall, Failure::io, Failure::overflow, Failure::busy,
          Failure::no_device, Failure::no_permission, Failure::not_found, Failure::unsupported,
          Failure::no_memory, Failure::interrupted}) {
        device_->camera.fail_out({failure, failure, failure});
        const auto got = commands_->read_register(0x15);
        ASSERT_FALSE(got);
        EXPECT_EQ(got.error().kind, failure);
        const Error error = usb::to_error(got.error(), "kinect1:");
        EXPECT_FALSE(error.what.empty());
        EXPECT_EQ(error.hint.empty(),
                  failure == Failure::interrupted || failure == Failure::unsupported);
        device_->camera.fail_out({});
    }
}

TEST_F(CameraCommandsTest, AGoneDeviceIsNotAskedAgain) {
    device_->camera.fail_out({Failure::no_device});
    EXPECT_EQ(commands_->read_register(0x15).error().kind, Failure::no_device);
    device_->unplug();
    EXPECT_EQ(commands_->read_register(0x15).error().kind, Failure::no_device);
}

TEST(ParseReply, SaysWhatIsWrong) {
    const test::Bytes good = {'R', 'B', 1, 0, 3, 0, 9, 0, 0, 0};
    const auto flaw = [&](std::size_t at, std::uint8_t value) {
        test::Bytes bytes = good;
        bytes[at] = value;
        return parse_reply(bytes, Command::write_register, 9).flaw;
    };
    EXPECT_EQ(parse_reply(good, Command::write_register, 9).flaw, ReplyFlaw::none);
    EXPECT_EQ(parse_reply(good, Command::write_register, 9).data.size(), 2u);
    EXPECT_EQ(flaw(0, 'G'), ReplyFlaw::magic);
    EXPECT_EQ(flaw(2, 2), ReplyFlaw::length);
    EXPECT_EQ(flaw(4, 2), ReplyFlaw::command);
    EXPECT_EQ(flaw(7, 1), ReplyFlaw::tag);
    EXPECT_EQ(parse_reply({}, Command::write_register, 9).flaw, ReplyFlaw::too_short);
}

}  // namespace
}  // namespace kino::kinect1
