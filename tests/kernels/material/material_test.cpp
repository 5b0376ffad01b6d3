// Energy, stress and tangents of every material, against the textbook forms, finite differences and symmetries.
#include <algorithm>
#include <cmath>

#include "tests/kernels/material/material_run.hpp"

namespace lancet::kernels::test {
namespace {

using lancet::test::clamped;
using lancet::test::flattened;

constexpr double stiffest = 2 + 3 * lambda_over_mu;  // the largest eigenvalue of Hooke's law, divided by mu

/// What the rotation of F multiplies the rounding of F by: |F| over the sum of the two smallest stretches.
double condition(const Eigen::Matrix3d& f) {
    const Eigen::Vector3d s = lancet::test::proper_stretches(f);
    return std::max(1.0, s[0] / (s[1] + s[2]));
}

class Material : public MaterialTest {
  protected:
    std::vector<MaterialState> states = material_states();
    std::vector<Eigen::Matrix3d> f = rounded_gradients();
    PointwiseReference reference = GetParam().reference();

    std::vector<Eigen::Matrix3d> rounded_gradients() const {
        std::vector<Eigen::Matrix3d> all;
        for (const MaterialState& state : states) all.push_back(GetParam().arithmetic.rounded(state.f));
        return all;
    }
    bool is_corotational() const { return model() == MaterialModel::corotational; }
    bool is_quadratic_strain() const { return model() == MaterialModel::st_venant_kirchhoff; }

