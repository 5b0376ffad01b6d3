#include "lancet/experiments/common/progress.hpp"

#include <cstdlib>
#include <iostream>

#include <sys/ioctl.h>
#include <unistd.h>

namespace lancet::experiments {
namespace {

std::size_t standard_error_width() {
    if (::isatty(STDERR_FILENO) == 0) return 0;
    // A terminal that cannot move its cursor gets plain lines as well.
    const char* kind = std::getenv("TERM");
    if (kind == nullptr || std::string(kind) == "dumb") return 0;
    constexpr std::size_t usual_width = 80;
    winsize size{};
    if (::ioctl(STDERR_FILENO, TIOCGWINSZ, &size) != 0 || size.ws_col == 0) return usual_width;
    return size.ws_col;
}

/// The first `columns` code points of `text`.
std::string shortened(const std::string& text, std::size_t columns) {
    std::size_t seen = 0;
    for (std::size_t i = 0; i < text.size(); ++i) {
        const bool continues = (text[i] & 0xC0) == 0x80;
        if (!continues && seen++ == columns) return text.substr(0, i);
    }
    return text;
}

}  // namespace

Progress::Progress() : Progress(std::cerr, standard_error_width()) {}

Progress::Progress(std::ostream& stream, std::size_t width) : stream_(&stream), width_(width) {}

Progress::~Progress() {
    clear();
}

void Progress::show(const std::string& text) {
    if (text == last_) return;
    last_ = text;
    if (width_ > 0) {
        // One column stays free: a full last column makes some terminals wrap.
        *stream_ << "\r\033[K" << shortened(text, width_ - 1) << std::flush;
    } else {
        *stream_ << text << std::endl;
    }
}

void Progress::show(std::size_t step, std::size_t steps, const std::string& text) {
    show("[" + std::to_string(step) + "/" + std::to_string(steps) + "] " + text);
}

void Progress::clear() {
    if (width_ > 0 && !last_.empty()) *stream_ << "\r\033[K" << std::flush;
    last_.clear();
}

}  // namespace lancet::experiments
