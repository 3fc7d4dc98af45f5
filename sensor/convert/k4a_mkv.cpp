#include "sensor/convert/k4a_mkv.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <string_view>
#include <utility>

#include "sensor/session/ebml_reader.h"

namespace kino {
namespace {

constexpr std::uint64_t kMaxHeadElement = std::uint64_t{8} << 20;
constexpr std::uint64_t kMaxFrameBytes = std::uint64_t{128} << 20;
constexpr std::size_t kMaxBlocks = 20'000'000;
constexpr std::size_t kMaxTracks = 64;
constexpr int kMaxSize = 16384;
constexpr TimeNs kMaxTime = TimeNs{1} << 61;
constexpr std::size_t kProbeBytes = 65536;

bool has_matroska_head(std::span<const std::uint8_t> start) {
    const auto head = read_ebml_head(start);
    if (!head || head->id != ebml::kEbml || head->size > 1024) return false;
    const auto content = start.subspan(head->head_bytes)
                             .first(std::min<std::size_t>(static_cast<std::size_t>(head->size),
                                                          start.size() - head->head_bytes));
    EbmlWalk walk(content);
    while (const auto child = walk.next()) {
        if (child->id == ebml::kDocType) return child->text() == "matroska";
    }
    return false;
}

std::optional<TimeNs> parse_ns(const std::string& text) {
    TimeNs value = 0;
    const char* end = text.data() + text.size();
    const auto [at, error] = std::from_chars(text.data(), end, value);
    if (error != std::errc() || at != end || value < 0 || value > kMaxTime) return std::nullopt;
    return value;
}

class Indexer {
  public:
    Indexer(const ByteSource& bytes, const std::string& where)
        : bytes_(bytes), window_(bytes), where_(where) {}

    Result<K4aFile> run() {
        if (!has_matroska_head(window_.at(0, 1100))) return fail("not a Matroska file", where_);
        const auto ebml = ebml_at(window_, 0, bytes_.size());
        if (!ebml) return fail("the file is cut off in its head", where_);
        const auto segment = read_ebml_head(window_.at(ebml->end, 12));
        if (!segment || segment->id != ebml::kSegment) {
            return fail("no Matroska segment", where_);
        }
        std::uint64_t at = ebml->end + segment->head_bytes;
        // Until it is closed, the recorder leaves the segment's size at 0.
        const bool sized =
            !segment->unknown_size && segment->size > 0 && segment->size <= bytes_.size() - at;
        if (!segment->unknown_size && !sized) {
            file_.findings.push_back("the recording was cut off");
        }
        KINO_TRY(walk(at, sized ? at + segment->size : bytes_.size()));
        if (!have_tracks_) return fail("the file is cut off before its tracks", where_);
        if (const auto tag = file_.tags.find("K4A_START_OFFSET_NS"); tag != file_.tags.end()) {
            const auto offset = parse_ns(tag->second);
            if (!offset) return fail("K4A_START_OFFSET_NS is no number", where_);
            file_.start_offset = *offset;
        }
        const bool marked = std::any_of(file_.tags.begin(), file_.tags.end(), [](const auto& tag) {
            return tag.first.starts_with("K4A_");
        });
        if (!marked) return fail("not an Azure Kinect recording: it has no K4A_ tag", where_);
        return std::move(file_);
    }

  private:
    Result<void> walk(std::uint64_t at, std::uint64_t end) {
        while (at < end) {
            const auto head = read_ebml_head(window_.at(at, 12));
            if (!head) {
                file_.findings.push_back(
                    "the recording was cut off or is damaged behind its last "
                    "sound frame");
                return {};
            }
            const std::uint64_t content = at + head->head_bytes;
            if (head->id == ebml::kCluster) {
                const std::uint64_t left = end - std::min(end, content);
                const bool whole = !head->unknown_size && head->size <= left;
                at = cluster(content, whole ? content + head->size : end, head->unknown_size);
                if (!whole && !head->unknown_size) {
                    file_.findings.push_back("the last cluster is cut off");
                }
                if (stopped_) return {};
                continue;
            }
            if (head->unknown_size || content > end || head->size > end - content) {
                file_.findings.push_back("the recording was cut off");
                return {};
            }
            KINO_TRY(element(head->id, content, head->size));
            at = content + head->size;
        }
        return {};
    }

