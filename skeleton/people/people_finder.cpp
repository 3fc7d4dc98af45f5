#include "skeleton/people/people_finder.h"

#include <fmt/format.h>
#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <utility>

namespace kino {
namespace {

constexpr int kCellsAcross = 160;
constexpr int kMinSide = 16;
constexpr float kFloorMarginM = 0.05f;
constexpr float kPassedM = 0.35f;
constexpr TimeNs kMomentNs = kNsPerSecond / 2;
constexpr std::size_t kFewestCells = 6;  // of a surface worth looking at

int cell_for(int width, int cell_px) {
    if (cell_px > 0) return cell_px;
    return std::max(1, (width + kCellsAcross / 2) / kCellsAcross);
}

FloorOptions floor_for(const PeopleOptions& options) {
    FloorOptions floor = options.floor;
    if (options.moving_sensor) floor.smooth_s = 0;  // it would lag behind the hand
    return floor;
}

TrackerOptions tracker_for(const PeopleOptions& options) {
    TrackerOptions tracker = options.tracker;
    if (options.moving_sensor) tracker.ask_for_motion = false;
    return tracker;
}

std::optional<glm::vec3> direction(const std::optional<glm::vec3>& v) {
    if (!v) return std::nullopt;
    const float length = glm::length(*v);
    if (!std::isfinite(length) || length < 1e-6f) return std::nullopt;
    return *v / length;
}

}  // namespace

Result<PeopleFinder> PeopleFinder::create(Image<RayXy> rays, const PeopleOptions& options) {
    if (rays.width() < kMinSide || rays.height() < kMinSide) {
        return fail(fmt::format("a depth picture of {}x{} pixels is too small to find people in",
                                rays.width(), rays.height()));
    }
    const int cell = cell_for(rays.width(), options.cell_px);
    if (options.cell_px < 0 || rays.width() < 8 * cell || rays.height() < 8 * cell) {
        return fail(fmt::format("cells of {} pixels do not suit a picture of {}x{}", cell,
                                rays.width(), rays.height()),
                    "cell_px");
    }
    const bool any = std::any_of(rays.pixels().begin(), rays.pixels().end(), [](const RayXy& r) {
        return std::isfinite(r.x) && std::isfinite(r.y);
    });
    if (!any) return fail("no pixel of the depth camera has a ray", "", "check its calibration");
    return PeopleFinder(std::move(rays), options, cell);
}

PeopleFinder::PeopleFinder(Image<RayXy> rays, const PeopleOptions& options, int cell_px)
    : rays_(std::move(rays)),
      options_(options),
      grid_(rays_, cell_px),
      background_(options.background),
      floor_finder_(floor_for(options)),
      tracker_(tracker_for(options), options.person),
      before_m_(grid_.width(), grid_.height(), 0.0f),
      last_m_(grid_.width(), grid_.height(), 0.0f),
      mask_(grid_.width(), grid_.height()),
      certain_(grid_.width(), grid_.height()),
      slots_(grid_.width(), grid_.height()),
      seen_(grid_.width(), grid_.height()),
      upright_m_(mask_.size()) {
    // A slope of 68 degrees between neighbouring cells is still one surface.
    step_ = {0.05f, 2.5f * grid_.cell_tangent(), 5 * options.background.noise_per_m};
    background_.reset(grid_.width(), grid_.height());
}

void PeopleFinder::reset() {
    std::fill(before_m_.pixels().begin(), before_m_.pixels().end(), 0.0f);
    std::fill(slots_.pixels().begin(), slots_.pixels().end(), std::uint8_t{0});
    background_.reset(grid_.width(), grid_.height());
    floor_finder_.reset();
    tracker_.reset();
    first_ = true;
}

bool PeopleFinder::in_front(std::size_t cell, float z, float height_m) const {
    const float limit = options_.moving_sensor ? 0.0f : background_.limit_m(cell);
    // Farther than what was taken for the room: that was something else.
    if (limit > 0 && !(z > background_.beyond_m(cell))) return z < limit;
    if (!floor_.known()) return true;
    return height_m > kFloorMarginM + 2 * options_.floor.noise_per_m * z * z;
}

void PeopleFinder::remember(TimeNs time) {
    if (time - before_time_ < kMomentNs && time >= before_time_) return;
    before_m_ = grid_.z_m();
    before_time_ = time;
}

bool PeopleFinder::changed(std::size_t cell) const {
    // Only within a surface: at its edges readings jump without anything moving.
    const auto width = static_cast<std::size_t>(grid_.width());
    const std::int32_t* labels = labels_.data();
    const float* z = grid_.z_m().data();
    if (cell < width + 1 || cell + width + 1 >= mask_.size()) return false;
    for (const std::size_t other : {cell - 1, cell + 1, cell - width, cell + width}) {
        if (labels[other] != labels[cell] || before_m_.data()[other] == 0) return false;
    }
    const float before = before_m_.data()[cell];
    const float noise = options_.background.noise_per_m * z[cell] * z[cell];
    // Much nearer before: somebody passed in front of it, which moves nothing here.
    if (before == 0 || before < z[cell] - kPassedM) return false;
    return std::abs(z[cell] - before) > 0.04f + 7 * noise;
}

void PeopleFinder::mark_foreground(const FloorPlane& floor) {
    const glm::mat3 upright = upright_from_camera(floor.up);
    for (std::size_t i = 0; i < mask_.size(); ++i) {
        const float z = grid_.z_m().data()[i];
        mask_.data()[i] = certain_.data()[i] = 0;
        if (z == 0) continue;
        upright_m_[i] = upright * grid_.point(i) + glm::vec3(0, floor.height_m, 0);
        mask_.data()[i] = in_front(i, z, upright_m_[i].y) ? 1 : 0;
        const bool known =
            !options_.moving_sensor && background_.limit_m(i) > 0 && z < background_.limit_m(i);
        certain_.data()[i] = known ? mask_.data()[i] : 0;
    }
}

void PeopleFinder::find_heads(TimeNs time) {
    labels_ = components_.labels();
    head_finder_.find(grid_, mask_, floor_.up);
    const glm::mat3 upright = upright_from_camera(floor_.up);
    const glm::vec3 above(0, floor_.height_m, 0);
    std::vector<BodyReach::Anchor> anchors;
    for (const Head& head : head_finder_.heads())
        anchors.push_back({head.cell, upright * head.place_m + above});
    // Who was seen a moment ago is there even if he hides his face.
    const std::size_t seen = anchors.size();
    for (const glm::vec3& head : tracker_.expected_heads(time)) {
        const bool again = std::any_of(
            anchors.begin(), anchors.begin() + static_cast<std::ptrdiff_t>(seen),
            [&](const BodyReach::Anchor& a) { return glm::distance(a.head_m, head) < 0.25f; });
        for (float down = 0; !again && down < 0.6f; down += 0.1f) {
            const glm::vec3 at = glm::transpose(upright) * (head - glm::vec3(0, down, 0) - above);
            const std::int32_t cell = grid_.cell_of(at);
            if (cell < 0 || !mask_.data()[cell]) continue;
            if (std::abs(grid_.z_m().data()[cell] - at.z) > 0.3f) continue;
            anchors.push_back({cell, head});
            break;
        }
    }
    reach_.cut(anchors, upright_m_, certain_, labels_);
}

std::vector<Blob> PeopleFinder::collect() const {
    const Image<std::int32_t>& labels = labels_;
    const int width = labels.width(), height = labels.height();
    std::vector<Blob> all(static_cast<std::size_t>(components_.count()));
    const float tangent2 = grid_.cell_tangent() * grid_.cell_tangent();
    const float floor_band = 2 * kFloorMarginM;
    for (int y = 0; y < height; ++y) {
        for (int x = 0; x < width; ++x) {
            const std::int32_t label = labels.at(x, y);
            if (label == 0) {
                const std::int32_t whole = components_.labels().at(x, y);
                if (whole != 0) all[static_cast<std::size_t>(whole - 1)].cut = true;
                continue;
            }
            const auto cell = static_cast<std::size_t>(y * width + x);
            const float z = grid_.z_m().data()[cell];
            CellPoint c;
            c.cell = static_cast<std::int32_t>(cell);
            c.upright_m = upright_m_[cell];
            c.area_m2 = z * z * tangent2;
            c.known = certain_.data()[cell] != 0;
            c.changed = changed(cell);
            c.border = y < 2;
            // `slots_` and `last_m_` are still those of the picture before.
            c.mine = slots_.data()[cell] != 0 && step_.joins(z, last_m_.data()[cell]);
            const auto side = [&](int u, int v) {
                if (u < 0 || v < 0 || u >= width || labels.at(u, v) == label) return;
                const auto other = static_cast<std::size_t>(v * width + u);
                const float z_other = grid_.z_m().data()[other];
                // The floor on which it stands says nothing.
                if (z_other != 0 && !mask_.data()[other] && upright_m_[other].y < floor_band)
                    return;
                ++c.sides;
                if (z_other == 0 || (z_other > z && !step_.joins(z, z_other))) ++c.free;
            };
            side(x - 1, y);
            side(x + 1, y);
            side(x, y - 1);
            all[static_cast<std::size_t>(label - 1)].cells.push_back(c);
        }
    }
    const glm::mat3 upright = upright_from_camera(floor_.up);
    for (const Head& head : head_finder_.heads()) {
        const std::int32_t label = labels.data()[head.cell];
        if (label == 0) continue;
        const glm::vec3 at = upright * head.place_m + glm::vec3(0, floor_.height_m, 0);
        if (floor_.known() && at.y < options_.person.min_head_top_m) continue;
        all[static_cast<std::size_t>(label - 1)].heads.push_back({at, head.score});
    }
    std::erase_if(all, [](const Blob& b) { return b.cells.size() < kFewestCells; });
    for (Blob& blob : all) {
        blob.drop_knees();
        blob.measure();
    }
    return all;
}

void PeopleFinder::find(const Image<float>& depth_m, TimeNs time,
                        const std::optional<glm::vec3>& specific_force, PeopleFrame& out) {
    if (!first_ && time <= last_) tracker_.reset();
    first_ = false;
    last_ = time;
    grid_.sample(depth_m);
    floor_ = floor_finder_.find(grid_, direction(specific_force), time);
    mark_foreground(floor_);
    components_.find(grid_.z_m(), mask_, step_);
    find_heads(time);
    PersonTest test = options_.person;
    test.floor_known = floor_.known();
    tracker_.set_test(test);
    tracker_.update(collect(), upright_from_camera(floor_.up), floor_.height_m, time);

    std::fill(slots_.pixels().begin(), slots_.pixels().end(), std::uint8_t{0});
    std::fill(seen_.pixels().begin(), seen_.pixels().end(), std::uint8_t{0});
    for (const PersonTrack& track : tracker_.tracks()) {
        if (!track.blob) continue;
        const std::uint8_t guarded = tracker_.protects(track, time) ? 1 : 0;
        for (const CellPoint& c : track.blob->cells) {
            slots_.data()[c.cell] = track.slot;
            seen_.data()[c.cell] = guarded;
        }
    }
    last_m_ = grid_.z_m();
    remember(time);
    paint(depth_m, out);
    describe(time, out);
    if (!options_.moving_sensor) {
        mark_surroundings(time);
        background_.learn(grid_.z_m(), seen_, time);
    }
    out.background_known = options_.moving_sensor ? 0.0f : background_.known_share();
}

void PeopleFinder::mark_surroundings(TimeNs time) {
    const std::vector<glm::vec3> heads = tracker_.expected_heads(time);
    if (heads.empty()) return;
    for (std::size_t i = 0; i < mask_.size(); ++i) {
        if (!mask_.data()[i] || seen_.data()[i]) continue;
        const bool near = std::any_of(heads.begin(), heads.end(), [&](const glm::vec3& head) {
            return within_reach(head, upright_m_[i]);
        });
        if (near) seen_.data()[i] = Background::kNearPerson;
    }
}

void PeopleFinder::paint(const Image<float>& depth_m, PeopleFrame& out) {
    out.labels.resize(depth_m.width(), depth_m.height());
    std::fill(out.labels.pixels().begin(), out.labels.pixels().end(), std::uint8_t{0});
    boxes_.assign(kPersonSlots + 1, {depth_m.width(), depth_m.height(), 0, 0});
    pixels_.assign(kPersonSlots + 1, 0);
    const int width = grid_.width(), height = grid_.height();
    struct Near {
        std::uint8_t slot;
        float z;
    };
    std::vector<Near> around;
    for (int cy = 0; cy < height; ++cy) {
        for (int cx = 0; cx < width; ++cx) {
            // Own cell first: its neighbours are asked only where it does not fit.
            around.clear();
            const auto ask = [&](int u, int v) {
                if (u < 0 || v < 0 || u >= width || v >= height || !slots_.at(u, v)) return;
                around.push_back({slots_.at(u, v), grid_.z_m().at(u, v)});
            };
            ask(cx, cy);
            for (int v = cy - 1; v <= cy + 1; ++v) {
                for (int u = cx - 1; u <= cx + 1; ++u) {
                    if (u != cx || v != cy) ask(u, v);
                }
            }
            if (around.empty()) continue;
            const auto cell = static_cast<std::size_t>(cy * width + cx);
            const PixelSpan columns = grid_.columns(cx), rows = grid_.rows(cy);
            for (int y = rows.first; y < rows.last; ++y) {
                const float* z_row = depth_m.row(y);
                std::uint8_t* label_row = out.labels.row(y);
                for (int x = columns.first; x < columns.last; ++x) {
                    const float z = z_row[x];
                    if (!(z >= DepthGrid::kMinDepthM && z <= DepthGrid::kMaxDepthM)) continue;
                    std::uint8_t slot = 0;
                    for (const Near& n : around) {
                        if (step_.joins(z, n.z)) {
                            slot = n.slot;
                            break;
                        }
                    }
                    if (slot == 0) continue;
                    const RayXy& ray = rays_.at(x, y);
                    const float up = z * (floor_.up.x * ray.x + floor_.up.y * ray.y + floor_.up.z) +
                                     floor_.height_m;
                    if (!in_front(cell, z, up)) continue;
                    label_row[x] = slot;
                    ++pixels_[slot];
                    PixelBox& box = boxes_[slot];
                    box = {std::min(box.x0, x), std::min(box.y0, y), std::max(box.x1, x + 1),
                           std::max(box.y1, y + 1)};
                }
            }
        }
    }
}

void PeopleFinder::describe(TimeNs time, PeopleFrame& out) const {
    out.time = time;
    out.floor = floor_;
    out.people.clear();
    out.lost.clear();
    const int full_width = out.labels.width(), full_height = out.labels.height();
    // A Kinect has no readings in its last eight columns of 640.
    const int margin_x = std::max(2 * grid_.cell_px(), full_width / 64);
    const int margin_y = 2 * grid_.cell_px();
    for (const PersonTrack& track : tracker_.tracks()) {
        if (track.id == 0) continue;
        if (!track.blob || pixels_[track.slot] == 0) {
            out.lost.push_back({track.id, track.slot, track.expected_m(time), track.seen});
            continue;
        }
        const Blob& blob = *track.blob;
        Person p;
        p.id = track.id;
        p.slot = track.slot;
        p.pixels = pixels_[track.slot];
        p.box = boxes_[track.slot];
        p.centroid_m = track.at_m;
        p.velocity_m_s = track.velocity_m_s;
        p.box_min_m = blob.min_m;
        p.box_max_m = blob.max_m;
        p.area_m2 = blob.area_m2;
        p.touches_border = p.box.x0 < margin_x || p.box.y0 < margin_y ||
                           p.box.x1 > full_width - margin_x || p.box.y1 > full_height - margin_y;
        p.merged = blob.shared;
        const bool sure = track.moved || blob.known > 0.5f;
        p.confidence = std::min(1.0f, blob.area_m2 / 0.3f) * (sure ? 1.0f : 0.6f) *
                       (p.merged ? 0.7f : 1.0f) * (p.touches_border ? 0.85f : 1.0f);
        out.people.push_back(p);
    }
    const auto by_slot = [](const auto& a, const auto& b) { return a.slot < b.slot; };
    std::sort(out.people.begin(), out.people.end(), by_slot);
    std::sort(out.lost.begin(), out.lost.end(), by_slot);
}

}  // namespace kino
