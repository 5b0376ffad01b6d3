#include "lancet/experiments/scaling/load.hpp"

#include <algorithm>
#include <cstdint>
#include <ctime>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <sstream>
#include <system_error>
#include <vector>

#include <unistd.h>

#include "lancet/experiments/common/statistics.hpp"
#include "lancet/experiments/common/table.hpp"
#include "lancet/kernels/error.hpp"
#include "lancet/runtime/observe/clock.hpp"
#include "lancet/runtime/observe/machine.hpp"

namespace lancet::experiments::scaling {
namespace {

/// Processor time of this process, all threads together.
double own_seconds() {
    std::timespec time{};
    if (::clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &time) != 0) return 0;
    return static_cast<double>(time.tv_sec) + 1e-9 * static_cast<double>(time.tv_nsec);
}

std::optional<CoreTimes> core_times_now() {
    std::ifstream stream("/proc/stat");
    const std::string text{std::istreambuf_iterator<char>(stream), {}};
    return core_times(text, static_cast<double>(::sysconf(_SC_CLK_TCK)));
}

/// Seconds for which each thread of this process was ready to run and did not: the second number of schedstat, in ns.
std::map<std::string, double> waited_seconds() {
    std::map<std::string, double> seconds;
    std::error_code failed;
    for (const auto& task : std::filesystem::directory_iterator("/proc/self/task", failed)) {
        std::ifstream stream(task.path() / "schedstat");
        double ran = 0, waited = 0;
        if (stream >> ran >> waited) seconds[task.path().filename().string()] = 1e-9 * waited;
    }
    return seconds;
}

/// A chain of shifts and additions of which each needs the one before: the same few milliseconds on any thread.
double spin() {
    const double start = runtime::steady_seconds();
    std::uint64_t value = 88172645463325252ULL;  // xorshift64 (Marsaglia 2003): never zero
    for (int i = 0; i < 1 << 20; ++i) {
        value ^= value << 13;
        value ^= value >> 7;
        value ^= value << 17;
    }
    const double seconds = runtime::steady_seconds() - start;
    if (value == 0) throw Error("spin: 0 found, which xorshift64 never gives");  // and so it is not left out
    return seconds;
}

double slowest_spin(runtime::Scheduler& scheduler) {
    std::vector<double> seconds(static_cast<std::size_t>(scheduler.threads()));
    scheduler.for_each_block(scheduler.threads(),
                             [&](int thread) { seconds[static_cast<std::size_t>(thread)] = spin(); });
    return *std::ranges::max_element(seconds);
}

}  // namespace

double lost_share(const Load& load, double shortest_spin_seconds, bool is_oversubscribed, int cores) {
    if (is_oversubscribed) return std::min(1.0, load.others / cores + load.stolen);
    const double slowed = load.spin_seconds > 0 ? 1 - shortest_spin_seconds / load.spin_seconds : 0;
    return std::max(load.waited + load.stolen, slowed);
}

LoadMark judge(std::span<const double> lost, int enough) {
    const auto quiet = std::ranges::count_if(lost, [](double share) { return share < loaded_from; });
    if (quiet >= enough) return LoadMark::quiet;
    return median(lost) < meaningless_from ? LoadMark::loaded : LoadMark::meaningless;
}

bool counts(LoadMark mark, double lost) {
    return mark != LoadMark::quiet || lost < loaded_from;
}

std::string to_string(LoadMark mark) {
    return mark == LoadMark::quiet ? "" : mark == LoadMark::loaded ? "loaded" : "meaningless";
}

std::string describe_load_rule() {
    const std::string low = format_number(100 * loaded_from, 3), high = format_number(100 * meaningless_from, 3);
    return "A repetition has lost the share of the time in which its most hindered thread was ready and something else "
           "had its core, or the share by which a fixed piece of arithmetic before and after it ran slower than at its "
           "fastest, whichever is more (with more threads than cores: the share of the cores that others kept busy). A "
           "row is the median of the repetitions that lost less than " +
           low +
           " %; where these are fewer than half of those asked for, it is the median of all and 'loaded', and from " +
           high + " % on 'meaningless': no speed-up is formed with it.";
}

std::optional<CoreTimes> core_times(const std::string& text, double ticks_per_second) {
    std::istringstream stream(text);
    std::string name;
    // user nice system idle iowait irq softirq steal
    double user = 0, nice = 0, system = 0, idle = 0, waiting = 0, interrupts = 0, soft_interrupts = 0, stolen = 0;
    stream >> name >> user >> nice >> system >> idle >> waiting >> interrupts >> soft_interrupts >> stolen;
    if (!stream || name != "cpu" || !(ticks_per_second > 0)) return std::nullopt;
    return CoreTimes{.busy = (user + nice + system + interrupts + soft_interrupts) / ticks_per_second,
                     .stolen = stolen / ticks_per_second};
}

LoadMeter::LoadMeter()
    : cores_at_start_(core_times_now()),
      seconds_at_start_(runtime::steady_seconds()),
      own_seconds_at_start_(own_seconds()) {}

void LoadMeter::begin(runtime::Scheduler& scheduler) {
    spin_seconds_ = slowest_spin(scheduler) / 2;
    waited_at_begin_ = waited_seconds();
    seconds_at_begin_ = runtime::steady_seconds();
}

void LoadMeter::end(runtime::Scheduler& scheduler) {
    const double seconds = runtime::steady_seconds() - seconds_at_begin_;
    for (const auto& [thread, waited] : waited_seconds()) {
        const auto before = waited_at_begin_.find(thread);
        const double since = waited - (before == waited_at_begin_.end() ? 0 : before->second);
        waited_ = std::max(waited_, std::min(1.0, since / seconds));
    }
    spin_seconds_ += slowest_spin(scheduler) / 2;
}

Load LoadMeter::finish() const {
    Load load{.waited = waited_, .spin_seconds = spin_seconds_};
    const auto cores = core_times_now();
    const double seconds = runtime::steady_seconds() - seconds_at_start_;
    if (!cores || !cores_at_start_ || !(seconds > 0)) return load;
    const double own = own_seconds() - own_seconds_at_start_;
    load.others = std::max(0.0, (cores->busy - cores_at_start_->busy - own) / seconds);
    load.stolen = (cores->stolen - cores_at_start_->stolen) / (seconds * runtime::cores_online());
    return load;
}

}  // namespace lancet::experiments::scaling
