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
        const int block = numbering.is_free(sorted[e][0]) ? numbering.block_of(sorted[e][0]) : numbering.blocks() - 1;
        elements[static_cast<std::size_t>(block)].push_back(static_cast<std::int32_t>(e));
    }
    for (std::vector<std::int32_t>& block : elements) {
        std::sort(block.begin(), block.end(),
                  [&](auto a, auto b) { return sorted[a] != sorted[b] ? sorted[a] < sorted[b] : a < b; });
    }
    return elements;
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
           heap_bytes(mass) + heap_bytes(pair_mass) + heap_bytes(slot_of_element) + scatter.bytes();
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
    const auto total = static_cast<std::size_t>(batches.batches());
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
                const double volume = fractions.empty() ? geometry.volume : fractions[e] * geometry.volume;
                const ElasticParameters& material = parameters[regions[e]];
                if (!is_padding) batches.slot_of_element[e] = static_cast<std::int32_t>(batch * lanes + lane);
                for (std::size_t corner = 0; corner < 4; ++corner) {
                    const std::int32_t node = numbering.internal_of_user[tetrahedra[e][corner]];
                    batches.nodes[(batch * 4 + corner) * lanes + lane] = 4 * node;
                    batches.targets[(batch * 4 + corner) * lanes + lane] =
                        4 * (is_padding ? batches.scatter.unused(static_cast<int>(block))
                                        : batches.scatter.target(static_cast<int>(block), node));
                }
                Real* rest = &batches.rest[batch * ElementBatches<Real>::rest_entries * lanes + lane];
                for (std::size_t entry = 0; entry < 9; ++entry) {
                    rest[entry * lanes] = static_cast<Real>(geometry.gradients[1 + entry / 3][entry % 3]);
                }
                rest[9 * lanes] = is_padding ? Real(0) : static_cast<Real>(std::sqrt(volume * material.mu));
                rest[10 * lanes] = static_cast<Real>(material.lambda / material.mu);
                batches.mass[batch * lanes + lane] =
                    is_padding ? Real(0) : static_cast<Real>(material.density * volume);
            }
        }
    }
    batches.scatter.finish();
    return batches;
}

template <class Real>
void set_pair_masses(ElementBatches<Real>& batches, std::span<const std::array<double, 6>> of_element) {
    const auto lanes = static_cast<std::size_t>(batches.width);
    batches.pair_mass.assign(static_cast<std::size_t>(batches.slots()) * 6, Real(0));
    for (std::size_t e = 0; e < of_element.size(); ++e) {
        if (batches.slot_of_element[e] < 0) continue;  // a body without free nodes has no batches
        const auto slot = static_cast<std::size_t>(batches.slot_of_element[e]);
        for (std::size_t pair = 0; pair < 6; ++pair) {
            batches.pair_mass[(slot / lanes * 6 + pair) * lanes + slot % lanes] =
                static_cast<Real>(of_element[e][pair]);
        }
    }
}

template struct ElementBatches<float>;
template struct ElementBatches<double>;
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
