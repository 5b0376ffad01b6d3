#include "lancet/experiments/common/stop_signal.hpp"

#include <csignal>
#include <thread>

#include <gtest/gtest.h>
#include <unistd.h>

namespace lancet::experiments {
namespace {

TEST(StopOnSignal, AsksToStopInsteadOfEndingTheProgram) {
    for (const int signal : {SIGINT, SIGTERM}) {
        const StopOnSignal signals;
        const std::stop_token token = signals.token();
        EXPECT_FALSE(token.stop_requested());
        ASSERT_EQ(::kill(::getpid(), signal), 0);
        // It comes from the thread that watches; without it this would wait until the test is ended.
        while (!token.stop_requested()) std::this_thread::yield();
    }
}

TEST(StopOnSignal, LeavesSignalsAsTheyWere) {
    sigset_t before{}, after{};
    pthread_sigmask(SIG_SETMASK, nullptr, &before);
    { const StopOnSignal signals; }
    pthread_sigmask(SIG_SETMASK, nullptr, &after);
    for (const int signal : {SIGINT, SIGTERM}) EXPECT_EQ(sigismember(&before, signal), sigismember(&after, signal));
}

}  // namespace
}  // namespace lancet::experiments
