// The three operators and the diagonal from the edge blocks of elements, against the dense matrix.
#include <cmath>

#include "tests/kernels/element/hyperelastic_elements.hpp"

namespace lancet::test {
namespace {

using kernels::GradientLayout;
using kernels::RowContent;

constexpr double stiffness_factor = 1e-3;
constexpr double mass_factor = 1.03;

class ElementBlocks : public ElementTest {
  protected:
    ReferenceSolid solid = [] {
        ReferenceSolid bar = jittered_bar({5, 3, 2}, 0.1, 0.15, 81);
        fix_first_section(bar, {5, 3, 2});
        return bar;
    }();
    Eigen::VectorXd x =
        moved(solid.rest() + random_vector(solid.unknowns(), 0.012, 82),
              Eigen::AngleAxisd(0.6, Eigen::Vector3d(1, 2, -1).normalized()).toRotationMatrix(), {0, 0, 0});

    /// Rows of the free unknowns; columns of the fixed ones are zero, as is z there.
    Eigen::MatrixXd on_free(Eigen::MatrixXd a) const {
        const std::vector<std::uint8_t> is_free = solid.free_unknowns();
        for (std::size_t i = 0; i < is_free.size(); ++i) {
            if (is_free[i] != 0) continue;
            a.row(static_cast<Eigen::Index>(i)).setZero();
            a.col(static_cast<Eigen::Index>(i)).setZero();
        }
        return a;
    }
    Eigen::MatrixXd stiffness(MaterialModel model, TangentKind kind) const {
        return on_free(stiffness_factor * solid.stiffness(x, model, kind));
    }
    Eigen::VectorXd some_z() const {
        const std::vector<std::uint8_t> is_free = solid.free_unknowns();
        Eigen::VectorXd z = random_vector(solid.unknowns(), 1, 83);
        for (std::size_t i = 0; i < is_free.size(); ++i) {
            if (is_free[i] == 0) z[static_cast<Eigen::Index>(i)] = 0;
        }
        return z;
    }
    /// Rounding of a product: a row adds up some 30 blocks of terms that partly cancel, and each block is a rounded
    /// tangent; a rotation's change amplifies by the strains here no more than 4 times.
    double tolerance(const Eigen::MatrixXd& a, const Eigen::VectorXd& z) const {
        return 160 * epsilon() * (a.cwiseAbs() * z.cwiseAbs()).maxCoeff();
    }

    template <class Check>
    void for_each_tangent(Check check) {
        for (const MaterialModel model : all_materials) {
            for (const TangentKind kind : all_tangents) {
                if (!kernels::has_tangent(model, kind)) continue;
                SCOPED_TRACE(::testing::Message() << to_string(model) << ", " << to_string(kind));
                check(model, kind);
            }
        }
    }
};
INSTANTIATE_TEST_SUITE_P(Arithmetics, ElementBlocks, ::testing::ValuesIn(element_arithmetics()), arithmetic_name);

/// The consistent mass of whole elements, times a factor: int rho phi_i phi_j = rho V / 20 for each pair of corners.
template <class Real>
void set_whole_pair_masses(const ReferenceSolid& solid, HyperelasticElements<Real>& elements, double factor) {
    std::vector<std::array<double, 6>> pairs(solid.tetrahedra.size());
    for (std::size_t e = 0; e < pairs.size(); ++e)
        pairs[e].fill(factor * solid.material(e).density * solid.volume(e) / 20);
    kernels::set_pair_masses(elements.batches, std::span<const std::array<double, 6>>(pairs));
}

double sum_of(const std::vector<double>& parts) {
    double sum = 0;
    for (const double part : parts) sum += part;
    return sum;
}

/// y = K z and z . K z by a kernel that is called for each block.
template <class Real>
struct Product {
    Eigen::VectorXd y;
    double quadratic;

