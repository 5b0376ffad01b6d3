#pragma once

#include <cstddef>
#include <iosfwd>
#include <string>

namespace lancet::experiments {

/// Tells a person how far a long run is. On a terminal it keeps one line up to date; elsewhere every new state is a
/// line of its own.
class Progress {
  public:
    /// On standard error.
    Progress();
    /// On `stream`; `width` is the width of the terminal in columns, 0 when it is not a terminal.
    Progress(std::ostream& stream, std::size_t width);
    Progress(const Progress&) = delete;
    Progress& operator=(const Progress&) = delete;
    ~Progress();

    /// Shows `text`; on a terminal in the place of the last one, shortened to its width.
    void show(const std::string& text);

    /// Shows "[step/steps] text", the steps counted from 1.
    void show(std::size_t step, std::size_t steps, const std::string& text);

    /// Takes the line away from a terminal, so that other output can follow. Called by the destructor too.
    void clear();

  private:
    std::ostream* stream_;
    std::size_t width_;
    std::string last_;
};

}  // namespace lancet::experiments
