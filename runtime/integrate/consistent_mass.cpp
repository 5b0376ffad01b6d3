#include "lancet/runtime/integrate/consistent_mass.hpp"

#include <algorithm>
#include <map>
#include <utility>

namespace lancet::runtime {

template <class Real>
ConsistentMass::ConsistentMass(const kernels::ElementBatches<Real>& batches,
                               std::span<const kernels::Tetrahedron> tetrahedra,
                               const kernels::NodeNumbering& numbering) {
    std::vector<std::map<std::int32_t, double>> rows(static_cast<std::size_t>(numbering.free_count));
    for (std::size_t e = 0; e < tetrahedra.size(); ++e) {
        if (batches.slot_of_element[e] < 0) continue;  // a body without free nodes has no batches
        const auto slot = static_cast<std::size_t>(batches.slot_of_element[e]),
                   width = static_cast<std::size_t>(batches.width);
        for (std::size_t pair = 0; pair < 6; ++pair) {
            const auto mass = static_cast<double>(batches.pair_mass[(slot / width * 6 + pair) * width + slot % width]);
            const auto& [i, j] = kernels::corner_pairs[pair];
            const std::int32_t a = numbering.internal_of_user[tetrahedra[e][i]],
                               b = numbering.internal_of_user[tetrahedra[e][j]];
            if (numbering.is_free(a)) rows[a][b] += mass;
            if (numbering.is_free(b)) rows[b][a] += mass;
        }
    }
    for (const auto& row : rows) {
        begin_.push_back(static_cast<std::int32_t>(column_.size()));
        for (const auto& [column, mass] : row) {
            column_.push_back(column);
            mass_.push_back(mass);
        }
        end_.push_back(static_cast<std::int32_t>(column_.size()));
    }
    column_.shrink_to_fit();
    mass_.shrink_to_fit();
}

void ConsistentMass::set_row(std::int32_t node, std::span<const std::pair<std::int32_t, double>> row) {
    const auto at = static_cast<std::size_t>(node);
    unused_ += static_cast<std::size_t>(end_[at] - begin_[at]);
    begin_[at] = static_cast<std::int32_t>(column_.size());
    for (const auto& [column, mass] : row) {
        column_.push_back(column);
        mass_.push_back(mass);
    }
    end_[at] = static_cast<std::int32_t>(column_.size());
}

void ConsistentMass::compress() {
    if (2 * unused_ < column_.size()) return;
    std::vector<std::int32_t> columns;
    std::vector<double> masses;
    for (std::size_t node = 0; node < begin_.size(); ++node) {
        const std::int32_t begin = std::exchange(begin_[node], static_cast<std::int32_t>(columns.size()));
        columns.insert(columns.end(), column_.begin() + begin, column_.begin() + end_[node]);
        masses.insert(masses.end(), mass_.begin() + begin, mass_.begin() + end_[node]);
        end_[node] = static_cast<std::int32_t>(columns.size());
    }
    column_ = std::move(columns);
    mass_ = std::move(masses);
    unused_ = 0;
}

void ConsistentMass::solve(std::span<const double> row_sums, const kernels::NodeNumbering& numbering,
                           const ConstraintFilter& filter, const System& system) const {
    const std::size_t numbers = 4 * static_cast<std::size_t>(numbering.free_count);
    const std::span<double> r = system.residual, p = system.direction, q = system.product, x = system.solution;
    const auto filtered = [&](std::span<double> nodal) {
        for (int block = 0; block < numbering.blocks(); ++block) filter.apply(nodal.data(), block);
    };
    // q = S B r, with B the inverse of the row sums; returns r . B r. r and with it B r lie in the filter's range.
    const auto precondition = [&] {
        double product = 0;
        for (std::size_t i = 0; i < numbers; ++i) {
            q[i] = i % 4 < 3 && row_sums[i / 4] > 0 ? r[i] / row_sums[i / 4] : 0.0;
            product += q[i] * r[i];
        }
        return product;
    };
    std::fill(x.begin(), x.end(), 0.0);
    std::fill(p.begin(), p.end(), 0.0);
    filtered(r);
    double r_dot_z = precondition();
    const double reference = r_dot_z;
    constexpr int iterations = 60;
    constexpr double tolerance = 0x1p-104;  // of the squared norm
    double beta = 0;
    for (int iteration = 0; iteration < iterations && r_dot_z > tolerance * reference; ++iteration) {
        for (std::size_t i = 0; i < numbers; ++i) p[i] = q[i] + beta * p[i];
        for (std::size_t i = 0; i < numbers; ++i) {
            const std::size_t axis = i % 4;
            q[i] = axis == 3
                       ? 0.0
                       : row_sums[i / 4] * p[i] + off_diagonal(i / 4, [&](std::size_t j) { return p[4 * j + axis]; });
        }
        filtered(q);
        double curvature = 0;
        for (std::size_t i = 0; i < numbers; ++i) curvature += p[i] * q[i];
        const double alpha = r_dot_z / curvature;
        for (std::size_t i = 0; i < numbers; ++i) {
            x[i] += alpha * p[i];
            r[i] -= alpha * q[i];
        }
        const double previous = r_dot_z;
        r_dot_z = precondition();
        beta = r_dot_z / previous;
    }
}

std::size_t ConsistentMass::bytes() const noexcept {
    using kernels::heap_bytes;
    return heap_bytes(begin_) + heap_bytes(end_) + heap_bytes(column_) + heap_bytes(mass_);
}

template ConsistentMass::ConsistentMass(const kernels::ElementBatches<float>&, std::span<const kernels::Tetrahedron>,
                                        const kernels::NodeNumbering&);
template ConsistentMass::ConsistentMass(const kernels::ElementBatches<double>&, std::span<const kernels::Tetrahedron>,
                                        const kernels::NodeNumbering&);

}  // namespace lancet::runtime
