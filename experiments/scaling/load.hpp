#pragma once

#include <map>
#include <optional>
#include <span>
#include <string>

#include "lancet/runtime/schedule/scheduler.hpp"

namespace lancet::experiments::scaling {

/// What the machine did beside a measured run.
struct Load {
    /// Share of the time in which the thread that suffered most was ready and something else had its core: the others
    /// wait for it at the end of every loop.
    double waited = 0;
    double stolen = 0;        ///< share of the cores' time that a hypervisor gave to other machines
    double others = 0;        ///< cores that other processes kept busy, on average
    double spin_seconds = 0;  ///< of the same arithmetic on each thread, before and after: the slowest thread's mean
};

/// The rule. A repetition has lost the larger of
///   waited + stolen, and
///   1 - s / spin_seconds with s the shortest spin_seconds of the whole experiment (slower clocks, shared cores).
/// Where there are more threads than cores they wait for each other and spin slowly by themselves: there it is the
/// share of the cores that others kept busy.
[[nodiscard]] double lost_share(const Load& load, double shortest_spin_seconds, bool is_oversubscribed, int cores);

/// What the load makes of a row.
enum class LoadMark {
    quiet,       ///< enough repetitions have lost less than loaded_from: the row is the median of these
    loaded,      ///< else; the row is the median of all
    meaningless  ///< else, and the median repetition has lost meaningless_from or more: no speed-up is formed with it
};
constexpr double loaded_from = 0.05;
constexpr double meaningless_from = 0.25;

/// Repetitions that are enough: half of those asked for.
[[nodiscard]] constexpr int enough_quiet(int repetitions) {
    return (repetitions + 1) / 2;
}

/// The mark of a row whose repetitions have lost these shares; there must be one or more.
[[nodiscard]] LoadMark judge(std::span<const double> lost, int enough);
/// Whether a repetition counts in a row with that mark.
[[nodiscard]] bool counts(LoadMark mark, double lost);
/// "", "loaded" or "meaningless".
[[nodiscard]] std::string to_string(LoadMark mark);
/// The rule in words, for people.
[[nodiscard]] std::string describe_load_rule();

/// The counters of Linux for the cores together (/proc/stat), in seconds.
struct CoreTimes {
    double busy = 0;
    double stolen = 0;
};
/// The counters in the first line of a text in the form of /proc/stat, or nothing where it has another form.
[[nodiscard]] std::optional<CoreTimes> core_times(const std::string& text, double ticks_per_second);

/// Measures Load in the process that is timed. Where the system keeps no such counters their shares are 0.
class LoadMeter {
  public:
    /// At the start of the process: `others` and `stolen` are counted in hundredths of a second, so they are those of
    /// the whole process.
    LoadMeter();
    /// Right before and after what is timed, with what it is timed on. Both take some milliseconds.
    void begin(runtime::Scheduler& scheduler);
    void end(runtime::Scheduler& scheduler);
    /// At the end of the process.
    [[nodiscard]] Load finish() const;

  private:
    std::optional<CoreTimes> cores_at_start_;
    double seconds_at_start_, own_seconds_at_start_;
    double seconds_at_begin_ = 0;
    std::map<std::string, double> waited_at_begin_;  ///< s, by thread
    double waited_ = 0, spin_seconds_ = 0;
};

}  // namespace lancet::experiments::scaling
