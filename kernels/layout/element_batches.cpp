#include "lancet/kernels/layout/element_batches.hpp"

#include <algorithm>
#include <cmath>

namespace lancet::kernels {

namespace {

Point subtract(const Point& a, const Point& b) {
    return {a[0] - b[0], a[1] - b[1], a[2] - b[2]};
}

Point cross(const Point& a, const Point& b) {
    return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}

/// The elements of each block, in the order of their nodes. An element belongs to the block of its first node.
std::vector<std::vector<std::int32_t>> elements_of_blocks(std::span<const Tetrahedron> tetrahedra,
                                                          const NodeNumbering& numbering) {
    std::vector<std::vector<std::int32_t>> elements(static_cast<std::size_t>(std::max(numbering.blocks(), 0)));
    std::vector<Tetrahedron> sorted(tetrahedra.size());
    for (std::size_t e = 0; e < tetrahedra.size(); ++e) {
        for (std::size_t corner = 0; corner < 4; ++corner) {
            sorted[e][corner] = numbering.internal_of_user[tetrahedra[e][corner]];
        }
        std::sort(sorted[e].begin(), sorted[e].end());
        if (elements.empty()) continue;
        const int block =
            numbering.is_free(sorted[e][0]) ? numbering.block_of(sorted[e][0]) : numbering.first_blocks() - 1;
        elements[static_cast<std::size_t>(block)].push_back(static_cast<std::int32_t>(e));
    }
    for (std::vector<std::int32_t>& block : elements) {
        std::sort(block.begin(), block.end(),
                  [&](auto a, auto b) { return sorted[a] != sorted[b] ? sorted[a] < sorted[b] : a < b; });
    }
    return elements;
}

/// Everything of an element but its nodes and where it scatters; fraction 0: no element.
template <class Real>
void write_rest(ElementBatches<Real>& batches, std::size_t slot, const TetrahedronGeometry& geometry,
                const ElasticParameters& material, double fraction) {
    const auto lanes = static_cast<std::size_t>(batches.width);
    const double volume = fraction * geometry.volume;
    Real* rest = &batches.rest[slot / lanes * ElementBatches<Real>::rest_entries * lanes + slot % lanes];
    for (std::size_t entry = 0; entry < 9; ++entry) {
        rest[entry * lanes] = static_cast<Real>(geometry.gradients[1 + entry / 3][entry % 3]);
    }
    rest[9 * lanes] = static_cast<Real>(std::sqrt(volume * material.mu));
    rest[10 * lanes] = static_cast<Real>(material.lambda / material.mu);
    batches.mass[slot] = static_cast<Real>(material.density * volume);
}

template <class Real>
void write_pair_masses(ElementBatches<Real>& batches, std::size_t slot, const std::array<double, 6>& masses) {
    if (batches.pair_mass.empty()) return;
    const auto lanes = static_cast<std::size_t>(batches.width);
    for (std::size_t pair = 0; pair < 6; ++pair) {
        batches.pair_mass[(slot / lanes * 6 + pair) * lanes + slot % lanes] = static_cast<Real>(masses[pair]);
    }
}

template <class Real>
std::size_t corner_place(const ElementBatches<Real>& batches, std::int32_t slot, std::size_t corner) {
    const auto lanes = static_cast<std::size_t>(batches.width), at = static_cast<std::size_t>(slot);
    return (at / lanes * 4 + corner) * lanes + at % lanes;
}

template <class Real>
int block_of_slot(const ElementBatches<Real>& batches, std::int32_t slot) {
    const auto& begin = batches.block_batch_begin;
    return static_cast<int>(std::upper_bound(begin.begin(), begin.end(), slot / batches.width) - begin.begin()) - 1;
}

}  // namespace

TetrahedronGeometry tetrahedron_geometry(std::span<const Point> positions, const Tetrahedron& element) {
    const Point& origin = positions[element[0]];
    const Point a = subtract(positions[element[1]], origin), b = subtract(positions[element[2]], origin),
                c = subtract(positions[element[3]], origin);
    const Point bc = cross(b, c), ca = cross(c, a), ab = cross(a, b);
    const double determinant = a[0] * bc[0] + a[1] * bc[1] + a[2] * bc[2];
    TetrahedronGeometry geometry{};
    geometry.volume = determinant / 6;
    for (std::size_t axis = 0; axis < 3; ++axis) {
        geometry.gradients[1][axis] = bc[axis] / determinant;
        geometry.gradients[2][axis] = ca[axis] / determinant;
        geometry.gradients[3][axis] = ab[axis] / determinant;
        geometry.gradients[0][axis] =
            -(geometry.gradients[1][axis] + geometry.gradients[2][axis] + geometry.gradients[3][axis]);
    }
    return geometry;
}

template <class Real>
std::size_t ElementBatches<Real>::bytes() const noexcept {
    return heap_bytes(block_batch_begin) + heap_bytes(nodes) + heap_bytes(targets) + heap_bytes(rest) +
           heap_bytes(mass) + heap_bytes(pair_mass) + heap_bytes(slot_of_element) + heap_bytes(free_slots) +
           scatter.bytes();
}

template <class Real>
ElementBatches<Real> make_element_batches(std::span<const Point> positions, std::span<const Tetrahedron> tetrahedra,
                                          std::span<const std::int32_t> regions,
                                          std::span<const ElasticParameters> parameters, const NodeNumbering& numbering,
                                          ScatterStrategy strategy, int width, std::span<const double> fractions) {
    ElementBatches<Real> batches;
    batches.width = width;
    batches.scatter = ScatterPlan(strategy, numbering);
    batches.slot_of_element.assign(tetrahedra.size(), -1);
    const auto lanes = static_cast<std::size_t>(width);

    const std::vector<std::vector<std::int32_t>> elements = elements_of_blocks(tetrahedra, numbering);
    batches.block_batch_begin.push_back(0);
    for (const std::vector<std::int32_t>& block : elements) {
        const int count = static_cast<int>((block.size() + lanes - 1) / lanes);
        batches.block_batch_begin.push_back(batches.block_batch_begin.back() + count);
    }
    // A node of the room comes with the parts of some elements around it.
    const int spare_elements = 8 * (numbering.free_count - numbering.spare_begin);
    batches.capacity = batches.batches() + (spare_elements + width - 1) / width;
    const auto total = static_cast<std::size_t>(batches.capacity);
    batches.nodes.resize(total * 4 * lanes);
    batches.targets.resize(total * 4 * lanes);
    batches.rest.resize((total + 1) * ElementBatches<Real>::rest_entries *
                        lanes);  // one batch of zeros behind the last
    batches.mass.resize(total * lanes);

    for (std::size_t block = 0; block < elements.size(); ++block) {
        const auto begin = static_cast<std::size_t>(batches.block_batch_begin[block]);
        const auto count = static_cast<std::size_t>(batches.block_batch_begin[block + 1]) - begin;
        for (std::size_t batch = begin; batch < begin + count; ++batch) {
            for (std::size_t lane = 0; lane < lanes; ++lane) {
                const std::size_t place = lane * count + (batch - begin);
                const bool is_padding = place >= elements[block].size();
                const std::int32_t e = is_padding ? elements[block].front() : elements[block][place];
                const TetrahedronGeometry geometry = tetrahedron_geometry(positions, tetrahedra[e]);
                if (!is_padding) batches.slot_of_element[e] = static_cast<std::int32_t>(batch * lanes + lane);
                for (std::size_t corner = 0; corner < 4; ++corner) {
                    const std::int32_t node = numbering.internal_of_user[tetrahedra[e][corner]];
                    batches.nodes[(batch * 4 + corner) * lanes + lane] = 4 * node;
                    batches.targets[(batch * 4 + corner) * lanes + lane] =
                        4 * (is_padding ? batches.scatter.unused(static_cast<int>(block))
                                        : batches.scatter.target(static_cast<int>(block), node));
                }
                write_rest(batches, batch * lanes + lane, geometry, parameters[regions[e]],
                           is_padding          ? 0
                           : fractions.empty() ? 1
                                               : fractions[e]);
            }
        }
    }
    batches.scatter.finish();
    return batches;
}

template <class Real>
std::int32_t take_slot(ElementBatches<Real>& batches, const ChangedElement& element) {
    if (!batches.free_slots.empty()) {
        const std::int32_t slot = batches.free_slots.back();
        batches.free_slots.pop_back();
        return slot;
    }
    if (batches.batches() == batches.capacity) return -1;
    // A new batch: lanes without an element repeat this one, without weight.
    const auto block = batches.block_batch_begin.size() - 2;
    const std::int32_t first = batches.block_batch_begin.back()++ * batches.width;
    for (std::int32_t slot = first; slot < first + batches.width; ++slot) {
        clear_slot(batches, slot);
        write_rest(batches, static_cast<std::size_t>(slot), element.geometry, element.material, 0);
        for (std::size_t corner = 0; corner < 4; ++corner) {
            batches.nodes[corner_place(batches, slot, corner)] = 4 * element.nodes[corner];
            batches.targets[corner_place(batches, slot, corner)] =
                4 * batches.scatter.unused_slot(static_cast<int>(block));
        }
    }
    // clear_slot has given all of them back, in ascending order.
    std::reverse(batches.free_slots.begin(), batches.free_slots.end());
    batches.free_slots.pop_back();
    return first;
}

template <class Real>
bool set_element(ElementBatches<Real>& batches, const NodeNumbering& numbering, std::int32_t slot,
                 const ChangedElement& element) {
    const int block = block_of_slot(batches, slot);
    for (std::size_t corner = 0; corner < 4; ++corner) {
        const std::int32_t target = batches.scatter.changed_target(numbering, block, element.nodes[corner]);
        if (target < 0) return false;
        batches.nodes[corner_place(batches, slot, corner)] = 4 * element.nodes[corner];
        batches.targets[corner_place(batches, slot, corner)] = 4 * target;
    }
    write_rest(batches, static_cast<std::size_t>(slot), element.geometry, element.material, element.fraction);
    write_pair_masses(batches, static_cast<std::size_t>(slot), element.pair_masses);
    return true;
}

template <class Real>
void clear_slot(ElementBatches<Real>& batches, std::int32_t slot) {
    const auto lanes = static_cast<std::size_t>(batches.width), at = static_cast<std::size_t>(slot);
    const int block = block_of_slot(batches, slot);
    batches.rest[(at / lanes * ElementBatches<Real>::rest_entries + 9) * lanes + at % lanes] = Real(0);
    batches.mass[at] = Real(0);
    write_pair_masses(batches, at, {});
    for (std::size_t corner = 0; corner < 4; ++corner) {
        batches.targets[corner_place(batches, slot, corner)] = 4 * batches.scatter.unused_slot(block);
    }
    if (block + 2 == static_cast<int>(batches.block_batch_begin.size())) batches.free_slots.push_back(slot);
}

template <class Real>
Tetrahedron nodes_of_slot(const ElementBatches<Real>& batches, std::int32_t slot) {
    Tetrahedron nodes{};
    for (std::size_t corner = 0; corner < 4; ++corner) {
        nodes[corner] = batches.nodes[corner_place(batches, slot, corner)] / 4;
    }
    return nodes;
}

template <class Real>
void set_pair_masses(ElementBatches<Real>& batches, std::span<const std::array<double, 6>> of_element) {
    batches.pair_mass.assign(static_cast<std::size_t>(batches.slots()) * 6, Real(0));
    for (std::size_t e = 0; e < of_element.size(); ++e) {
        if (batches.slot_of_element[e] < 0) continue;  // a body without free nodes has no batches
        write_pair_masses(batches, static_cast<std::size_t>(batches.slot_of_element[e]), of_element[e]);
    }
}

template struct ElementBatches<float>;
template std::int32_t take_slot<float>(ElementBatches<float>&, const ChangedElement&);
template bool set_element<float>(ElementBatches<float>&, const NodeNumbering&, std::int32_t, const ChangedElement&);
template void clear_slot<float>(ElementBatches<float>&, std::int32_t);
template Tetrahedron nodes_of_slot<float>(const ElementBatches<float>&, std::int32_t);
template struct ElementBatches<double>;
template std::int32_t take_slot<double>(ElementBatches<double>&, const ChangedElement&);
template bool set_element<double>(ElementBatches<double>&, const NodeNumbering&, std::int32_t, const ChangedElement&);
template void clear_slot<double>(ElementBatches<double>&, std::int32_t);
template Tetrahedron nodes_of_slot<double>(const ElementBatches<double>&, std::int32_t);
template void set_pair_masses<float>(ElementBatches<float>&, std::span<const std::array<double, 6>>);
template void set_pair_masses<double>(ElementBatches<double>&, std::span<const std::array<double, 6>>);
template ElementBatches<float> make_element_batches<float>(std::span<const Point>, std::span<const Tetrahedron>,
                                                           std::span<const std::int32_t>,
                                                           std::span<const ElasticParameters>, const NodeNumbering&,
                                                           ScatterStrategy, int, std::span<const double>);
template ElementBatches<double> make_element_batches<double>(std::span<const Point>, std::span<const Tetrahedron>,
                                                             std::span<const std::int32_t>,
                                                             std::span<const ElasticParameters>, const NodeNumbering&,
                                                             ScatterStrategy, int, std::span<const double>);

}  // namespace lancet::kernels
