#include "tests/kernels/material/material_run.hpp"

#include <random>

#include "tests/kernels/material/material_probe.hpp"

#include "lancet/kernels/layout/aligned_vector.hpp"

namespace lancet::kernels::test {

namespace {

/// Calls use(batch) for batches of `width` states; numbers[entry][lane] is filled by `entry_of(state, entry)`, the last
/// batch by repeating the last state.
template <class Real, class EntryOf>
void fill(std::vector<Real>& numbers, std::size_t first, std::size_t states, std::size_t entries, std::size_t width,
          EntryOf entry_of) {
    for (std::size_t lane = 0; lane < width; ++lane) {
        const std::size_t state = std::min(first + lane, states - 1);
        for (std::size_t entry = 0; entry < entries; ++entry) {
            numbers[entry * width + lane] = static_cast<Real>(entry_of(state, entry));
        }
    }
}

double entry_of_matrix(const Eigen::Matrix3d& a, std::size_t entry) {
    return a(static_cast<Eigen::Index>(entry / 3), static_cast<Eigen::Index>(entry % 3));
}

template <class Real>
Eigen::Matrix3d matrix_of(const std::vector<Real>& numbers, std::size_t lane, std::size_t width) {
    Eigen::Matrix3d a;
    for (std::size_t entry = 0; entry < 9; ++entry) {
        a(static_cast<Eigen::Index>(entry / 3), static_cast<Eigen::Index>(entry % 3)) =
            static_cast<double>(numbers[entry * width + lane]);
    }
    return a;
}

/// Calls for_batch(first state, lanes in use, F of the batch) with the probe's batches.
template <class Real, class ForBatch>
void for_each_batch(const MaterialProbe<Real>& probe, const std::vector<Eigen::Matrix3d>& f, ForBatch for_batch) {
    const auto width = static_cast<std::size_t>(probe.width);
    std::vector<Real> numbers(9 * width);
    for (std::size_t first = 0; first < f.size(); first += width) {
        fill(numbers, first, f.size(), 9, width,
             [&](std::size_t state, std::size_t entry) { return entry_of_matrix(f[state], entry); });
        for_batch(first, std::min(width, f.size() - first), numbers.data());
    }
}

template <class Real>
std::vector<Eigen::Matrix3d> evaluate_all(const MaterialRun& run, const std::vector<Eigen::Matrix3d>& f,
                                          std::vector<double>& energies) {
    const MaterialProbe<Real>& probe = material_probe<Real>(run.arithmetic.instruction_set);
    const auto width = static_cast<std::size_t>(probe.width);
    std::vector<Real> energy(width), stress(9 * width);
    std::vector<Eigen::Matrix3d> stresses;
    for_each_batch<Real>(probe, f, [&](std::size_t, std::size_t lanes, const Real* numbers) {
        probe.evaluate(run.model, static_cast<Real>(lambda_over_mu), numbers, energy.data(), stress.data());
        for (std::size_t lane = 0; lane < lanes; ++lane) {
            energies.push_back(static_cast<double>(energy[lane]));
            stresses.push_back(matrix_of(stress, lane, width));
        }
    });
    return stresses;
}

template <class Real>
std::vector<Eigen::Matrix3d> products(const MaterialRun& run, TangentKind kind, const std::vector<Eigen::Matrix3d>& f,
                                      const std::vector<Eigen::Matrix3d>& change) {
    const MaterialProbe<Real>& probe = material_probe<Real>(run.arithmetic.instruction_set);
    const auto width = static_cast<std::size_t>(probe.width);
    std::vector<Real> d(9 * width), product(9 * width);
    std::vector<Eigen::Matrix3d> results;
    for_each_batch<Real>(probe, f, [&](std::size_t first, std::size_t lanes, const Real* numbers) {
        fill(d, first, f.size(), 9, width,
             [&](std::size_t state, std::size_t entry) { return entry_of_matrix(change[state], entry); });
        probe.tangent(run.model, kind, static_cast<Real>(lambda_over_mu), numbers, d.data(), product.data());
        for (std::size_t lane = 0; lane < lanes; ++lane) results.push_back(matrix_of(product, lane, width));
    });
    return results;
}

template <class Real>
PrincipalValues principal_values(const MaterialRun& run, const Eigen::Vector3d& stretch) {
    const MaterialProbe<Real>& probe = material_probe<Real>(run.arithmetic.instruction_set);
    const auto width = static_cast<std::size_t>(probe.width);
    std::vector<Real> s(3 * width), d(15 * width);
    fill(s, 0, 1, 3, width, [&](std::size_t, std::size_t entry) { return stretch[static_cast<Eigen::Index>(entry)]; });
    probe.principal(run.model, static_cast<Real>(lambda_over_mu), s.data(), d.data());
    const auto at = [&](std::size_t entry) { return static_cast<double>(d[(entry + 1) * width - 1]); };
    PrincipalValues values;
    values.first << at(0), at(1), at(2);
    values.second << at(3), at(6), at(7), at(6), at(4), at(8), at(7), at(8), at(5);
    values.flip << at(9), at(10), at(11);
    values.twist << at(12), at(13), at(14);
    return values;
}

template <class Real>
std::vector<Decomposition> decompositions(InstructionSet instruction_set, const std::vector<Eigen::Matrix3d>& f) {
    const MaterialProbe<Real>& probe = material_probe<Real>(instruction_set);
    const auto width = static_cast<std::size_t>(probe.width);
    std::vector<Real> stretch(3 * width), left(9 * width), right(9 * width);
    std::vector<Decomposition> results;
    for_each_batch<Real>(probe, f, [&](std::size_t, std::size_t lanes, const Real* numbers) {
        probe.decompose(numbers, stretch.data(), left.data(), right.data());
        for (std::size_t lane = 0; lane < lanes; ++lane) {
            const auto s = [&](std::size_t i) { return static_cast<double>(stretch[i * width + lane]); };
            results.push_back({{s(0), s(1), s(2)}, matrix_of(left, lane, width), matrix_of(right, lane, width)});
        }
    });
    return results;
}

template <class Real>
std::vector<Eigen::Matrix3d> positive_parts(InstructionSet instruction_set, const std::vector<Eigen::Matrix3d>& a) {
    const MaterialProbe<Real>& probe = material_probe<Real>(instruction_set);
    const auto width = static_cast<std::size_t>(probe.width);
    constexpr std::array<std::size_t, 6> places{0, 4, 8, 1, 2, 5};
    std::vector<Real> given(6 * width), result(6 * width);
    std::vector<Eigen::Matrix3d> results;
    for (std::size_t first = 0; first < a.size(); first += width) {
        fill(given, first, a.size(), 6, width,
             [&](std::size_t state, std::size_t entry) { return entry_of_matrix(a[state], places[entry]); });
        probe.positive_part(given.data(), result.data());
        for (std::size_t lane = 0; lane < std::min(width, a.size() - first); ++lane) {
            const auto at = [&](std::size_t entry) { return static_cast<double>(result[entry * width + lane]); };
            Eigen::Matrix3d full;
            full << at(0), at(3), at(4), at(3), at(1), at(5), at(4), at(5), at(2);
            results.push_back(full);
        }
    }
    return results;
}

}  // namespace

Eigen::Matrix3d MaterialArithmetic::rounded(const Eigen::Matrix3d& f) const {
    return single ? Eigen::Matrix3d(f.cast<float>().cast<double>()) : f;
}

std::vector<double> MaterialRun::energy(const std::vector<Eigen::Matrix3d>& f) const {
    std::vector<double> energies;
    arithmetic.single ? evaluate_all<float>(*this, f, energies) : evaluate_all<double>(*this, f, energies);
    return energies;
}

std::vector<Eigen::Matrix3d> MaterialRun::stress(const std::vector<Eigen::Matrix3d>& f) const {
    std::vector<double> energies;
    return arithmetic.single ? evaluate_all<float>(*this, f, energies) : evaluate_all<double>(*this, f, energies);
}

std::vector<Eigen::Matrix3d> MaterialRun::product(TangentKind kind, const std::vector<Eigen::Matrix3d>& f,
                                                  const std::vector<Eigen::Matrix3d>& change) const {
    return arithmetic.single ? products<float>(*this, kind, f, change) : products<double>(*this, kind, f, change);
}

std::vector<Tangent> MaterialRun::tangent(TangentKind kind, const std::vector<Eigen::Matrix3d>& f) const {
    std::vector<Tangent> tangents(f.size());
    for (int column = 0; column < 9; ++column) {
        const Eigen::Matrix3d unit = lancet::test::unflattened(Eigen::Matrix<double, 9, 1>::Unit(column));
        const std::vector<Eigen::Matrix3d> columns = product(kind, f, {f.size(), unit});
        for (std::size_t state = 0; state < f.size(); ++state) {
            tangents[state].col(column) = lancet::test::flattened(columns[state]);
        }
    }
    return tangents;
}

PrincipalValues principal(const MaterialRun& run, const Eigen::Vector3d& stretch) {
    return run.arithmetic.single ? principal_values<float>(run, stretch) : principal_values<double>(run, stretch);
}

std::vector<Decomposition> decompose(const MaterialArithmetic& arithmetic, const std::vector<Eigen::Matrix3d>& f) {
    return arithmetic.single ? decompositions<float>(arithmetic.instruction_set, f)
                             : decompositions<double>(arithmetic.instruction_set, f);
}

std::vector<Eigen::Matrix3d> positive_part(const MaterialArithmetic& arithmetic,
                                           const std::vector<Eigen::Matrix3d>& symmetric) {
    return arithmetic.single ? positive_parts<float>(arithmetic.instruction_set, symmetric)
                             : positive_parts<double>(arithmetic.instruction_set, symmetric);
}

Eigen::Matrix3d random_matrix(unsigned seed) {
    std::mt19937 generator(seed);
    std::uniform_real_distribution<double> number(-1, 1);
    Eigen::Matrix3d a;
    for (int i = 0; i < 9; ++i) a(i / 3, i % 3) = number(generator);
    return a;
}

Eigen::Matrix3d random_rotation(unsigned seed) {
    std::mt19937 generator(seed);
    std::normal_distribution<double> number;
    Eigen::Quaterniond q(number(generator), number(generator), number(generator), number(generator));
    return q.normalized().toRotationMatrix();
}

std::vector<MaterialState> material_states() {
    std::vector<MaterialState> states;
    unsigned seed = 1;
    const auto add = [&](const std::string& name, const Eigen::Vector3d& stretch) {
        for (int orientation = 0; orientation < 3; ++orientation, ++seed) {
            states.push_back(
                {name, random_rotation(2 * seed) * stretch.asDiagonal() * random_rotation(2 * seed + 1).transpose()});
        }
    };
    states.push_back({"rest", Eigen::Matrix3d::Identity()});
    add("turned", {1, 1, 1});
    add("near rest", {1.001, 0.9995, 1.0002});
    add("moderate", {1.2, 0.95, 0.85});
    add("equal stretches", {1.3, 1.3, 0.9});
    add("blown up", {2.5, 2.1, 1.8});
    add("large strain", {3, 1.5, 0.4});
    add("pressed", {0.5, 0.45, 0.6});
    add("nearly singular", {1.2, 0.9, 1e-3});
    add("nearly a line", {1.1, 0.05, 1e-3});
    add("inverted", {1.2, 0.8, -0.5});
    add("inverted thrice", {-1.1, -0.7, -0.4});
    for (int k = 0; k < 8; ++k, ++seed) {
        states.push_back({"random", random_rotation(seed) * (Eigen::Matrix3d::Identity() + 0.3 * random_matrix(seed))});
    }
    return states;
}

std::vector<Eigen::Matrix3d> gradients_of(const std::vector<MaterialState>& states) {
    std::vector<Eigen::Matrix3d> f;
    f.reserve(states.size());
    for (const MaterialState& state : states) f.push_back(state.f);
    return f;
}

std::vector<MaterialArithmetic> material_arithmetics() {
    std::vector<MaterialArithmetic> all;
    for (const InstructionSet instruction_set : compiled_instruction_sets()) {
        for (const bool single : {true, false}) all.push_back({instruction_set, single});
    }
    return all;
}

std::vector<MaterialRun> material_runs() {
    std::vector<MaterialRun> runs;
    for (const MaterialArithmetic& arithmetic : material_arithmetics()) {
        for (const auto model :
             {MaterialModel::linear, MaterialModel::corotational, MaterialModel::st_venant_kirchhoff}) {
            runs.push_back({arithmetic, model});
        }
    }
    return runs;
}

std::string run_name(const ::testing::TestParamInfo<MaterialRun>& info) {
    std::string name = info.param.arithmetic.name() + "_" + std::string(to_string(info.param.model));
    for (char& c : name) c = c == '-' ? '_' : c;
    return name;
}

}  // namespace lancet::kernels::test
