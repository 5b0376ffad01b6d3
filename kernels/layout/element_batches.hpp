#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "lancet/kernels/layout/aligned_vector.hpp"
#include "lancet/kernels/layout/node_numbering.hpp"
#include "lancet/kernels/layout/scatter_plan.hpp"

namespace lancet::kernels {

/// The Lame parameters and the density of an isotropic material, in SI units.
struct ElasticParameters {
    double lambda = 0;
    double mu = 0;
    double density = 0;
};

/// Gradients of the four shape functions and the volume of a linear tetrahedron.
struct TetrahedronGeometry {
    std::array<Point, 4> gradients;
    double volume;
};
TetrahedronGeometry tetrahedron_geometry(std::span<const Point> positions, const Tetrahedron& element);

/// Linear tetrahedra in batches of `width` lanes. A lane of the last batch of a block that has no element of its own
/// repeats one with weight zero. The lanes of a batch come from distant places of the block, since lanes that share
/// nodes wait for each other when they are scattered.
template <class Real>
struct ElementBatches {
    /// Numbers per lane of `rest`: the gradients of the shape functions of corners 1, 2, 3 (row by row; that of corner
    /// 0 is minus their sum), sqrt(v V mu) with v the fraction that is there and lambda / mu.
    static constexpr int rest_entries = 11;

    int width = 1;
    std::vector<std::int32_t> block_batch_begin;  ///< first batch of each block, and the end
    AlignedVector<std::int32_t> nodes;            ///< [batch][corner][lane] 4 * node, its place in a nodal vector
    AlignedVector<std::int32_t> targets;          ///< [batch][corner][lane] 4 * target in the buffer of `scatter`
    AlignedVector<Real> rest;                     ///< [batch][entry][lane]
    AlignedVector<Real> mass;                     ///< [batch][lane] rho v V, zero in padding
    AlignedVector<Real> pair_mass;  ///< [batch][pair of corners][lane] int rho phi_i phi_j, for a consistent mass; or
                                    ///< empty
    std::vector<std::int32_t> slot_of_element;  ///< batch * width + lane of each element of the mesh
    ScatterPlan scatter;
    int capacity = 0;  ///< batches that there is room for: the last block of a numbering with room grows into it
    std::vector<std::int32_t> free_slots{};  ///< of elements that came into the room and went again

    int batches() const noexcept { return block_batch_begin.empty() ? 0 : block_batch_begin.back(); }
    std::int32_t slots() const noexcept { return capacity * width; }
    std::size_t bytes() const noexcept;
};

/// Lays the elements out.
/// - positions, tetrahedra: the mesh at rest, in the user's numbering
/// - parameters: of each element's region, `regions` one per element
/// - fractions: how much of each element is there, for parts of cut ones; empty: all of each
template <class Real>
ElementBatches<Real> make_element_batches(std::span<const Point> positions, std::span<const Tetrahedron> tetrahedra,
                                          std::span<const std::int32_t> regions,
                                          std::span<const ElasticParameters> parameters, const NodeNumbering& numbering,
                                          ScatterStrategy strategy, int width, std::span<const double> fractions = {});

/// An element as it is laid out later than the others.
struct ChangedElement {
    Tetrahedron nodes{};  ///< internal numbers
    TetrahedronGeometry geometry{};
    ElasticParameters material{};
    double fraction = 1;
    std::array<double, 6> pair_masses{};  ///< for a consistent mass
};

/// A slot for a further element, in the room that the numbering left; -1 where there is none.
template <class Real>
std::int32_t take_slot(ElementBatches<Real>& batches, const ChangedElement& element);
/// Lays an element out in a slot. False where its block has no room for the private copy of one of its nodes.
/// `batches.scatter` must be told when all changes are made (ScatterPlan::finish_changes).
template <class Real>
bool set_element(ElementBatches<Real>& batches, const NodeNumbering& numbering, std::int32_t slot,
                 const ChangedElement& element);
/// Takes the element out of a slot, which is free then if it is in the room.
template <class Real>
void clear_slot(ElementBatches<Real>& batches, std::int32_t slot);
/// The internal numbers of an element's nodes.
template <class Real>
Tetrahedron nodes_of_slot(const ElementBatches<Real>& batches, std::int32_t slot);

/// The pairs of corners of a tetrahedron, in the order in which their numbers are kept.
inline constexpr std::array<std::array<std::size_t, 2>, 6> corner_pairs{
    {{0, 1}, {0, 2}, {0, 3}, {1, 2}, {1, 3}, {2, 3}}};
/// The place of a pair of different corners in corner_pairs.
constexpr std::size_t pair_of_corners(std::size_t i, std::size_t j) noexcept {
    return (i < j ? i : j) == 0 ? i + j - 1 : i + j;
}

/// Lays out the masses int rho phi_i phi_j of the pairs of corners of each element, kilograms.
template <class Real>
void set_pair_masses(ElementBatches<Real>& batches, std::span<const std::array<double, 6>> of_element);

}  // namespace lancet::kernels
