#pragma once

#include <cstdint>

/// What the program needs of OpenNI2's binary interface (2.2, the one Debian ships), declared here
/// so that neither its headers nor its library are needed to build. tests/sensor/openni2 compares
/// sizes, offsets and numbers with the real headers.
namespace kino::openni {

constexpr int kApiVersion = 2 * 1000 + 2;
constexpr int kMaxText = 256;

using Status = int;  ///< 0 is success
constexpr Status kOk = 0;
constexpr Status kTimedOut = 102;

constexpr int kSensorInfrared = 1;
constexpr int kSensorColor = 2;
constexpr int kSensorDepth = 3;

constexpr int kDepth1Mm = 100;
constexpr int kDepth100Um = 101;
constexpr int kShift92 = 102;
constexpr int kShift93 = 103;
constexpr int kRgb888 = 200;
constexpr int kYuv422 = 201;  ///< u y1 v y2
constexpr int kGray8 = 202;
constexpr int kGray16 = 203;
constexpr int kJpeg = 204;
constexpr int kYuyv = 205;

constexpr int kDeviceSerialNumber = 3;
constexpr int kDeviceImageRegistration = 5;
constexpr int kDevicePlaybackSpeed = 100;   ///< float; -1 waits for a reader
constexpr int kDevicePlaybackRepeat = 101;  ///< int
constexpr int kStreamCropping = 0;
constexpr int kStreamHorizontalFov = 1;  ///< float, radians
constexpr int kStreamVerticalFov = 2;    ///< float, radians
constexpr int kStreamVideoMode = 3;
constexpr int kStreamMirroring = 7;           ///< int
constexpr int kStreamAutoWhiteBalance = 100;  ///< int
constexpr int kStreamAutoExposure = 101;      ///< int
constexpr int kStreamExposure = 102;          ///< int
constexpr int kStreamGain = 103;              ///< int
constexpr int kCommandSeek = 1;
constexpr int kRegistrationOff = 0;
constexpr int kRegistrationDepthToColor = 1;
constexpr int kStateError = 1;

struct DeviceInfo {
    char uri[kMaxText];
    char vendor[kMaxText];
    char name[kMaxText];
    std::uint16_t usb_vendor;
    std::uint16_t usb_product;
};

struct VideoMode {
    int pixel_format;
    int width;
    int height;
    int fps;
};

struct SensorInfo {
    int sensor;
    int mode_count;
    VideoMode* modes;
};

struct Cropping {
    int enabled;
    int x;
    int y;
    int width;
    int height;
};

struct Frame {
    int bytes;
    void* data;
    int sensor;
    std::uint64_t timestamp_us;
    int index;
    int width;
    int height;
    VideoMode mode;
    int cropped;
    int crop_x;
    int crop_y;
    int stride;  ///< bytes
};

struct Device;
struct Stream;
struct Callbacks;

struct Seek {
    int frame;
    Stream* stream;
};

struct DeviceCallbacks {
    void (*connected)(const DeviceInfo*, void* cookie);
    void (*disconnected)(const DeviceInfo*, void* cookie);
    void (*state_changed)(const DeviceInfo*, int state, void* cookie);
};

/// The functions used, by their names in the library without "oni".
struct Api {
    Status (*Initialize)(int version);
    const char* (*GetExtendedError)();
    Status (*SetLogConsoleOutput)(int on);
    Status (*SetLogFileOutput)(int on);
    Status (*GetDeviceList)(DeviceInfo** devices, int* count);
    Status (*ReleaseDeviceList)(DeviceInfo* devices);
    Status (*RegisterDeviceCallbacks)(DeviceCallbacks*, void* cookie, Callbacks** handle);
    Status (*WaitForAnyStream)(Stream** streams, int count, int* index, int timeout_ms);
    Status (*DeviceOpen)(const char* uri, Device** device);
    Status (*DeviceClose)(Device*);
    const SensorInfo* (*DeviceGetSensorInfo)(Device*, int sensor);
    Status (*DeviceGetInfo)(Device*, DeviceInfo*);
    Status (*DeviceCreateStream)(Device*, int sensor, Stream** stream);
    Status (*DeviceEnableDepthColorSync)(Device*);
    void (*DeviceDisableDepthColorSync)(Device*);
    Status (*DeviceSetProperty)(Device*, int id, const void* data, int size);
    Status (*DeviceGetProperty)(Device*, int id, void* data, int* size);
    int (*DeviceIsPropertySupported)(Device*, int id);
    Status (*DeviceInvoke)(Device*, int command, void* data, int size);
    int (*DeviceIsImageRegistrationModeSupported)(Device*, int mode);
    void (*StreamDestroy)(Stream*);
    Status (*StreamStart)(Stream*);
    void (*StreamStop)(Stream*);
    Status (*StreamReadFrame)(Stream*, Frame** frame);
    Status (*StreamSetProperty)(Stream*, int id, const void* data, int size);
    Status (*StreamGetProperty)(Stream*, int id, void* data, int* size);
    int (*StreamIsPropertySupported)(Stream*, int id);
    void (*FrameRelease)(Frame*);
};

}  // namespace kino::openni
