// Elastic force and energy of linear tetrahedra: invariants, and comparison with the reference solid.
#include <algorithm>
#include <array>
#include <cmath>
#include <map>

#include "tests/runtime/solve/bodies_under_test.hpp"
#include <gtest/gtest.h>

namespace lancet::test {
namespace {

using runtime::ElementModel;

constexpr double spacing = 0.1;

runtime::Settings settings_of(const Arithmetic& arithmetic, ElementModel model) {
    runtime::Settings settings = accurate_settings();
    arithmetic.set(settings);
    settings.model = model;
    return settings;
}

Eigen::Matrix3d some_rotation(double angle) {
    return Eigen::AngleAxisd(angle, Eigen::Vector3d(0.3, -0.5, 0.8).normalized()).toRotationMatrix();
}

/// The largest nodal force that an elastic strain of 1 would cause: stress times the area that a node answers for.
double force_scale(const ReferenceSolid& solid) {
    double stiffest = 0;
    for (const ReferenceMaterial& m : solid.materials) stiffest = std::max(stiffest, m.lambda() + 2 * m.mu());
    return stiffest * spacing * spacing;
}

class ElasticForce : public ArithmeticTest {
  protected:
    ReferenceSolid solid = jittered_bar({5, 3, 2}, spacing, 0.15, 21);
    std::unique_ptr<runtime::Scheduler> scheduler = serial();

