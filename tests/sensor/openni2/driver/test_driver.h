#pragma once

#include <OniCTypes.h>

/// What the test driver lets tests do behind the library's back. Device names are
/// "kino/<kind>/<serial>/<port>", the kind being one of
///   mm um shift2 shift3   depth of that format, RGB888, GRAY16 infrared
///   yuv yuyv gray jpeg    DEPTH_1_MM, colour of that format, GRAY8 infrared
///   mirror                as mm, and mirroring cannot be switched off
///   gaps                  as mm, and the frames 7 n + 3 never arrive
///   plain                 as mm without registration, controls and serial number
struct KinoTestDriver {
    void (*plug)(const char* uri);
    /// The device is gone: it says so, and gives no frame any more.
    void (*unplug)(const char* uri);
    /// The last value set for a device's property (sensor 0) or a sensor's; -1 if none was.
    int (*value)(const char* uri, int sensor, int property);
    int (*open_devices)();
    int (*syncs)();  ///< how often frame sync has been switched on
};
using KinoTestDriverGet = KinoTestDriver (*)();
