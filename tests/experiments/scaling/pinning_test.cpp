#include "lancet/experiments/scaling/pinning.hpp"

#include <thread>

#include <gtest/gtest.h>

#include "lancet/runtime/schedule/scheduler.hpp"

namespace lancet::experiments::scaling {
namespace {

// In a thread of its own, for what is pinned stays pinned. A pool may have kept pinned threads of the case before, so
// there may be more.
TEST(Pinning, EveryThreadOfEverySchedulerIsHeldToACore) {
    for (const runtime::SchedulerKind kind : runtime::available_schedulers()) {
        for (const int threads : {1, 2, 3}) {
            if (kind == runtime::SchedulerKind::serial && threads > 1) continue;
            int pinned = 0;
            std::thread([&] {
                const auto scheduler = runtime::make_scheduler(kind, threads);
                pinned = pin_threads(*scheduler);
            }).join();
            EXPECT_GE(pinned, threads) << to_string(kind);
        }
    }
}

}  // namespace
}  // namespace lancet::experiments::scaling
