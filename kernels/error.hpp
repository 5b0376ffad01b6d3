#pragma once

#include <stdexcept>
#include <string>

namespace lancet {

/// The one exception type of Lancet: bad input or an impossible request. The message is one line that says what was
/// read, where (file, line or element), and what was expected. Programs print it and exit with code 2.
class Error : public std::runtime_error {
  public:
    explicit Error(const std::string& message) : std::runtime_error(message) {}
};

}  // namespace lancet
