#include <OniCAPI.h>
#include <gtest/gtest.h>

#include <cstddef>
#include <type_traits>

#include "sensor/openni2/openni_c.h"

/// The interface as declared in the program against the real headers.
namespace kino {
namespace {

#define SAME_FIELD(ours, a, theirs, b)                               \
    static_assert(offsetof(openni::ours, a) == offsetof(theirs, b)); \
    static_assert(sizeof(openni::ours::a) == sizeof(theirs::b))

static_assert(sizeof(openni::DeviceInfo) == sizeof(OniDeviceInfo));
SAME_FIELD(DeviceInfo, vendor, OniDeviceInfo, vendor);
SAME_FIELD(DeviceInfo, name, OniDeviceInfo, name);
SAME_FIELD(DeviceInfo, usb_product, OniDeviceInfo, usbProductId);
static_assert(sizeof(openni::VideoMode) == sizeof(OniVideoMode));
SAME_FIELD(VideoMode, width, OniVideoMode, resolutionX);
SAME_FIELD(VideoMode, fps, OniVideoMode, fps);
static_assert(sizeof(openni::SensorInfo) == sizeof(OniSensorInfo));
SAME_FIELD(SensorInfo, modes, OniSensorInfo, pSupportedVideoModes);
static_assert(sizeof(openni::Cropping) == sizeof(OniCropping));
SAME_FIELD(Cropping, width, OniCropping, width);
static_assert(sizeof(openni::Seek) == sizeof(OniSeek));
SAME_FIELD(Seek, stream, OniSeek, stream);
static_assert(sizeof(openni::DeviceCallbacks) == sizeof(OniDeviceCallbacks));
SAME_FIELD(DeviceCallbacks, disconnected, OniDeviceCallbacks, deviceDisconnected);
SAME_FIELD(DeviceCallbacks, state_changed, OniDeviceCallbacks, deviceStateChanged);
static_assert(sizeof(openni::Frame) == sizeof(OniFrame));
SAME_FIELD(Frame, data, OniFrame, data);
SAME_FIELD(Frame, timestamp_us, OniFrame, timestamp);
SAME_FIELD(Frame, index, OniFrame, frameIndex);
SAME_FIELD(Frame, mode, OniFrame, videoMode);
SAME_FIELD(Frame, cropped, OniFrame, croppingEnabled);
SAME_FIELD(Frame, stride, OniFrame, stride);

static_assert(sizeof(openni::Status) == sizeof(OniStatus) && sizeof(int) == sizeof(OniBool));
static_assert(openni::kApiVersion == ONI_API_VERSION);
static_assert(openni::kMaxText == ONI_MAX_STR);
static_assert(openni::kTimedOut == ONI_STATUS_TIME_OUT);
static_assert(openni::kSensorDepth == ONI_SENSOR_DEPTH && openni::kSensorColor == ONI_SENSOR_COLOR);
static_assert(openni::kSensorInfrared == ONI_SENSOR_IR);
static_assert(openni::kDepth1Mm == ONI_PIXEL_FORMAT_DEPTH_1_MM);
static_assert(openni::kDepth100Um == ONI_PIXEL_FORMAT_DEPTH_100_UM);
static_assert(openni::kShift92 == ONI_PIXEL_FORMAT_SHIFT_9_2);
static_assert(openni::kShift93 == ONI_PIXEL_FORMAT_SHIFT_9_3);
static_assert(openni::kRgb888 == ONI_PIXEL_FORMAT_RGB888);
static_assert(openni::kYuv422 == ONI_PIXEL_FORMAT_YUV422);
static_assert(openni::kYuyv == ONI_PIXEL_FORMAT_YUYV);
static_assert(openni::kGray8 == ONI_PIXEL_FORMAT_GRAY8);
static_assert(openni::kGray16 == ONI_PIXEL_FORMAT_GRAY16);
static_assert(openni::kJpeg == ONI_PIXEL_FORMAT_JPEG);
static_assert(openni::kDeviceSerialNumber == ONI_DEVICE_PROPERTY_SERIAL_NUMBER);
static_assert(openni::kDeviceImageRegistration == ONI_DEVICE_PROPERTY_IMAGE_REGISTRATION);
static_assert(openni::kDevicePlaybackSpeed == ONI_DEVICE_PROPERTY_PLAYBACK_SPEED);
static_assert(openni::kDevicePlaybackRepeat == ONI_DEVICE_PROPERTY_PLAYBACK_REPEAT_ENABLED);
static_assert(openni::kStreamCropping == ONI_STREAM_PROPERTY_CROPPING);
static_assert(openni::kStreamHorizontalFov == ONI_STREAM_PROPERTY_HORIZONTAL_FOV);
static_assert(openni::kStreamVerticalFov == ONI_STREAM_PROPERTY_VERTICAL_FOV);
static_assert(openni::kStreamVideoMode == ONI_STREAM_PROPERTY_VIDEO_MODE);
static_assert(openni::kStreamMirroring == ONI_STREAM_PROPERTY_MIRRORING);
static_assert(openni::kStreamAutoWhiteBalance == ONI_STREAM_PROPERTY_AUTO_WHITE_BALANCE);
static_assert(openni::kStreamAutoExposure == ONI_STREAM_PROPERTY_AUTO_EXPOSURE);
static_assert(openni::kStreamExposure == ONI_STREAM_PROPERTY_EXPOSURE);
static_assert(openni::kStreamGain == ONI_STREAM_PROPERTY_GAIN);
static_assert(openni::kCommandSeek == ONI_DEVICE_COMMAND_SEEK);
static_assert(openni::kRegistrationDepthToColor == ONI_IMAGE_REGISTRATION_DEPTH_TO_COLOR);
static_assert(openni::kStateError == ONI_DEVICE_STATE_ERROR);

template <class R, class... A>
constexpr std::size_t arguments(R (*)(A...)) {
    return sizeof...(A);
}

TEST(OpenniInterface, FunctionsTakeAsManyArguments) {
#define SAME_COUNT(name) \
    static_assert(arguments(decltype(openni::Api::name){}) == arguments(decltype(&oni##name){}))
    SAME_COUNT(Initialize);
    SAME_COUNT(GetDeviceList);
    SAME_COUNT(ReleaseDeviceList);
    SAME_COUNT(RegisterDeviceCallbacks);
    SAME_COUNT(WaitForAnyStream);
    SAME_COUNT(DeviceOpen);
    SAME_COUNT(DeviceGetSensorInfo);
    SAME_COUNT(DeviceCreateStream);
    SAME_COUNT(DeviceEnableDepthColorSync);
    SAME_COUNT(DeviceSetProperty);
    SAME_COUNT(DeviceGetProperty);
    SAME_COUNT(DeviceInvoke);
    SAME_COUNT(DeviceIsImageRegistrationModeSupported);
    SAME_COUNT(StreamStart);
    SAME_COUNT(StreamReadFrame);
    SAME_COUNT(StreamSetProperty);
    SAME_COUNT(StreamGetProperty);
    SAME_COUNT(FrameRelease);
    SAME_COUNT(SetLogConsoleOutput);
#undef SAME_COUNT
}

}  // namespace
}  // namespace kino
