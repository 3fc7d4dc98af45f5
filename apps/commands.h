#pragma once

#include <functional>

namespace CLI {
class App;
}

namespace kino {

/// A subcommand tells CLI11 its options and gets run after parsing; it returns an ExitCode.
using Command = std::function<int()>;

[[nodiscard]] Command add_replay(CLI::App& parent);
[[nodiscard]] Command add_live(CLI::App& parent);
[[nodiscard]] Command add_demo(CLI::App& parent);
[[nodiscard]] Command add_record(CLI::App& parent);
[[nodiscard]] Command add_convert(CLI::App& parent);
[[nodiscard]] Command add_repair(CLI::App& parent);
[[nodiscard]] Command add_devices(CLI::App& parent);
[[nodiscard]] Command add_compare(CLI::App& parent);
/// Hands its arguments to the program kinoscope-bench beside this one.
[[nodiscard]] Command add_bench(CLI::App& parent);
/// Likewise kinoscope-train.
[[nodiscard]] Command add_train(CLI::App& parent);
/// As add_bench: kinoscope-calibrate.
[[nodiscard]] Command add_calibrate(CLI::App& parent);

}  // namespace kino
