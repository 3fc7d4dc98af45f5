#pragma once

#include <filesystem>
#include <string>

#include "base/error.h"

namespace kino {

/// A file or folder that grows beside its place under another name ("x.mkv.1234.partial") and is
/// moved there when it is whole; taken away if it never is.
class StagedOutput {
  public:
    /// Fails where `target` is there already, unless `replace`. The file itself is not made.
    [[nodiscard]] static Result<StagedOutput> file(const std::filesystem::path& target,
                                                   bool replace);
    /// Makes the folder under its passing name. Fails where `target` is there and not empty; with
    /// `replace` only where it holds anything that no conversion writes.
    [[nodiscard]] static Result<StagedOutput> folder(const std::filesystem::path& target,
                                                     bool replace);
    ~StagedOutput();
    StagedOutput(StagedOutput&& other) noexcept;
    StagedOutput& operator=(StagedOutput&&) = delete;

    /// Where to write until commit().
    [[nodiscard]] const std::filesystem::path& path() const { return partial_; }
    [[nodiscard]] const std::filesystem::path& target() const { return target_; }
    [[nodiscard]] Result<void> commit();

  private:
    StagedOutput(std::filesystem::path target, bool replace);

    std::filesystem::path target_;
    std::filesystem::path partial_;
    bool replace_ = false;
    bool owns_ = true;
};

}  // namespace kino
