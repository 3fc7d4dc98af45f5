#include "tests/sensor/device/guest_run.h"

#include <fmt/format.h>
#include <sys/wait.h>

#include <cstdio>
#include <fstream>
#include <iterator>
#include <sstream>

namespace kino::guest {
namespace {

std::string quoted(const std::string& text) {
    std::string result = "'";
    for (const char c : text) {
        if (c == '\'') {
            result += "'\\''";
        } else {
            result += c;
        }
    }
    return result + "'";
}

}  // namespace

GuestRun parse_report(const std::string& output) {
    GuestRun run;
    run.output = output;
    std::istringstream lines(output);
    for (std::string line; std::getline(lines, line);) {
        std::istringstream fields(line);
        std::string mark;
        std::string scenario;
        if (!(fields >> mark >> scenario)) continue;
        if (mark == "=") {
            std::string key;
            double number = 0;
            if (fields >> key >> number) run.values[scenario][key] = number;
        } else if (mark == "!") {
            std::string text;
            std::getline(fields, text);
            run.failures[scenario].push_back(text);
        }
    }
    return run;
}

GuestRun boot_guest(const std::string& script, const std::string& folder,
                    const std::string& program, int seconds_at_most) {
    const std::string command = fmt::format("bash {} {} {} {} 2>&1", quoted(script), quoted(folder),
                                            seconds_at_most, quoted(program));
    std::string messages;
    int status = -1;
    if (FILE* pipe = popen(command.c_str(), "r"); pipe != nullptr) {
        char part[4096];
        while (const std::size_t got = std::fread(part, 1, sizeof part, pipe)) {
            messages.append(part, got);
        }
        status = pclose(pipe);
    }
    std::ifstream file(folder + "/share/output");
    GuestRun run = parse_report({std::istreambuf_iterator<char>(file), {}});
    run.status = WIFEXITED(status) ? WEXITSTATUS(status) : -1;
    run.messages = messages;
    return run;
}

}  // namespace kino::guest
