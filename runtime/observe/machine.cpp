#include "lancet/runtime/observe/machine.hpp"

#include <cstdlib>
#include <fstream>
#include <thread>

#include <sched.h>
#include <sys/utsname.h>
#include <unistd.h>

namespace lancet::runtime {
namespace {

std::string first_word(const std::string& path) {
    std::string word;
    std::ifstream(path) >> word;
    return word;
}

// Sizes look like 32K or 1M.
std::size_t bytes_of(const std::string& text) {
    if (text.empty()) return 0;
    char* unit = nullptr;
    const std::size_t number = std::strtoull(text.c_str(), &unit, 10);
    constexpr std::size_t kilo = 1024;
    if (*unit == 'K') return number * kilo;
    if (*unit == 'M') return number * kilo * kilo;
    if (*unit == 'G') return number * kilo * kilo * kilo;
    return number;
}

utsname system_name() {
    utsname name{};
    uname(&name);  // fails for a bad pointer only
    return name;
}

}  // namespace

std::string cpu_model() {
    std::ifstream file("/proc/cpuinfo");
    for (std::string line; std::getline(file, line);) {
        if (!line.starts_with("model name")) continue;
        const auto colon = line.find(": ");
        if (colon != std::string::npos) return line.substr(colon + 2);
    }
    return std::string("unknown ") + system_name().machine;
}

int cores_online() {
    const long count = sysconf(_SC_NPROCESSORS_ONLN);
    return count > 0 ? static_cast<int>(count) : static_cast<int>(std::thread::hardware_concurrency());
}

int cores_allowed() {
    cpu_set_t set;
    CPU_ZERO(&set);
    return sched_getaffinity(0, sizeof set, &set) == 0 ? CPU_COUNT(&set) : cores_online();
}

std::string kernel_release() {
    const utsname name = system_name();
    return std::string(name.sysname) + " " + name.release + " " + name.machine;
}

std::size_t cache_bytes(int level) {
    const std::string folder = "/sys/devices/system/cpu/cpu0/cache/index";
    for (int index = 0;; ++index) {
        const std::string cache = folder + std::to_string(index) + "/";
        const std::string this_level = first_word(cache + "level");
        if (this_level.empty()) return 0;
        if (this_level == std::to_string(level) && first_word(cache + "type") != "Instruction") {
            return bytes_of(first_word(cache + "size"));
        }
    }
}

std::array<double, 3> load_averages() {
    std::array<double, 3> averages{-1, -1, -1};
    getloadavg(averages.data(), static_cast<int>(averages.size()));
    return averages;
}

}  // namespace lancet::runtime
