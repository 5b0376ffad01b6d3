#include "lancet/experiments/scaling/pinning.hpp"

#include <atomic>
#include <filesystem>
#include <string>
#include <system_error>
#include <thread>
#include <vector>

#include <sched.h>

#include "lancet/kernels/error.hpp"
#include "lancet/runtime/observe/clock.hpp"

namespace lancet::experiments::scaling {
namespace {

std::vector<int> allowed_cores() {
    cpu_set_t set;
    CPU_ZERO(&set);
    std::vector<int> cores;
    if (::sched_getaffinity(0, sizeof set, &set) == 0) {
        for (int core = 0; core < CPU_SETSIZE; ++core) {
            if (CPU_ISSET(core, &set)) cores.push_back(core);
        }
    }
    if (cores.empty()) throw Error("--pin: the system does not tell which cores this process may use");
    return cores;
}

bool pin_calling_thread(int core) {
    cpu_set_t set;
    CPU_ZERO(&set);
    CPU_SET(core, &set);
    return ::sched_setaffinity(0, sizeof set, &set) == 0;  // 0: this thread, not the process
}

int count_pinned_threads() {
    int count = 0;
    std::error_code failed;
    for (const auto& task : std::filesystem::directory_iterator("/proc/self/task", failed)) {
        cpu_set_t set;
        CPU_ZERO(&set);
        const int thread = std::stoi(task.path().filename().string());
        if (::sched_getaffinity(thread, sizeof set, &set) == 0 && CPU_COUNT(&set) == 1) ++count;
    }
    return count;
}

}  // namespace

int pin_threads(runtime::Scheduler& scheduler) {
    constexpr double patience_seconds = 60;  // a thread that is not there at all never comes; a busy machine delays one
    const std::vector<int> cores = allowed_cores();
    const int threads = scheduler.threads();
    const double start = runtime::steady_seconds();
    std::atomic<int> arrived = 0;
    scheduler.for_each_block(threads, [&](int) {
        const int place = arrived.fetch_add(1);
        if (!pin_calling_thread(cores[static_cast<std::size_t>(place) % cores.size()])) {
            throw Error("--pin: the system refuses to hold a thread to a core");
        }
        while (arrived.load() < threads) {
            if (runtime::steady_seconds() - start > patience_seconds) {
                throw Error("--pin: " + std::to_string(arrived.load()) + " of " + std::to_string(threads) +
                            " threads came, expected all of them");
            }
            std::this_thread::yield();
        }
    });
    return count_pinned_threads();
}

}  // namespace lancet::experiments::scaling
