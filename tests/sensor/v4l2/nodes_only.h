#pragma once

#include <cerrno>

#include "sensor/v4l2/video_system.h"

namespace kino::test {

/// A system on which nothing can be opened.
class NodesOnly : public VideoSystem {
  public:
    std::string resolve(const std::string& path) override { return path; }
    int open(const std::string&) override { return -ENOENT; }
    int close(int) override { return -EBADF; }
    int ioctl(int, unsigned long, void*) override { return -EBADF; }
    MapResult map(int, std::size_t, std::int64_t) override { return {nullptr, EBADF}; }
    int unmap(void*, std::size_t) override { return -EINVAL; }
    int make_event() override { return -EMFILE; }
    void set_event(int) override {}
    PollResult poll(int, int, TimeNs) override { return {.error = EBADF}; }
    TimeNs now() override { return 0; }
};

}  // namespace kino::test
