#pragma once

#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "lancet/runtime/schedule/function_reference.hpp"

namespace lancet::runtime {

class GraphTopology;
class GraphExecution;

/// What the blocks of a loop and the tasks of a step graph run on.
enum class SchedulerKind { serial, openmp, tbb, threads };

/// The kind chosen with the CMake option LANCET_SCHEDULER.
#if defined(LANCET_DEFAULT_SCHEDULER_TBB)
inline constexpr SchedulerKind default_scheduler = SchedulerKind::tbb;
#elif defined(LANCET_DEFAULT_SCHEDULER_OPENMP)
inline constexpr SchedulerKind default_scheduler = SchedulerKind::openmp;
#elif defined(LANCET_DEFAULT_SCHEDULER_SERIAL)
inline constexpr SchedulerKind default_scheduler = SchedulerKind::serial;
#else
#error "link lancet::runtime: it defines LANCET_DEFAULT_SCHEDULER_TBB, _OPENMP or _SERIAL"
#endif

/// Runs blocks and graph tasks on a fixed number of threads, the calling thread being one of them. Every body runs
/// with denormal numbers flushed to zero (see FlushDenormals); the caller's mode is as before when a call returns.
///
/// Which thread runs which block is up to the scheduler, so bodies write where no other block writes, and sums are
/// formed as in ordered_sum.hpp: then all schedulers and thread counts give the same bits.
class Scheduler {
  public:
    Scheduler();
    Scheduler(const Scheduler&) = delete;
    Scheduler& operator=(const Scheduler&) = delete;
    virtual ~Scheduler() = default;

    virtual SchedulerKind kind() const noexcept = 0;

    /// Number of threads bodies may run on, with the calling thread; at least 1.
    virtual int threads() const noexcept = 0;

    /// Calls body(block) once for each block in [0, blocks), on any thread, in any order; returns when all are done.
    /// No allocation in steady state. An exception thrown by `body` is rethrown to the caller: the first by block
    /// number; blocks after it may or may not have run.
    ///
    /// May be called from a body (the inner loop then runs on the calling thread alone) and from a task of a StepGraph
    /// (the inner loop then uses the threads that are free; the waiting thread takes up no other task of the graph).
    /// Throws lancet::Error for a negative number of blocks.
    virtual void for_each_block(int blocks, FunctionReference<void(int)> body) = 0;

    /// Prepares what running a graph of this topology again and again needs. StepGraph::run calls it once for each
    /// topology and scheduler. The execution may be used while both the topology and this scheduler live.
    virtual std::unique_ptr<GraphExecution> prepare(const GraphTopology& topology) = 0;

    /// Identifies this scheduler: unlike its address, not given to another one while somebody holds it.
    const std::shared_ptr<const int>& identity() const noexcept { return identity_; }

  private:
    std::shared_ptr<const int> identity_;
};

/// A scheduler of that kind with that many threads, which it keeps. The serial one takes any number and has one thread.
/// Throws lancet::Error if the kind is not compiled in or threads < 1.
std::unique_ptr<Scheduler> make_scheduler(SchedulerKind kind, int threads);

/// The kinds that are compiled in, in the order of the enumeration. All can be used in one program.
std::vector<SchedulerKind> available_schedulers();

/// "serial", "openmp", "tbb" or "threads".
std::string_view to_string(SchedulerKind kind) noexcept;

/// The inverse of to_string. Throws lancet::Error, which lists the choices, for another text; a kind that is known but
/// not compiled in is returned (make_scheduler refuses it).
SchedulerKind scheduler_from_string(std::string_view text);

}  // namespace lancet::runtime
