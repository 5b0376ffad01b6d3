// The critical step of cut elements: what holds for any shape, Poisson's ratio and fractions. The curves of one regular
// element are compared with an independent code in tests/verification.
#include "lancet/runtime/cut/critical_step_study.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <random>
#include <vector>

#include <Eigen/Dense>
#include <Eigen/Eigenvalues>
#include <gtest/gtest.h>

#include "lancet/kernels/error.hpp"
#include "lancet/kernels/layout/element_batches.hpp"
#include "lancet/mesh/generate/box.hpp"
#include "lancet/runtime/cut/part_mass.hpp"

namespace lancet::runtime {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;
using RowMajor = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

constexpr std::array all_enrichments{Enrichment::substituted, Enrichment::shifted, Enrichment::heaviside};
constexpr std::array all_lumpings{StudyLumping::enrichment, StudyLumping::row_sum, StudyLumping::weighted_diagonal,
                                  StudyLumping::consistent, StudyLumping::fraction};
constexpr std::array<mesh::Point, 4> regular{{{1, 1, 1}, {1, -1, -1}, {-1, -1, 1}, {-1, 1, -1}}};

/// Eigenvalues of at most 36 x 36 matrices, relative to the largest one.
constexpr double rounding = 1e3 * std::numeric_limits<double>::epsilon();

double uniform(std::mt19937& random, double from, double to) {
    return std::uniform_real_distribution<double>(from, to)(random);
}

/// A tetrahedron with corners anywhere in a cube, from well-shaped to flat.
StudyElement random_tetrahedron(std::mt19937& random) {
    std::array<mesh::Point, 4> corners{};
    for (mesh::Point& corner : corners) {
        for (double& value : corner) value = uniform(random, -1, 1);
    }
    return study_tetrahedron(corners, uniform(random, -0.5, 0.499));
}

/// A part with this fraction and moments as if it were spread like the whole: what lumpings by fraction do not look at.
StudyPart part_of_fraction(double fraction) {
    StudyPart part = study_part(mesh::PartMoments{});
    part.fraction = fraction;
    for (double& value : part.first) value *= fraction;
    for (double& value : part.second) value *= fraction;
    return part;
}

/// A regular tetrahedron cut off at node 0, or between the edges 0 1 and 2 3.
CutElement cut_once(bool at_edge, double fraction) {
    const auto parts = at_edge ? cut_off_edge(fraction) : cut_off_corner(fraction);
    return {.element = study_tetrahedron(regular, 0.33),
            .parts = {study_part(parts[0]), study_part(parts[1])},
            .cuts = {{.from = 0}},
            .corner_parts = {0, at_edge ? 0 : 1, 1, 1}};
}

/// Two cuts off the corner of node 0: its tip, a layer, and the rest.
CutElement cut_twice(double tip, double layer, int from) {
    const auto inner = cut_off_corner(tip);
    const auto outer = cut_off_corner(tip + layer);
    StudyPart middle = study_part(outer[0]);
    const StudyPart first = study_part(inner[0]);
    middle.fraction -= first.fraction;
    for (std::size_t i = 0; i < 4; ++i) middle.first[i] -= first.first[i];
    for (std::size_t i = 0; i < 16; ++i) middle.second[i] -= first.second[i];
    const StudyPart rest = study_part(outer[1]);
    // Off the tip comes the rest of all, then that in two; or off the tip and layer the rest, then the layer off the
    // tip.
    CutElement cut{study_tetrahedron(regular, 0.33), {first, middle, rest}, {{.from = 0}, {.from = 1}}, {0, 2, 2, 2}};
    if (from == 0) {
        cut.parts = {first, rest, middle};
        cut.cuts = {{.from = 0}, {.from = 0}};
        cut.corner_parts = {0, 1, 1, 1};
    }
    return cut;
}

MatrixXd matrix_of(const std::vector<double>& values) {
    const auto size = static_cast<Index>(std::lround(std::sqrt(static_cast<double>(values.size()))));
    return RowMajor::Map(values.data(), size, size);
}

/// The change of basis for all axes.
MatrixXd copies_from(const CutElement& cut, Enrichment enrichment) {
    const MatrixXd scalar = matrix_of(copies_of_enriched(cut, enrichment));
    const Index axes = cut.element.axes;
    MatrixXd change = MatrixXd::Zero(scalar.rows() * axes, scalar.cols() * axes);
    for (Index row = 0; row < change.rows(); ++row) {
        for (Index column = row % axes; column < change.cols(); column += axes) {
            change(row, column) = scalar(row / axes, column / axes);
        }
    }
    return change;
}

double largest_eigenvalue(const MatrixXd& stiffness, const MatrixXd& mass) {
    return Eigen::GeneralizedSelfAdjointEigenSolver<MatrixXd>(stiffness, mass, Eigen::EigenvaluesOnly)
        .eigenvalues()
        .maxCoeff();
}

TEST(CriticalStepStudy, EnrichmentsAreAChangeOfBasis) {
    for (const CutElement& cut :
         {cut_once(false, 0.3), cut_once(true, 0.3), cut_twice(0.2, 0.3, 0), cut_twice(0.2, 0.3, 1)}) {
        for (const StudyLumping lumping : {StudyLumping::consistent, StudyLumping::fraction}) {
            const StudyMatrices own = assemble(cut, Enrichment::substituted, lumping);
            for (const Enrichment enrichment : all_enrichments) {
                SCOPED_TRACE(to_string(enrichment));
                const MatrixXd change = copies_from(cut, enrichment);
                const StudyMatrices matrices = assemble(cut, enrichment, lumping);
                EXPECT_TRUE(matrix_of(matrices.stiffness)
                                .isApprox(change.transpose() * matrix_of(own.stiffness) * change, rounding));
                EXPECT_TRUE(
                    matrix_of(matrices.mass).isApprox(change.transpose() * matrix_of(own.mass) * change, rounding));
                // The eigenvalues are those of the substituted basis: here the enriched pencil is well-conditioned
                // enough to compare (the mass has a condition of some 1e4).
                const double ratio = critical_step_ratio(cut, enrichment, lumping);
                const double whole = 4 * matrix_of(cut.element.stiffness).eigenvalues().real().maxCoeff();
                const double eigenvalue = largest_eigenvalue(matrix_of(matrices.stiffness), matrix_of(matrices.mass));
                EXPECT_NEAR(ratio, std::sqrt(whole / eigenvalue), 1e4 * rounding * ratio);
            }
        }
    }
}

TEST(CriticalStepStudy, ShiftedUnknownsOfNodesHaveThePsiOfTheirSide) {
    // psi_i = (H - H_i) / 2 with H = +1 on the first part: u is the copy on the node's own side.
    const CutElement cut = cut_once(true, 0.3);
    const MatrixXd change = matrix_of(copies_of_enriched(cut, Enrichment::shifted));
    for (Index corner = 0; corner < 4; ++corner) {
        const double h_node = cut.corner_parts[static_cast<std::size_t>(corner)] == 0 ? 1 : -1;
        for (Index part = 0; part < 2; ++part) {
            const double h = part == 0 ? 1 : -1;
            EXPECT_EQ(change(corner * 2 + part, corner * 2), 1);
            EXPECT_EQ(change(corner * 2 + part, corner * 2 + 1), (h - h_node) / 2);
        }
    }
    EXPECT_EQ(change.cwiseAbs().sum(), 8 + 4);
}

TEST(CriticalStepStudy, TheNodesOwnPartIsUInEveryNestedCut) {
    for (const int from : {0, 1}) {
        for (int code = 0; code < 81; ++code) {
            CutElement cut = cut_twice(0.2, 0.3, from);
            cut.corner_parts = {code % 3, code / 3 % 3, code / 9 % 3, code / 27};
            const MatrixXd change = matrix_of(copies_of_enriched(cut, Enrichment::shifted));
            for (Index corner = 0; corner < 4; ++corner) {
                const Index own = cut.corner_parts[static_cast<std::size_t>(corner)];
                EXPECT_EQ(change.row(corner * 3 + own), VectorXd::Unit(12, corner * 3).transpose());
                EXPECT_NEAR(std::abs(change.block(corner * 3, corner * 3, 3, 3).determinant()), 1, rounding);
            }
        }
    }
}

TEST(CriticalStepStudy, MassesAreThatOfTheElementAndRigidMotionIsFree) {
    for (const CutElement& cut : {cut_once(false, 0.3), cut_once(true, 1e-6), cut_twice(0.2, 0.3, 0)}) {
        for (const Enrichment enrichment : all_enrichments) {
            const Index copies = static_cast<Index>(cut.parts.size());
            // A unit velocity along the second axis: all copies alike, or u alone.
            VectorXd motion = VectorXd::Zero(12 * copies);
            for (Index corner = 0; corner < 4; ++corner) {
                for (Index level = 0; level < copies; ++level) {
                    const bool moves = enrichment == Enrichment::substituted || level == 0;
                    if (moves) motion((corner * copies + level) * 3 + 1) = 1;
                }
            }
            for (const StudyLumping lumping : all_lumpings) {
                SCOPED_TRACE(to_string(lumping));
                const StudyMatrices matrices = assemble(cut, enrichment, lumping);
                EXPECT_EQ(matrices.size, 12 * copies);
                const MatrixXd stiffness = matrix_of(matrices.stiffness);
                EXPECT_NEAR(motion.dot(matrix_of(matrices.mass) * motion), 1, rounding);
                EXPECT_LE((stiffness * motion).cwiseAbs().maxCoeff(), rounding * stiffness.cwiseAbs().maxCoeff());
            }
        }
    }
}

TEST(CriticalStepStudy, FractionLumpingIsNeverBelowTheWholeElement) {
    std::mt19937 random(4);
    for (const double smallest : {0.5, 1e-3, 1e-8, 1e-14}) {
        for (int sample = 0; sample < 40; ++sample) {
            CutElement cut{.element = random_tetrahedron(random), .parts = {}, .cuts = {}, .corner_parts = {}};
            // One to six cuts: the smallest fraction and others that make up for it.
            const int cuts = smallest == 0.5 ? 1 : 1 + sample % 6;
            std::vector<double> fractions{smallest};
            double others = 0;
            for (int k = 0; k < cuts; ++k) {
                fractions.push_back(uniform(random, 0.1, 1));
                others += fractions.back();
            }
            for (std::size_t k = 1; k < fractions.size(); ++k) fractions[k] *= (1 - smallest) / others;
            for (const double fraction : fractions) cut.parts.push_back(part_of_fraction(fraction));
            for (int k = 0; k < cuts; ++k)
                cut.cuts.push_back({static_cast<int>(random() % (static_cast<unsigned>(k) + 1))});
            for (int corner = 0; corner < 4; ++corner) {
                cut.corner_parts.push_back(static_cast<int>(random() % (static_cast<unsigned>(cuts) + 1)));
            }
            const double ratio = critical_step_ratio(cut, Enrichment::substituted, StudyLumping::fraction);
            EXPECT_GE(ratio, 1 - rounding);
            // The masses are diagonal in this basis, and the assembled matrices say the same.
            const StudyMatrices matrices = assemble(cut, Enrichment::substituted, StudyLumping::fraction);
            const VectorXd scale = matrix_of(matrices.mass).diagonal().cwiseSqrt().cwiseInverse();
            const MatrixXd scaled = scale.asDiagonal() * matrix_of(matrices.stiffness) * scale.asDiagonal();
            const double whole = 4 * matrix_of(cut.element.stiffness).eigenvalues().real().maxCoeff();
            EXPECT_LE(Eigen::SelfAdjointEigenSolver<MatrixXd>(scaled, Eigen::EigenvaluesOnly).eigenvalues().maxCoeff(),
                      whole * (1 + rounding));
            // The thesis' lumping has a bound of its own for so many cuts.
            for (const Enrichment enrichment : {Enrichment::shifted, Enrichment::heaviside}) {
                EXPECT_GE(critical_step_ratio(cut, enrichment, StudyLumping::enrichment),
                          1 / std::sqrt(1.0 + cuts) - rounding);
            }
        }
    }
}

TEST(CriticalStepStudy, FractionLumpingHoldsTheBoundOfElementsInAMeshHoweverItIsCut) {
    // Twenty tetrahedra, each in random parts, and the corners of the parts at a node joined at random: more general
    // than what cuts can do.
    const mesh::TetMesh mesh = mesh::box({.cells = {2, 2, 1}, .size = {2, 1.3, 0.4}});
    std::mt19937 random(9);
    for (int sample = 0; sample < 5; ++sample) {
        double bound = 0;
        const auto copies_per_node = static_cast<Index>(1 + sample);
        const auto unknowns = static_cast<Index>(mesh.nodes().size()) * copies_per_node * 3;
        MatrixXd stiffness = MatrixXd::Zero(unknowns, unknowns);
        VectorXd mass = VectorXd::Zero(unknowns);
        for (const mesh::Tetrahedron& t : mesh.tetrahedra()) {
            std::array<mesh::Point, 4> corners{};
            for (std::size_t i = 0; i < 4; ++i) corners[i] = mesh.nodes()[static_cast<std::size_t>(t[i])];
            const MatrixXd element = matrix_of(study_tetrahedron(corners, 0.4).stiffness);
            const double volume = std::abs(kernels::tetrahedron_geometry(mesh.nodes(), t).volume);
            bound = std::max(bound, 4 / volume * element.eigenvalues().real().maxCoeff());
            double rest = 1;
            for (int part = 0; part < 4; ++part) {
                const double v = part == 3 ? rest : rest * std::pow(10, uniform(random, -14, -0.1));
                rest -= v;
                mesh::PartMoments moments{};
                moments.fraction = v;
                const auto masses = corner_masses(MassKind::fraction, moments);
                std::array<Index, 12> place{};
                for (std::size_t i = 0; i < 4; ++i) {
                    const auto copy = static_cast<Index>(random() % static_cast<unsigned>(copies_per_node));
                    for (std::size_t axis = 0; axis < 3; ++axis) {
                        place[3 * i + axis] = (t[i] * copies_per_node + copy) * 3 + static_cast<Index>(axis);
                        mass(place[3 * i + axis]) += volume * masses[i];
                    }
                }
                for (std::size_t i = 0; i < 12; ++i) {
                    for (std::size_t j = 0; j < 12; ++j) {
                        stiffness(place[i], place[j]) += v * element(static_cast<Index>(i), static_cast<Index>(j));
                    }
                }
            }
        }
        // Copies that no part has carry nothing.
        const VectorXd scale = mass.unaryExpr([](double m) { return m > 0 ? 1 / std::sqrt(m) : 0.0; });
        const MatrixXd scaled = scale.asDiagonal() * stiffness * scale.asDiagonal();
        const double largest =
            Eigen::SelfAdjointEigenSolver<MatrixXd>(scaled, Eigen::EigenvaluesOnly).eigenvalues().maxCoeff();
        EXPECT_LE(largest, bound * (1 + rounding));
        EXPECT_GT(largest, bound / 10);
    }
}

TEST(CriticalStepStudy, OtherMassesLetThinPartsShortenTheStep) {
    for (const Enrichment enrichment : all_enrichments) {
        for (const StudyLumping lumping : {StudyLumping::row_sum, StudyLumping::consistent}) {
            if (enrichment == Enrichment::heaviside && lumping == StudyLumping::row_sum) continue;
            const double thin = critical_step_ratio(cut_once(true, 1e-4), enrichment, lumping);
            const double thinner = critical_step_ratio(cut_once(true, 1e-10), enrichment, lumping);
            EXPECT_LT(thin, 0.2);
            EXPECT_LT(thinner, thin / 25);
        }
    }
}

TEST(CriticalStepStudy, TheThesisLumpingDependsOnFractionsAloneAndHasABound) {
    std::mt19937 random(5);
    for (int sample = 0; sample < 200; ++sample) {
        const double v = std::pow(10, uniform(random, -12, -0.31));
        CutElement cut = cut_once(sample % 2 == 0, sample % 3 == 0 ? 1 - v : v);
        cut.element = random_tetrahedron(random);
        const double ratio = critical_step_ratio(cut, Enrichment::shifted, StudyLumping::enrichment);
        EXPECT_GE(ratio, 1 / std::sqrt(1 + std::sqrt(1 - v)) - rounding);
        for (StudyPart& part : cut.parts) part = part_of_fraction(part.fraction);
        EXPECT_NEAR(critical_step_ratio(cut, Enrichment::shifted, StudyLumping::enrichment), ratio, rounding);
    }
    for (const double cut : {1e-9, 0.1, 0.5, 0.77}) {
        const auto parts = cut_bar(cut);
        const CutElement bar{study_bar(), {parts[0], parts[1]}, {{0}}, {0, 1}};
        EXPECT_NEAR(critical_step_ratio(bar, Enrichment::shifted, StudyLumping::enrichment), std::sqrt(2.0 / 3),
                    rounding);
    }
}

TEST(CriticalStepStudy, TwoNestedCutsBringTheThesisLumpingBelow059) {
    // Two thin parts, one after the other off the side of three nodes. The bound 1 / sqrt(3) = 0.577 is come close to.
    const auto ratio = [](double thin, StudyLumping lumping, Enrichment enrichment) {
        CutElement cut{study_tetrahedron(regular, 0), {}, {{0}, {0}}, {0, 0, 1, 1}};
        for (const double fraction : {thin, thin, 1 - 2 * thin}) cut.parts.push_back(part_of_fraction(fraction));
        return critical_step_ratio(cut, enrichment, lumping);
    };
    EXPECT_LT(ratio(0.02, StudyLumping::enrichment, Enrichment::shifted), 0.59);
    EXPECT_NEAR(ratio(1e-10, StudyLumping::enrichment, Enrichment::shifted), 1 / std::sqrt(3.0), 1e-5);
    EXPECT_GE(ratio(1e-10, StudyLumping::enrichment, Enrichment::shifted), 1 / std::sqrt(3.0) - rounding);
    EXPECT_NEAR(ratio(0.02, StudyLumping::fraction, Enrichment::substituted), 1, rounding);
}

/// The accelerations of the corners of the second part of an element at rest, in m/s^2, when each corner of the first
/// is pulled with 1 N.
double acceleration_across_the_cut(const CutElement& cut, Enrichment enrichment, StudyLumping lumping) {
    const MatrixXd change = copies_from(cut, enrichment);
    VectorXd force = VectorXd::Zero(change.rows());
    for (Index corner = 0; corner < 4; ++corner) force(corner * 2 * 3) = 1;
    const MatrixXd mass = matrix_of(assemble(cut, enrichment, lumping).mass);
    const VectorXd acceleration = change * mass.ldlt().solve(change.transpose() * force);
    double largest = 0;
    for (Index corner = 0; corner < 4; ++corner) {
        largest = std::max(largest, acceleration.segment((corner * 2 + 1) * 3, 3).cwiseAbs().maxCoeff());
    }
    return largest;
}

TEST(CriticalStepStudy, TheThesisLumpingCouplesPartsThatAreApartAndOthersDoNot) {
    for (const bool at_edge : {false, true}) {
        const CutElement cut = cut_once(at_edge, 0.4);
        for (const StudyLumping lumping : {StudyLumping::fraction, StudyLumping::row_sum,
                                           StudyLumping::weighted_diagonal, StudyLumping::consistent}) {
            EXPECT_EQ(acceleration_across_the_cut(cut, Enrichment::substituted, lumping), 0);
        }
        for (const Enrichment enrichment : {Enrichment::shifted, Enrichment::heaviside}) {
            // Kept whole, the mass is the same in every basis: with its coupling of u and a the parts are apart.
            EXPECT_NEAR(acceleration_across_the_cut(cut, enrichment, StudyLumping::fraction), 0, 1e-12);
        }
        // 1 N on a copy is 1 N on u of its node if it lies on that side, so that the other copy, u - a, moves with 1 N
        // / (m/4).
        EXPECT_NEAR(acceleration_across_the_cut(cut, Enrichment::shifted, StudyLumping::enrichment), 4, 1e-12);
    }
}

TEST(CriticalStepStudy, RefusesWhatDoesNotGoTogether) {
    const CutElement good = cut_once(false, 0.5);
    const auto refused = [&](auto change) {
        CutElement bad = good;
        change(bad);
        EXPECT_THROW(critical_step_ratio(bad, Enrichment::shifted, StudyLumping::fraction), Error);
        EXPECT_THROW(assemble(bad, Enrichment::shifted, StudyLumping::fraction), Error);
    };
    refused([](CutElement& bad) { bad.parts.pop_back(); });
    refused([](CutElement& bad) { bad.parts.clear(), bad.cuts.clear(); });
    refused([](CutElement& bad) { bad.cuts[0].from = 1; });
    refused([](CutElement& bad) { bad.corner_parts[2] = 2; });
    refused([](CutElement& bad) { bad.element = study_bar(); });
    EXPECT_THROW(study_tetrahedron({}, 0.3), Error);
    EXPECT_THROW(study_tetrahedron(regular, 0.5), Error);
    EXPECT_THROW(cut_bar(1), Error);
    EXPECT_THROW(cut_off_corner(0), Error);
    EXPECT_THROW(cut_off_edge(-1), Error);
}

TEST(CriticalStepStudy, SimpleCutsHaveTheirFractionsAndAddUp) {
    for (const double v : {1e-14, 1e-6, 0.2, 0.5, 0.9, 1 - 1e-9}) {
        for (const auto& parts : {cut_off_corner(v), cut_off_edge(v)}) {
            // 1 - v, of which the other part is made, has lost digits where v is close to one.
            EXPECT_NEAR(parts[0].fraction, v, 1e-14 * v);
            EXPECT_NEAR(parts[1].fraction, 1 - v, 1e-14);
            for (std::size_t i = 0; i < 4; ++i) {
                EXPECT_NEAR(parts[0].first[i] + parts[1].first[i], 0.25, 1e-14);
                for (std::size_t j = 0; j < 4; ++j) {
                    EXPECT_NEAR(parts[0].second[i][j] + parts[1].second[i][j], i == j ? 0.1 : 0.05, 1e-14);
                }
            }
        }
        const auto bar = cut_bar(v);
        EXPECT_NEAR(bar[0].second[3], v * v * v / 3, 1e-14 * v * v * v);
        EXPECT_NEAR(bar[0].second[1] + bar[1].second[1], 1.0 / 6, 1e-14);
    }
}

}  // namespace
}  // namespace lancet::runtime
