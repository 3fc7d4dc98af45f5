#include "sensor/v4l2/v4l2_controls.h"

#include <fmt/format.h>
#include <linux/videodev2.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <cerrno>
#include <cmath>
#include <cstring>
#include <utility>

namespace kino {
namespace {

constexpr int kMostControls = 1024;
constexpr std::int64_t kMostMenuEntries = 256;

constexpr std::array<std::pair<std::uint32_t, const char*>, 19> kSharedNames{{
    {V4L2_CID_AUTO_WHITE_BALANCE, "white_balance_auto"},
    {V4L2_CID_WHITE_BALANCE_TEMPERATURE, "white_balance"},
    {V4L2_CID_EXPOSURE_AUTO, "exposure_auto"},
    {V4L2_CID_EXPOSURE_ABSOLUTE, "exposure"},
    {V4L2_CID_EXPOSURE, "exposure"},
    {V4L2_CID_AUTOGAIN, "gain_auto"},
    {V4L2_CID_GAIN, "gain"},
    {V4L2_CID_BRIGHTNESS, "brightness"},
    {V4L2_CID_CONTRAST, "contrast"},
    {V4L2_CID_SATURATION, "saturation"},
    {V4L2_CID_HUE, "hue"},
    {V4L2_CID_SHARPNESS, "sharpness"},
    {V4L2_CID_GAMMA, "gamma"},
    {V4L2_CID_FOCUS_AUTO, "focus_auto"},
    {V4L2_CID_FOCUS_ABSOLUTE, "focus"},
    {V4L2_CID_ZOOM_ABSOLUTE, "zoom"},
    {V4L2_CID_HFLIP, "mirror"},
    {V4L2_CID_VFLIP, "flip"},
    {V4L2_CID_BACKLIGHT_COMPENSATION, "backlight_compensation"},
}};

std::string plain_id(std::uint32_t id, const std::string& name) {
    for (const auto& [known, shared] : kSharedNames)
        if (known == id) return shared;
    std::string out;
    for (const char c : name) {
        const auto letter = static_cast<unsigned char>(c);
        if (std::isalnum(letter) != 0)
            out += static_cast<char>(std::tolower(letter));
        else if (!out.empty() && out.back() != '_')
            out += '_';
    }
    while (!out.empty() && out.back() == '_') out.pop_back();
    return out.empty() ? fmt::format("control_{:08x}", id) : out;
}

template <class Char, std::size_t N>
std::string text_of(const Char (&field)[N]) {
    const auto* const text = reinterpret_cast<const char*>(field);
    return {text, strnlen(text, N)};
}

bool has_number(std::uint32_t type) {
    return type == V4L2_CTRL_TYPE_INTEGER || type == V4L2_CTRL_TYPE_BOOLEAN ||
           type == V4L2_CTRL_TYPE_MENU || type == V4L2_CTRL_TYPE_INTEGER_MENU ||
           type == V4L2_CTRL_TYPE_INTEGER64;
}

}  // namespace

V4l2Controls::V4l2Controls(const VideoDevice& device) : device_(device) {
    std::uint32_t last = 0;
    bool extended = true;
    for (int i = 0; i < kMostControls; ++i) {
        auto range = extended ? query_extended(last) : query_simple(last);
        if (!range && last == 0 && extended) {
            extended = false;
            range = query_simple(last);
        }
        // A driver that does not move on would be asked for ever.
        if (!range || range->id <= last) return;
        last = range->id;
        add(*range);
    }
}

std::optional<V4l2Controls::Range> V4l2Controls::query_extended(std::uint32_t after) const {
    v4l2_query_ext_ctrl query{};
    query.id = after | V4L2_CTRL_FLAG_NEXT_CTRL;
    if (!device_.call(VIDIOC_QUERY_EXT_CTRL, query)) return std::nullopt;
    Range out{query.id, query.type, query.flags, text_of(query.name)};
    if (query.elems > 1 || query.nr_of_dims > 0) out.flags |= V4L2_CTRL_FLAG_DISABLED;
    out.minimum = query.minimum;
    out.maximum = query.maximum;
    out.step =
        static_cast<std::int64_t>(std::min<std::uint64_t>(query.step, std::uint64_t{1} << 62));
    out.fallback = query.default_value;
    return out;
}

std::optional<V4l2Controls::Range> V4l2Controls::query_simple(std::uint32_t after) const {
    v4l2_queryctrl query{};
    query.id = after | V4L2_CTRL_FLAG_NEXT_CTRL;
    if (!device_.call(VIDIOC_QUERYCTRL, query)) return std::nullopt;
    Range out{query.id, query.type, query.flags, text_of(query.name)};
    out.minimum = query.minimum;
    out.maximum = query.maximum;
    out.step = query.step;
    out.fallback = query.default_value;
    return out;
}

std::string V4l2Controls::free_id(std::string id) const {
    if (find(id) == nullptr) return id;
    for (int i = 2;; ++i) {
        std::string next = fmt::format("{}_{}", id, i);
        if (find(next) == nullptr) return next;
    }
}

void V4l2Controls::add(const Range& range) {
    if ((range.flags & V4L2_CTRL_FLAG_DISABLED) != 0 || !has_number(range.type)) return;
    if (range.minimum > range.maximum) return;
    Knob knob;
    knob.id = range.id;
    knob.wide = range.type == V4L2_CTRL_TYPE_INTEGER64;
    knob.read_only = (range.flags & V4L2_CTRL_FLAG_READ_ONLY) != 0;
    knob.write_only = (range.flags & V4L2_CTRL_FLAG_WRITE_ONLY) != 0;
    knob.control.name = range.name;
    knob.control.minimum = static_cast<double>(range.minimum);
    knob.control.maximum = static_cast<double>(range.maximum);
    knob.control.step = static_cast<double>(std::max<std::int64_t>(1, range.step));
    knob.control.fallback = static_cast<double>(range.fallback);
    if (range.type == V4L2_CTRL_TYPE_BOOLEAN) knob.control.kind = ControlKind::toggle;
    const bool menu =
        range.type == V4L2_CTRL_TYPE_MENU || range.type == V4L2_CTRL_TYPE_INTEGER_MENU;
    if (menu && !add_menu(range, knob)) return;
    knob.control.id = free_id(plain_id(range.id, range.name));
    knobs_.push_back(std::move(knob));
}

bool V4l2Controls::add_menu(const Range& range, Knob& knob) const {
    if (range.minimum < 0 || range.maximum > kMostMenuEntries) return false;
    Control& control = knob.control;
    for (std::int64_t i = range.minimum; i <= range.maximum; ++i) {
        v4l2_querymenu entry{};
        entry.id = range.id;
        entry.index = static_cast<std::uint32_t>(i);
        // Menus have holes: a camera may know modes 1 and 3 only.
        if (!device_.call(VIDIOC_QUERYMENU, entry)) continue;
        control.menu.push_back(range.type == V4L2_CTRL_TYPE_MENU
                                   ? text_of(entry.name)
                                   : std::to_string(static_cast<std::int64_t>(entry.value)));
        knob.values.push_back(i);
    }
    if (knob.values.empty()) return false;
    const auto position = [&](std::int64_t value) {
        const auto found = std::find(knob.values.begin(), knob.values.end(), value);
        return found == knob.values.end() ? -1 : static_cast<int>(found - knob.values.begin());
    };
    control.kind = ControlKind::menu;
    control.fallback = std::max(0, position(range.fallback));
    control.minimum = 0;
    control.maximum = static_cast<double>(knob.values.size() - 1);
    control.step = 1;
    if (range.id != V4L2_CID_EXPOSURE_AUTO || position(V4L2_EXPOSURE_MANUAL) < 0) return true;
    for (const std::int64_t automatic : {V4L2_EXPOSURE_AUTO, V4L2_EXPOSURE_APERTURE_PRIORITY}) {
        if (position(automatic) < 0) continue;
        control.kind = ControlKind::toggle;
        control.fallback = range.fallback == V4L2_EXPOSURE_MANUAL ? 0 : 1;
        control.maximum = 1;
        control.menu.clear();
        knob.values = {V4L2_EXPOSURE_MANUAL, automatic};
        return true;
    }
    return true;
}

std::vector<Control> V4l2Controls::list() const {
    std::vector<Control> out;
    for (const Knob& knob : knobs_)
        if (!knob.read_only) out.push_back(knob.control);
    return out;
}

const V4l2Controls::Knob* V4l2Controls::find(const std::string& id) const {
    for (const Knob& knob : knobs_)
        if (knob.control.id == id) return &knob;
    return nullptr;
}

Called V4l2Controls::read(const Knob& knob, std::int64_t& value) const {
    v4l2_ext_control one{};
    one.id = knob.id;
    v4l2_ext_controls all{};
    all.which = V4L2_CTRL_WHICH_CUR_VAL;
    all.count = 1;
    all.controls = &one;
    Called called = device_.call(VIDIOC_G_EXT_CTRLS, all);
    if (called) value = knob.wide ? one.value64 : one.value;
    if (called || called.error().error != ENOTTY || knob.wide) return called;
    v4l2_control simple{knob.id, 0};
    called = device_.call(VIDIOC_G_CTRL, simple);
    if (called) value = simple.value;
    return called;
}

Called V4l2Controls::write(const Knob& knob, std::int64_t value) const {
    v4l2_ext_control one{};
    one.id = knob.id;
    if (knob.wide)
        one.value64 = value;
    else
        one.value = static_cast<std::int32_t>(value);
    v4l2_ext_controls all{};
    all.which = V4L2_CTRL_WHICH_CUR_VAL;
    all.count = 1;
    all.controls = &one;
    Called called = device_.call(VIDIOC_S_EXT_CTRLS, all);
    if (called || called.error().error != ENOTTY || knob.wide) return called;
    v4l2_control simple{knob.id, static_cast<std::int32_t>(value)};
    return device_.call(VIDIOC_S_CTRL, simple);
}

Result<double> V4l2Controls::get(const std::string& id) {
    const Knob* const knob = find(id);
    if (knob == nullptr) return fail(fmt::format("no control {}", id), device_.path());
    if (knob->write_only) return fail(fmt::format("{} can only be set", id), device_.path());
    std::int64_t value = 0;
    if (const Called called = read(*knob, value); !called) return device_.fails(called.error());
    if (knob->values.empty()) return static_cast<double>(value);
    const auto found = std::find(knob->values.begin(), knob->values.end(), value);
    if (found != knob->values.end()) return static_cast<double>(found - knob->values.begin());
    // One of several automatic modes.
    if (knob->control.kind == ControlKind::toggle)
        return value == V4L2_EXPOSURE_AUTO || value == V4L2_EXPOSURE_APERTURE_PRIORITY ? 1.0 : 0.0;
    return fail(fmt::format("{} is {}, which its menu does not have", id, value), device_.path());
}

Result<void> V4l2Controls::set(const std::string& id, double value) {
    const Knob* const knob = find(id);
    if (knob == nullptr) return fail(fmt::format("no control {}", id), device_.path());
    if (knob->read_only) return fail(fmt::format("{} can only be read", id), device_.path());
    const Control& control = knob->control;
    if (!(value >= control.minimum && value <= control.maximum))
        return fail(
            fmt::format("{} = {} is outside {} to {}", id, value, control.minimum, control.maximum),
            device_.path());
    const double steps = std::round((value - control.minimum) / control.step);
    double exact = control.minimum + steps * control.step;
    if (exact > control.maximum) exact -= control.step;
    auto number = static_cast<std::int64_t>(exact);
    if (!knob->values.empty()) number = knob->values[static_cast<std::size_t>(number)];
    if (const Called called = write(*knob, number); !called) return device_.fails(called.error());
    return {};
}

std::optional<double> V4l2Controls::metres_per_unit() {
    for (const Knob& knob : knobs_) {
        if (!knob.control.id.starts_with("depth_unit") || knob.write_only) continue;
        const auto micrometres = get(knob.control.id);
        if (micrometres && *micrometres >= 1 && *micrometres <= 1e5) return *micrometres * 1e-6;
    }
    return std::nullopt;
}

}  // namespace kino
