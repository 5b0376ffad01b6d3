#pragma once

#include <cstddef>
#include <vector>

#include "lancet/runtime/integrate/consistent_mass.hpp"

namespace lancet::runtime {

/// The mass matrix M of a body, lumped or consistent.
struct Inertia {
    std::vector<double> row_sums;  ///< [internal node], kilograms
    ConsistentMass consistent{};   ///< what M has beside its row sums; empty for a lumped mass

    /// A component of M v at a free node, where value(node) is that component of v.
    template <class Value>
    double momentum(std::size_t node, const Value& value) const {
        const double lumped = row_sums[node] * value(node);
        return consistent.empty() ? lumped : lumped + consistent.off_diagonal(node, value);
    }
};

}  // namespace lancet::runtime
