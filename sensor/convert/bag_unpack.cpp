#include "sensor/convert/bag_unpack.h"

#include <bzlib.h>
#include <lz4frame.h>

#include <algorithm>
#include <memory>

#include "base/check.h"

namespace kino {
namespace {

// Grown as bytes come, so that a small lie of a file cannot ask for 64 MB.
constexpr std::size_t kStep = std::size_t{1} << 20;

}  // namespace

Result<std::vector<std::uint8_t>> unpack_lz4(std::span<const std::uint8_t> packed, std::size_t size,
                                             bool cut) {
    KINO_CHECK_LE(size, kMaxBagChunk);
    LZ4F_dctx* raw = nullptr;
    if (LZ4F_isError(LZ4F_createDecompressionContext(&raw, LZ4F_VERSION))) {
        return fail("the LZ4 decoder could not be opened");
    }
    const std::unique_ptr<LZ4F_dctx, decltype(&LZ4F_freeDecompressionContext)> context(
        raw, &LZ4F_freeDecompressionContext);
    std::vector<std::uint8_t> out;
    std::size_t done = 0;
    std::size_t hint = 1;
    while (hint != 0 && !packed.empty()) {
        // One byte more than stated, so that too much is noticed.
        out.resize(std::min(size + 1, done + kStep));
        std::size_t produced = out.size() - done;
        std::size_t consumed = packed.size();
        hint =
            LZ4F_decompress(raw, out.data() + done, &produced, packed.data(), &consumed, nullptr);
        if (LZ4F_isError(hint)) {
            if (cut) break;
            return fail(std::string("an LZ4 chunk is damaged: ") + LZ4F_getErrorName(hint));
        }
        done += produced;
        packed = packed.subspan(consumed);
        if (done > size) return fail("an LZ4 chunk unpacks to more than it says");
        if (produced == 0 && consumed == 0) break;
    }
    out.resize(done);
    if (done < size && !cut) return fail("an LZ4 chunk is cut off");
    return out;
}

Result<std::vector<std::uint8_t>> unpack_bz2(std::span<const std::uint8_t> packed, std::size_t size,
                                             bool cut) {
    KINO_CHECK_LE(size, kMaxBagChunk);
    bz_stream stream{};
    if (BZ2_bzDecompressInit(&stream, 0, 0) != BZ_OK) {
        return fail("the bzip2 decoder could not be opened");
    }
    const std::unique_ptr<bz_stream, decltype(&BZ2_bzDecompressEnd)> ender(&stream,
                                                                           &BZ2_bzDecompressEnd);
    constexpr std::size_t kMaxInput = 0x7FFFFFFF;
    if (packed.size() > kMaxInput) return fail("a bzip2 chunk is too large");
    // The library does not write through this pointer.
    stream.next_in = const_cast<char*>(reinterpret_cast<const char*>(packed.data()));
    stream.avail_in = static_cast<unsigned>(packed.size());
    std::vector<std::uint8_t> out;
    std::size_t done = 0;
    for (;;) {
        out.resize(std::min(size + 1, done + kStep));
        const std::size_t room = out.size() - done;
        stream.next_out = reinterpret_cast<char*>(out.data() + done);
        stream.avail_out = static_cast<unsigned>(room);
        const int code = BZ2_bzDecompress(&stream);
        done += room - stream.avail_out;
        if (done > size) return fail("a bzip2 chunk unpacks to more than it says");
        if (code == BZ_STREAM_END) break;
        if (code != BZ_OK) {
            if (cut) break;
            return fail("a bzip2 chunk is damaged");
        }
        if (stream.avail_in == 0 && stream.avail_out > 0) break;
    }
    out.resize(done);
    if (done < size && !cut) return fail("a bzip2 chunk is cut off");
    return out;
}

}  // namespace kino
