#include "fake_video_system.h"

#include <poll.h>

#include <algorithm>
#include <cerrno>
#include <cstring>

#include "tests/support/random.h"

namespace kino::test {
namespace {

const std::map<unsigned long, std::string> kNames{
    {VIDIOC_QUERYCAP, "VIDIOC_QUERYCAP"},
    {VIDIOC_ENUM_FMT, "VIDIOC_ENUM_FMT"},
    {VIDIOC_ENUM_FRAMESIZES, "VIDIOC_ENUM_FRAMESIZES"},
    {VIDIOC_ENUM_FRAMEINTERVALS, "VIDIOC_ENUM_FRAMEINTERVALS"},
    {VIDIOC_G_FMT, "VIDIOC_G_FMT"},
    {VIDIOC_S_FMT, "VIDIOC_S_FMT"},
    {VIDIOC_G_PARM, "VIDIOC_G_PARM"},
    {VIDIOC_S_PARM, "VIDIOC_S_PARM"},
    {VIDIOC_REQBUFS, "VIDIOC_REQBUFS"},
    {VIDIOC_QUERYBUF, "VIDIOC_QUERYBUF"},
    {VIDIOC_QBUF, "VIDIOC_QBUF"},
    {VIDIOC_DQBUF, "VIDIOC_DQBUF"},
    {VIDIOC_STREAMON, "VIDIOC_STREAMON"},
    {VIDIOC_STREAMOFF, "VIDIOC_STREAMOFF"},
    {VIDIOC_QUERYCTRL, "VIDIOC_QUERYCTRL"},
    {VIDIOC_QUERY_EXT_CTRL, "VIDIOC_QUERY_EXT_CTRL"},
    {VIDIOC_QUERYMENU, "VIDIOC_QUERYMENU"},
    {VIDIOC_G_CTRL, "VIDIOC_G_CTRL"},
    {VIDIOC_S_CTRL, "VIDIOC_S_CTRL"},
    {VIDIOC_G_EXT_CTRLS, "VIDIOC_G_EXT_CTRLS"},
    {VIDIOC_S_EXT_CTRLS, "VIDIOC_S_EXT_CTRLS"},
};

constexpr TimeNs kPeriod = kNsPerSecond / 30;

}  // namespace

std::vector<std::uint8_t> random_bytes(std::size_t count, std::uint64_t seed) {
    Random random(seed);
    std::vector<std::uint8_t> out(count);
    for (std::uint8_t& byte : out) byte = static_cast<std::uint8_t>(random.bits() >> 11);
    return out;
}

void FakeVideoSystem::arrive(FakeArrival arrival) {
    const std::lock_guard lock(mutex_);
    arrivals_.push_back(std::move(arrival));
    idle_ = false;
    changed_.notify_all();
}

void FakeVideoSystem::fault(const FakeFault& fault) {
    const std::lock_guard lock(mutex_);
    faults_.push_back(fault);
}

void FakeVideoSystem::fault_named(const std::string& name, int error, int times) {
    const std::lock_guard lock(mutex_);
    named_faults_[name] = {error, times};
}

void FakeVideoSystem::unplug() {
    const std::lock_guard lock(mutex_);
    plugged_ = false;
    for (auto& [descriptor, alive] : nodes_open_) alive = false;
    changed_.notify_all();
}

void FakeVideoSystem::plug_in() {
    const std::lock_guard lock(mutex_);
    plugged_ = true;
    buffers_.clear();
    queued_.clear();
    done_.clear();
    streaming_ = false;
}

FakeVideoSystem::Held FakeVideoSystem::held() const {
    const std::lock_guard lock(mutex_);
    return {static_cast<int>(nodes_open_.size()), static_cast<int>(events_.size()),
            static_cast<int>(mappings_.size()), static_cast<std::uint32_t>(buffers_.size())};
}

std::vector<std::string> FakeVideoSystem::calls() const {
    const std::lock_guard lock(mutex_);
    return calls_;
}

int FakeVideoSystem::count(const std::string& name) const {
    const std::lock_guard lock(mutex_);
    return static_cast<int>(std::count(calls_.begin(), calls_.end(), name));
}

std::int64_t FakeVideoSystem::misuses() const {
    const std::lock_guard lock(mutex_);
    return misuses_;
}

std::int64_t FakeVideoSystem::value(std::uint32_t id) const {
    const std::lock_guard lock(mutex_);
    for (const FakeControl& control : camera_.controls)
        if (control.id == id) return control.value;
    return -1;
}

v4l2_fract FakeVideoSystem::interval() const {
    const std::lock_guard lock(mutex_);
    return interval_;
}

/// Counts the call; the errno it is to fail with, or 0.
int FakeVideoSystem::faulty(const std::string& name) {
    const auto number = static_cast<std::int64_t>(calls_.size());
    calls_.push_back(name);
    now_ += 1000;
    for (const FakeFault& fault : faults_)
        if (fault.call == number || (fault.for_ever && number > fault.call)) return fault.error;
    const auto named = named_faults_.find(name);
    if (named != named_faults_.end() && named->second.times > 0) {
        --named->second.times;
        return named->second.error;
    }
    return 0;
}

bool FakeVideoSystem::known(int descriptor) const {
    if (nodes_open_.contains(descriptor)) return true;
    ++misuses_;
    return false;
}

std::vector<VideoNode> FakeVideoSystem::nodes() {
    const std::lock_guard lock(mutex_);
    if (!plugged_) return {};
    return {camera_.node};
}

std::string FakeVideoSystem::resolve(const std::string& path) {
    return path == "/dev/v4l/by-id/fake" ? "/dev/video0" : path;
}

int FakeVideoSystem::open(const std::string& path) {
    const std::lock_guard lock(mutex_);
    if (const int error = faulty("open")) return -error;
    if (!plugged_ || path != camera_.node.path) return -ENOENT;
    nodes_open_[next_descriptor_] = true;
    return next_descriptor_++;
}

int FakeVideoSystem::close(int descriptor) {
    const std::lock_guard lock(mutex_);
    const int error = faulty("close");
    // As Linux does: the descriptor is gone even where close complains.
    if (nodes_open_.erase(descriptor) == 0) {
        if (events_.erase(descriptor) == 0) ++misuses_;
    } else {
        streaming_ = false;
        buffers_.clear();
        queued_.clear();
        done_.clear();
    }
    return -error;
}

MapResult FakeVideoSystem::map(int descriptor, std::size_t length, std::int64_t offset) {
    const std::lock_guard lock(mutex_);
    if (const int error = faulty("mmap")) return {nullptr, error};
    if (!known(descriptor)) return {nullptr, EBADF};
    if (!nodes_open_[descriptor]) return {nullptr, ENODEV};
    const auto index = static_cast<std::size_t>(offset / 0x1000);
    if (index >= buffers_.size()) return {nullptr, EINVAL};
    std::vector<std::uint8_t> memory(length, 0xa5);
    void* const data = memory.data();
    mappings_[data] = std::move(memory);
    buffers_[index].data = static_cast<std::uint8_t*>(data);
    return {data, 0};
}

int FakeVideoSystem::unmap(void* data, std::size_t length) {
    const std::lock_guard lock(mutex_);
    const int error = faulty("munmap");
    const auto found = mappings_.find(data);
    if (found == mappings_.end() || found->second.size() != length) {
        ++misuses_;
        return -EINVAL;
    }
    for (Buffer& buffer : buffers_)
        if (buffer.data == data) buffer.data = nullptr;
    mappings_.erase(found);
    return -error;
}

int FakeVideoSystem::make_event() {
    const std::lock_guard lock(mutex_);
    if (const int error = faulty("eventfd")) return -error;
    events_[next_descriptor_] = false;
    return next_descriptor_++;
}

void FakeVideoSystem::set_event(int event) {
    const std::lock_guard lock(mutex_);
    if (!events_.contains(event)) ++misuses_;
    events_[event] = true;
    changed_.notify_all();
}

TimeNs FakeVideoSystem::now() {
    const std::lock_guard lock(mutex_);
    return now_;
}

PollResult FakeVideoSystem::poll(int descriptor, int event, TimeNs timeout) {
    std::unique_lock lock(mutex_);
    const int error = faulty("poll");
    if (!events_.contains(event)) ++misuses_;
    if (events_[event]) return {.stopped = true};
    if (error != 0) return {.error = error};
    if (descriptor < 0) {
        now_ += timeout;
        return {};
    }
    if (!known(descriptor)) return {.error = EBADF};
    while (nodes_open_[descriptor]) {
        if (!done_.empty()) return {.events = POLLIN};
        if (!streaming_) return {.events = POLLERR};
        if (queued_.empty()) return {.events = POLLERR};
        if (!arrivals_.empty()) {
            const short events = deliver();
            if (events != 0) return {.events = events};
            now_ += timeout;
            return {};
        }
        idle_ = true;
        changed_.notify_all();
        changed_.wait(
            lock, [&] { return events_[event] || !arrivals_.empty() || !nodes_open_[descriptor]; });
        if (events_[event]) return {.stopped = true};
    }
    return {.events = POLLERR | POLLHUP};
}

/// The next arrival; the poll events it makes, 0 for a stall.
short FakeVideoSystem::deliver() {
    const FakeArrival next = std::move(arrivals_.front());
    arrivals_.pop_front();
    using Kind = FakeArrival::Kind;
    if (next.kind == Kind::stall) return 0;
    if (next.kind == Kind::error) return POLLERR;
    if (next.kind == Kind::hang_up) {
        for (auto& [descriptor, alive] : nodes_open_) alive = false;
        plugged_ = false;
        return POLLERR | POLLHUP;
    }
    now_ += kPeriod * (1 + static_cast<TimeNs>(next.skipped));
    sequence_ += next.skipped;
    const std::uint32_t index = queued_.front();
    queued_.pop_front();
    Buffer& buffer = buffers_[index];
    if (next.kind == Kind::stray) {
        // Handed out without a word, together with an EIO.
        buffer.state = Buffer::State::ours;
        ++sequence_;
        named_faults_["VIDIOC_DQBUF"] = {EIO, 1};
        return POLLIN;
    }
    buffer.state = Buffer::State::done;
    buffer.sequence = sequence_++;
    buffer.flags = next.flags;
    buffer.stamp = next.stamp.value_or(now_ / 1000 * 1000);
    const std::size_t offset = mplane() ? camera_.data_offset : 0;
    const std::size_t room = mappings_[buffer.data].size();
    const std::size_t count = std::min(next.bytes.size(), room - std::min(room, offset));
    if (count > 0) std::memcpy(buffer.data + offset, next.bytes.data(), count);
    buffer.bytesused = next.bytesused.value_or(static_cast<std::uint32_t>(count + offset));
    done_.push_back(index);
    return POLLIN;
}

bool FakeVideoSystem::mplane() const {
    const std::uint32_t caps = camera_.capabilities & V4L2_CAP_DEVICE_CAPS
                                   ? camera_.device_capabilities
                                   : camera_.capabilities;
    return (caps & V4L2_CAP_VIDEO_CAPTURE) == 0;
}

std::uint32_t FakeVideoSystem::buffer_type() const {
    return mplane() ? V4L2_BUF_TYPE_VIDEO_CAPTURE_MPLANE : V4L2_BUF_TYPE_VIDEO_CAPTURE;
}

int FakeVideoSystem::ioctl(int descriptor, unsigned long request, void* argument) {
    const std::lock_guard lock(mutex_);
    if (const int error = faulty(kNames.at(request))) return -error;
    if (!known(descriptor)) return -EBADF;
    if (!nodes_open_[descriptor]) return -ENODEV;
    return answer(request, argument);
}

int FakeVideoSystem::answer(unsigned long request, void* argument) {
    switch (request) {
        case VIDIOC_QUERYCAP:
            return query_capabilities(*static_cast<v4l2_capability*>(argument));
        case VIDIOC_ENUM_FMT:
            return enumerate_formats(*static_cast<v4l2_fmtdesc*>(argument));
        case VIDIOC_ENUM_FRAMESIZES:
            return enumerate_sizes(*static_cast<v4l2_frmsizeenum*>(argument));
        case VIDIOC_ENUM_FRAMEINTERVALS:
            return enumerate_intervals(*static_cast<v4l2_frmivalenum*>(argument));
        case VIDIOC_G_FMT:
            return get_format(*static_cast<v4l2_format*>(argument));
        case VIDIOC_S_FMT:
            return set_format(*static_cast<v4l2_format*>(argument));
        case VIDIOC_G_PARM:
        case VIDIOC_S_PARM:
            return parameters(*static_cast<v4l2_streamparm*>(argument), request == VIDIOC_S_PARM);
        case VIDIOC_REQBUFS:
            return request_buffers(*static_cast<v4l2_requestbuffers*>(argument));
        case VIDIOC_QUERYBUF:
            return query_buffer(*static_cast<v4l2_buffer*>(argument));
        case VIDIOC_QBUF:
            return queue_buffer(*static_cast<v4l2_buffer*>(argument));
        case VIDIOC_DQBUF:
            return dequeue_buffer(*static_cast<v4l2_buffer*>(argument));
        case VIDIOC_STREAMON:
            if (buffers_.empty()) return -EINVAL;
            streaming_ = true;
            sequence_ = 0;
            return 0;
        case VIDIOC_STREAMOFF:
            streaming_ = false;
            queued_.clear();
            done_.clear();
            for (Buffer& buffer : buffers_) buffer.state = Buffer::State::ours;
            return 0;
        default:
            return controls(request, argument);
    }
}

int FakeVideoSystem::query_capabilities(v4l2_capability& out) const {
    put_text(out.driver, camera_.driver);
    put_text(out.card, "Fake camera");
    put_text(out.bus_info, camera_.bus);
    out.capabilities = camera_.capabilities;
    out.device_caps = camera_.device_capabilities;
    return 0;
}

int FakeVideoSystem::enumerate_formats(v4l2_fmtdesc& out) const {
    if (out.type != buffer_type() || out.index >= camera_.formats.size()) return -EINVAL;
    out.pixelformat = camera_.formats[out.index].fourcc;
    return 0;
}

int FakeVideoSystem::enumerate_sizes(v4l2_frmsizeenum& out) const {
    for (const FakeFormat& format : camera_.formats) {
        if (format.fourcc != out.pixel_format) continue;
        if (out.index >= format.sizes.size()) return -EINVAL;
        out.type = V4L2_FRMSIZE_TYPE_DISCRETE;
        out.discrete = {format.sizes[out.index].first, format.sizes[out.index].second};
        return 0;
    }
    return -EINVAL;
}

int FakeVideoSystem::enumerate_intervals(v4l2_frmivalenum& out) const {
    for (const FakeFormat& format : camera_.formats) {
        if (format.fourcc != out.pixel_format) continue;
        if (format.intervals.empty()) return -ENOTTY;
        if (out.index >= format.intervals.size()) return -EINVAL;
        out.type = V4L2_FRMIVAL_TYPE_DISCRETE;
        out.discrete = format.intervals[out.index];
        return 0;
    }
    return -EINVAL;
}

int FakeVideoSystem::get_format(v4l2_format& format) const {
    if (format.type != buffer_type()) return -EINVAL;
    if (format_.type != 0) format = format_;
    return 0;
}

int FakeVideoSystem::set_format(v4l2_format& format) {
    if (format.type != buffer_type()) return -EINVAL;
    if (!buffers_.empty()) return -EBUSY;
    auto& pix = format.fmt.pix;
    auto& pix_mp = format.fmt.pix_mp;
    std::uint32_t fourcc = mplane() ? pix_mp.pixelformat : pix.pixelformat;
    std::uint32_t width = mplane() ? pix_mp.width : pix.width;
    const FakeFormat* chosen = &camera_.formats.front();
    for (const FakeFormat& known : camera_.formats)
        if (known.fourcc == fourcc) chosen = &known;
    fourcc = camera_.gives_instead.value_or(chosen->fourcc);
    auto size = chosen->sizes.front();
    for (const auto& known : chosen->sizes)
        if (known.first == width) size = known;
    width = size.first;
    const std::uint32_t stride = (width * chosen->bits_per_pixel + 7) / 8 + camera_.row_padding;
    const std::uint32_t bytes = stride * size.second + camera_.tail_padding + camera_.data_offset;
    if (mplane()) {
        pix_mp.pixelformat = fourcc;
        pix_mp.width = width;
        pix_mp.height = size.second;
        pix_mp.num_planes = static_cast<std::uint8_t>(camera_.planes);
        pix_mp.plane_fmt[0].bytesperline = stride;
        pix_mp.plane_fmt[0].sizeimage = bytes;
        pix_mp.colorspace = camera_.colorspace;
        pix_mp.ycbcr_enc = static_cast<std::uint8_t>(camera_.ycbcr);
        pix_mp.quantization = static_cast<std::uint8_t>(camera_.quantization);
    } else {
        pix.pixelformat = fourcc;
        pix.width = width;
        pix.height = size.second;
        pix.bytesperline = stride;
        pix.sizeimage = bytes;
        pix.colorspace = camera_.colorspace;
        pix.ycbcr_enc = camera_.ycbcr;
        pix.quantization = camera_.quantization;
    }
    format_ = format;
    return 0;
}

int FakeVideoSystem::parameters(v4l2_streamparm& out, bool set) {
    if (!camera_.has_rate) return -ENOTTY;
    if (out.type != buffer_type()) return -EINVAL;
    if (set) interval_ = out.parm.capture.timeperframe;
    out.parm.capture.capability = V4L2_CAP_TIMEPERFRAME;
    out.parm.capture.timeperframe = interval_;
    return 0;
}

int FakeVideoSystem::request_buffers(v4l2_requestbuffers& out) {
    if (out.type != buffer_type() || out.memory != V4L2_MEMORY_MMAP) return -EINVAL;
    if (streaming_ || !mappings_.empty()) return -EBUSY;
    if (out.count > 0 && camera_.buffers > 0) out.count = camera_.buffers;
    buffers_.assign(out.count, Buffer{});
    queued_.clear();
    done_.clear();
    return 0;
}

int FakeVideoSystem::describe(v4l2_buffer& out, const Buffer& buffer) const {
    const std::uint32_t length =
        mplane() ? format_.fmt.pix_mp.plane_fmt[0].sizeimage : format_.fmt.pix.sizeimage;
    const std::uint32_t offset = out.index * 0x1000;
    out.flags = buffer.flags;
    if (buffer.state == Buffer::State::queued) out.flags |= V4L2_BUF_FLAG_QUEUED;
    if (buffer.state == Buffer::State::done) out.flags |= V4L2_BUF_FLAG_DONE;
    out.sequence = buffer.sequence;
    out.timestamp.tv_sec = buffer.stamp / kNsPerSecond;
    out.timestamp.tv_usec = buffer.stamp % kNsPerSecond / 1000;
    if (!mplane()) {
        out.length = length;
        out.m.offset = offset;
        out.bytesused = buffer.bytesused;
        return 0;
    }
    if (out.length < 1 || out.m.planes == nullptr) return -EINVAL;
    out.m.planes[0].length = length;
    out.m.planes[0].m.mem_offset = offset;
    out.m.planes[0].bytesused = buffer.bytesused;
    out.m.planes[0].data_offset = camera_.data_offset;
    return 0;
}

int FakeVideoSystem::query_buffer(v4l2_buffer& out) const {
    if (out.type != buffer_type() || out.index >= buffers_.size()) return -EINVAL;
    return describe(out, buffers_[out.index]);
}

int FakeVideoSystem::queue_buffer(v4l2_buffer& in) {
    if (in.type != buffer_type() || in.memory != V4L2_MEMORY_MMAP) return -EINVAL;
    if (in.index >= buffers_.size()) return -EINVAL;
    Buffer& buffer = buffers_[in.index];
    if (buffer.state != Buffer::State::ours) return -EINVAL;
    buffer.state = Buffer::State::queued;
    buffer.flags = 0;
    queued_.push_back(in.index);
    return 0;
}

int FakeVideoSystem::dequeue_buffer(v4l2_buffer& out) {
    if (out.type != buffer_type() || !streaming_) return -EINVAL;
    if (done_.empty()) return -EAGAIN;
    out.index = done_.front();
    Buffer& buffer = buffers_[out.index];
    const Buffer filled = buffer;
    done_.pop_front();
    buffer.state = Buffer::State::ours;
    Buffer plain = filled;
    plain.state = Buffer::State::ours;
    return describe(out, plain);
}

}  // namespace kino::test