    Result<void> element(std::uint32_t id, std::uint64_t at, std::uint64_t size) {
        if (id != ebml::kInfo && id != ebml::kTracks && id != ebml::kAttachments &&
            id != ebml::kTags) {
            return {};
        }
        if (size > kMaxHeadElement) {
            return fail(fmt::format("an element before the frames has {} bytes", size), where_);
        }
        std::vector<std::uint8_t> content(static_cast<std::size_t>(size));
        if (!bytes_.read(at, content)) return fail("could not be read", where_);
        EbmlWalk children(content);
        while (const auto child = children.next()) {
            if (id == ebml::kInfo && child->id == ebml::kTimestampScale) {
                const std::uint64_t scale = child->number().value_or(0);
                if (scale == 0 || scale > 1'000'000'000) {
                    return fail("the time scale makes no sense", where_);
                }
                scale_ = static_cast<TimeNs>(scale);
            } else if (id == ebml::kTracks && child->id == ebml::kTrackEntry) {
                KINO_TRY(track(child->content));
            } else if (id == ebml::kAttachments && child->id == ebml::kAttachedFile) {
                attachment(child->content);
            } else if (id == ebml::kTags && child->id == ebml::kTag) {
                tag(child->content);
            }
        }
        if (id == ebml::kTracks) have_tracks_ = true;
        return {};
    }

    Result<void> track(std::span<const std::uint8_t> content) {
        K4aTrack out;
        std::string codec;
        std::span<const std::uint8_t> private_data;
        EbmlWalk children(content);
        while (const auto child = children.next()) {
            if (child->id == ebml::kTrackNumber) out.number = child->number().value_or(0);
            if (child->id == ebml::kTrackName) out.name = child->text();
            if (child->id == ebml::kCodecId) codec = child->text();
            if (child->id == ebml::kCodecPrivate) private_data = child->content;
            if (child->id == ebml::kDefaultDuration) {
                out.frame_distance = static_cast<TimeNs>(std::min<std::uint64_t>(
                    child->number().value_or(0), static_cast<std::uint64_t>(kMaxTime)));
            }
            if (child->id != ebml::kVideo) continue;
            EbmlWalk video(child->content);
            while (const auto size = video.next()) {
                const auto value = static_cast<int>(
                    std::min<std::uint64_t>(size->number().value_or(0), kMaxSize + 1));
                if (size->id == ebml::kPixelWidth) out.width = value;
                if (size->id == ebml::kPixelHeight) out.height = value;
            }
        }
        if (codec == "S_K4A/IMU") {
            out.role = K4aRole::motion;
            out.pixels = K4aPixels::imu;
            return add(std::move(out));
        }
        static const std::map<std::string, K4aRole> kNames = {{"DEPTH", K4aRole::depth},
                                                              {"KINOSCOPE_DEPTH", K4aRole::depth},
                                                              {"COLOR", K4aRole::color},
                                                              {"IR", K4aRole::infrared},
                                                              {"KINOSCOPE_IR", K4aRole::infrared}};
        const auto name = kNames.find(out.name);
        if (name == kNames.end() || codec != "V_MS/VFW/FOURCC") return {};
        out.role = name->second;
        constexpr std::size_t kFourccAt = 16;
        if (private_data.size() < kFourccAt + 4) {
            return fail(fmt::format("track {} states no pixel format", out.name), where_);
        }
        const std::string fourcc(private_data.begin() + kFourccAt,
                                 private_data.begin() + kFourccAt + 4);
        static const std::map<std::string, K4aPixels> kFourccs = {{"b16g", K4aPixels::b16g},
                                                                  {"MJPG", K4aPixels::mjpg},
                                                                  {"NV12", K4aPixels::nv12},
                                                                  {"YUY2", K4aPixels::yuy2},
                                                                  {"BGRA", K4aPixels::bgra}};
        const auto pixels = kFourccs.find(fourcc);
        const bool picture = out.role == K4aRole::color;
        if (pixels == kFourccs.end() || picture == (pixels->second == K4aPixels::b16g)) {
            return fail(fmt::format("track {} has a pixel format it cannot have", out.name),
                        where_);
        }
        out.pixels = pixels->second;
        if (out.width < 1 || out.height < 1 || out.width > kMaxSize || out.height > kMaxSize) {
            return fail(fmt::format("track {} has no size between 1 and {}", out.name, kMaxSize),
                        where_);
        }
        const bool halves = out.pixels == K4aPixels::nv12 || out.pixels == K4aPixels::yuy2;
        if (halves && (out.width % 2 != 0 || out.height % 2 != 0)) {
            return fail(fmt::format("track {} has an odd size", out.name), where_);
        }
        return add(std::move(out));
    }

    Result<void> add(K4aTrack track) {
        const auto same = [&](const K4aTrack& other) {
            return other.role == track.role || other.number == track.number;
        };
        if (file_.tracks.size() >= kMaxTracks ||
            std::any_of(file_.tracks.begin(), file_.tracks.end(), same)) {
            return fail(fmt::format("track {} is there twice", track.name), where_);
        }
        file_.tracks.push_back(std::move(track));
        return {};
    }

