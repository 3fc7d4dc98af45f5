#include "sensor/filters/depth_filter_chain.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <utility>

#include "base/check.h"
#include "sensor/filters/decimation_filter.h"
#include "sensor/filters/flying_pixel_filter.h"
#include "sensor/filters/hole_filter.h"
#include "sensor/filters/spatial_filter.h"
#include "sensor/filters/temporal_filter.h"

namespace kino {
namespace {

struct Parsed {
    std::unique_ptr<DepthFilter> filter;
    std::string text;  // of its settings
};

/// Cuts the text up to the separator off the front; `rest` has no data once there was none.
std::string_view cut(std::string_view& rest, char separator) {
    const std::size_t end = rest.find(separator);
    const std::string_view part = rest.substr(0, end);
    rest = end == std::string_view::npos ? std::string_view() : rest.substr(end + 1);
    return part;
}

template <class Parameters>
Result<Parameters> preset(std::string_view filter, std::string_view name) {
    if (name == "default") return Parameters{};
    if constexpr (requires { Parameters::librealsense(); }) {
        if (name == "librealsense") return Parameters::librealsense();
        return fail(fmt::format("there is no preset \"{}\"", name), std::string(filter),
                    "it has default, librealsense");
    }
    return fail(fmt::format("there is no preset \"{}\"", name), std::string(filter),
                "it has default");
}

template <class Filter, class Parameters>
Result<Parsed> make(std::string_view name, std::string_view settings, bool any,
                    FilterOptions options) {
    Parameters parameters;
    for (bool first = true; any; first = false) {
        any = settings.find(':') != std::string_view::npos;
        std::string_view value = cut(settings, ':');
        const bool has_value = value.find('=') != std::string_view::npos;
        const std::string_view key = cut(value, '=');
        if (key.empty() || !has_value) {
            return fail(fmt::format("\"{}\" is not a setting", key), std::string(name),
                        "settings are written :key=value");
        }
        if (key == "preset" && !first) {
            return fail("the preset must come first", std::string(name));
        }
        if (key == "preset") {
            KINO_ASSIGN(parameters, preset<Parameters>(name, value));
        } else {
            KINO_TRY(filters::apply_setting(name, key, value, parameters));
        }
    }
    KINO_ASSIGN(auto filter, Filter::create(parameters, options));
    return Parsed{std::move(filter), filters::settings_text(parameters)};
}

template <class Parameters>
std::string describe() {
    std::string text;
    const Parameters defaults;
    for (const auto& setting : Parameters::settings()) {
        text += fmt::format("    {}={}  {} ({} to {})\n", setting.key, setting.get(defaults),
                            setting.meaning, setting.minimum, setting.maximum);
    }
    return text;
}

struct Kind {
    std::string_view name;
    std::string_view meaning;
    Result<Parsed> (*make)(std::string_view, std::string_view, bool, FilterOptions);
    std::string (*describe)();
};

template <class Filter, class Parameters>
constexpr Kind kind(std::string_view name, std::string_view meaning) {
    return {name, meaning, &make<Filter, Parameters>, &describe<Parameters>};
}

// In the order that makes sense.
constexpr std::array kKinds = {
    kind<FlyingPixelFilter, FlyingPixelParameters>("flying",
                                                   "removes readings between two surfaces"),
    kind<DecimationFilter, DecimationParameters>("decimate", "makes the picture smaller"),
    kind<SpatialFilter, SpatialParameters>("spatial", "averages neighbours, keeps edges"),
    kind<TemporalFilter, TemporalParameters>("temporal", "averages frames; preset=librealsense"),
    kind<HoleFilter, HoleParameters>("holes", "fills small gaps"),
};

std::string known_names() {
    std::string text;
    for (const Kind& k : kKinds) text += fmt::format("{}{}", text.empty() ? "" : ", ", k.name);
    return text;
}

}  // namespace

Result<DepthFilterChain> DepthFilterChain::parse(std::string_view specification,
                                                 FilterOptions options) {
    DepthFilterChain chain;
    std::string_view rest = specification;
    for (bool more = !specification.empty(); more;) {
        more = rest.find(',') != std::string_view::npos;
        std::string_view settings = cut(rest, ',');
        const bool any = settings.find(':') != std::string_view::npos;
        const std::string_view name = cut(settings, ':');
        const auto found = std::find_if(kKinds.begin(), kKinds.end(),
                                        [&](const Kind& k) { return k.name == name; });
        if (found == kKinds.end()) {
            return fail(fmt::format("there is no depth filter \"{}\"", name),
                        std::string(specification), "there are " + known_names());
        }
        for (const auto& filter : chain.filters_) {
            if (filter->name() == name) {
                return fail(fmt::format("the depth filter \"{}\" is named twice", name),
                            std::string(specification));
            }
        }
        KINO_ASSIGN(Parsed parsed, found->make(name, settings, any, options));
        chain.specification_ += fmt::format("{}{}{}", chain.empty() ? "" : ",", name, parsed.text);
        chain.filters_.push_back(std::move(parsed.filter));
    }
    return chain;
}

std::string DepthFilterChain::help() {
    std::string text;
    for (const Kind& k : kKinds) text += fmt::format("{}: {}\n{}", k.name, k.meaning, k.describe());
    return text;
}

void DepthFilterChain::apply(const Image<float>& in, Image<float>& out) {
    KINO_CHECK(&in != &out);
    if (filters_.empty()) {
        out.resize(in.width(), in.height());
        std::copy(in.pixels().begin(), in.pixels().end(), out.pixels().begin());
        return;
    }
    const Image<float>* from = &in;
    for (std::size_t i = 0; i < filters_.size(); ++i) {
        Image<float>& to = i + 1 == filters_.size() ? out : between_[i % 2];
        filters_[i]->apply(*from, to);
        from = &to;
    }
}

void DepthFilterChain::reset() {
    for (const auto& filter : filters_) filter->reset();
}

int DepthFilterChain::reduction() const {
    int all = 1;
    for (const auto& filter : filters_) all *= filter->reduction();
    return all;
}

CameraModel DepthFilterChain::camera(const CameraModel& depth) const {
    CameraModel camera = depth;
    for (const auto& filter : filters_) {
        if (filter->reduction() > 1) camera = decimated(camera, filter->reduction());
    }
    return camera;
}

}  // namespace kino
