#include "calibration/files/calibration_store.h"

#include <gmock/gmock.h>

#include "tests/support/temp_dir.h"

namespace kino {
namespace {

TEST(CalibrationStore, FindsADeviceAgainByItsSerial) {
    const test::TempDir temp;
    const auto folder = temp / "a/b";
    RigParameters rig = default_kinect1_rig();
    EXPECT_FALSE(store_calibration(folder, rig));
    // The second would lie elsewhere, the third would meet the first, were they not written out.
    for (const char* serial : {"A00362", "../../etc/x", "A00362 ", "\xFF\n"}) {
        EXPECT_FALSE(stored_calibration(folder, serial).value()) << serial;
        rig.serial = serial;
        rig.depth.fx += 1;
        const auto file = store_calibration(folder, rig);
        ASSERT_TRUE(file) << file.error().to_string();
        EXPECT_EQ(file->parent_path(), folder);
        if (std::string(serial).find('\xFF') != std::string::npos) continue;  // JSON is UTF-8
        const auto found = stored_calibration(folder, serial);
        ASSERT_TRUE(found) << found.error().to_string();
        EXPECT_EQ(found->value(), rig);
    }
    rig.serial = "A00362";
    rig.depth.fx = 1;
    ASSERT_TRUE(store_calibration(folder, rig));
    EXPECT_EQ(stored_calibration(folder, "A00362")->value().depth.fx, 1);
    EXPECT_FALSE(stored_calibration(folder, "").value());
}

TEST(CalibrationStore, AnotherDevicesFileIsAnError) {
    const test::TempDir temp;
    RigParameters rig = default_kinect1_rig();
    rig.serial = "one";
    const auto file = store_calibration(temp.path(), rig);
    ASSERT_TRUE(file);
    std::filesystem::rename(*file, calibration_file(temp.path(), "two"));
    const auto found = stored_calibration(temp.path(), "two");
    ASSERT_FALSE(found);
    EXPECT_THAT(found.error().to_string(), testing::HasSubstr("calibration of one, not of two"));
    temp.write("three.json", "{}");
    EXPECT_FALSE(stored_calibration(temp.path(), "three"));
}

}  // namespace
}  // namespace kino