    void attachment(std::span<const std::uint8_t> content) {
        std::string name;
        std::span<const std::uint8_t> data;
        EbmlWalk children(content);
        while (const auto child = children.next()) {
            if (child->id == ebml::kFileName) name = child->text();
            if (child->id == ebml::kFileData) data = child->content;
        }
        std::string text(data.begin(), data.end());
        if (name == "calibration.json") file_.calibration = std::move(text);
        if (name == "kinoscope_rig.json") file_.own_rig = std::move(text);
    }

    void tag(std::span<const std::uint8_t> content) {
        EbmlWalk children(content);
        while (const auto child = children.next()) {
            if (child->id != ebml::kSimpleTag) continue;
            std::string name;
            std::string value;
            EbmlWalk fields(child->content);
            while (const auto field = fields.next()) {
                if (field->id == ebml::kTagName) name = field->text();
                if (field->id == ebml::kTagString) value = field->text();
            }
            constexpr std::size_t kMostTags = 1000;
            const bool known = name.starts_with("K4A_") || name.starts_with("KINOSCOPE_");
            if (known && file_.tags.size() < kMostTags) {
                file_.tags.emplace(std::move(name), std::move(value));
            }
        }
    }

    /// Reads the blocks up to `end` (of an unknown size: up to an element that a cluster cannot
    /// have) and returns where it stopped.
    std::uint64_t cluster(std::uint64_t at, std::uint64_t end, bool open) {
        TimeNs start = 0;
        while (at < end) {
            const auto head = read_ebml_head(window_.at(at, 12));
            if (head && open &&
                (head->id == ebml::kCluster || head->id == ebml::kCues || head->id == ebml::kTags ||
                 head->id == ebml::kAttachments)) {
                return at;
            }
            if (!head || head->unknown_size || head->size > end - at ||
                head->head_bytes > end - at - head->size) {
                cut();
                return end;
            }
            const std::uint64_t content = at + head->head_bytes;
            at = content + head->size;
            if (head->id == ebml::kTimestamp) {
                const auto bytes = window_.at(
                    content, static_cast<std::size_t>(std::min<std::uint64_t>(head->size, 9)));
                const auto ticks = EbmlChild{head->id, bytes}.number();
                if (!ticks || *ticks > static_cast<std::uint64_t>(kMaxTime / scale_)) {
                    cut();
                    return end;
                }
                start = static_cast<TimeNs>(*ticks) * scale_;
            } else if (head->id == ebml::kSimpleBlock) {
                block(content, head->size, start);
            } else if (head->id == ebml::kBlockGroup) {
                const auto inner = ebml_at(window_, content, at);
                if (inner && inner->id == ebml::kBlock) {
                    block(inner->content, inner->end - inner->content, start);
                }
            }
        }
        return at;
    }

    void cut() {
        if (stopped_) return;
        stopped_ = true;
        file_.findings.push_back("the recording is cut off or damaged behind its last sound frame");
    }

    void block(std::uint64_t at, std::uint64_t size, TimeNs cluster_time) {
        const auto head =
            window_.at(at, static_cast<std::size_t>(std::min<std::uint64_t>(size, 12)));
        // Track numbers are as EBML's sizes; tracks beyond the 126th are not this recorder's.
        constexpr std::size_t kHead = 4;
        if (head.size() < kHead || head[0] < 0x81 || size > kMaxFrameBytes) return;
        const std::uint64_t number = head[0] & 0x7Fu;
        const auto track =
            std::find_if(file_.tracks.begin(), file_.tracks.end(),
                         [&](const K4aTrack& candidate) { return candidate.number == number; });
        if (track == file_.tracks.end() || file_.blocks.size() >= kMaxBlocks) return;
        const auto relative = static_cast<std::int16_t>(head[1] << 8 | head[2]);
        const TimeNs time = cluster_time + relative * scale_;
        if (time < 0) return;
        file_.blocks.push_back({static_cast<std::size_t>(track - file_.tracks.begin()), time,
                                at + kHead, size - kHead});
    }

    const ByteSource& bytes_;
    ByteWindow window_;
    const std::string& where_;
    K4aFile file_;
    TimeNs scale_ = 1'000'000;
    bool have_tracks_ = false;
    bool stopped_ = false;
};

}  // namespace

Result<K4aFile> index_k4a(const ByteSource& bytes, const std::string& where) {
    return Indexer(bytes, where).run();
}

bool looks_like_k4a(const ByteSource& bytes) {
    std::vector<std::uint8_t> start(
        static_cast<std::size_t>(std::min<std::uint64_t>(bytes.size(), kProbeBytes)));
    if (!bytes.read(0, start) || !has_matroska_head(start)) return false;
    const std::string_view text(reinterpret_cast<const char*>(start.data()), start.size());
    for (const std::string_view mark :
         {"K4A_DEPTH_MODE", "K4A_COLOR_MODE", "K4A_IR_MODE", "K4A_START_OFFSET_NS", "S_K4A/IMU"}) {
        if (text.find(mark) != std::string_view::npos) return true;
    }
    return false;
}

}  // namespace kino
