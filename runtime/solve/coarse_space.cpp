#include "lancet/runtime/solve/coarse_space.hpp"

#include <algorithm>
#include <limits>

#include "lancet/runtime/solve/aggregates.hpp"
#include "lancet/runtime/solve/coarse_factor.hpp"
#include "lancet/runtime/solve/coarse_matrix.hpp"
#include "lancet/runtime/solve/rigid_modes.hpp"

namespace lancet::runtime {

using Eigen::Vector3d;

template <class Real>
struct CoarseSpace<Real>::Parts {
    Parts(const kernels::KernelSet<Real>& kernels, const kernels::NodeNumbering& numbering,
          const BlockMatrix<Real>& block_edges)
        : edges(&block_edges),
          aggregates(numbering),
          modes(numbering, aggregates),
          matrix(kernels, block_edges, numbering, aggregates) {}

    const BlockMatrix<Real>* edges;
    Aggregates aggregates;
    RigidModes<Real> modes;
    CoarseMatrix<Real> matrix;
    CoarseFactor factor{};
};

template <class Real>
CoarseSpace<Real>::CoarseSpace(const kernels::KernelSet<Real>& kernels, const kernels::NodeNumbering& numbering,
                               const BlockMatrix<Real>& edges)
    : numbering_(&numbering), parts_(std::make_unique<Parts>(kernels, numbering, edges)) {
    lay_out();
}

template <class Real>
CoarseSpace<Real>::~CoarseSpace() = default;
template <class Real>
CoarseSpace<Real>::CoarseSpace(CoarseSpace&&) noexcept = default;

template <class Real>
void CoarseSpace<Real>::lay_out() {
    auto& [edges, aggregates, modes, matrix, factor] = *parts_;
    aggregates.choose_leaders(matrix.links());
    restricted_.assign(static_cast<std::size_t>(rigid_motions * aggregates.count()), 0.0);
    correction_.assign(restricted_.size(), Real(0));
    modes.resize(aggregates.count());
    matrix.resize(aggregates.count());
    factor.lay_out(aggregates.leader(), matrix.pairs());
}

template <class Real>
void CoarseSpace<Real>::change(std::span<const int> blocks) {
    auto& [edges, aggregates, modes, matrix, factor] = *parts_;
    const auto count = static_cast<std::size_t>(numbering_->blocks());
    // Where the aggregates of a block are others, so are the pairs of all blocks that border on it.
    std::vector<std::vector<int>> borders(count);
    for (std::size_t block = 0; block < count; ++block) borders[block] = matrix.borders(static_cast<int>(block));
    std::vector<bool> is_old(count);
    for (const int block : blocks) is_old[static_cast<std::size_t>(block)] = true;
    for (const int severed : aggregates.change(edges->pattern(), blocks)) {
        for (std::size_t block = 0; block < count; ++block) {
            is_old[block] = is_old[block] || std::ranges::find(borders[block], severed) != borders[block].end();
        }
    }
    for (std::size_t block = 0; block < count; ++block) {
        if (is_old[block]) matrix.take_up_edges(static_cast<int>(block));
    }
    is_fresh_ = false;
    lay_out();
}

template <class Real>
double CoarseSpace<Real>::change(Scheduler& scheduler, const double* positions) {
    return is_fresh_ ? parts_->modes.change(scheduler, positions) : std::numeric_limits<double>::infinity();
}

template <class Real>
bool CoarseSpace<Real>::refresh(Scheduler& scheduler, const double* positions, const Real* scaled_mass) {
    std::ranges::fill(restricted_, 0.0);
    parts_->modes.set(scheduler, positions);
    parts_->matrix.assemble(scheduler, parts_->modes.offset().data(), scaled_mass);
    is_fresh_ = true;
    return factorise();
}

template <class Real>
bool CoarseSpace<Real>::factorise() {
    const auto& [edges, aggregates, modes, matrix, factor] = *parts_;
    return parts_->factor.factorise({.diagonal = matrix.diagonal(), .pairs = matrix.pairs(), .basis = modes.basis()});
}

template <class Real>
void CoarseSpace<Real>::solve() {
    auto& [edges, aggregates, modes, matrix, factor] = *parts_;
    if (!factor.is_usable()) {
        std::fill(correction_.begin(), correction_.end(), Real(0));
        return;
    }
    // Forces on followers are about the centre of their leader already.
    aggregates.for_each_follower([&](std::int32_t follower, std::int32_t leader) {
        for (int k = 0; k < rigid_motions; ++k) {
            restricted_[rigid_motions * leader + k] += restricted_[rigid_motions * follower + k];
        }
    });
    factor.solve(modes.basis(), restricted_);
    for (std::size_t place = 0; place < factor.leaders().size(); ++place) {
        const RigidVector motion = factor.motion(modes.basis(), place);
        Real* correction = &correction_[rigid_motions * factor.leaders()[place]];
        for (int k = 0; k < rigid_motions; ++k) correction[k] = static_cast<Real>(motion[k]);
    }
    aggregates.for_each_follower([&](std::int32_t follower, std::int32_t leader) {
        std::copy_n(&correction_[rigid_motions * leader], rigid_motions, &correction_[rigid_motions * follower]);
    });
    for (int block = 0; block < numbering_->blocks(); ++block) {
        aggregates.for_each_piece(block, [&](std::int32_t number, const Aggregates::Piece& piece) {
            Real* motion = &correction_[rigid_motions * number];
            const Real* of_aggregate = &correction_[rigid_motions * piece.aggregate];
            for (int k = 0; k < rigid_motions; ++k) motion[k] -= of_aggregate[k];
        });
    }
}

template <class Real>
template <class Accumulate>
void CoarseSpace<Real>::restrict_to_pieces(const Accumulate* r, int block) {
    const Real* offset = parts_->modes.offset().data();
    parts_->aggregates.for_each_piece(block, [&](std::int32_t number, const Aggregates::Piece& piece) {
        Vector3d force = Vector3d::Zero(), torque = Vector3d::Zero();
        for (const std::int32_t node : piece.nodes) {
            const Vector3d f = nodal_vector(r, node);
            force += f;
            torque += nodal_vector(offset, node).cross(f);
        }
        double *of_piece = &restricted_[rigid_motions * number],
               *of_aggregate = &restricted_[rigid_motions * piece.aggregate];
        for (int axis = 0; axis < 3; ++axis) {
            of_piece[axis] = force[axis];
            of_piece[3 + axis] = torque[axis];
        }
        for (int k = 0; k < rigid_motions; ++k) of_aggregate[k] -= of_piece[k];
    });
}

template <class Real>
template <class Accumulate>
double CoarseSpace<Real>::move_pieces(const Accumulate* r, Real* z, int block) const {
    using Motion = Eigen::Matrix<Real, 3, 1>;
    const Real* offset = parts_->modes.offset().data();
    double product = 0;
    parts_->aggregates.for_each_piece(block, [&](std::int32_t number, const Aggregates::Piece& piece) {
        const Eigen::Map<const Motion> translation(&correction_[rigid_motions * number]),
            rotation(&correction_[rigid_motions * number + 3]);
        for (const std::int32_t node : piece.nodes) {
            const std::int64_t at = 4 * static_cast<std::int64_t>(node);
            const Motion motion = translation + rotation.cross(Eigen::Map<const Motion>(&offset[at]));
            for (int axis = 0; axis < 3; ++axis) {
                z[at + axis] += motion[axis];
                product += static_cast<double>(r[at + axis]) * static_cast<double>(motion[axis]);
            }
        }
    });
    return product;
}

template <class Real>
kernels::CoarseArguments<Real> CoarseSpace<Real>::arguments() noexcept {
    return {.block_aggregate_begin = numbering_->block_aggregate_begin.data(),
            .aggregate_begin = numbering_->aggregate_begin.data(),
            .offset = parts_->modes.offset().data(),
            .restricted = restricted_.data(),
            .correction = correction_.data()};
}

template <class Real>
int CoarseSpace<Real>::unknowns() const noexcept {
    return parts_->factor.unknowns();
}

template <class Real>
std::size_t CoarseSpace<Real>::bytes() const noexcept {
    const auto& [edges, aggregates, modes, matrix, factor] = *parts_;
    return aggregates.bytes() + modes.bytes() + matrix.bytes() + factor.bytes() + kernels::heap_bytes(restricted_) +
           kernels::heap_bytes(correction_);
}

template <class Real>
void CoarseSpace<Real>::save(std::vector<double>& numbers) const {
    const auto& [edges, aggregates, modes, matrix, factor] = *parts_;
    numbers.push_back(is_fresh_ ? 1 : 0);
    numbers.insert(numbers.end(), modes.offset().begin(), modes.offset().end());
    const auto append = [&](const RigidMatrix& block) {
        numbers.insert(numbers.end(), block.data(), block.data() + block.size());
    };
    for (const RigidMatrix& block : matrix.diagonal()) append(block);
    for (const RigidMatrix& block : modes.basis()) append(block);
    for (const auto& pairs : matrix.pairs()) {
        for (const AggregatePair& pair : pairs) append(pair.coupling);
    }
}

template <class Real>
void CoarseSpace<Real>::restore(std::span<const double>& numbers) {
    auto& [edges, aggregates, modes, matrix, factor] = *parts_;
    std::ranges::fill(restricted_, 0.0);
    std::size_t next = 0;
    is_fresh_ = numbers[next++] != 0;
    for (Real& number : modes.offset()) number = static_cast<Real>(numbers[next++]);
    const auto read = [&](RigidMatrix& block) {
        for (int i = 0; i < block.size(); ++i) block.data()[i] = numbers[next++];
    };
    for (RigidMatrix& block : matrix.diagonal()) read(block);
    for (RigidMatrix& block : modes.basis()) read(block);
    for (auto& pairs : matrix.pairs()) {
        for (AggregatePair& pair : pairs) read(pair.coupling);
    }
    numbers = numbers.subspan(next);
    if (is_fresh_) factorise();
}

template class CoarseSpace<float>;
template class CoarseSpace<double>;
template void CoarseSpace<float>::restrict_to_pieces<float>(const float*, int);
template void CoarseSpace<float>::restrict_to_pieces<double>(const double*, int);
template void CoarseSpace<double>::restrict_to_pieces<double>(const double*, int);
template double CoarseSpace<float>::move_pieces<float>(const float*, float*, int) const;
template double CoarseSpace<float>::move_pieces<double>(const double*, float*, int) const;
template double CoarseSpace<double>::move_pieces<double>(const double*, double*, int) const;

}  // namespace lancet::runtime