    /// Rounding of the strain: a few eps of what it is the difference of.
    double strain_error(const Eigen::Matrix3d& at) const {
        const double size = 1 + at.norm();
        return 4 * epsilon() * (is_quadratic_strain() ? size * size : size);
    }
    /// The energy is a quadratic form of the strain.
    double energy_error(const Eigen::Matrix3d& at, double energy) const {
        const double error = strain_error(at);
        return 2 * std::sqrt(energy * stiffest) * error + stiffest * error * error + 8 * epsilon() * energy;
    }
    double stress_error(const Eigen::Matrix3d& at) const {
        const double factor = is_quadratic_strain() ? 1 + at.norm() : is_corotational() ? condition(at) : 1;
        return 2 * stiffest * strain_error(at) * factor;
    }
    double tangent_error(const Eigen::Matrix3d& at) const {
        const double size = 1 + at.norm();
        const double factor = is_quadratic_strain() ? size * size
                              : is_corotational()   ? condition(at) * condition(at)
                                                    : 1;
        return 32 * epsilon() * stiffest * size * factor;
    }
};
INSTANTIATE_TEST_SUITE_P(Runs, Material, ::testing::ValuesIn(material_runs()), run_name);

TEST_P(Material, EnergyAndStressEqualTheReference) {
    const std::vector<double> energies = GetParam().energy(f);
    const std::vector<Eigen::Matrix3d> stresses = GetParam().stress(f);
    for (std::size_t k = 0; k < f.size(); ++k) {
        SCOPED_TRACE(states[k].name);
        const double energy = reference.energy(f[k]);
        EXPECT_NEAR(energies[k], energy, energy_error(f[k], energy));
        EXPECT_LE((stresses[k] - reference.stress(f[k])).norm(), stress_error(f[k]));
    }
}

TEST_P(Material, TangentsEqualTheReference) {
    for (const TangentKind kind : {TangentKind::rotated, TangentKind::exact, TangentKind::projected}) {
        if (!has_tangent(model(), kind)) continue;
        const std::vector<Tangent> tangents = GetParam().tangent(kind, f);
        for (std::size_t k = 0; k < f.size(); ++k) {
            SCOPED_TRACE(states[k].name + ", " + std::string(to_string(kind)));
            EXPECT_LE((tangents[k] - reference.tangent(f[k], kind)).norm(), tangent_error(f[k]));
        }
    }
}

TEST_P(Material, IsHookesLawAtRest) {
    const std::vector<Eigen::Matrix3d> rest{Eigen::Matrix3d::Identity()};
    EXPECT_EQ(GetParam().energy(rest)[0], 0);
    EXPECT_EQ(GetParam().stress(rest)[0].cwiseAbs().maxCoeff(), 0);
    const Tangent hooke = PointwiseReference{MaterialModel::linear, lambda_over_mu, 1}.tangent(rest[0], {});
    for (const TangentKind kind : {TangentKind::rotated, TangentKind::exact, TangentKind::projected}) {
        if (!has_tangent(model(), kind)) continue;
        EXPECT_LE((GetParam().tangent(kind, rest)[0] - hooke).cwiseAbs().maxCoeff(), 16 * epsilon() * stiffest);
    }
}

// The linear material counts rotations as strain.
std::vector<MaterialRun> objective_runs() {
    std::vector<MaterialRun> runs = material_runs();
    std::erase_if(runs, [](const MaterialRun& run) { return run.model == MaterialModel::linear; });
    return runs;
}
class ObjectiveMaterial : public Material {};
INSTANTIATE_TEST_SUITE_P(Runs, ObjectiveMaterial, ::testing::ValuesIn(objective_runs()), run_name);

TEST_P(ObjectiveMaterial, DoesNotSeeRotations) {
    std::vector<Eigen::Matrix3d> turned;
    std::vector<Eigen::Matrix3d> rotations;
    for (std::size_t k = 0; k < f.size(); ++k) {
        rotations.push_back(random_rotation(900 + static_cast<unsigned>(k)));
        turned.push_back(rotations.back() * f[k]);
    }
    const std::vector<double> energy = GetParam().energy(f), energy_turned = GetParam().energy(turned);
    const std::vector<Eigen::Matrix3d> stress = GetParam().stress(f), stress_turned = GetParam().stress(turned);
    for (std::size_t k = 0; k < f.size(); ++k) {
        SCOPED_TRACE(states[k].name);
        EXPECT_NEAR(energy_turned[k], energy[k], 2 * energy_error(f[k], energy[k]));
        EXPECT_LE((stress_turned[k] - rotations[k] * stress[k]).norm(), 2 * stress_error(f[k]));
    }
}

TEST_P(Material, ProjectedTangentIsPositiveAndElsewhereExact) {
    const std::vector<Tangent> exact = GetParam().tangent(TangentKind::exact, f);
    const std::vector<Tangent> projected = GetParam().tangent(TangentKind::projected, f);
    int positive = 0, indefinite = 0;
    for (std::size_t k = 0; k < f.size(); ++k) {
        SCOPED_TRACE(states[k].name);
        const double tolerance = tangent_error(f[k]);
        EXPECT_LE((projected[k] - projected[k].transpose()).norm(), tolerance);
        const Eigen::SelfAdjointEigenSolver<Tangent> of_projected(0.5 * (projected[k] + projected[k].transpose()));
        EXPECT_GE(of_projected.eigenvalues().minCoeff(), -tolerance);
        const double least =
            Eigen::SelfAdjointEigenSolver<Tangent>(0.5 * (exact[k] + exact[k].transpose())).eigenvalues().minCoeff();
        if (least > -tolerance) {
            ++positive;
            EXPECT_LE((projected[k] - exact[k]).norm(), 2 * tolerance);
        } else {
            ++indefinite;
            EXPECT_LE((projected[k] - clamped(exact[k])).norm(), 2 * tolerance);
        }
    }
    EXPECT_GE(positive, 3);
    if (model() != MaterialModel::linear) {
        EXPECT_GE(indefinite, 6);
    }
}

TEST_P(Material, IsFiniteWhereTheRotationIsNotDefined) {
    std::vector<Eigen::Matrix3d> hostile;
    for (const Eigen::Vector3d& stretch :
         {Eigen::Vector3d(0, 0, 0), Eigen::Vector3d(1, 0, 0), Eigen::Vector3d(1, 1, 0), Eigen::Vector3d(-1, -1, -1),
          Eigen::Vector3d(1, 1, -1), Eigen::Vector3d(2, 0.5, -0.5), Eigen::Vector3d(1e-30, 1e-30, 1e-30),
          Eigen::Vector3d(1e6, 1e6, 1e6), Eigen::Vector3d(1e6, 1, 1e-6)}) {
        hostile.push_back(stretch.asDiagonal());
        hostile.push_back(random_rotation(31) * stretch.asDiagonal() * random_rotation(32));
    }
    for (const double energy : GetParam().energy(hostile)) EXPECT_TRUE(std::isfinite(energy));
    for (const Eigen::Matrix3d& stress : GetParam().stress(hostile)) EXPECT_TRUE(stress.allFinite());
    for (const TangentKind kind : {TangentKind::rotated, TangentKind::exact, TangentKind::projected}) {
        if (!has_tangent(model(), kind)) continue;
        for (const Tangent& tangent : GetParam().tangent(kind, hostile)) EXPECT_TRUE(tangent.allFinite());
    }
}

// Differences of energies need double; the laws in float are compared with the reference in double above.
std::vector<MaterialRun> double_runs() {
    std::vector<MaterialRun> runs = material_runs();
    std::erase_if(runs, [](const MaterialRun& run) { return run.arithmetic.single; });
    return runs;
}
class MaterialInDouble : public Material {
  protected:
    static constexpr int directions = 4;
    static Eigen::Matrix3d direction(std::size_t state, int index) {
        return random_matrix(5000 + static_cast<unsigned>(directions * state) + static_cast<unsigned>(index));
    }
    /// The smallest of the errors that `error(step)` gives for central differences over a sweep of steps, per state.
    template <class ErrorsOf>
    std::vector<double> least_errors(ErrorsOf errors_of) const {
        std::vector<double> least(f.size(), HUGE_VAL);
        for (double step = 1e-1; step > 1e-8; step /= 3) {
            const std::vector<double> errors = errors_of(step);
            for (std::size_t k = 0; k < f.size(); ++k) least[k] = std::min(least[k], errors[k]);
        }
        return least;
    }
    std::vector<Eigen::Matrix3d> moved(double step, int index) const {
        std::vector<Eigen::Matrix3d> all;
        for (std::size_t k = 0; k < f.size(); ++k) all.push_back(f[k] + step * direction(k, index));
        return all;
    }
};
INSTANTIATE_TEST_SUITE_P(Runs, MaterialInDouble, ::testing::ValuesIn(double_runs()), run_name);

TEST_P(MaterialInDouble, StressIsTheGradientOfTheEnergy) {
    const std::vector<Eigen::Matrix3d> stress = GetParam().stress(f);
    for (int index = 0; index < directions; ++index) {
        const std::vector<double> errors = least_errors([&](double step) {
            const std::vector<double> above = GetParam().energy(moved(step, index)),
                                      below = GetParam().energy(moved(-step, index));
            std::vector<double> relative;
            for (std::size_t k = 0; k < f.size(); ++k) {
                const Eigen::Matrix3d d = direction(k, index);
                const double difference = (above[k] - below[k]) / (2 * step);
                const double exact = stress[k].cwiseProduct(d).sum();
                // At rest there is no stress: relative to that of a strain of 1 %.
                relative.push_back(std::abs(difference - exact) / (std::max(stress[k].norm(), 0.01) * d.norm()));
            }
            return relative;
        });
        for (std::size_t k = 0; k < f.size(); ++k) EXPECT_LT(errors[k], 1e-6) << states[k].name;
    }
}

TEST_P(MaterialInDouble, TangentIsTheDerivativeOfTheStress) {
    for (int index = 0; index < directions; ++index) {
        std::vector<Eigen::Matrix3d> change;
        for (std::size_t k = 0; k < f.size(); ++k) change.push_back(direction(k, index));
        const std::vector<Eigen::Matrix3d> product = GetParam().product(TangentKind::exact, f, change);
        const std::vector<double> errors = least_errors([&](double step) {
            const std::vector<Eigen::Matrix3d> above = GetParam().stress(moved(step, index)),
                                               below = GetParam().stress(moved(-step, index));
            std::vector<double> relative;
            for (std::size_t k = 0; k < f.size(); ++k) {
                const Eigen::Matrix3d difference = (above[k] - below[k]) / (2 * step);
                relative.push_back((difference - product[k]).norm() / product[k].norm());
            }
            return relative;
        });
        for (std::size_t k = 0; k < f.size(); ++k) EXPECT_LT(errors[k], 1e-6) << states[k].name;
    }
}

}  // namespace
}  // namespace lancet::kernels::test
