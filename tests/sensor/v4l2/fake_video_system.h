#pragma once

#include <linux/videodev2.h>

#include <algorithm>
#include <condition_variable>
#include <cstdint>
#include <cstring>
#include <deque>
#include <map>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include "sensor/v4l2/video_system.h"

namespace kino::test {

/// Cut to fit, zero-terminated if the field was zero.
template <std::size_t N>
void put_text(std::uint8_t (&field)[N], const std::string& text) {
    std::memcpy(field, text.data(), std::min(N - 1, text.size()));
}

struct FakeFormat {
    std::uint32_t fourcc = 0;
    std::vector<std::pair<std::uint32_t, std::uint32_t>> sizes;
    std::uint32_t bits_per_pixel = 16;
    std::vector<v4l2_fract> intervals;  ///< empty: ENOTTY
};

struct FakeControl {
    std::uint32_t id = 0;
    std::uint32_t type = V4L2_CTRL_TYPE_INTEGER;
    std::string name;
    std::int64_t minimum = 0, maximum = 100, step = 1, fallback = 0, value = 0;
    std::uint32_t flags = 0;
    std::map<std::uint32_t, std::string> menu;
};

/// What a fake camera is.
struct FakeCamera {
    VideoNode node{.path = "/dev/video0", .name = "fake", .bus_path = "1-2:1.0", .part = "1.0.0"};
    std::string driver = "fake";
    std::string bus = "platform:fake";
    std::uint32_t capabilities = V4L2_CAP_VIDEO_CAPTURE | V4L2_CAP_STREAMING | V4L2_CAP_DEVICE_CAPS;
    std::uint32_t device_capabilities = V4L2_CAP_VIDEO_CAPTURE | V4L2_CAP_STREAMING;
    std::vector<FakeFormat> formats{{V4L2_PIX_FMT_Y16, {{8, 6}}, 16, {}}};
    std::uint32_t row_padding = 0;   ///< bytes
    std::uint32_t tail_padding = 0;  ///< bytes that sizeimage has beyond the rows
    std::uint32_t buffers = 0;       ///< granted whatever is asked; 0: as asked
    std::uint32_t planes = 1;
    std::uint32_t data_offset = 0;  ///< of multi-planar buffers
    std::uint32_t ycbcr = V4L2_YCBCR_ENC_DEFAULT;
    std::uint32_t quantization = V4L2_QUANTIZATION_DEFAULT;
    std::uint32_t colorspace = V4L2_COLORSPACE_SRGB;
    std::optional<std::uint32_t> gives_instead;  ///< a format that S_FMT always gives
    bool has_rate = false;
    bool extended_controls = true;
    std::vector<FakeControl> controls;
};

/// What happens next at a streaming camera.
struct FakeArrival {
    enum class Kind : std::uint8_t { frame, stall, hang_up, error, stray };
    Kind kind = Kind::frame;
    std::vector<std::uint8_t> bytes;
    std::uint32_t skipped = 0;  ///< frames that the driver counted and never gave, before this
    std::uint32_t flags = V4L2_BUF_FLAG_TIMESTAMP_MONOTONIC;
    std::optional<TimeNs> stamp;             ///< none: the moment of arrival
    std::optional<std::uint32_t> bytesused;  ///< none: as many as there are
};

/// Makes call number `call` (from 0, of every kind) fail with `error`, and the following ones too
/// where `for_ever`. `only` restricts the for_ever ones to one name.
struct FakeFault {
    std::int64_t call = -1;
    int error = 0;
    bool for_ever = false;
};

/// One camera and its kernel in this process. Time is its own: it passes only by waiting. Once
/// nothing is left to arrive, a poll really waits for its event, and idle() is true.
class FakeVideoSystem final : public VideoSystem {
  public:
    explicit FakeVideoSystem(FakeCamera camera = {}) : camera_(std::move(camera)) {}

    // The script.
    void arrive(FakeArrival arrival);
    void fault(const FakeFault& fault);
    void fault_named(const std::string& name, int error, int times);  ///< the next ones
    void unplug();
    void plug_in();
    FakeCamera& camera() { return camera_; }

