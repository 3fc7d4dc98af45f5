#include "logged_file.h"

#include <algorithm>

#include "base/check.h"

namespace kino::test {
namespace {

using Kind = FileStep::Kind;

void apply(std::vector<std::uint8_t>& content, const FileStep& step, std::size_t count) {
    if (step.kind == Kind::truncate) {
        content.resize(static_cast<std::size_t>(step.offset));
        return;
    }
    const auto offset = static_cast<std::size_t>(step.offset);
    if (count > 0 && content.size() < offset + count) content.resize(offset + count);
    std::copy_n(step.bytes.begin(), count, content.begin() + static_cast<std::ptrdiff_t>(offset));
}

}  // namespace

Result<void> LoggedFile::append(std::span<const std::uint8_t> bytes) {
    const std::uint64_t room = capacity_ - std::min(capacity_, size());
    const auto count = static_cast<std::size_t>(std::min<std::uint64_t>(room, bytes.size()));
    log_.steps.push_back({Kind::append, size(), {bytes.begin(), bytes.begin() + count}});
    apply(log_.content, log_.steps.back(), count);
    if (count < bytes.size()) return fail("No space left on device");
    return {};
}

Result<void> LoggedFile::overwrite(std::uint64_t offset, std::span<const std::uint8_t> bytes) {
    KINO_CHECK_LE(offset + bytes.size(), size());
    log_.steps.push_back({Kind::overwrite, offset, {bytes.begin(), bytes.end()}});
    apply(log_.content, log_.steps.back(), bytes.size());
    return {};
}

Result<void> LoggedFile::sync() {
    if (broken_) return fail("Input/output error");
    log_.steps.push_back({Kind::sync, 0, {}});
    return {};
}

Result<void> LoggedFile::truncate(std::uint64_t size) {
    log_.steps.push_back({Kind::truncate, size, {}});
    log_.content.resize(static_cast<std::size_t>(size));
    return {};
}

std::vector<std::uint8_t> after_power_cut(const FileLog& log, std::size_t steps, Random& random) {
    std::size_t synced = 0;
    for (std::size_t i = 0; i < steps; ++i) {
        if (log.steps[i].kind == Kind::sync) synced = i + 1;
    }
    std::vector<std::uint8_t> content;
    for (std::size_t i = 0; i < steps; ++i) {
        const FileStep& step = log.steps[i];
        if (step.kind == Kind::sync) continue;
        if (i < synced) {
            apply(content, step, step.bytes.size());
            continue;
        }
        const int fate = random.integer(0, 2);
        if (fate == 0) continue;
        std::size_t count = step.bytes.size();
        if (fate == 1 && step.kind == Kind::append) {
            count = static_cast<std::size_t>(random.integer(0, static_cast<int>(count)));
        }
        if (step.kind == Kind::overwrite) {
            KINO_CHECK(step.offset / 512 == (step.offset + count - 1) / 512);
            if (step.offset + count > content.size()) continue;
        }
        if (step.kind == Kind::truncate && step.offset > content.size()) continue;
        apply(content, step, count);
    }
    return content;
}

std::uint64_t synced_size(const FileLog& log, std::size_t steps) {
    std::uint64_t size = 0;
    std::uint64_t synced = 0;
    for (std::size_t i = 0; i < steps; ++i) {
        const FileStep& step = log.steps[i];
        if (step.kind == Kind::append) size = std::max(size, step.offset + step.bytes.size());
        if (step.kind == Kind::truncate) size = step.offset;
        if (step.kind == Kind::sync) synced = size;
    }
    return synced;
}

}  // namespace kino::test
