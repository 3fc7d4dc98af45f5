#include "tests/support/golden.h"

#include <cstdlib>
#include <string_view>
#include <system_error>

#include "sensor/png_io.h"

namespace kino::test {

namespace {

namespace fs = std::filesystem;

std::string write_or_reason(const fs::path& path, const Image<Rgba8>& picture) {
    std::error_code ignored;  // the write tells
    fs::create_directories(path.parent_path(), ignored);
    const auto written = write_png_rgba8(path, picture.view());
    return written ? path.string() : written.error().to_string();
}

}  // namespace

GoldenPlace default_golden_place() {
    const char* update = std::getenv("KINO_UPDATE_GOLDENS");
    return {.stored = fs::path(KINO_SOURCE_FOLDER) / "tests/data/golden",
            .failures = fs::path(KINO_BUILD_FOLDER) / "out/golden",
            .update = update != nullptr && std::string_view(update) == "1"};
}

testing::AssertionResult matches_golden(const std::string& name, const Image<Rgba8>& actual,
                                        const GoldenGate& gate, const GoldenPlace& place) {
    const fs::path stored = place.stored / (name + ".png");
    if (place.update) {
        std::error_code ignored;
        fs::create_directories(stored.parent_path(), ignored);
        const auto written = write_png_rgba8(stored, actual.view());
        if (!written) return testing::AssertionFailure() << written.error().to_string();
        return testing::AssertionSuccess() << "stored " << stored;
    }
    const auto failure = [&](const std::string& reason) {
        return testing::AssertionFailure()
               << name << ": " << reason
               << "\n  actual: " << write_or_reason(place.failures / (name + "-actual.png"), actual)
               << "\n  KINO_UPDATE_GOLDENS=1 stores it as " << stored.string();
    };
    const auto golden = read_png_rgba8(stored);
    if (!golden) return failure(golden.error().to_string());
    const auto verdict = judge_golden(actual, *golden, gate);
    if (verdict && verdict->passes) {
        return testing::AssertionSuccess() << name << ": " << verdict->difference.to_string();
    }
    const std::string reason =
        verdict ? verdict->difference.to_string() : verdict.error().to_string();
    return failure(reason + "\n  difference: " +
                   write_or_reason(place.failures / (name + "-difference.png"),
                                   difference_picture(actual, *golden)));
}

}  // namespace kino::test