    // The verdict.
    struct Held {
        int nodes = 0, events = 0, mappings = 0;
        std::uint32_t buffers = 0;
        friend bool operator==(const Held&, const Held&) = default;
    };
    [[nodiscard]] Held held() const;
    [[nodiscard]] std::vector<std::string> calls() const;  ///< names, in order
    [[nodiscard]] int count(const std::string& name) const;
    [[nodiscard]] std::int64_t misuses() const;  ///< of descriptors and mappings nobody holds
    [[nodiscard]] std::int64_t value(std::uint32_t control) const;
    [[nodiscard]] v4l2_fract interval() const;
    /// Waits (really) until nothing is left to arrive or `also` is true.
    template <class F>
    void wait_idle(F&& also) {
        std::unique_lock lock(mutex_);
        while (!idle_) {
            lock.unlock();
            if (also()) return;
            lock.lock();
            changed_.wait_for(lock, std::chrono::microseconds(200));
        }
    }
    void wake() { changed_.notify_all(); }

    std::vector<VideoNode> nodes() override;
    std::string resolve(const std::string& path) override;
    int open(const std::string& path) override;
    int close(int descriptor) override;
    int ioctl(int descriptor, unsigned long request, void* argument) override;
    MapResult map(int descriptor, std::size_t length, std::int64_t offset) override;
    int unmap(void* data, std::size_t length) override;
    int make_event() override;
    void set_event(int event) override;
    PollResult poll(int descriptor, int event, TimeNs timeout) override;
    TimeNs now() override;

  private:
    struct Buffer {
        enum class State : std::uint8_t { ours, queued, done };
        State state = State::ours;
        std::uint32_t sequence = 0, flags = 0, bytesused = 0;
        TimeNs stamp = 0;
        std::uint8_t* data = nullptr;
    };

    int faulty(const std::string& name);
    int answer(unsigned long request, void* argument);
    int query_capabilities(v4l2_capability& out) const;
    int enumerate_formats(v4l2_fmtdesc& out) const;
    int enumerate_sizes(v4l2_frmsizeenum& out) const;
    int enumerate_intervals(v4l2_frmivalenum& out) const;
    int set_format(v4l2_format& format);
    int get_format(v4l2_format& format) const;
    int parameters(v4l2_streamparm& out, bool set);
    int request_buffers(v4l2_requestbuffers& out);
    int describe(v4l2_buffer& out, const Buffer& buffer) const;
    int query_buffer(v4l2_buffer& out) const;
    int queue_buffer(v4l2_buffer& in);
    int dequeue_buffer(v4l2_buffer& out);
    int controls(unsigned long request, void* argument);
    FakeControl* control(std::uint32_t id);
    const FakeControl* next_control(std::uint32_t after) const;
    [[nodiscard]] bool mplane() const;
    [[nodiscard]] std::uint32_t buffer_type() const;
    [[nodiscard]] bool known(int descriptor) const;
    short deliver();

    mutable std::mutex mutex_;
    std::condition_variable changed_;
    FakeCamera camera_;
    std::deque<FakeArrival> arrivals_;
    std::vector<FakeFault> faults_;
    struct NamedFault {
        int error = 0, times = 0;
    };
    std::map<std::string, NamedFault> named_faults_;
    std::vector<std::string> calls_;
    std::map<int, bool> nodes_open_;  ///< false: opened before it was unplugged
    std::map<int, bool> events_;      ///< whether it is set
    std::map<void*, std::vector<std::uint8_t>> mappings_;
    std::vector<Buffer> buffers_;
    std::deque<std::uint32_t> queued_, done_;
    v4l2_format format_{};
    v4l2_fract interval_{1, 30};
    std::uint32_t sequence_ = 0;
    bool streaming_ = false;
    bool plugged_ = true;
    bool idle_ = false;
    int next_descriptor_ = 100;
    TimeNs now_ = 1000 * kNsPerSecond;
    mutable std::int64_t misuses_ = 0;
};

/// Bytes that follow no pattern that could hide a shift.
[[nodiscard]] std::vector<std::uint8_t> random_bytes(std::size_t count, std::uint64_t seed);

}  // namespace kino::test
