#pragma once

#include <functional>
#include <ostream>
#include <stdexcept>
#include <string>

namespace lancet::experiments {

/// Exit codes of every experiment.
enum class ExitCode : int {
    success = 0,
    check_failed = 1,  ///< the program ran, but a check of its own on the results failed
    bad_input = 2,     ///< wrong options, a broken file, or something that this machine cannot do
    stopped = 3        ///< a signal ended the run; what it had found by then has been written
};

/// Thrown when a check of the experiment on its own results fails. The message says which, and what was found.
class CheckFailed : public std::runtime_error {
  public:
    explicit CheckFailed(const std::string& message) : std::runtime_error(message) {}
};

/// The body of a program: what main() would do.
using MainFunction = std::function<ExitCode(int argc, const char* const* argv)>;

/// Calls `body` and turns what it throws into one line on `errors` that begins with the program's name, and an exit
/// code: CheckFailed gives 1; lancet::Error, errors of the command line, exhausted memory and any other
/// std::exception give 2. Use: int main(int argc, char** argv) { return run_main(argc, argv, body); }
int run_main(int argc, const char* const* argv, const MainFunction& body, std::ostream& errors);

/// The same with standard error.
int run_main(int argc, const char* const* argv, const MainFunction& body);

}  // namespace lancet::experiments
