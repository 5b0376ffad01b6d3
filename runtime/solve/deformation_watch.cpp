#include "lancet/runtime/solve/deformation_watch.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "lancet/kernels/layout/aligned_vector.hpp"

namespace lancet::runtime {

template <class Real>
DeformationWatch::DeformationWatch(const kernels::ElementBatches<Real>& batches,
                                   const kernels::NodeNumbering& numbering)
    : blocks_(static_cast<std::size_t>(numbering.blocks())) {
    for (int block = 0; block < numbering.blocks(); ++block) change(batches, numbering, block);
}

template <class Real>
void DeformationWatch::change(const kernels::ElementBatches<Real>& batches, const kernels::NodeNumbering& numbering,
                              int block) {
    Block& of = blocks_[static_cast<std::size_t>(block)];
    of = {};
    const auto width = static_cast<std::size_t>(batches.width);
    for (auto batch = static_cast<std::size_t>(batches.block_batch_begin[static_cast<std::size_t>(block)]);
         batch < static_cast<std::size_t>(batches.block_batch_begin[static_cast<std::size_t>(block) + 1]); ++batch) {
        const Real* rest = &batches.rest[batch * kernels::ElementBatches<Real>::rest_entries * width];
        for (std::size_t lane = 0; lane < width; ++lane) {
            // Padding has no weight.
            if (rest[9 * width + lane] == 0) continue;
            double square = 0;
            for (std::size_t k = 0; k < 9; ++k) {
                square += static_cast<double>(rest[k * width + lane]) * static_cast<double>(rest[k * width + lane]);
            }
            // |b_1| + |b_2| + |b_3| <= sqrt(3 (|b_1|^2 + |b_2|^2 + |b_3|^2)).
            of.reach = std::max(of.reach, std::sqrt(3 * square));
            for (std::size_t corner = 0; corner < 4; ++corner) {
                of.nodes.push_back(batches.nodes[(batch * 4 + corner) * width + lane] / 4);
            }
        }
    }
    std::ranges::sort(of.nodes);
    of.nodes.erase(std::unique(of.nodes.begin(), of.nodes.end()), of.nodes.end());
    of.places.resize(3 * of.nodes.size());
    for (const std::int32_t node : of.nodes) {
        if (!numbering.is_free(node)) break;  // and neither are those behind it
        const int owner = numbering.block_of(node);
        if (of.touched.empty() || of.touched.back() != owner) of.touched.push_back(owner);
    }
}

bool DeformationWatch::has_changed(int block, const double* positions, double bound) {
    const Block& of = blocks_[static_cast<std::size_t>(block)];
    if (of.is_known) {
        std::array<double, 3> lowest{}, highest{};
        lowest.fill(std::numeric_limits<double>::infinity());
        highest.fill(-std::numeric_limits<double>::infinity());
        double sum = 0;  // not a number where one of them is none
        for (std::size_t k = 0; k < of.nodes.size(); ++k) {
            const double* at = positions + 4 * static_cast<std::ptrdiff_t>(of.nodes[k]);
            for (std::size_t axis = 0; axis < 3; ++axis) {
                const double moved = at[axis] - of.places[3 * k + axis];
                lowest[axis] = std::min(lowest[axis], moved);
                highest[axis] = std::max(highest[axis], moved);
                sum += moved;
            }
        }
        const double extent = std::hypot(highest[0] - lowest[0], highest[1] - lowest[1], highest[2] - lowest[2]);
        if (std::isfinite(sum) && extent * of.reach <= bound) return false;
    }
    take_up(block, positions);
    return true;
}

void DeformationWatch::take_up(int block, const double* positions) {
    Block& of = blocks_[static_cast<std::size_t>(block)];
    for (std::size_t k = 0; k < of.nodes.size(); ++k) {
        std::copy_n(positions + 4 * static_cast<std::ptrdiff_t>(of.nodes[k]), 3, &of.places[3 * k]);
    }
    of.is_known = true;
}

void DeformationWatch::save(std::vector<double>& numbers) const {
    for (const Block& block : blocks_) {
        numbers.push_back(block.is_known ? 1 : 0);
        numbers.insert(numbers.end(), block.places.begin(), block.places.end());
    }
}

void DeformationWatch::restore(std::span<const double>& numbers) {
    for (Block& block : blocks_) {
        block.is_known = numbers[0] != 0;
        std::copy_n(numbers.begin() + 1, block.places.size(), block.places.begin());
        numbers = numbers.subspan(1 + block.places.size());
    }
}

std::size_t DeformationWatch::bytes() const noexcept {
    std::size_t bytes = kernels::heap_bytes(blocks_);
    for (const Block& block : blocks_) {
        bytes +=
            kernels::heap_bytes(block.nodes) + kernels::heap_bytes(block.places) + kernels::heap_bytes(block.touched);
    }
    return bytes;
}

template DeformationWatch::DeformationWatch(const kernels::ElementBatches<float>&, const kernels::NodeNumbering&);
template DeformationWatch::DeformationWatch(const kernels::ElementBatches<double>&, const kernels::NodeNumbering&);
template void DeformationWatch::change(const kernels::ElementBatches<float>&, const kernels::NodeNumbering&, int);
template void DeformationWatch::change(const kernels::ElementBatches<double>&, const kernels::NodeNumbering&, int);

}  // namespace lancet::runtime
