#include <algorithm>
#include <cerrno>
#include <cstring>

#include "fake_video_system.h"

namespace kino::test {
FakeControl* FakeVideoSystem::control(std::uint32_t id) {
    for (FakeControl& control : camera_.controls)
        if (control.id == id) return &control;
    return nullptr;
}

const FakeControl* FakeVideoSystem::next_control(std::uint32_t after) const {
    const FakeControl* best = nullptr;
    for (const FakeControl& control : camera_.controls)
        if (control.id > after && (best == nullptr || control.id < best->id)) best = &control;
    return best;
}

int FakeVideoSystem::controls(unsigned long request, void* argument) {
    const bool extended = request == VIDIOC_QUERY_EXT_CTRL || request == VIDIOC_G_EXT_CTRLS ||
                          request == VIDIOC_S_EXT_CTRLS;
    if (extended && !camera_.extended_controls) return -ENOTTY;
    constexpr std::uint32_t kIds = ~(V4L2_CTRL_FLAG_NEXT_CTRL | V4L2_CTRL_FLAG_NEXT_COMPOUND);
    if (request == VIDIOC_QUERY_EXT_CTRL) {
        auto& out = *static_cast<v4l2_query_ext_ctrl*>(argument);
        const FakeControl* const found = next_control(out.id & kIds);
        if (found == nullptr) return -EINVAL;
        out = {};
        out.id = found->id;
        out.type = found->type;
        std::strncpy(out.name, found->name.c_str(), sizeof out.name - 1);
        out.minimum = found->minimum;
        out.maximum = found->maximum;
        out.step = static_cast<std::uint64_t>(found->step);
        out.default_value = found->fallback;
        out.flags = found->flags;
        out.elems = 1;
        return 0;
    }
    if (request == VIDIOC_QUERYCTRL) {
        auto& out = *static_cast<v4l2_queryctrl*>(argument);
        const FakeControl* const found = next_control(out.id & kIds);
        if (found == nullptr) return -EINVAL;
        out = {};
        out.id = found->id;
        out.type = found->type;
        put_text(out.name, found->name);
        out.minimum = static_cast<std::int32_t>(found->minimum);
        out.maximum = static_cast<std::int32_t>(found->maximum);
        out.step = static_cast<std::int32_t>(found->step);
        out.default_value = static_cast<std::int32_t>(found->fallback);
        out.flags = found->flags;
        return 0;
    }
    if (request == VIDIOC_QUERYMENU) {
        auto& out = *static_cast<v4l2_querymenu*>(argument);
        const FakeControl* const found = control(out.id);
        if (found == nullptr || !found->menu.contains(out.index)) return -EINVAL;
        const std::string& text = found->menu.at(out.index);
        std::memcpy(&out.name, text.c_str(), std::min(sizeof out.name, text.size() + 1));
        return 0;
    }
    if (request == VIDIOC_G_CTRL || request == VIDIOC_S_CTRL) {
        auto& simple = *static_cast<v4l2_control*>(argument);
        FakeControl* const found = control(simple.id);
        if (found == nullptr) return -EINVAL;
        if (request == VIDIOC_G_CTRL)
            simple.value = static_cast<std::int32_t>(found->value);
        else
            found->value = simple.value;
        return 0;
    }
    if (!extended) return -ENOTTY;
    auto& all = *static_cast<v4l2_ext_controls*>(argument);
    if (all.count != 1) return -EINVAL;
    v4l2_ext_control& one = all.controls[0];
    FakeControl* const found = control(one.id);
    if (found == nullptr) return -EINVAL;
    const bool wide = found->type == V4L2_CTRL_TYPE_INTEGER64;
    if (request == VIDIOC_S_EXT_CTRLS) {
        if ((found->flags & V4L2_CTRL_FLAG_GRABBED) != 0) return -EBUSY;
        found->value = wide ? static_cast<std::int64_t>(one.value64) : one.value;
    } else if (wide) {
        one.value64 = found->value;
    } else {
        one.value = static_cast<std::int32_t>(found->value);
    }
    return 0;
}

}  // namespace kino::test
