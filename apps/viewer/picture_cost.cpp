#include "apps/viewer/picture_cost.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <set>

namespace kino {
namespace {

constexpr double kCalm = 0.25;      ///< weight of a measurement near what is known
constexpr double kSurprised = 0.6;  ///< and of another
constexpr double kSurprise = 0.25;
constexpr double kMostSurprise = 4;  ///< more is a hiccup, and counts as this
constexpr double kForgetting = 0.8;
/// Reconstruction before it was ever measured: docs/accuracy/framebuffer-lod.md, ns a pixel, and no
/// more than a part of the frame, for devices that are faster than those two cores.
constexpr double kGuidedNs = 25;
constexpr double kBilinearNs = 8;
constexpr double kZoomNs = 4;
constexpr double kMostGuess = 0.3;
/// Shares of pixels that differ by less are the same point.
constexpr double kSameShare = 0.05;
constexpr std::int64_t kSameLoad = 90;  ///< frames
constexpr int kSamePoints = 6;
constexpr double kMostPart = 0.98;
/// Lights hide each other and reach past what they light: the time grows with this power of their
/// count, more or less (light painting: 0.6 to 1).
constexpr double kLights = 0.75;
constexpr double kMoreLights = 1;
constexpr double kFewerLights = 0.5;
/// Shading and resizing work for every sample. A load that changed between two points makes it
/// seem otherwise, and a level that seems worthless would never be tried again.
constexpr double kLeastPart = 0.8;
/// Of what drawing meshes takes.
constexpr double kTrianglePart = 0.6;
/// Of what a frame takes beside its light, so much grows with the pixels drawn, where no group says
/// anything.
constexpr double kPixelShare = 0.6;

/// Of a group's time at full size, what grows with the pixels before it is known better.
double first_part(std::string_view group) {
    static const std::map<std::string_view, double> kParts = {
        {"raster", 0.5},      {"final", kMostPart}, {"resolve", kMostPart}, {"frame", 0.5},
        {"debug", kMostPart}, {"meshes", 0.4},      {"normals", 0.05},      {"readback", 0.3}};
    const auto known = kParts.find(group);
    return known == kParts.end() ? 0 : known->second;
}

double pixels_of(glm::ivec2 size) {
    return static_cast<double>(std::max(1, size.x)) * std::max(1, size.y);
}

void approach(double& known, double measured, bool at_once) {
    if (at_once) {
        known = measured;
        return;
    }
    const double least = known / kMostSurprise;
    measured = std::clamp(measured, least, std::max(known * kMostSurprise, least + 0.05));
    const bool surprised = std::abs(measured - known) > kSurprise * known;
    known += (surprised ? kSurprised : kCalm) * (measured - known);
}

}  // namespace

PictureCost::Key PictureCost::key_of(std::string_view group, int occurrence,
                                     const PictureLevel& level) {
    const std::string name = fmt::format("{}#{}", group, occurrence);
    const bool resized = level.lod > 1;
    const char* way = level.reconstruction == Reconstruction::bilinear ? "bilinear" : "guided";
    // The coarse surface is picked, and later brought to full size.
    if (group == "lod") return {name + way, occurrence == 0 ? Grows::picked : Grows::resized};
    // Lights are sorted into the tiles of what is shaded.
    if (group == "shadows" || group == "cull") return {name, Grows::with_shaded};
    if (group == "light") {
        // Shading comes first; what shading does not resize comes later.
        if (occurrence == 0) return {name, Grows::with_shaded};
        return resized ? Key{name + way, Grows::resized} : Key{name, Grows::not_resized};
    }
    if (group == "zoom") return {name, Grows::when_zoomed};
    return {name, first_part(group) > 0 ? Grows::with_drawn : Grows::never};
}

double PictureCost::share_for(const Group& group, const PictureLevel& level, glm::ivec2 size) {
    const PictureShare share = share_of(level, size);
    const bool resized = level.lod > 1;
    switch (group.grows) {
        case Grows::with_shaded:
            return share.shaded;
        case Grows::with_drawn:
            return share.drawn;
        case Grows::picked:
            return resized && level.reconstruction == group.reconstruction ? share.shaded : -1;
        case Grows::resized:
            return resized && level.reconstruction == group.reconstruction ? share.drawn : -1;
        case Grows::not_resized:
            return resized ? -1 : share.drawn;
        case Grows::when_zoomed:
            return level.zoom > 1 ? 1 : -1;
        case Grows::never:
            return 1;
    }
    return 1;
}

double PictureCost::burden(const Group& group, const PictureWork& work, double lights_power) {
    if (group.grows == Grows::with_shaded) {
        return std::pow(work.lights / group.work.lights, lights_power);
    }
    if (group.name != "meshes") return 1;
    return 1 - kTrianglePart + kTrianglePart * work.triangles / std::max(1.0, group.work.triangles);
}

double PictureCost::safe_burden(const Group& group, const PictureWork& work) {
    return burden(group, work, work.lights > group.work.lights ? kMoreLights : kFewerLights);
}

double PictureCost::ms_of(const Group& group, const PictureLevel& level, glm::ivec2 size,
                          const PictureWork& work) {
    const double share = share_for(group, level, size);
    return share < 0 ? 0 : safe_burden(group, work) * group.at(share);
}

double PictureCost::Group::at(double share) const {
    return ms * (1 - part + part * share) / (1 - part + part * x);
}

void PictureCost::Group::add(double share, double measured_ms, bool at_once, std::int64_t frame) {
    if (std::abs(share - x) > kSameShare * std::max(share, x)) {
        then_x = x;
        then_ms = ms;
        then_frame = frame;
        points = 1;
        x = share;
        ms = measured_ms;
    } else {
        approach(ms, measured_ms, at_once);
        ++points;
    }
    // Two points of one line, as long as the load can be thought the same.
    if (then_x < 0 || points > kSamePoints || frame - then_frame > kSameLoad) return;
    const double slope = std::max(0.0, (then_ms - ms) / (then_x - x));
    const double offset = std::max(0.0, ms - slope * x);
    if (!(slope + offset > 0)) return;
    const double weight = std::min(1.0, 2 * std::abs(then_x - x)) * 0.5;
    part += weight * (slope / (slope + offset) - part);
    part = std::clamp(part, grows == Grows::with_drawn ? 0.0 : kLeastPart, kMostPart);
}

/// Of what this level would run and no frame has run yet.
double PictureCost::unmeasured_ms(const PictureLevel& level, glm::ivec2 size) const {
    double guided_ms = -1;
    bool bilinear = false, zoom = false;
    for (const auto& [key, group] : groups_) {
        if (group.grows == Grows::when_zoomed) zoom = true;
        if (group.grows != Grows::resized) continue;
        if (group.reconstruction == Reconstruction::bilinear) {
            bilinear = true;
        } else {
            guided_ms = std::max(0.0, guided_ms) + group.at(1);
        }
    }
    const double most_ms = kMostGuess * frame_ms_;
    const auto guess = [&](double ns) { return std::min(most_ms, 1e-6 * ns * pixels_of(size)); };
    double ms = 0;
    if (level.lod > 1) {
        const double drawn = share_of(level, size).drawn;
        if (level.reconstruction == Reconstruction::bilinear) {
            const double own =
                guided_ms >= 0 ? guided_ms * kBilinearNs / kGuidedNs : guess(kBilinearNs);
            if (!bilinear) ms += drawn * own;
        } else if (guided_ms < 0) {
            ms += drawn * guess(kGuidedNs);
        }
    }
    if (level.zoom > 1 && !zoom) ms += std::min(0.2 * most_ms, 1e-6 * kZoomNs * pixels_of(size));
    return ms;
}

double PictureCost::shaded(const PictureShare& share, const PictureWork& work) const {
    return share.shaded * std::pow(work.lights / first_lights_, kLights);
}

double PictureCost::line_ms(const PictureLevel& level, glm::ivec2 size,
                            const PictureWork& work) const {
    const PictureShare share = share_of(level, size);
    const double others = 1 - kPixelShare + kPixelShare * share.drawn;
    return line_.slope() * shaded(share, work) + line_.offset() * others +
           unmeasured_ms(level, size);
}

double PictureCost::ms(const PictureLevel& level, glm::ivec2 size, const PictureWork& work) const {
    if (!knows_groups_) return has_line_ ? line_ms(level, size, work) : 0;
    double sum = std::max(0.0, rest_ms_) + unmeasured_ms(level, size);
    for (const auto& [key, group] : groups_) sum += ms_of(group, level, size, work);
    return sum;
}

std::vector<PictureCost::Part> PictureCost::parts(const PictureLevel& level, glm::ivec2 size,
                                                  const PictureWork& work) const {
    std::vector<Part> parts;
    const auto add = [&](const std::string& name, double ms) {
        if (!(ms > 0)) return;
        const auto known = std::find_if(parts.begin(), parts.end(),
                                        [&](const Part& part) { return part.name == name; });
        if (known == parts.end()) {
            parts.push_back({name, ms});
        } else {
            known->ms += ms;
        }
    };
    if (!knows_groups_) {
        const double light_ms = line_.slope() * shaded(share_of(level, size), work);
        add("light", light_ms);
        add("rest", ms(level, size, work) - light_ms);
        return parts;
    }
    for (const auto& [key, group] : groups_) {
        add(group.name == "lod" ? "resize" : group.name, ms_of(group, level, size, work));
    }
    std::stable_sort(parts.begin(), parts.end(),
                     [](const Part& a, const Part& b) { return a.ms > b.ms; });
    add("rest", rest_ms_);
    return parts;
}

void PictureCost::learn_line(const PictureLevel& drawn, glm::ivec2 size, const PictureWork& work,
                             double frame_ms) {
    const PictureShare share = share_of(drawn, size);
    const double others = 1 - kPixelShare + kPixelShare * share.drawn;
    const double ms = std::max(0.0, frame_ms - unmeasured_ms(drawn, size)) / others;
    const double x = shaded(share, work) / others;
    if (!has_line_) {
        // Half of it light: a guess that the first change of the level puts right.
        line_ = CostModel(0.5 * ms / x, 0.5 * ms, kForgetting);
        has_line_ = true;
    }
    line_.add(x, ms);
}

void PictureCost::learn(const PictureLevel& drawn, glm::ivec2 size, const PictureWork& work,
                        std::span<const graph::GroupTime> groups, double frame_ms, bool at_once) {
    if (!std::isfinite(frame_ms) || frame_ms < 0) return;
    frame_ms_ = frame_ms;
    if (++frame_ == 1) first_lights_ = work.lights;
    learn_line(drawn, size, work, frame_ms);
    if (groups.empty()) {
        knows_groups_ = false;
        return;
    }
    std::map<std::string_view, int> occurrences;
    std::set<std::string> ran;
    double measured_ms = 0;
    bool all_known = true;
    for (const graph::GroupTime& time : groups) {
        const Key key = key_of(time.group, occurrences[time.group]++, drawn);
        ran.insert(key.text);
        const bool measured = std::isfinite(time.ms) && time.ms >= 0;
        const auto known = groups_.find(key.text);
        if (known == groups_.end() && !measured) {
            all_known = false;
            continue;
        }
        if (known == groups_.end()) {
            Group group{.name = time.group,
                        .grows = key.grows,
                        .reconstruction = drawn.reconstruction,
                        .part = key.grows == Grows::never        ? 0
                                : key.grows == Grows::with_drawn ? first_part(time.group)
                                                                 : kMostPart};
            group.ms = time.ms;
            group.work = work;
            group.x = std::max(0.0, share_for(group, drawn, size));
            groups_.emplace(key.text, group);
            measured_ms += time.ms;
            continue;
        }
        Group& group = known->second;
        measured_ms += measured ? time.ms : ms_of(group, drawn, size, work);
        const double share = share_for(group, drawn, size);
        if (measured && share >= 0) {
            const double more = burden(group, work, kLights);
            group.ms *= more;
            group.then_ms *= more;
            group.work = work;
            group.add(share, time.ms, at_once, frame_);
        }
    }
    // What would have run at this level and did not is no longer called for.
    std::erase_if(groups_, [&](const auto& entry) {
        return ran.count(entry.first) == 0 && share_for(entry.second, drawn, size) >= 0;
    });
    knows_groups_ = all_known;
    if (!all_known) return;
    const double rest = std::max(0.0, frame_ms - measured_ms);
    if (rest_ms_ < 0) {
        rest_ms_ = rest;
    } else {
        approach(rest_ms_, rest, at_once);
    }
}

}  // namespace kino