    template <class Multiply>
    Product(const ReferenceSolid& solid, HyperelasticElements<Real>& elements, const kernels::ScatterPlan& plan,
            bool exclusive_slots, const Eigen::VectorXd& z, Multiply multiply) {
        AlignedVector<Real> nodal(static_cast<std::size_t>(elements.numbering.node_count) * 4);
        elements.put(z, nodal);
        AlignedVector<Real> buffer(static_cast<std::size_t>(plan.buffer_size()) * 4);
        std::vector<double> quadratics(static_cast<std::size_t>(elements.numbering.blocks()), 0.0);
        const kernels::ProductArguments<Real> product{
            .z = nodal.data(), .y = buffer.data(), .quadratic = quadratics.data(), .exclusive_slots = exclusive_slots};
        elements.scatter_with(plan, buffer, [&](int block) { multiply(product, block); });
        y = elements.at_free_nodes(solid, buffer);
        quadratic = sum_of(quadratics);
    }
};

TEST_P(ElementBlocks, MatrixFreeProductEqualsTheDenseOne) {
    const Eigen::VectorXd z = some_z();
    for (const ScatterStrategy strategy : scatter_strategies) {
        with_elements(solid, strategy, [&]<class Real>(HyperelasticElements<Real>& elements) {
            set_whole_pair_masses(solid, elements, mass_factor);
            elements.set_positions(x);
            for_each_tangent([&](MaterialModel model, TangentKind kind) {
                elements.compute_element_blocks(model, kind);
                for (const bool consistent : {false, true}) {
                    Eigen::MatrixXd a = stiffness(model, kind);
                    // The kernel adds the consistent mass less its row sums, which are nodal.
                    if (consistent) a += on_free(mass_factor * (solid.mass(true) - solid.mass(false)));
                    const kernels::MatrixFreeArguments<Real> matrix{
                        .block_batch_begin = elements.batches.block_batch_begin.data(),
                        .nodes = elements.batches.nodes.data(),
                        .targets = elements.batches.targets.data(),
                        .rest = nullptr,
                        .rotated = elements.element_blocks.data(),
                        .pair_mass = consistent ? elements.batches.pair_mass.data() : nullptr,
                        .stiffness_factor = static_cast<Real>(stiffness_factor),
                        .layout = GradientLayout::element_blocks};
                    const Product<Real> product(solid, elements, elements.batches.scatter, elements.exclusive_slots(),
                                                z, [&](const auto& arguments, int block) {
                                                    elements.kernels.matrix.matrix_free(arguments, matrix, block);
                                                });
                    EXPECT_LE((product.y - a * z).cwiseAbs().maxCoeff(), tolerance(a, z));
                    EXPECT_NEAR(product.quadratic, z.dot(a * z),
                                tolerance(a, z) * std::sqrt(static_cast<double>(z.size())));
                }
            });
        });
    }
}

TEST_P(ElementBlocks, AssembledRowsEqualTheDenseMatrix) {
    const Eigen::VectorXd z = some_z();
    for (const RowContent content : {RowContent::upper_edges, RowContent::full_rows}) {
        for (const ScatterStrategy strategy : scatter_strategies) {
            with_elements(solid, strategy, [&]<class Real>(HyperelasticElements<Real>& elements) {
                elements.set_positions(x);
                const kernels::RowPattern pattern = kernels::make_row_pattern(
                    content, solid.tetrahedra, elements.batches.slot_of_element, elements.batches.slots(),
                    elements.numbering, strategy, elements.kernels.width);
                AlignedVector<Real> values(static_cast<std::size_t>(pattern.entries()) * 9 *
                                           static_cast<std::size_t>(pattern.width));
                for_each_tangent([&](MaterialModel model, TangentKind kind) {
                    SCOPED_TRACE(content == RowContent::full_rows ? "full rows" : "upper edges");
                    elements.compute_element_blocks(model, kind);
                    const kernels::AssemblyArguments<Real> assembly{
                        .block_chunk_begin = pattern.block_chunk_begin.data(),
                        .chunk_entry_begin = pattern.chunk_entry_begin.data(),
                        .incidence_begin = pattern.incidence_begin.data(),
                        .incidence = pattern.incidence.data(),
                        .rotated = elements.element_blocks.data(),
                        .rest = nullptr,
                        .entry_mass = nullptr,
                        .values = values.data(),
                        .stiffness_factor = static_cast<Real>(stiffness_factor),
                        .layout = GradientLayout::element_blocks};
                    for (int block = 0; block < elements.numbering.blocks(); ++block) {
                        elements.kernels.matrix.assemble(assembly, block);
                    }
                    const kernels::RowArguments<Real> matrix{.block_chunk_begin = pattern.block_chunk_begin.data(),
                                                             .chunk_entry_begin = pattern.chunk_entry_begin.data(),
                                                             .row = pattern.row.data(),
                                                             .row_target = pattern.row_target.data(),
                                                             .column = pattern.column.data(),
                                                             .column_target = pattern.column_target.data(),
                                                             .values = values.data()};
                    const Product<Real> product(
                        solid, elements, pattern.scatter,
                        content == RowContent::upper_edges && strategy == ScatterStrategy::node_gather, z,
                        [&](const auto& arguments, int block) {
                            if (content == RowContent::upper_edges) {
                                elements.kernels.matrix.edge_blocks(arguments, matrix, block);
                            } else {
                                elements.kernels.matrix.block_rows(arguments, matrix, block);
                            }
                        });
                    const Eigen::MatrixXd a = stiffness(model, kind);
                    EXPECT_LE((product.y - a * z).cwiseAbs().maxCoeff(), tolerance(a, z));
                    EXPECT_NEAR(product.quadratic, z.dot(a * z),
                                tolerance(a, z) * std::sqrt(static_cast<double>(z.size())));
                });
            });
        }
    }
}

TEST_P(ElementBlocks, DiagonalEqualsThatOfTheDenseMatrix) {
    for (const ScatterStrategy strategy : scatter_strategies) {
        with_elements(solid, strategy, [&]<class Real>(HyperelasticElements<Real>& elements) {
            set_whole_pair_masses(solid, elements, 1);
            elements.set_positions(x);
            const auto width = static_cast<std::size_t>(elements.kernels.width);
            const auto nodes = static_cast<std::size_t>(elements.numbering.node_count);
            AlignedVector<Real> mass(nodes), inverse(6 * nodes);
            const Eigen::MatrixXd lumped = mass_factor * solid.mass(false);
            for (std::size_t node = 0; node < solid.nodes.size(); ++node) {
                const auto i = static_cast<Eigen::Index>(3 * node);
                mass[static_cast<std::size_t>(elements.numbering.internal_of_user[node])] =
                    static_cast<Real>(lumped(i, i));
            }
            for_each_tangent([&](MaterialModel model, TangentKind kind) {
                elements.compute_element_blocks(model, kind);
                kernels::ElementDiagonalArguments<Real> shares{
                    .block_batch_begin = elements.batches.block_batch_begin.data(),
                    .targets = elements.batches.targets.data(),
                    .rest = nullptr,
                    .rotated = elements.element_blocks.data(),
                    .pair_mass = elements.batches.pair_mass.data(),
                    .buffer = elements.buffer.data(),
                    .stiffness_factor = static_cast<Real>(stiffness_factor),
                    .mass_factor = static_cast<Real>(mass_factor),
                    .layout = GradientLayout::element_blocks,
                    .part = kernels::DiagonalPart::axial,
                    .exclusive_slots = elements.exclusive_slots()};
                const kernels::InvertDiagonalArguments<Real> inversion{
                    .block_begin = elements.numbering.block_begin.data(),
                    .buffer = elements.buffer.data(),
                    .mass = mass.data(),
                    .inverse = inverse.data(),
                    .blocks = true};
                const auto for_each_block = [&](auto function) {
                    for (int block = 0; block < elements.numbering.blocks(); ++block) function(inversion, block);
                };
                elements.scatter([&](int block) { elements.kernels.diagonal.scatter(shares, block); });
                for_each_block(elements.kernels.diagonal.keep);
                shares.part = kernels::DiagonalPart::mixed;
                elements.scatter([&](int block) { elements.kernels.diagonal.scatter(shares, block); });
                for_each_block(elements.kernels.diagonal.invert);

                const Eigen::MatrixXd a = stiffness(model, kind) + on_free(mass_factor * solid.mass(true));
                for (std::size_t node = 0; node < solid.nodes.size(); ++node) {
                    const auto internal = static_cast<std::size_t>(elements.numbering.internal_of_user[node]);
                    if (!elements.numbering.is_free(elements.numbering.internal_of_user[node])) continue;
                    const auto at = [&](std::size_t c) {
                        return static_cast<double>(inverse[(internal / width * 6 + c) * width + internal % width]);
                    };
                    Eigen::Matrix3d block;
                    block << at(0), at(3), at(4), at(3), at(1), at(5), at(4), at(5), at(2);
                    const auto i = static_cast<Eigen::Index>(3 * node);
                    const Eigen::Matrix3d expected = a.block<3, 3>(i, i);
                    const double condition = expected.norm() * expected.inverse().norm();
                    EXPECT_LE((block * expected - Eigen::Matrix3d::Identity()).norm(),
                              160 * epsilon() * condition * condition)
                        << "node " << node;
                }
            });
        });
    }
}

}  // namespace
}  // namespace lancet::test
