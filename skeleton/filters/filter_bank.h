#pragma once

#include <map>
#include <memory>
#include <string>

#include "skeleton/filters/body_filter.h"

namespace kino {

/// One filter for each person in view, by id. Not thread-safe.
class FilterBank {
  public:
    /// `name` as make_body_filter() takes it.
    [[nodiscard]] static Result<FilterBank> create(std::string name);

    /// The filtered frame: the same bodies in the same order. A person away for longer than a
    /// second is forgotten. Bodies with id 0 pass as they are, but for readings that are not
    /// finite, which become lost.
    [[nodiscard]] BodyFrame update(const BodyFrame& frame);

    /// The bodies of the last frame as they are expected at `time`; as BodyFilter::predict().
    [[nodiscard]] BodyFrame predict(TimeNs time) const;

  private:
    struct Entry {
        std::unique_ptr<BodyFilter> filter;
        TimeNs seen = 0;
    };
    std::string name_;
    std::map<std::uint32_t, Entry> entries_;
    BodyFrame last_;
};

}  // namespace kino
