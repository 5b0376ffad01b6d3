#include "lancet/experiments/bar/reference.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <ostream>
#include <span>
#include <string>
#include <system_error>

#include "lancet/experiments/bar/workers.hpp"
#include "lancet/experiments/common/file.hpp"
#include "lancet/kernels/error.hpp"

namespace lancet::experiments::bar {
namespace {

std::string key(const Problem& problem, const std::vector<double>& times) {
    Hash hash;
    add_to(hash, problem);
    hash.add(std::span<const double>(times));
    return hash.text();
}

void write_states(const std::filesystem::path& file, const std::vector<std::vector<double>>& states) {
    write_file(file, [&states](std::ostream& stream) {
        for (const auto& state : states) {
            stream.write(reinterpret_cast<const char*>(state.data()),
                         static_cast<std::streamsize>(state.size() * sizeof(double)));
        }
    });
}

struct Places {
    std::filesystem::path folder, cache;
};

/// States at `times`, each step solved.
std::vector<std::vector<double>> converged(ProblemOptions options, const std::vector<double>& times,
                                           const Places& places, const std::string& what, Progress& progress) {
    options.steps = static_cast<int>(std::round(times.back() / options.time_step));
    const Problem problem = make_problem(options);
    const std::size_t nodes = problem.mesh.nodes().size();
    const std::filesystem::path file = places.cache / ("state-" + key(problem, times));
    if (std::filesystem::exists(file)) return read_snapshots(file, times.size(), nodes);

    progress.show("computing the " + what + ", kept in " + file.string());
    const Job job{"lancet", "reference", places.folder / "bar_lancet", converged_arguments(), 1};
    std::vector<std::vector<double>> states;
    run_worker(job, options, times, nodes, states);
    std::error_code error;
    std::filesystem::create_directories(places.cache, error);
    if (error) throw Error(places.cache.string() + ": cannot be made: " + error.message());
    write_states(file, states);
    return states;
}

}  // namespace

std::vector<std::string> converged_arguments() {
    // Lancet in double with every step solved; the baseline `eigen`, which shares nothing with it but the mesh, comes
    // to the same positions to 2e-10 m on the Bar at t = 1 s and takes nine times as long.
    return {"--scalar=double",      "--scheduler=serial",  "--no-safeguard",
            "--cg-iterations=2000", "--cg-tolerance=1e-4", "--newton-tolerance=1e-8"};
}

void add_to(Hash& hash, const Problem& problem) {
    hash.add(problem.mesh.nodes());
    hash.add(problem.mesh.tetrahedra());
    hash.add(std::span<const std::int32_t>(problem.fixed_nodes));
    const std::array numbers{problem.young_modulus, problem.poisson_ratio,      problem.density,
                             problem.rayleigh_mass, problem.rayleigh_stiffness, problem.time_step};
    hash.add(std::span<const double>(numbers));
    hash.add(std::span<const double>(problem.gravity));
}

Reference make_reference(const ProblemOptions& options, const Problem& problem, const ReferenceChoice& choice,
                         const std::filesystem::path& folder, const std::filesystem::path& cache, Progress& progress) {
    const Places places{folder, cache};
    Reference reference;
    reference.times = error_times(problem);
    if (!reference.times.empty()) {
        reference.positions = converged(options, reference.times, places, "converged solution", progress);
    }
    if (choice.step_length && !reference.times.empty() && reference.times.front() == 1.0) {
        ProblemOptions finer = options;
        finer.time_step = options.time_step / 8;
        const auto coarse = converged(finer, {1.0}, places, "solution of an eighth of the step", progress).front();
        finer.time_step = options.time_step / 16;
        const auto fine = converged(finer, {1.0}, places, "solution of a sixteenth of the step", progress).front();
        reference.positions_t1_dt0.resize(fine.size());
        std::transform(fine.begin(), fine.end(), coarse.begin(), reference.positions_t1_dt0.begin(),
                       [](double f, double c) { return 2 * f - c; });
    }
    if (choice.rest) {
        const ProblemOptions rest = to_rest(options, problem);
        const double end = rest.steps * rest.time_step;
        reference.positions_rest = converged(rest, {end}, places, "state of rest", progress).front();
    }
    return reference;
}

std::filesystem::path default_cache() {
    const auto folder_in = [](const char* variable) {
        const char* value = std::getenv(variable);
        return std::filesystem::path(value == nullptr ? "" : value);
    };
    if (const auto cache = folder_in("XDG_CACHE_HOME"); !cache.empty()) return cache / "lancet" / "bar";
    if (const auto home = folder_in("HOME"); !home.empty()) return home / ".cache" / "lancet" / "bar";
    return std::filesystem::temp_directory_path() / "lancet" / "bar";
}

ProblemOptions to_rest(const ProblemOptions& options, const Problem& problem) {
    constexpr double decay_times = 16;  // e^-16 of the motion is left
    const auto& g = problem.gravity;
    const double frequency = std::sqrt(std::sqrt(g[0] * g[0] + g[1] * g[1] + g[2] * g[2]) / problem.length);
    ProblemOptions rest = options;
    if (frequency > 0) {
        rest.rayleigh = {2 * frequency, options.rayleigh[1]};
        rest.steps = static_cast<int>(std::ceil(decay_times / frequency / options.time_step));
    }
    return rest;
}

}  // namespace lancet::experiments::bar
