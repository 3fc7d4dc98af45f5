#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "base/error.h"
#include "base/time.h"
#include "sensor/session/byte_source.h"

namespace kino {

struct BagMessage {
    std::uint32_t connection = 0;
    TimeNs time = 0;  ///< as recorded
    /// Index of the chunk; SIZE_MAX: the message lies in the file itself.
    std::size_t chunk = 0;
    std::uint64_t offset = 0;  ///< of its record, in the unpacked chunk or the file
};

/// A ROS bag of version 2.0 (chunks plain, LZ4 or bzip2). A bag that was never closed ("unindexed")
/// is read by looking through its chunks, the last one as far as it goes.
class BagFile {
  public:
    /// Messages of topics that `wanted` refuses are not remembered. Fails for what is no bag.
    [[nodiscard]] static Result<std::unique_ptr<BagFile>> open(
        std::unique_ptr<ByteSource> bytes, const std::string& where,
        const std::function<bool(const std::string& topic)>& wanted);

    /// Topics by connection.
    [[nodiscard]] const std::map<std::uint32_t, std::string>& topics() const { return topics_; }
    [[nodiscard]] const std::vector<BagMessage>& messages() const { return messages_; }
    /// What a user must be told, whole sentences without stop.
    [[nodiscard]] const std::vector<std::string>& findings() const { return findings_; }

    /// The message's bytes, valid until the next call. Fails where its chunk is damaged.
    [[nodiscard]] Result<std::span<const std::uint8_t>> read(const BagMessage& message);

  private:
    enum class Packing : std::uint8_t { none, lz4, bz2 };
    struct Chunk {
        std::uint64_t data = 0;  ///< offset in the file
        std::uint64_t size = 0;  ///< packed
        std::uint64_t unpacked_size = 0;
        Packing packing = Packing::none;
        bool cut = false;      ///< the file ends within it
        bool indexed = false;  ///< index records followed
    };
    struct Loaded {
        std::size_t chunk = SIZE_MAX;
        std::vector<std::uint8_t> bytes;
    };
    struct IndexedMessage {
        std::size_t chunk;
        std::uint64_t record;  ///< offset of the index record's data
        std::uint32_t count;
        std::uint32_t connection;
    };
    using Wanted = std::function<bool(const std::string&)>;

    BagFile(std::unique_ptr<ByteSource> bytes, std::string where);
    [[nodiscard]] Result<void> scan(const Wanted& wanted);
    [[nodiscard]] Result<void> scan_records(const Wanted& wanted,
                                            std::vector<IndexedMessage>& indexed);
    [[nodiscard]] Result<void> read_index(const Wanted& wanted,
                                          const std::vector<IndexedMessage>& indexed);
    void scan_chunk(std::size_t chunk, const Wanted& wanted);
    void find(const std::string& what);
    [[nodiscard]] bool remember(const BagMessage& message, const Wanted& wanted);
    [[nodiscard]] Result<std::span<const std::uint8_t>> load(std::size_t chunk);

    std::unique_ptr<ByteSource> bytes_;
    std::string where_;
    std::map<std::uint32_t, std::string> topics_;
    std::map<std::uint32_t, bool> wanted_;
    std::vector<BagMessage> messages_;
    std::vector<Chunk> chunks_;
    std::vector<std::string> findings_;
    std::array<Loaded, 2> loaded_;  // depth and colour of one moment may lie in neighbours
    std::size_t next_slot_ = 0;
    std::vector<std::uint8_t> loose_;
};

[[nodiscard]] bool looks_like_bag(const ByteSource& bytes);

}  // namespace kino
