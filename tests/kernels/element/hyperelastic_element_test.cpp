// Elements of every material: energy, force and edge blocks against the reference solid, and their invariants.
#include <algorithm>
#include <cmath>
#include <limits>

#include "tests/kernels/element/hyperelastic_elements.hpp"

namespace lancet::test {
namespace {

constexpr double spacing = 0.1;

Eigen::Matrix3d some_rotation(double angle) {
    return Eigen::AngleAxisd(angle, Eigen::Vector3d(0.3, -0.5, 0.8).normalized()).toRotationMatrix();
}

class HyperelasticElement : public ElementTest {
  protected:
    ReferenceSolid solid = jittered_bar({5, 3, 2}, spacing, 0.15, 71);

    /// Strains of some 20 %, turned by `angle`; then one element pressed almost flat and another one inside out.
    Eigen::VectorXd deformed(double angle, bool tortured = false) const {
        Eigen::VectorXd x =
            moved(solid.rest() + random_vector(solid.unknowns(), 0.012, 72), some_rotation(angle), {0.3, -1, 2});
        if (!tortured) return x;
        for (const auto& [element, height] : {std::pair<std::size_t, double>{3, 1e-2}, {100, -0.4}}) {
            const Tetrahedron& t = solid.tetrahedra[element];
            const auto at = [&](int corner) { return Eigen::Vector3d(x.segment<3>(3 * t[corner])); };
            const Eigen::Vector3d centre = (at(0) + at(1) + at(2)) / 3;
            x.segment<3>(3 * t[3]) = centre + height * (at(3) - centre);
        }
        return x;
    }
    /// The largest stretch of any element, and the smallest sum of two.
    std::pair<double, double> extremes(const Eigen::VectorXd& x) const {
        double largest = 1, smallest = 1;
        for (std::size_t e = 0; e < solid.tetrahedra.size(); ++e) {
            const Eigen::Vector3d s = proper_stretches(solid.deformation_gradient(e, x));
            largest = std::max(largest, s[0]);
            smallest = std::min(smallest, s[1] + s[2]);
        }
        return {largest, smallest};
    }
    /// What multiplies the rounding of the strain, a few eps, in a nodal force: as many as 24 elements meet in a node.
    double force_tolerance(MaterialModel model, const Eigen::VectorXd& x) const {
        const auto [largest, smallest] = extremes(x);
        const double growth = model == MaterialModel::st_venant_kirchhoff ? std::pow(1 + largest, 3)
                              : model == MaterialModel::corotational      ? (1 + largest) * largest / smallest
                                                                          : 1 + largest;
        const double strain_error = 8 * (epsilon() + 0x1p-52 * (x.cwiseAbs().maxCoeff() + 1) / spacing);
        return 24 * strain_error * growth * force_of_unit_strain(solid, spacing);
    }
};
INSTANTIATE_TEST_SUITE_P(Arithmetics, HyperelasticElement, ::testing::ValuesIn(element_arithmetics()), arithmetic_name);

TEST_P(HyperelasticElement, EnergyAndForceEqualTheReference) {
    for (const ScatterStrategy strategy : scatter_strategies) {
        with_elements(solid, strategy, [&](auto& elements) {
            for (const MaterialModel model : all_materials) {
                for (const bool tortured : {false, true}) {
                    SCOPED_TRACE(::testing::Message() << to_string(model) << ", " << to_string(strategy) << ", "
                                                      << (tortured ? "tortured" : "deformed"));
                    const Eigen::VectorXd x = deformed(model == MaterialModel::linear ? 0 : 2.5, tortured);
                    elements.set_positions(x);
                    const double energy = elements.evaluate(model);
                    const double expected = solid.elastic_energy(x, model);
                    EXPECT_NEAR(energy, expected, 100 * epsilon() * expected);
                    const Eigen::VectorXd force = elements.at_free_nodes(solid, elements.buffer);
                    EXPECT_LE((force - solid.elastic_force(x, model)).cwiseAbs().maxCoeff(), force_tolerance(model, x));
                }
            }
        });
    }
}

TEST_P(HyperelasticElement, EdgeBlocksEqualTheReference) {
    with_elements(solid, ScatterStrategy::private_copies, [&](auto& elements) {
        for (const MaterialModel model : all_materials) {
            const Eigen::VectorXd x = deformed(model == MaterialModel::linear ? 0 : 2.5, true);
            elements.set_positions(x);
            for (const TangentKind kind : all_tangents) {
                if (!kernels::has_tangent(model, kind)) continue;
                SCOPED_TRACE(::testing::Message() << to_string(model) << ", " << to_string(kind));
                elements.compute_element_blocks(model, kind);
                for (std::size_t e = 0; e < solid.tetrahedra.size(); ++e) {
                    const auto expected = solid.element_stiffness(e, x, model, kind);
                    const Eigen::Vector3d s = proper_stretches(solid.deformation_gradient(e, x));
                    const double gap = s[1] + s[2];
                    // The rotation, the more its change, know F to eps times |F| over the gap.
                    const double condition =
                        model == MaterialModel::corotational ? std::max(1.0, std::pow((1 + s[0]) / gap, 2)) : 1;
                    const double size = std::max(expected.norm(), solid.element_stiffness(e).norm());
                    EXPECT_LE((elements.element_stiffness(e) - expected).norm(), 64 * epsilon() * condition * size)
                        << "element " << e;
                }
            }
        }
    });
}

TEST_P(HyperelasticElement, PaddingHasNoStiffness) {
    with_elements(solid, ScatterStrategy::private_copies, [&](auto& elements) {
        elements.set_positions(deformed(0.4));
        std::vector<bool> is_used(static_cast<std::size_t>(elements.batches.slots()), false);
        for (const std::int32_t slot : elements.batches.slot_of_element) is_used[slot] = true;
        if (elements.batches.width > 4) {
            EXPECT_NE(std::count(is_used.begin(), is_used.end(), false), 0);
        }
        for (const MaterialModel model : all_materials) {
            elements.compute_element_blocks(model, TangentKind::projected);
            const auto width = static_cast<std::size_t>(elements.batches.width);
            for (std::size_t slot = 0; slot < is_used.size() + width; ++slot) {
                if (slot < is_used.size() && is_used[slot]) continue;
                for (std::size_t entry = 0; entry < 54; ++entry) {
                    EXPECT_EQ(elements.element_blocks[(slot / width * 54 + entry) * width + slot % width], 0);
                }
            }
        }
    });
}

TEST_P(HyperelasticElement, RigidMotionsCauseNoForce) {
    with_elements(solid, ScatterStrategy::private_copies, [&](auto& elements) {
        for (const MaterialModel model : all_materials) {
            for (const double angle : {0.0, 0.01, 1.5707963, 3.14159265358979, 5.0}) {
                if (model == MaterialModel::linear && angle != 0) continue;
                const Eigen::VectorXd x = moved(solid.rest(), some_rotation(angle), {10, -20, 5});
                elements.set_positions(x);
                const double strain_error = 16 * (epsilon() + 0x1p-52 * 20 / spacing);
                EXPECT_LE(elements.evaluate(model), 1000 * strain_error * strain_error *
                                                        force_of_unit_strain(solid, spacing) * spacing *
                                                        static_cast<double>(solid.tetrahedra.size()));
                EXPECT_LE(elements.at_free_nodes(solid, elements.buffer).cwiseAbs().maxCoeff(),
                          force_tolerance(model, x))
                    << to_string(model) << ", angle " << angle;
            }
        }
    });
}

TEST_P(HyperelasticElement, ForcesAddUpToNothing) {
    with_elements(solid, ScatterStrategy::private_copies, [&](auto& elements) {
        for (const MaterialModel model : all_materials) {
            const Eigen::VectorXd x = deformed(model == MaterialModel::linear ? 0 : 1, true);
            elements.set_positions(x);
            elements.evaluate(model);
            const Eigen::VectorXd force = elements.at_free_nodes(solid, elements.buffer);
            const double largest = force.cwiseAbs().maxCoeff(), count = static_cast<double>(force.size());
            EXPECT_GT(largest, 1e-3 * force_of_unit_strain(solid, spacing));
            EXPECT_LE(total_force(force).cwiseAbs().maxCoeff(), 8 * epsilon() * count * largest);
            if (model == MaterialModel::linear) continue;  // not objective: no angular momentum
            const double extent = x.cwiseAbs().maxCoeff();
            EXPECT_LE(total_torque(x, force).cwiseAbs().maxCoeff(), 64 * epsilon() * count * largest * extent);
        }
    });
}

TEST_P(HyperelasticElement, WarmStartsDoNotMatter) {
    with_elements(solid, ScatterStrategy::private_copies, [&](auto& elements) {
        const Eigen::VectorXd x = deformed(3.1);
        elements.set_positions(x);
        elements.evaluate(MaterialModel::corotational);
        const Eigen::VectorXd cold = elements.at_free_nodes(solid, elements.buffer);
        elements.evaluate(MaterialModel::corotational);
        const Eigen::VectorXd warm = elements.at_free_nodes(solid, elements.buffer);
        EXPECT_LE((warm - cold).cwiseAbs().maxCoeff(), force_tolerance(MaterialModel::corotational, x));
        for (std::size_t e = 0; e < solid.tetrahedra.size(); ++e) {
            const auto width = static_cast<std::size_t>(elements.batches.width);
            const auto slot = static_cast<std::size_t>(elements.batches.slot_of_element[e]);
            const auto* q = &elements.quaternion[slot / width * 4 * width + slot % width];
            const Eigen::Quaterniond rotation(static_cast<double>(q[0]), static_cast<double>(q[width]),
                                              static_cast<double>(q[2 * width]), static_cast<double>(q[3 * width]));
            const Eigen::Matrix3d expected = nearest_rotation(solid.deformation_gradient(e, x));
            EXPECT_LE((rotation.toRotationMatrix() - expected).norm(), 100 * epsilon());
        }
    });
}

/// The lanes without node `broken` must be what they are without it, to the bit.
template <class Real>
void expect_no_spreading(const ReferenceSolid& solid, HyperelasticElements<Real>& elements, const Eigen::VectorXd& x) {
    constexpr std::int32_t broken = 25;
    const auto has_broken = [&](std::size_t e) {
        const Tetrahedron& t = solid.tetrahedra[e];
        return std::find(t.begin(), t.end(), broken) != t.end();
    };
    std::vector<bool> touched(solid.nodes.size(), false);
    for (std::size_t e = 0; e < solid.tetrahedra.size(); ++e) {
        if (!has_broken(e)) continue;
        for (const std::int32_t node : solid.tetrahedra[e]) touched[static_cast<std::size_t>(node)] = true;
    }
    const AlignedVector<Real> start = elements.quaternion;
    for (const MaterialModel model : all_materials) {
        for (const TangentKind kind : {TangentKind::exact, TangentKind::projected}) {
            SCOPED_TRACE(::testing::Message() << to_string(model) << ", " << to_string(kind));
            const auto force_and_blocks = [&](const Eigen::VectorXd& at) {
                elements.quaternion = start;
                elements.set_positions(at);
                elements.evaluate(model);
                elements.compute_element_blocks(model, kind);
            };
            force_and_blocks(x);
            const AlignedVector<Real> force = elements.buffer, blocks = elements.element_blocks;
            for (const double bad : {std::numeric_limits<double>::quiet_NaN(), HUGE_VAL}) {
                Eigen::VectorXd ill = x;
                ill[3 * broken] = bad;
                force_and_blocks(ill);
                const auto width = static_cast<std::size_t>(elements.batches.width);
                for (std::size_t e = 0; e < solid.tetrahedra.size(); ++e) {
                    if (has_broken(e)) continue;
                    const auto slot = static_cast<std::size_t>(elements.batches.slot_of_element[e]);
                    for (std::size_t entry = 0; entry < 54; ++entry) {
                        const std::size_t at = (slot / width * 54 + entry) * width + slot % width;
                        ASSERT_EQ(elements.element_blocks[at], blocks[at]) << "element " << e;
                    }
                }
                for (std::size_t node = 0; node < solid.nodes.size(); ++node) {
                    if (touched[node]) continue;
                    for (std::size_t axis = 0; axis < 3; ++axis) {
                        const std::size_t at = elements.place(node, axis);
                        ASSERT_EQ(elements.buffer[at], force[at]) << "node " << node;
                    }
                }
                const std::size_t at = elements.place(static_cast<std::size_t>(broken), 0);
                EXPECT_FALSE(std::isfinite(elements.buffer[at])) << "what is not a number stays visible";
                // Nothing of it is kept as the start of the next rotation.
                elements.set_positions(x);
                elements.evaluate(model);
                const double tolerance = 24 * 64 * static_cast<double>(std::numeric_limits<Real>::epsilon()) *
                                         force_of_unit_strain(solid, spacing);
                for (std::size_t node = 0; node < solid.nodes.size(); ++node) {
                    const std::size_t healed = elements.place(node, 0);
                    EXPECT_NEAR(elements.buffer[healed], force[healed], tolerance);
                }
            }
        }
    }
}

TEST_P(HyperelasticElement, OneBadNodeDoesNotSpread) {
    with_elements(solid, ScatterStrategy::private_copies,
                  [&](auto& elements) { expect_no_spreading(solid, elements, deformed(0.5)); });
}

TEST_P(HyperelasticElement, ATangentThatDoesNotExistIsNotANumber) {
    with_elements(solid, ScatterStrategy::private_copies, [&](auto& elements) {
        elements.set_positions(deformed(0.5));
        elements.compute_element_blocks(MaterialModel::st_venant_kirchhoff, TangentKind::rotated);
        for (std::size_t e = 0; e < solid.tetrahedra.size(); ++e) {
            EXPECT_TRUE(elements.element_block(e, 0, 1).array().isNaN().all());
            EXPECT_TRUE(elements.element_block(e, 2, 3).array().isNaN().all());
        }
    });
}

}  // namespace
}  // namespace lancet::test
