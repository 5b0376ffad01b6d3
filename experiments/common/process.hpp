#pragma once

#include <chrono>
#include <filesystem>
#include <optional>
#include <stop_token>
#include <string>
#include <utility>
#include <variant>
#include <vector>

namespace lancet::experiments {

/// A program to run.
struct Command {
    std::filesystem::path program{};                                 ///< looked up in PATH when it has no slash
    std::vector<std::string> arguments{};                            ///< without the program's own name
    std::vector<std::pair<std::string, std::string>> environment{};  ///< set on top of the caller's own environment
    std::optional<std::chrono::milliseconds> timeout{};              ///< after this time the program is killed
    std::stop_token stop{};                                          ///< when it asks, the program is killed
};

/// It ended by itself, with this exit code.
struct Exited {
    int code = 0;
};
/// A signal ended it.
struct Signalled {
    int number = 0;
};
/// It ran longer than Command::timeout and was killed.
struct TimedOut {};
/// Command::stop asked, and it was killed.
struct Stopped {};

/// How a program ended.
using ProcessEnd = std::variant<Exited, Signalled, TimedOut, Stopped>;

/// What is left of a program that was run.
struct ProcessResult {
    ProcessEnd end;
    std::string output;  ///< all that it wrote to standard output

    /// Whether it ended by itself with exit code 0.
    [[nodiscard]] bool succeeded() const;
};

/// Runs a program and waits until it and everything that shares its standard output are done. Its standard output is
/// captured, its standard error is the caller's, its standard input is empty. Throws lancet::Error when it cannot be
/// started; however it ends, once started, is a result.
[[nodiscard]] ProcessResult run_process(const Command& command);

/// "exit code 3", "signal 11 (Segmentation fault)", "killed after its time limit" or "stopped".
[[nodiscard]] std::string describe(const ProcessEnd& end);

/// The file of the running program, for programs that start copies of themselves as workers. Throws lancet::Error where
/// the system does not tell.
[[nodiscard]] std::filesystem::path this_program();

}  // namespace lancet::experiments
