#include <ctime>
#include <memory>
#include <sstream>
#include <string>

#include <benchmark/benchmark.h>

#include "lancet/experiments/microbench/samples.hpp"
#include "lancet/experiments/microbench/subjects.hpp"
#include "lancet/experiments/microbench/vector_pass.hpp"

namespace lancet::experiments {

namespace {

using runtime::OperatorKind;
using runtime::PreconditionerKind;

/// What a benchmark is made on.
struct Subject {
    std::shared_ptr<Samples> samples;
    int elements;
    kernels::InstructionSet instruction_set;
    OperatorKind kind;

    template <class Real>
    SolverParts<Real>& parts() const {
        return samples->parts<Real>(elements, instruction_set, kind);
    }
    const Reference& reference() const { return samples->reference(elements); }
};

/// What no correct kernel exceeds. A nodal force is a small sum of large forces of the elements around it: it loses
/// digits as elements become smaller. Rotations that have followed a motion by one Newton step leave a rest of its
/// square.
struct Tolerance {
    double single_precision;
    double double_precision;
};
constexpr Tolerance rounding{1e-5, 1e-12};
constexpr Tolerance nodal_force{1e-3, 1e-10};
constexpr Tolerance preconditioned{1e-3, 1e-9};
constexpr Tolerance followed{1e-3, 1e-6};

/// Calls run() as often as the benchmark wants. Returns the seconds of processor time that one took.
template <class Run>
double time_runs(benchmark::State& state, const Run& run) {
    const std::clock_t start = std::clock();
    for ([[maybe_unused]] auto iteration : state) run();
    const std::clock_t end = std::clock();
    return static_cast<double>(end - start) / CLOCKS_PER_SEC / static_cast<double>(state.iterations());
}

template <class Real>
void report(benchmark::State& state, const Subject& subject, double seconds, const Real* found,
            const std::vector<double>& reference, const Tolerance& tolerance) {
    state.counters["ns_per_element"] = seconds * 1e9 / subject.elements;
    const double error = relative_error(subject.samples->bar(subject.elements), found, reference);
    state.counters["error"] = error;
    if (!(error <= (sizeof(Real) == 4 ? tolerance.single_precision : tolerance.double_precision))) {
        subject.samples->add_failure();
        std::ostringstream text;
        text << "the relative error is " << error;
        state.SkipWithError(text.str().c_str());
    }
}

void report_bytes(benchmark::State& state, const Subject& subject, double seconds, double bytes, double working_set) {
    const double limit = subject.samples->limits().read_gbytes_per_s(working_set);
    state.counters["gbytes_per_s"] = bytes * 1e-9 / seconds;
    state.counters["percent_of_bandwidth"] = 100 * bytes * 1e-9 / seconds / limit;
}

template <class Real>
void report_flops(benchmark::State& state, const Subject& subject, double seconds, double flops) {
    const double limit = subject.samples->limits().peak_gflops<Real>(subject.instruction_set);
    state.counters["gflops"] = flops * 1e-9 / seconds;
    state.counters["percent_of_peak"] = 100 * flops * 1e-9 / seconds / limit;
}

/// Rotation, rotated gradients and force, the bar moving by a time step every time.
template <class Real>
void measure_corotational_force(benchmark::State& state, const Subject& subject) {
    auto& parts = subject.parts<Real>();
    const double seconds = time_runs(state, [&] { parts.follow(); });
    parts.follow_to_later_state();
    report(state, subject, seconds, parts.force(), subject.reference().force, followed);
}

/// The force from rotated gradients that are kept: a linear material, or a step that renews no rotations.
template <class Real>
void measure_linear_force(benchmark::State& state, const Subject& subject) {
    auto& parts = subject.parts<Real>();
    parts.settle();
    const double seconds = time_runs(state, [&] { parts.force_of_kept_rotations(); });
    report(state, subject, seconds, parts.force(), subject.reference().force, nodal_force);
}

template <class Real>
void measure_assembly(benchmark::State& state, const Subject& subject) {
    auto& parts = subject.parts<Real>();
    parts.settle();
    const double seconds = time_runs(state, [&] { parts.assemble(); });
    parts.multiply();
    report(state, subject, seconds, parts.product(), subject.reference().product, rounding);
}

/// All that a step does before it solves, the bar moving by a time step every time.
template <class Real>
void measure_rotation_force_assembly(benchmark::State& state, const Subject& subject) {
    auto& parts = subject.parts<Real>();
    const double seconds = time_runs(state, [&] {
        parts.follow();
        parts.assemble();
    });
    parts.follow_to_later_state();
    parts.assemble();
    parts.multiply();
    report(state, subject, seconds, parts.product(), subject.reference().product, followed);
}

/// A product, complete at every node.
template <class Real>
void measure_product(benchmark::State& state, const Subject& subject) {
    auto& parts = subject.parts<Real>();
    parts.settle();
    const double seconds = time_runs(state, [&] { parts.multiply(); });
    const auto work = parts.product_work();
    report_flops<Real>(state, subject, seconds, work.flops);
    report_bytes(state, subject, seconds, work.bytes, work.bytes);
    report(state, subject, seconds, parts.product(), subject.reference().product, rounding);
}

template <class Real, class Accumulate>
void measure_vectors(benchmark::State& state, const Subject& subject, PreconditionerKind preconditioner) {
    auto& parts = subject.parts<Real>();
    VectorPass<Real, Accumulate> pass(parts, preconditioner);
    const double seconds = time_runs(state, [&] { pass.run(); });
    VectorPass<Real, Accumulate> once(parts, preconditioner);
    report_bytes(state, subject, seconds, once.bytes(), once.bytes());
    once.run();
    const Reference& reference = subject.reference();
    report(state, subject, seconds, once.z(),
           preconditioner == PreconditionerKind::coarse ? reference.coarse : reference.block_jacobi, preconditioned);
}

/// Inverses of the diagonal blocks and, with a coarse space, its modes, matrix and factors.
template <class Real>
void measure_refresh(benchmark::State& state, const Subject& subject, PreconditionerKind preconditioner) {
    auto& parts = subject.parts<Real>();
    const auto& refreshed = parts.preconditioner(preconditioner);
    const double seconds = time_runs(state, [&] { parts.refresh(preconditioner); });
    VectorPass<Real, Real> pass(parts, preconditioner);
    pass.run();
    const Reference& reference = subject.reference();
    const bool has_coarse = preconditioner == PreconditionerKind::coarse;
    if (has_coarse) state.counters["coarse_unknowns"] = parts.preconditioner(preconditioner).coarse()->unknowns();
    report(state, subject, seconds, pass.z(), has_coarse ? reference.coarse : reference.block_jacobi, preconditioned);
    if (refreshed.coarse_failures() > 0) {
        subject.samples->add_failure();
        state.SkipWithError("the coarse matrix is not positive definite");
    }
}

template <class Function>
void add(const Subject& subject, const std::string& what, const std::string& scalar, const Function& measure) {
    const std::string name = what + "/" + scalar + "/" + std::string(kernels::to_string(subject.instruction_set)) +
                             "/" + std::to_string(subject.elements);
    benchmark::RegisterBenchmark(name.c_str(),
                                 [subject, measure](benchmark::State& state) { measure(state, subject); });
}

template <class Real, class Accumulate>
void register_vectors(const Subject& subject, const std::string& scalar) {
    for (const PreconditionerKind kind : {PreconditionerKind::block_jacobi, PreconditionerKind::coarse}) {
        add(subject, "vectors/update-" + std::string(runtime::to_string(kind)), scalar,
            [kind](benchmark::State& state, const Subject& on) { measure_vectors<Real, Accumulate>(state, on, kind); });
    }
}

template <class Real>
void register_operator(const Subject& subject) {
    const std::string scalar = scalar_name<Real>();
    const std::string kind(runtime::to_string(subject.kind));
    add(subject, "product/" + kind, scalar, measure_product<Real>);
    if (subject.kind != OperatorKind::matrix_free) add(subject, "assemble/" + kind, scalar, measure_assembly<Real>);
    add(subject, "rotation-force-assembly/" + kind, scalar, measure_rotation_force_assembly<Real>);
}

/// Those that share one set of solver parts follow one another.
template <class Real>
void register_all(Subject subject) {
    const std::string scalar = scalar_name<Real>();
    subject.kind = OperatorKind::edge_blocks;
    add(subject, "force/corotational", scalar, measure_corotational_force<Real>);
    add(subject, "force/linear", scalar, measure_linear_force<Real>);
    register_operator<Real>(subject);
    register_vectors<Real, Real>(subject, scalar);
    if constexpr (sizeof(Real) == 4) register_vectors<float, double>(subject, "mixed");
    add(subject, "diagonal/refresh", scalar, [](benchmark::State& state, const Subject& on) {
        measure_refresh<Real>(state, on, PreconditionerKind::block_jacobi);
    });
    add(subject, "coarse/refresh", scalar, [](benchmark::State& state, const Subject& on) {
        measure_refresh<Real>(state, on, PreconditionerKind::coarse);
    });
    for (const OperatorKind kind : {OperatorKind::block_rows, OperatorKind::matrix_free}) {
        subject.kind = kind;
        register_operator<Real>(subject);
    }
}

}  // namespace

std::shared_ptr<Samples> register_solver(const std::vector<std::array<int, 3>>& cells) {
    auto samples = std::make_shared<Samples>(cells);
    for (const auto& one : cells) {
        for (const kernels::InstructionSet set : instruction_sets_to_measure()) {
            const Subject subject{samples, elements_of(one), set, OperatorKind::edge_blocks};
            register_all<float>(subject);
            register_all<double>(subject);
        }
    }
    return samples;
}

}  // namespace lancet::experiments
