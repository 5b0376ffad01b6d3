#include "lancet/experiments/common/peak_memory.hpp"

#include <algorithm>
#include <fstream>
#include <sstream>
#include <string>

#include <malloc.h>

namespace lancet::experiments {
namespace {

/// A field of /proc/self/status, in bytes.
std::optional<std::int64_t> status(const std::string& field) {
    std::ifstream file("/proc/self/status");
    std::string line;
    while (std::getline(file, line)) {
        if (!line.starts_with(field + ":")) continue;
        std::istringstream words(line.substr(field.size() + 1));
        std::int64_t kibibytes = 0;
        if (words >> kibibytes) return 1024 * kibibytes;
    }
    return {};
}

/// See proc(5): 5 resets the peak resident set size.
bool reset_peak() {
    std::ofstream file("/proc/self/clear_refs");
    file << "5" << std::flush;
    return file.good();
}

}  // namespace

PeakMemory::PeakMemory() {
    ::malloc_trim(0);
    if (reset_peak()) before_ = status("VmRSS");
}

std::optional<std::int64_t> PeakMemory::bytes() const {
    const std::optional<std::int64_t> peak = status("VmHWM");
    if (!before_ || !peak) return {};
    return std::max<std::int64_t>(0, *peak - *before_);
}

}  // namespace lancet::experiments
