#include "lancet/runtime/cut/critical_step_study.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <string>

#include <Eigen/Dense>
#include <Eigen/Eigenvalues>

#include "lancet/kernels/error.hpp"

namespace lancet::runtime {

namespace {

using Matrix = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
using Eigen::Index;
using Eigen::VectorXd;

Matrix matrix_of(const std::vector<double>& values) {
    const auto size = static_cast<Index>(std::lround(std::sqrt(static_cast<double>(values.size()))));
    return Matrix::Map(values.data(), size, size);
}

std::vector<double> values_of(const Matrix& matrix) {
    return {matrix.data(), matrix.data() + matrix.size()};
}

/// The same matrix for each axis: rows and columns become row * axes + axis.
Matrix for_axes(const Matrix& scalar, Index axes) {
    Matrix matrix = Matrix::Zero(scalar.rows() * axes, scalar.cols() * axes);
    for (Index row = 0; row < scalar.rows(); ++row) {
        for (Index column = 0; column < scalar.cols(); ++column) {
            matrix.block(row * axes, column * axes, axes, axes).diagonal().setConstant(scalar(row, column));
        }
    }
    return matrix;
}

void validate(const CutElement& cut) {
    const auto corners = static_cast<std::size_t>(cut.element.corners);
    const std::size_t unknowns = corners * static_cast<std::size_t>(cut.element.axes);
    const auto parts = static_cast<int>(cut.parts.size());
    bool holds = cut.element.stiffness.size() == unknowns * unknowns && parts > 0 &&
                 cut.cuts.size() + 1 == cut.parts.size() && cut.corner_parts.size() == corners;
    for (const StudyPart& part : cut.parts) {
        holds = holds && part.first.size() == corners && part.second.size() == corners * corners;
    }
    for (std::size_t k = 0; holds && k < cut.cuts.size(); ++k) {
        holds = cut.cuts[k].from >= 0 && cut.cuts[k].from <= static_cast<int>(k);
    }
    for (const int part : cut.corner_parts) holds = holds && part >= 0 && part < parts;
    if (!holds) throw Error("study of critical steps: parts, cuts and corners do not go together");
}

/// The copies of a corner: levels with the corner's own side as the one that keeps the value, and the copy of each
/// part.
struct CornerCopies {
    std::vector<CopyLevel> levels;
    std::vector<int> copy_of_part;
};

CornerCopies corner_copies(const std::vector<StudyCut>& cuts, int own_part) {
    // Whose piece the corner's own part was before cut k.
    std::vector<int> own(cuts.size() + 1);
    own[cuts.size()] = own_part;
    for (std::size_t k = cuts.size(); k-- > 0;) {
        own[k] = own[k + 1] == static_cast<int>(k) + 1 ? cuts[k].from : own[k + 1];
    }
    CornerCopies copies;
    copies.copy_of_part = {0};
    for (std::size_t k = 0; k < cuts.size(); ++k) {
        const int piece = static_cast<int>(k) + 1;
        int& parent = copies.copy_of_part[static_cast<std::size_t>(cuts[k].from)];
        const bool moves = own[k + 1] == piece;
        copies.levels.push_back({.parent = parent, .side = moves ? -1 : 1});
        const int of_piece = moves ? parent : piece;
        if (moves) parent = piece;
        copies.copy_of_part.push_back(of_piece);
    }
    return copies;
}

Matrix change_of_basis(const CutElement& cut, Enrichment enrichment) {
    const auto parts = static_cast<Index>(cut.parts.size());
    const auto corners = static_cast<Index>(cut.element.corners);
    Matrix change = Matrix::Identity(corners * parts, corners * parts);
    if (enrichment == Enrichment::substituted) return change;
    for (Index corner = 0; corner < corners; ++corner) {
        const CornerCopies copies = corner_copies(cut.cuts, cut.corner_parts[static_cast<std::size_t>(corner)]);
        auto block = change.block(corner * parts, corner * parts, parts, parts);
        for (Index level = 0; level < parts; ++level) {
            std::vector<mesh::Point> values(static_cast<std::size_t>(parts), mesh::Point{});
            values[static_cast<std::size_t>(level)][0] = 1;
            enriched_to_copies(enrichment, copies.levels, values);
            for (Index part = 0; part < parts; ++part) {
                const int copy = copies.copy_of_part[static_cast<std::size_t>(part)];
                block(part, level) = values[static_cast<std::size_t>(copy)][0];
            }
        }
    }
    return change;
}

/// Adds T_p^T A T_p to `sum`, with T_p the rows of the change of basis that give the copies of part p.
void add_part(Matrix& sum, const Matrix& change, const Matrix& matrix, Index part, Index parts, Index axes) {
    const Index corners = change.rows() / parts;
    Matrix rows(corners, change.cols());
    for (Index corner = 0; corner < corners; ++corner) rows.row(corner) = change.row(corner * parts + part);
    const Matrix all = for_axes(rows, axes);
    sum += all.transpose() * matrix * all;
}

Matrix stiffness_of(const CutElement& cut, const Matrix& change) {
    const Index axes = cut.element.axes;
    const auto parts = static_cast<Index>(cut.parts.size());
    const Matrix whole = matrix_of(cut.element.stiffness);
    Matrix stiffness = Matrix::Zero(change.rows() * axes, change.cols() * axes);
    for (Index p = 0; p < parts; ++p) {
        add_part(stiffness, change, cut.parts[static_cast<std::size_t>(p)].fraction * whole, p, parts, axes);
    }
    return stiffness;
}

/// For one axis: the consistent mass, or, in its place, the fraction-lumped one.
Matrix mass_of_parts(const CutElement& cut, const Matrix& change, bool is_consistent) {
    const auto parts = static_cast<Index>(cut.parts.size());
    const Index corners = cut.element.corners;
    Matrix mass = Matrix::Zero(change.rows(), change.cols());
    for (Index p = 0; p < parts; ++p) {
        const StudyPart& part = cut.parts[static_cast<std::size_t>(p)];
        const Matrix shares = Matrix::Identity(corners, corners) * (part.fraction / static_cast<double>(corners));
        add_part(mass, change, is_consistent ? matrix_of(part.second) : shares, p, parts, 1);
    }
    return mass;
}

/// The entries of one level, or of one part in the substituted basis: every `parts`-th row and column.
Matrix level_of(const Matrix& matrix, Index level, Index parts) {
    const Index corners = matrix.rows() / parts;
    Matrix result(corners, corners);
    for (Index i = 0; i < corners; ++i) {
        for (Index j = 0; j < corners; ++j) result(i, j) = matrix(i * parts + level, j * parts + level);
    }
    return result;
}

/// For one axis.
Matrix mass_of(const CutElement& cut, Enrichment enrichment, StudyLumping lumping, const Matrix& change) {
    const bool is_consistent = lumping != StudyLumping::fraction && lumping != StudyLumping::enrichment;
    const Matrix mass = mass_of_parts(cut, change, is_consistent);
    if (lumping == StudyLumping::consistent || lumping == StudyLumping::fraction) return mass;
    if (lumping == StudyLumping::enrichment) return mass.diagonal().asDiagonal();
    const auto parts = static_cast<Index>(cut.parts.size());
    VectorXd lumped(mass.rows());
    for (Index level = 0; level < parts; ++level) {
        const Matrix own = level_of(mass, level, parts);
        VectorXd sums = own.rowwise().sum();
        if (lumping == StudyLumping::weighted_diagonal) {
            const bool is_part = enrichment == Enrichment::substituted;
            const double total = is_part ? cut.parts[static_cast<std::size_t>(level)].fraction : 1.0;
            sums = own.diagonal() * (total / own.trace());
        }
        for (Index corner = 0; corner < own.rows(); ++corner) lumped(corner * parts + level) = sums(corner);
    }
    return lumped.asDiagonal();
}

/// The largest eigenvalue of M^-1 K, by M^-1/2 K M^-1/2 scaled first with the diagonal of M: slivers make entries of
/// very different size, which scaling removes without rounding to speak of.
double largest_eigenvalue(const Matrix& stiffness, const Matrix& mass) {
    const VectorXd scale = mass.diagonal().cwiseSqrt().cwiseInverse();
    const Eigen::MatrixXd k = scale.asDiagonal() * stiffness * scale.asDiagonal();
    const Eigen::MatrixXd m = scale.asDiagonal() * mass * scale.asDiagonal();
    if (!k.allFinite() || !m.allFinite()) return std::nan("");
    if (mass.isDiagonal(0)) {
        return Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(k, Eigen::EigenvaluesOnly).eigenvalues().maxCoeff();
    }
    return Eigen::GeneralizedSelfAdjointEigenSolver<Eigen::MatrixXd>(k, m, Eigen::EigenvaluesOnly)
        .eigenvalues()
        .maxCoeff();
}

double largest_eigenvalue(const CutElement& cut, Enrichment enrichment, StudyLumping lumping) {
    const Index axes = cut.element.axes;
    if (lumping != StudyLumping::consistent && lumping != StudyLumping::fraction) {
        const Matrix change = change_of_basis(cut, enrichment);
        return largest_eigenvalue(stiffness_of(cut, change), for_axes(mass_of(cut, enrichment, lumping, change), axes));
    }
    // (T^T K T, T^T M T) has the eigenvalues of (K, M), and in the substituted basis the parts are apart. With slivers
    // the mass in an enriched basis is singular to rounding: the eigenvalues are taken where they are well-conditioned.
    const Matrix whole = matrix_of(cut.element.stiffness);
    double largest = 0;
    for (const StudyPart& part : cut.parts) {
        const Matrix shares = Matrix::Identity(cut.element.corners, cut.element.corners) *
                              (part.fraction / static_cast<double>(cut.element.corners));
        const Matrix mass = lumping == StudyLumping::consistent ? matrix_of(part.second) : shares;
        const double eigenvalue = largest_eigenvalue(part.fraction * whole, for_axes(mass, axes));
        if (std::isnan(eigenvalue)) return eigenvalue;
        largest = std::max(largest, eigenvalue);
    }
    return largest;
}

}  // namespace

std::string_view to_string(StudyLumping lumping) noexcept {
    switch (lumping) {
        case StudyLumping::enrichment:
            return "enrichment";
        case StudyLumping::row_sum:
            return "row-sum";
        case StudyLumping::weighted_diagonal:
            return "weighted-diagonal";
        case StudyLumping::consistent:
            return "consistent";
        case StudyLumping::fraction:
            break;
    }
    return "fraction";
}

StudyMatrices assemble(const CutElement& cut, Enrichment enrichment, StudyLumping lumping) {
    validate(cut);
    const Matrix change = change_of_basis(cut, enrichment);
    const Matrix stiffness = stiffness_of(cut, change);
    return {.size = static_cast<int>(stiffness.rows()),
            .stiffness = values_of(stiffness),
            .mass = values_of(for_axes(mass_of(cut, enrichment, lumping, change), cut.element.axes))};
}

std::vector<double> copies_of_enriched(const CutElement& cut, Enrichment enrichment) {
    validate(cut);
    return values_of(change_of_basis(cut, enrichment));
}

double critical_step_ratio(const CutElement& cut, Enrichment enrichment, StudyLumping lumping) {
    validate(cut);
    const Index unknowns = static_cast<Index>(cut.element.corners) * cut.element.axes;
    const Matrix whole_mass = Matrix::Identity(unknowns, unknowns) / static_cast<double>(cut.element.corners);
    const double whole = largest_eigenvalue(matrix_of(cut.element.stiffness), whole_mass);
    return std::sqrt(whole / largest_eigenvalue(cut, enrichment, lumping));
}

}  // namespace lancet::runtime
