#include "lancet/runtime/observe/bandwidth.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "lancet/kernels/error.hpp"
#include "lancet/runtime/observe/clock.hpp"
#include "lancet/runtime/observe/stream_loops.hpp"

namespace lancet::runtime {
namespace {

struct alignas(64) CacheLine {
    std::array<double, 8> values;
};

constexpr std::size_t line_bytes = sizeof(CacheLine);

/// An array of doubles in one share for each thread, of which no page is touched before its thread does.
class SharedArray {
  public:
    SharedArray(std::size_t shares, std::size_t lines_per_share)
        : lines_(std::make_unique_for_overwrite<CacheLine[]>(shares * lines_per_share)),
          share_size_(lines_per_share * (line_bytes / sizeof(double))) {}

    std::span<double> share(int index) const noexcept {
        return {lines_[0].values.data() + static_cast<std::size_t>(index) * share_size_, share_size_};
    }
    std::size_t share_size() const noexcept { return share_size_; }

  private:
    std::unique_ptr<CacheLine[]> lines_;
    std::size_t share_size_;
};

/// Makes the compiler believe that memory has changed, so that a repeated pass is a pass.
void forget_memory() noexcept {
    __asm__ volatile("" : : : "memory");
}

/// How many passes of one thread over its share take a few milliseconds; pass() makes one. Measured without the
/// scheduler, so that the time to start and end a loop stays a small part of a run.
template <class Pass>
int enough_passes(const Pass& pass) {
    constexpr double enough_seconds = 4e-3;
    constexpr int most_passes = 1 << 24;
    for (int passes = 1;; passes *= 2) {
        const double start = steady_seconds();
        for (int index = 0; index < passes; ++index) pass();
        if (steady_seconds() - start >= enough_seconds || passes == most_passes) return passes;
    }
}

/// Median over the repetitions of the seconds that run() takes; it has run once before.
template <class Run>
double median_seconds(int repetitions, const Run& run) {
    run();
    std::vector<double> seconds(static_cast<std::size_t>(repetitions));
    for (double& value : seconds) {
        const double start = steady_seconds();
        run();
        value = steady_seconds() - start;
    }
    const auto middle = seconds.begin() + repetitions / 2;
    std::nth_element(seconds.begin(), middle, seconds.end());
    return *middle;
}

void require_value(const char* loop, double found, double expected) {
    if (found != expected) {
        throw Error(std::string("bandwidth: the ") + loop + " loop gave " + std::to_string(found) + ", expected " +
                    std::to_string(expected));
    }
}

double measure_read(Scheduler& scheduler, std::size_t lines_per_share, int repetitions) {
    const int shares = scheduler.threads();
    const SharedArray array(static_cast<std::size_t>(shares), lines_per_share);
    scheduler.for_each_block(shares, [&](int share) { std::ranges::fill(array.share(share), 1.0); });
    std::vector<CacheLine> sums(static_cast<std::size_t>(shares));  // a line each: threads must not disturb each other
    double sum_of_one_pass = 0;
    const int passes = enough_passes([&] {
        sum_of_one_pass = stream_sum(array.share(0));
        forget_memory();
    });
    require_value("read", sum_of_one_pass, static_cast<double>(array.share_size()));
    const double seconds = median_seconds(repetitions, [&] {
        scheduler.for_each_block(shares, [&](int share) {
            double sum = 0;
            for (int pass = 0; pass < passes; ++pass) {
                sum += stream_sum(array.share(share));
                forget_memory();
            }
            sums[static_cast<std::size_t>(share)].values[0] = sum;
        });
    });
    for (const CacheLine& sum : sums) {
        require_value("read", sum.values[0], static_cast<double>(array.share_size()) * passes);
    }
    return static_cast<double>(array.share_size() * sizeof(double)) * shares * passes / seconds / 1e9;
}

double measure_triad(Scheduler& scheduler, std::size_t lines_per_share, int repetitions) {
    const int shares = scheduler.threads();
    const auto count = static_cast<std::size_t>(shares);
    const SharedArray a(count, lines_per_share);
    const SharedArray b(count, lines_per_share);
    const SharedArray c(count, lines_per_share);
    scheduler.for_each_block(shares, [&](int share) {
        std::ranges::fill(a.share(share), 0.0);
        std::ranges::fill(b.share(share), 1.0);
        std::ranges::fill(c.share(share), 2.0);
    });
    const int passes = enough_passes([&] {
        stream_triad(a.share(0), b.share(0), c.share(0), 1.0);
        forget_memory();
    });
    const double seconds = median_seconds(repetitions, [&] {
        scheduler.for_each_block(shares, [&](int share) {
            for (int pass = 1; pass <= passes; ++pass) {
                stream_triad(a.share(share), b.share(share), c.share(share), pass);
                forget_memory();
            }
        });
    });
    for (int share = 0; share < shares; ++share) {
        for (const double value : {a.share(share).front(), a.share(share).back()}) {
            require_value("triad", value, 1.0 + 2.0 * passes);
        }
    }
    return 3 * static_cast<double>(a.share_size() * sizeof(double)) * shares * passes / seconds / 1e9;
}

}  // namespace

Bandwidth measure_bandwidth(Scheduler& scheduler, std::size_t working_set_bytes, int repetitions) {
    constexpr std::size_t least_bytes_per_thread = 1024;
    const auto threads = static_cast<std::size_t>(scheduler.threads());
    if (working_set_bytes < least_bytes_per_thread * threads) {
        throw Error("bandwidth: a working set of " + std::to_string(working_set_bytes) + " bytes for " +
                    std::to_string(threads) + " threads; expected " + std::to_string(least_bytes_per_thread) +
                    " bytes or more for each");
    }
    if (repetitions < 1) throw Error("bandwidth: " + std::to_string(repetitions) + " repetitions; expected 1 or more");
    const std::size_t lines_per_thread = working_set_bytes / line_bytes / threads;
    return {measure_read(scheduler, lines_per_thread, repetitions),
            measure_triad(scheduler, lines_per_thread / 3, repetitions)};
}

}  // namespace lancet::runtime
