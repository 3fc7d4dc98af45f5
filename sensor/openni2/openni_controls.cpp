#include "sensor/openni2/openni_controls.h"

#include <fmt/format.h>

#include <cmath>
#include <utility>

namespace kino {
namespace {

constexpr std::chrono::seconds kLimit{1};

openni::Stream* color_stream(const OpenniSession& session) {
    const OpenniStream* color = session.find(StreamKind::color);
    return color ? color->handle : nullptr;
}

struct Answer {
    openni::Status status = openni::kOk;
    int value = 0;
    std::string why;
};

/// Gets (or sets, with a value) the property on another thread, at most a second long.
Result<int> exchange(const std::shared_ptr<OpenniSession>& session, int property,
                     std::optional<int> value) {
    if (session->gone()) return fail("the device has gone", session->device().uri);
    auto answer = std::make_shared<Answer>();
    const bool returned = run_bounded(
        [session, property, value, answer] {
            OpenniLibrary& library = session->library();
            const std::lock_guard lock(library.calls());
            openni::Stream* const stream = color_stream(*session);
            answer->value = value.value_or(0);
            int size = sizeof(answer->value);
            answer->status =
                value ? library.api().StreamSetProperty(stream, property, &answer->value, size)
                      : library.api().StreamGetProperty(stream, property, &answer->value, &size);
            if (answer->status != openni::kOk) answer->why = library.last_error();
        },
        kLimit);
    if (!returned) return fail("the device does not answer", session->device().uri);
    if (answer->status != openni::kOk) {
        return fail(fmt::format("the device refuses: {}", answer->why), session->device().uri);
    }
    return answer->value;
}

}  // namespace

OpenniControls::OpenniControls(std::shared_ptr<OpenniSession> session)
    : session_(std::move(session)) {
    openni::Stream* const stream = color_stream(*session_);
    if (!stream) return;
    const auto add = [&](int property, Control control) {
        auto supported = std::make_shared<bool>(false);
        const bool returned = run_bounded(
            [session = session_, stream, property, supported] {
                OpenniLibrary& library = session->library();
                const std::lock_guard lock(library.calls());
                *supported = library.api().StreamIsPropertySupported(stream, property) != 0;
            },
            kLimit);
        if (!returned || !*supported) return;
        if (const auto now = exchange(session_, property, std::nullopt)) control.fallback = *now;
        controls_.push_back(std::move(control));
        properties_.push_back(property);
    };
    add(openni::kStreamAutoExposure,
        {"exposure_auto", "automatic exposure", ControlKind::toggle, 0, 1, 1, 1, {}});
    add(openni::kStreamAutoWhiteBalance,
        {"white_balance_auto", "automatic white balance", ControlKind::toggle, 0, 1, 1, 1, {}});
    add(openni::kStreamExposure,
        {"exposure", "exposure, device units", ControlKind::range, 0, 65535, 1, 0, {}});
    add(openni::kStreamGain,
        {"gain", "gain, device units", ControlKind::range, 0, 65535, 1, 0, {}});
}

Result<std::size_t> OpenniControls::index_of(const std::string& id) const {
    for (std::size_t i = 0; i < controls_.size(); ++i) {
        if (controls_[i].id == id) return i;
    }
    return fail(fmt::format("the device has no control \"{}\"", id), session_->device().uri);
}

Result<double> OpenniControls::get(const std::string& id) {
    KINO_ASSIGN(const std::size_t index, index_of(id));
    KINO_ASSIGN(const int value, exchange(session_, properties_[index], std::nullopt));
    return static_cast<double>(value);
}

Result<void> OpenniControls::set(const std::string& id, double value) {
    KINO_ASSIGN(const std::size_t index, index_of(id));
    const Control& control = controls_[index];
    if (!(value >= control.minimum && value <= control.maximum)) {
        return fail(fmt::format("{} is outside {} to {} of {}", value, control.minimum,
                                control.maximum, id),
                    session_->device().uri);
    }
    KINO_TRY(exchange(session_, properties_[index], static_cast<int>(std::lround(value))));
    return {};
}

}  // namespace kino
