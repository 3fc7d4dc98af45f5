#pragma once

#include <cstddef>
#include <memory>
#include <vector>

#include "sensor/source.h"

namespace kino {

/// One stream of a recording in a foreign format, known before any pixel is read.
struct ImportedStream {
    StreamInfo info;
    std::vector<TimeNs> times;        ///< host time, strictly rising
    std::vector<std::size_t> frames;  ///< what the reader calls each of them; as many as times
};

/// Reads one frame when it is asked for; the same number gives the same frame.
class ImportReader {
  public:
    virtual ~ImportReader() = default;
    virtual Result<StreamFrame> read(StreamKind kind, std::size_t frame) = 0;
};

struct Import {
    SourceInfo info;  ///< its streams are filled in from those below
    RigParameters rig;
    std::vector<ImportedStream> streams;  ///< of device 0; the first leads and is not empty
    std::unique_ptr<ImportReader> reader;
};

/// Gives a foreign recording the face of a Source with a Timeline: frame i is the i-th of the
/// leading stream, the others beside it as pair_in_time() says. A tap sees every frame of the
/// subscribed streams, also those that are beside no leading one.
[[nodiscard]] std::unique_ptr<Source> make_imported_source(Import import);

/// Drops what does not rise strictly, keeping times and frames together; returns how many.
std::size_t keep_rising(ImportedStream& stream);

}  // namespace kino