    std::unique_ptr<runtime::DeformableBody> body(ElementModel model = ElementModel::corotational) {
        return make_body(scene_of(solid), settings_of(GetParam(), model), *scheduler);
    }
    Eigen::VectorXd force_at(runtime::DeformableBody& b, const Eigen::VectorXd& x) {
        b.set_positions(as_points(x));
        return elastic_forces_of(b, *scheduler);
    }
    double energy_at(runtime::DeformableBody& b, const Eigen::VectorXd& x) {
        b.set_positions(as_points(x));
        return b.energies(*scheduler).elastic;
    }
    /// Strains are formed from differences of double positions, rounded to the scalar: a few eps, with the rounding of
    /// the positions themselves; up to 24 elements at a node.
    double tolerance(double distance = 0) const {
        const double strain_error = 8 * (GetParam().epsilon() + 0x1p-52 * (distance + 1) / spacing);
        return 24 * strain_error * force_scale(solid);
    }
};
INSTANTIATE_TEST_SUITE_P(Arithmetics, ElasticForce, ::testing::ValuesIn(compiled_arithmetics()), ArithmeticName());

TEST_P(ElasticForce, EqualsTheReference) {
    for (const ElementModel model : {ElementModel::linear, ElementModel::corotational}) {
        const bool corotational = model == ElementModel::corotational;
        const auto b = body(model);
        for (const double turn : {0.0, 0.5, 3.0}) {
            const Eigen::VectorXd x = moved(solid.rest(), some_rotation(corotational ? turn : 0), {0.3, -1, 2}) +
                                      random_vector(solid.unknowns(), 0.02, 22);
            EXPECT_LE((force_at(*b, x) - solid.elastic_force(x, corotational)).cwiseAbs().maxCoeff(), tolerance(3));
            const double energy = solid.elastic_energy(x, corotational);
            EXPECT_NEAR(energy_at(*b, x), energy, 100 * GetParam().epsilon() * energy);
        }
    }
}

TEST_P(ElasticForce, VanishesUnderRigidTranslation) {
    for (const ElementModel model : {ElementModel::linear, ElementModel::corotational}) {
        const auto b = body(model);
        for (const Eigen::Vector3d& shift :
             {Eigen::Vector3d(0, 0, 0), Eigen::Vector3d(0.1, 0.2, -0.3), Eigen::Vector3d(100, -100, 50)}) {
            const Eigen::VectorXd x = moved(solid.rest(), Eigen::Matrix3d::Identity(), shift);
            EXPECT_LE(force_at(*b, x).cwiseAbs().maxCoeff(), tolerance(shift.cwiseAbs().maxCoeff()));
        }
    }
}

TEST_P(ElasticForce, VanishesUnderRigidRotation) {
    const auto b = body();
    for (const double angle : {0.01, 0.7, 1.5707963, 3.1, 3.14159265358979, 5.0}) {
        for (const Eigen::Vector3d& shift : {Eigen::Vector3d(0, 0, 0), Eigen::Vector3d(100, -100, 50)}) {
            const Eigen::VectorXd x = moved(solid.rest(), some_rotation(angle), shift);
            EXPECT_LE(force_at(*b, x).cwiseAbs().maxCoeff(), tolerance(shift.cwiseAbs().maxCoeff())) << angle;
        }
    }
}

TEST_P(ElasticForce, OfTheWholeBodyAddsUpToNothing) {
    const auto b = body();
    for (unsigned seed = 0; seed < 5; ++seed) {
        const Eigen::VectorXd x =
            moved(solid.rest(), some_rotation(seed), {0, 0, 0}) + random_vector(solid.unknowns(), 0.04, 30 + seed);
        const Eigen::VectorXd force = force_at(*b, x);
        const double count = static_cast<double>(force.size());
        const double largest = force.cwiseAbs().maxCoeff(), extent = x.cwiseAbs().maxCoeff();
        EXPECT_GT(largest, 0.01 * force_scale(solid));
        EXPECT_LE(total_force(force).cwiseAbs().maxCoeff(), 8 * GetParam().epsilon() * count * largest);
        EXPECT_LE(total_torque(x, force).cwiseAbs().maxCoeff(), 16 * GetParam().epsilon() * count * largest * extent);
    }
}

/// Elastic forces of a uniform first Piola-Kirchhoff stress: nothing inside, - P N A / 3 at the corners of each
/// triangle of the boundary with outward normal N.
Eigen::VectorXd boundary_forces(const ReferenceSolid& solid, const Eigen::Matrix3d& stress) {
    std::map<std::array<std::int32_t, 3>, std::pair<int, Eigen::Vector3d>> faces;
    const auto x = [&](std::int32_t node) { return Eigen::Vector3d(solid.nodes[node].data()); };
    constexpr int corners[4][3] = {{0, 2, 1}, {0, 1, 3}, {0, 3, 2}, {1, 2, 3}};
    for (const Tetrahedron& t : solid.tetrahedra) {
        for (const auto& c : corners) {
            std::array<std::int32_t, 3> key{t[c[0]], t[c[1]], t[c[2]]};
            const Eigen::Vector3d area = (x(key[1]) - x(key[0])).cross(x(key[2]) - x(key[0])) / 2;
            std::sort(key.begin(), key.end());
            auto& face = faces[key];
            ++face.first;
            face.second = area;
        }
    }
    Eigen::VectorXd force = Eigen::VectorXd::Zero(solid.unknowns());
    for (const auto& [nodes, face] : faces) {
        if (face.first != 1) continue;
        for (const std::int32_t node : nodes) force.segment<3>(3 * node) -= stress * face.second / 3;
    }
    return force;
}

TEST_P(ElasticForce, PassesThePatchTest) {
    solid.materials[1] = solid.materials[0];
    const double lambda = solid.materials[0].lambda(), mu = solid.materials[0].mu();
    Eigen::Matrix3d gradient;
    gradient << 0.05, 0.02, -0.03, 0.01, -0.04, 0.02, 0.03, -0.01, 0.06;
    const Eigen::Matrix3d identity = Eigen::Matrix3d::Identity();
    const auto hooke = [&](const Eigen::Matrix3d& strain) {
        return Eigen::Matrix3d(2 * mu * strain + lambda * strain.trace() * identity);
    };
    const Eigen::Matrix3d symmetric = 0.5 * (gradient + gradient.transpose());

    const auto linear = body(ElementModel::linear);
    const Eigen::VectorXd stretched = moved(solid.rest(), identity + gradient, {0.2, 0.1, 0});
    EXPECT_LE((force_at(*linear, stretched) - boundary_forces(solid, hooke(symmetric))).cwiseAbs().maxCoeff(),
              tolerance(1));

    // Corotated: F = R (1 + E) with E symmetric has the stress R sigma(E).
    const Eigen::Matrix3d rotation = some_rotation(2);
    const auto corotational = body();
    const Eigen::VectorXd turned = moved(solid.rest(), rotation * (identity + symmetric), {0.2, 0.1, 0});
    EXPECT_LE(
        (force_at(*corotational, turned) - boundary_forces(solid, rotation * hooke(symmetric))).cwiseAbs().maxCoeff(),
        tolerance(1));
}

// Differences of energies need double; the forces of the other scalars are compared with these above.
std::vector<Arithmetic> double_arithmetics() {
    std::vector<Arithmetic> all = compiled_arithmetics();
    std::erase_if(all, [](const Arithmetic& a) { return a.scalar != runtime::ScalarMode::double_precision; });
    return all;
}
class ElasticForceInDouble : public ElasticForce {};
INSTANTIATE_TEST_SUITE_P(Arithmetics, ElasticForceInDouble, ::testing::ValuesIn(double_arithmetics()),
                         ArithmeticName());

TEST_P(ElasticForceInDouble, IsMinusTheGradientOfTheEnergy) {
    for (const ElementModel model : {ElementModel::linear, ElementModel::corotational}) {
        const auto b = body(model);
        for (const double amplitude : {0.005, 0.03}) {
            Eigen::VectorXd x = solid.rest() + random_vector(solid.unknowns(), amplitude, 41);
            if (amplitude > 0.01) {
                // One element is pressed almost flat, another one is turned inside out.
                for (const auto& [element, height] : {std::pair<std::size_t, double>{3, 1e-3}, {100, -0.2}}) {
                    const Tetrahedron& t = solid.tetrahedra[element];
                    const auto at = [&](int corner) { return Eigen::Vector3d(x.segment<3>(3 * t[corner])); };
                    const Eigen::Vector3d centre = (at(0) + at(1) + at(2)) / 3;
                    x.segment<3>(3 * t[3]) = centre + height * (at(3) - centre);
                }
                EXPECT_LT(std::abs(solid.deformation_gradient(3, x).determinant()), 0.01);
                EXPECT_LT(solid.deformation_gradient(100, x).determinant(), 0);
            }
            const Eigen::VectorXd force = force_at(*b, x);
            for (unsigned direction = 0; direction < 6; ++direction) {
                // Everything at random, then single coordinates of nodes of the tortured elements.
                Eigen::VectorXd d = random_vector(solid.unknowns(), 1, 50 + direction);
                if (direction >= 3) {
                    d = Eigen::VectorXd::Unit(solid.unknowns(), 3 * solid.tetrahedra[direction == 3 ? 3 : 100][3] +
                                                                    static_cast<Eigen::Index>(direction % 3));
                }
                const double exact = -force.dot(d);
                double best = HUGE_VAL;
                for (double step = 1e-2; step > 0.5e-9; step /= 10) {
                    const double h = step * spacing;
                    const double difference = (energy_at(*b, x + h * d) - energy_at(*b, x - h * d)) / (2 * h);
                    best = std::min(best, std::abs(difference - exact) / std::abs(exact));
                }
                EXPECT_LT(best, 1e-6) << "amplitude " << amplitude << ", direction " << direction;
            }
        }
    }
}

}  // namespace
}  // namespace lancet::test
