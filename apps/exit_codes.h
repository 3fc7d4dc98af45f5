#pragma once

namespace kino {

/// What the program's exit status says; --help lists them.
enum ExitCode : int {
    kExitDone = 0,
    kExitFailed = 1,    ///< a file or device could not be used
    kExitUsage = 2,     ///< the command line is wrong
    kExitNoVulkan = 3,  ///< no Vulkan device fits
    kExitDiffer = 4     ///< compare: the pictures differ by more than is allowed
};

constexpr const char* kExitCodesText =
    "Exit status: 0 done (also when ended by Ctrl-C), 1 a file or device could not be used,\n"
    "2 wrong usage, 3 no usable Vulkan device, 4 (compare) the pictures differ.";

}  // namespace kino
