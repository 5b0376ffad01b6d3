#include "lancet/runtime/schedule/scheduler.hpp"

#include <array>
#include <string>

#include "lancet/kernels/error.hpp"
#include "lancet/runtime/schedule/graph_topology.hpp"
#include "lancet/runtime/schedule/implementations.hpp"

namespace lancet::runtime {
namespace {

constexpr std::array all_kinds{SchedulerKind::serial, SchedulerKind::openmp, SchedulerKind::tbb,
                               SchedulerKind::threads};

#if defined(LANCET_HAS_OPENMP)
constexpr bool has_openmp = true;
#else
constexpr bool has_openmp = false;
#endif

#if defined(LANCET_HAS_TBB)
constexpr bool has_tbb = true;
#else
constexpr bool has_tbb = false;
#endif

constexpr bool compiled_in(SchedulerKind kind) {
    if (kind == SchedulerKind::openmp) return has_openmp;
    if (kind == SchedulerKind::tbb) return has_tbb;
    return true;
}

template <class Kinds>
std::string list(const Kinds& kinds) {
    std::string text;
    for (const SchedulerKind kind : kinds) {
        if (!text.empty()) text += ", ";
        text += to_string(kind);
    }
    return text;
}

}  // namespace

Scheduler::Scheduler() : identity_(std::make_shared<const int>(0)) {}

std::unique_ptr<Scheduler> make_scheduler(SchedulerKind kind, int threads) {
    if (threads < 1) {
        throw Error("scheduler '" + std::string(to_string(kind)) + "': " + std::to_string(threads) +
                    " threads; expected 1 or more");
    }
    switch (kind) {
        case SchedulerKind::serial:
            return make_serial();
        case SchedulerKind::openmp:
#if defined(LANCET_HAS_OPENMP)
            return make_openmp(threads);
#else
            break;
#endif
        case SchedulerKind::tbb:
#if defined(LANCET_HAS_TBB)
            return make_tbb(threads);
#else
            break;
#endif
        case SchedulerKind::threads:
            return make_std_threads(threads);
    }
    throw Error("scheduler '" + std::string(to_string(kind)) +
                "' is not compiled in; this program has: " + list(available_schedulers()));
}

std::vector<SchedulerKind> available_schedulers() {
    std::vector<SchedulerKind> kinds;
    for (const SchedulerKind kind : all_kinds) {
        if (compiled_in(kind)) kinds.push_back(kind);
    }
    return kinds;
}

std::string_view to_string(SchedulerKind kind) noexcept {
    switch (kind) {
        case SchedulerKind::serial:
            return "serial";
        case SchedulerKind::openmp:
            return "openmp";
        case SchedulerKind::tbb:
            return "tbb";
        case SchedulerKind::threads:
            return "threads";
    }
    return "unknown";
}

SchedulerKind scheduler_from_string(std::string_view text) {
    for (const SchedulerKind kind : all_kinds) {
        if (to_string(kind) == text) return kind;
    }
    throw Error("there is no scheduler '" + std::string(text) + "'; expected one of: " + list(all_kinds));
}

}  // namespace lancet::runtime
