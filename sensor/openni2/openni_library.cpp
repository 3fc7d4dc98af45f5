#include "sensor/openni2/openni_library.h"

#include <dlfcn.h>
#include <fmt/format.h>

#include <algorithm>
#include <condition_variable>
#include <cstdlib>
#include <cstring>
#include <deque>
#include <thread>
#include <utility>

namespace kino {
namespace {

constexpr const char* kDefaultLibrary = "libOpenNI2.so.0";
constexpr std::chrono::seconds kLoadLimit{30};
constexpr std::chrono::seconds kListLimit{5};
constexpr const char* kInstallHint = "install the package libopenni2-0";

/// The name under which OpenNI2's file player lists every ONI file that was opened.
constexpr const char* kFilePlayerName = "oni File";

}  // namespace

Result<OpenniLibrary*> OpenniLibrary::get() {
    static std::mutex mutex;
    // Never destroyed: the drivers' threads may outlive main().
    static OpenniLibrary* loaded = nullptr;
    const std::lock_guard lock(mutex);
    if (loaded) return loaded;
    struct Attempt {
        std::unique_ptr<OpenniLibrary> library{new OpenniLibrary};
        Result<void> result;
    };
    auto attempt = std::make_shared<Attempt>();
    if (!run_bounded([attempt] { attempt->result = attempt->library->load(); }, kLoadLimit)) {
        return fail("OpenNI2 does not come back from starting", kDefaultLibrary);
    }
    KINO_TRY(attempt->result);
    loaded = attempt->library.release();
    return loaded;
}

Result<void> OpenniLibrary::load() {
    const char* named = std::getenv(kOpenniLibraryVariable);
    const std::string path = named && *named ? named : kDefaultLibrary;
    void* const handle = dlopen(path.c_str(), RTLD_NOW | RTLD_LOCAL);
    if (!handle) {
        const char* const why = dlerror();
        return fail(fmt::format("OpenNI2 is not to be had: {}", why ? why : "unknown error"), path,
                    kInstallHint);
    }
    std::string missing;
    const auto find = [&](auto& function, const char* name) {
        void* const symbol = dlsym(handle, name);
        if (!symbol && missing.empty()) missing = name;
        std::memcpy(&function, &symbol, sizeof(symbol));
    };
#define KINO_ONI(name) find(api_.name, "oni" #name)
    KINO_ONI(Initialize);
    KINO_ONI(GetExtendedError);
    KINO_ONI(SetLogConsoleOutput);
    KINO_ONI(SetLogFileOutput);
    KINO_ONI(GetDeviceList);
    KINO_ONI(ReleaseDeviceList);
    KINO_ONI(RegisterDeviceCallbacks);
    KINO_ONI(WaitForAnyStream);
    KINO_ONI(DeviceOpen);
    KINO_ONI(DeviceClose);
    KINO_ONI(DeviceGetSensorInfo);
    KINO_ONI(DeviceGetInfo);
    KINO_ONI(DeviceCreateStream);
    KINO_ONI(DeviceEnableDepthColorSync);
    KINO_ONI(DeviceDisableDepthColorSync);
    KINO_ONI(DeviceSetProperty);
    KINO_ONI(DeviceGetProperty);
    KINO_ONI(DeviceIsPropertySupported);
    KINO_ONI(DeviceInvoke);
    KINO_ONI(DeviceIsImageRegistrationModeSupported);
    KINO_ONI(StreamDestroy);
    KINO_ONI(StreamStart);
    KINO_ONI(StreamStop);
    KINO_ONI(StreamReadFrame);
    KINO_ONI(StreamSetProperty);
    KINO_ONI(StreamGetProperty);
    KINO_ONI(StreamIsPropertySupported);
    KINO_ONI(FrameRelease);
#undef KINO_ONI
    if (!missing.empty()) {
        return fail(fmt::format("the library has no {}: this is not OpenNI 2.2", missing), path,
                    kInstallHint);
    }

    // Before and after: the library reads a configuration file on the way that may ask for logs.
    const auto silence = [&] {
        (void)api_.SetLogConsoleOutput(0);
        (void)api_.SetLogFileOutput(0);
    };
    silence();
    const openni::Status status = api_.Initialize(openni::kApiVersion);
    silence();
    if (status != openni::kOk) {
        return fail(fmt::format("OpenNI2 does not start: {}", last_error()), path, kInstallHint);
    }

    callbacks_.connected = [](const openni::DeviceInfo*, void*) {};
    callbacks_.disconnected = [](const openni::DeviceInfo* info, void* cookie) {
        static_cast<OpenniLibrary*>(cookie)->device_gone(info->uri, "the device was unplugged");
    };
    callbacks_.state_changed = [](const openni::DeviceInfo* info, int state, void* cookie) {
        if (state != openni::kStateError) return;
        static_cast<OpenniLibrary*>(cookie)->device_gone(info->uri, "the device reports an error");
    };
    if (api_.RegisterDeviceCallbacks(&callbacks_, this, &callback_handle_) != openni::kOk) {
        return fail(fmt::format("OpenNI2 does not tell of devices: {}", last_error()), path);
    }
    return {};
}

std::string OpenniLibrary::last_error() const {
    const char* const text = api_.GetExtendedError();
    std::string message = text ? text : "";
    while (!message.empty() && (message.back() == '\n' || message.back() == '\t' ||
                                message.back() == ' ' || message.back() == '.')) {
        message.pop_back();
    }
    std::replace_if(
        message.begin(), message.end(), [](char c) { return c == '\n' || c == '\t'; }, ' ');
    return message.empty() ? "no reason given" : message;
}

std::vector<openni::DeviceInfo> OpenniLibrary::devices() {
    auto devices = std::make_shared<std::vector<openni::DeviceInfo>>();
    const bool returned = run_bounded(
        [this, devices] {
            const std::lock_guard lock(calls_);
            openni::DeviceInfo* list = nullptr;
            int count = 0;
            if (api_.GetDeviceList(&list, &count) != openni::kOk) return;
            devices->assign(list, list + count);
            (void)api_.ReleaseDeviceList(list);
        },
        kListLimit);
    if (!returned) return {};
    std::erase_if(*devices, [](openni::DeviceInfo& info) {
        for (char* text : {info.uri, info.vendor, info.name}) text[openni::kMaxText - 1] = '\0';
        return std::strcmp(info.name, kFilePlayerName) == 0;
    });
    return *devices;
}

std::int64_t OpenniLibrary::watch(std::string uri, std::function<void(const std::string&)> gone) {
    const std::lock_guard lock(watch_mutex_);
    watches_.push_back({++last_watch_, std::move(uri), std::move(gone)});
    return last_watch_;
}

void OpenniLibrary::unwatch(std::int64_t watch) {
    const std::lock_guard lock(watch_mutex_);
    std::erase_if(watches_, [&](const Watch& w) { return w.number == watch; });
}

void OpenniLibrary::device_gone(const char* uri, const std::string& why) {
    const std::lock_guard lock(watch_mutex_);
    for (Watch& watch : watches_) {
        if (watch.gone && watch.uri == uri) std::exchange(watch.gone, nullptr)(why);
    }
}

void run_kept(std::function<void()> work) {
    struct Threads {
        std::mutex mutex;
        std::condition_variable changed;
        std::deque<std::function<void()>> waiting;
        std::size_t idle = 0;
    };
    // Never destroyed, as its threads are never ended.
    static auto* const threads = new Threads;
    const std::lock_guard lock(threads->mutex);
    threads->waiting.push_back(std::move(work));
    if (threads->idle >= threads->waiting.size()) {
        threads->changed.notify_one();
        return;
    }
    std::thread([] {
        std::unique_lock own(threads->mutex);
        for (;;) {
            ++threads->idle;
            threads->changed.wait(own, [] { return !threads->waiting.empty(); });
            --threads->idle;
            std::function<void()> job = std::move(threads->waiting.front());
            threads->waiting.pop_front();
            own.unlock();
            job();
            job = nullptr;
            own.lock();
        }
    }).detach();
}

bool run_bounded(std::function<void()> work, std::chrono::milliseconds limit) {
    struct State {
        std::mutex mutex;
        std::condition_variable changed;
        bool done = false;
    };
    auto state = std::make_shared<State>();
    run_kept([state, work = std::move(work)]() mutable {
        work();
        work = nullptr;
        const std::lock_guard lock(state->mutex);
        state->done = true;
        state->changed.notify_all();
    });
    std::unique_lock lock(state->mutex);
    return state->changed.wait_for(lock, limit, [&] { return state->done; });
}

}  // namespace kino
