#include "lancet/runtime/observe/memory.hpp"

#include <fstream>
#include <limits>
#include <string>

#include "lancet/kernels/error.hpp"

namespace lancet::runtime {

ResidentMemory resident_memory() {
    constexpr const char* path = "/proc/self/status";
    constexpr std::size_t bytes_per_kilobyte = 1024;
    std::ifstream file(path);
    ResidentMemory memory;
    std::string key;
    while (file >> key) {
        std::size_t kilobytes = 0;
        if (key == "VmRSS:" && file >> kilobytes) memory.current = kilobytes * bytes_per_kilobyte;
        if (key == "VmHWM:" && file >> kilobytes) memory.peak = kilobytes * bytes_per_kilobyte;
        file.ignore(std::numeric_limits<std::streamsize>::max(), '\n');
    }
    if (memory.current == 0 || memory.peak == 0) {
        throw Error(std::string(path) + ": expected the lines 'VmRSS: N kB' and 'VmHWM: N kB'");
    }
    return memory;
}

}  // namespace lancet::runtime
