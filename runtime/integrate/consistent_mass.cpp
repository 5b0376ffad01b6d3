#include "lancet/runtime/integrate/consistent_mass.hpp"

#include <map>

namespace lancet::runtime {

template <class Real>
ConsistentMass::ConsistentMass(const kernels::ElementBatches<Real>& batches,
                               std::span<const kernels::Tetrahedron> tetrahedra,
                               const kernels::NodeNumbering& numbering) {
    std::vector<std::map<std::int32_t, double>> rows(static_cast<std::size_t>(numbering.free_count));
    for (std::size_t e = 0; e < tetrahedra.size(); ++e) {
        if (batches.slot_of_element[e] < 0) continue;  // a body without free nodes has no batches
        const double mass = static_cast<double>(batches.mass[batches.slot_of_element[e]]) / 20;
        for (const std::int32_t i : tetrahedra[e]) {
            const std::int32_t row = numbering.internal_of_user[i];
            if (!numbering.is_free(row)) continue;
            for (const std::int32_t j : tetrahedra[e]) {
                if (i != j) rows[row][numbering.internal_of_user[j]] += mass;
            }
        }
    }
    begin_.push_back(0);
    for (const auto& row : rows) {
        for (const auto& [column, mass] : row) {
            column_.push_back(column);
            mass_.push_back(mass);
        }
        begin_.push_back(static_cast<std::int32_t>(column_.size()));
    }
    column_.shrink_to_fit();
    mass_.shrink_to_fit();
}

std::size_t ConsistentMass::bytes() const noexcept {
    using kernels::heap_bytes;
    return heap_bytes(begin_) + heap_bytes(column_) + heap_bytes(mass_);
}

template ConsistentMass::ConsistentMass(const kernels::ElementBatches<float>&, std::span<const kernels::Tetrahedron>,
                                        const kernels::NodeNumbering&);
template ConsistentMass::ConsistentMass(const kernels::ElementBatches<double>&, std::span<const kernels::Tetrahedron>,
                                        const kernels::NodeNumbering&);

}  // namespace lancet::runtime
