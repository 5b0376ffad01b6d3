#pragma once

#include <iostream>
#include <memory>
#include <ostream>
#include <string>
#include <vector>

#include "lancet/runtime/schedule/scheduler.hpp"

#if defined(__SANITIZE_THREAD__)
#define LANCET_THREAD_SANITIZER 1
#elif defined(__has_feature)
#if __has_feature(thread_sanitizer)
#define LANCET_THREAD_SANITIZER 1
#endif
#endif

namespace lancet::runtime::testing {

/// A scheduler to make, as a test parameter.
struct SchedulerChoice {
    SchedulerKind kind;
    int threads;

    std::unique_ptr<Scheduler> make() const { return make_scheduler(kind, threads); }
    std::string name() const { return std::string(to_string(kind)) + "_" + std::to_string(threads); }
};

inline std::ostream& operator<<(std::ostream& stream, const SchedulerChoice& choice) {
    return stream << choice.name();
}

/// The kinds that tests run on. The libraries of OpenMP and oneTBB are not instrumented for the thread sanitizer, which
/// would report their correct synchronisation as races.
inline std::vector<SchedulerKind> kinds_under_test() {
#if defined(LANCET_THREAD_SANITIZER)
    static const bool told = [] {
        std::cerr << "thread sanitizer: the schedulers openmp and tbb are left out (their libraries are not "
                     "instrumented)\n";
        return true;
    }();
    static_cast<void>(told);
    return {SchedulerKind::serial, SchedulerKind::threads};
#else
    return available_schedulers();
#endif
}

/// Every kind with 1, 2, 3 and 8 threads.
inline std::vector<SchedulerChoice> schedulers_under_test() {
    std::vector<SchedulerChoice> choices;
    for (const SchedulerKind kind : kinds_under_test()) {
        for (const int threads : {1, 2, 3, 8}) choices.push_back({kind, threads});
    }
    return choices;
}

/// Names a parameterised test after its scheduler.
struct SchedulerName {
    template <class Parameter>
    std::string operator()(const Parameter& parameter) const {
        return parameter.param.name();
    }
};

}  // namespace lancet::runtime::testing
