#include "lancet/runtime/solve/conjugate_gradients.hpp"

#include <algorithm>
#include <cmath>
#include <type_traits>

#include "lancet/runtime/solve/block_loop.hpp"

namespace lancet::runtime {

template <class Real, class Accumulate>
ConjugateGradients<Real, Accumulate>::ConjugateGradients(const kernels::KernelSet<Real>& kernels,
                                                         const kernels::NodeNumbering& numbering)
    : numbering_(&numbering),
      z_(static_cast<std::size_t>(numbering.node_count) * 4),
      p_(z_.size()),
      s_(z_.size()),
      r_(z_.size()),
      r_dot_z_(static_cast<std::size_t>(numbering.blocks())),
      r_dot_r_(r_dot_z_.size()) {
    if constexpr (std::is_same_v<Real, Accumulate>) {
        kernels_ = &kernels.vector;
    } else {
        kernels_ = &kernels.vector_mixed;
    }
}

template <class Real, class Accumulate>
typename ConjugateGradients<Real, Accumulate>::Products ConjugateGradients<Real, Accumulate>::sum_products()
    const noexcept {
    return {sum_over_awake_blocks(*numbering_, r_dot_z_), sum_over_awake_blocks(*numbering_, r_dot_r_)};
}

template <class Real, class Accumulate>
typename ConjugateGradients<Real, Accumulate>::Products ConjugateGradients<Real, Accumulate>::precondition(
    Scheduler& scheduler, Preconditioner<Real>& preconditioner, const ConstraintFilter& filter) {
    // The products r . z hold before z is filtered, for r is: r . S z = S r . z = r . z.
    if (preconditioner.coarse() == nullptr) {
        for_each_awake_block(scheduler, *numbering_, [&](int block) {
            kernels_->precondition(arguments_, block);
            filter.apply(z_.data(), block);
        });
        return sum_products();
    }
    return precondition_with_coarse(scheduler, *preconditioner.coarse(), filter, [](int) {});
}

template <class Real, class Accumulate>
template <class Before>
typename ConjugateGradients<Real, Accumulate>::Products ConjugateGradients<Real, Accumulate>::precondition_with_coarse(
    Scheduler& scheduler, CoarseSpace<Real>& coarse, const ConstraintFilter& filter, const Before& before) {
    const auto modes = coarse.arguments();
    for_each_awake_block(scheduler, *numbering_, [&](int block) {
        before(block);
        kernels_->restrict_residual(modes, arguments_, block);
        coarse.restrict_to_pieces(r_.data(), block);
    });
    coarse.solve();
    for_each_awake_block(scheduler, *numbering_, [&](int block) {
        kernels_->precondition_with_coarse(modes, arguments_, block);
        r_dot_z_[static_cast<std::size_t>(block)] += coarse.move_pieces(r_.data(), z_.data(), block);
        filter.apply(z_.data(), block);
    });
    return sum_products();
}

template <class Real, class Accumulate>
typename ConjugateGradients<Real, Accumulate>::Products ConjugateGradients<Real, Accumulate>::advance(
    Scheduler& scheduler, Operator<Real>& matrix, Preconditioner<Real>& preconditioner, const ConstraintFilter& filter,
    double alpha, double beta) {
    arguments_.alpha = static_cast<Accumulate>(alpha);
    arguments_.beta = static_cast<Accumulate>(beta);
    const auto complete_product = [&](int block) {
        matrix.merge(block);
        filter.apply(matrix.buffer(), block);
    };
    if (preconditioner.coarse() == nullptr) {
        for_each_awake_block(scheduler, *numbering_, [&](int block) {
            complete_product(block);
            kernels_->update_and_precondition(arguments_, block);
            filter.apply(z_.data(), block);
        });
        return sum_products();
    }
    return precondition_with_coarse(scheduler, *preconditioner.coarse(), filter, [&](int block) {
        complete_product(block);
        kernels_->update(arguments_, block);
    });
}

template <class Real, class Accumulate>
typename ConjugateGradients<Real, Accumulate>::Corrections ConjugateGradients<Real, Accumulate>::corrections(
    Scheduler& scheduler, std::span<const Accumulate> x) {
    // The sums of products have been taken: their places are free.
    for_each_awake_block(scheduler, *numbering_, [&](int block) {
        double correction = 0, solution = 0;
        const std::size_t end = 4 * static_cast<std::size_t>(numbering_->block_begin[block + 1]);
        for (std::size_t i = 4 * static_cast<std::size_t>(numbering_->block_begin[block]); i < end; ++i) {
            correction = std::max(correction, static_cast<double>(std::abs(z_[i])));
            solution = std::max(solution, static_cast<double>(std::abs(x[i])));
        }
        r_dot_z_[static_cast<std::size_t>(block)] = correction;
        r_dot_r_[static_cast<std::size_t>(block)] = solution;
    });
    return {largest_of_awake_blocks(*numbering_, r_dot_z_), largest_of_awake_blocks(*numbering_, r_dot_r_)};
}

template <class Real, class Accumulate>
bool ConjugateGradients<Real, Accumulate>::correct_thin_nodes(Scheduler& scheduler, Operator<Real>& matrix,
                                                              const ConstraintFilter& filter, std::span<Accumulate> x,
                                                              double limit, double r_dot_z) {
    const auto for_block_nodes = [&](int block, const auto& body) {
        const auto end = static_cast<std::size_t>(numbering_->block_begin[block + 1]);
        for (auto node = static_cast<std::size_t>(numbering_->block_begin[block]); node < end; ++node) {
            const std::size_t at = 4 * node;
            const Real largest = std::max({std::abs(z_[at]), std::abs(z_[at + 1]), std::abs(z_[at + 2])});
            body(at, static_cast<double>(largest) > limit);
        }
    };
    for_each_awake_block(scheduler, *numbering_, [&](int block) {
        double sum = 0;
        for_block_nodes(block, [&](std::size_t at, bool wants_more) {
            for (std::size_t i = at; wants_more && i < at + 3; ++i) {
                sum += static_cast<double>(r_[i]) * static_cast<double>(z_[i]);
            }
        });
        r_dot_z_[static_cast<std::size_t>(block)] = sum;
    });
    const double downhill = sum_over_awake_blocks(*numbering_, r_dot_z_);
    constexpr double invisible = 0.01;
    if (!(downhill > 0) || downhill > invisible * r_dot_z) return false;
    for_each_awake_block(scheduler, *numbering_, [&](int block) {
        for_block_nodes(block, [&](std::size_t at, bool wants_more) {
            if (!wants_more) std::fill_n(&z_[at], 3, Real(0));
        });
    });
    const double curvature = matrix.product(scheduler, z_.data());
    const auto alpha = static_cast<Accumulate>(curvature > 0 ? downhill / curvature : 0);
    for_each_awake_block(scheduler, *numbering_, [&](int block) {
        matrix.merge(block);
        filter.apply(matrix.buffer(), block);
        const std::size_t end = 4 * static_cast<std::size_t>(numbering_->block_begin[block + 1]);
        for (std::size_t i = 4 * static_cast<std::size_t>(numbering_->block_begin[block]); i < end; ++i) {
            x[i] += alpha * static_cast<Accumulate>(z_[i]);
            r_[i] -= alpha * static_cast<Accumulate>(matrix.buffer()[i]);
        }
    });
    return true;
}

template <class Real, class Accumulate>
ConjugateGradientResult ConjugateGradients<Real, Accumulate>::solve(
    Scheduler& scheduler, Operator<Real>& matrix, Preconditioner<Real>& preconditioner, const ConstraintFilter& filter,
    std::span<const Accumulate> b, std::span<Accumulate> x, const ConjugateGradientSettings& settings,
    std::span<double> history) {
    arguments_ = {.block_begin = numbering_->block_begin.data(),
                  .w = matrix.buffer(),
                  .z = z_.data(),
                  .p = p_.data(),
                  .s = s_.data(),
                  .x = x.data(),
                  .r = r_.data(),
                  .inverse_diagonal = preconditioner.inverse_diagonal(),
                  .alpha = 0,
                  .beta = 0,
                  .r_dot_z = r_dot_z_.data(),
                  .r_dot_r = r_dot_r_.data()};
    const std::size_t free_numbers = static_cast<std::size_t>(numbering_->free_count) * 4;

    // The norm of the right-hand side in which the residual is measured.
    const auto for_block_numbers = [&](int block, const auto& body) {
        const std::size_t end = 4 * static_cast<std::size_t>(numbering_->block_begin[block + 1]);
        for (std::size_t i = 4 * static_cast<std::size_t>(numbering_->block_begin[block]); i < end; ++i) body(i);
    };
    const bool starts_from_zero = std::all_of(x.begin(), x.end(), [](Accumulate value) { return value == 0; });
    for_each_awake_block(scheduler, *numbering_, [&](int block) {
        for_block_numbers(block, [&](std::size_t i) {
            r_[i] = b[i];
            p_[i] = 0;
            s_[i] = 0;
        });
        filter.apply(r_.data(), block);
    });
    Products products = precondition(scheduler, preconditioner, filter);
    const double reference = products.r_dot_z;
    ConjugateGradientResult result;
    if (!std::isfinite(reference)) {
        result.broke_down = true;
        result.residual = reference;
        return result;
    }

    if (!starts_from_zero) {
        for (std::size_t i = 0; i < x.size(); ++i) z_[i] = static_cast<Real>(x[i]);
        matrix.product(scheduler, z_.data());
        for_each_awake_block(scheduler, *numbering_, [&](int block) {
            matrix.merge(block);
            for_block_numbers(block,
                              [&](std::size_t i) { r_[i] = b[i] - static_cast<Accumulate>(matrix.buffer()[i]); });
            filter.apply(r_.data(), block);
        });
        // From here on z is a correction: it does not move what is prescribed.
        std::fill(z_.begin() + static_cast<std::ptrdiff_t>(free_numbers), z_.end(), Real(0));
        products = precondition(scheduler, preconditioner, filter);
    }

    const auto relative = [&](double r_dot_z) {
        return reference > 0 ? std::sqrt(std::max(r_dot_z, 0.0) / reference) : (r_dot_z > 0 ? HUGE_VAL : 0.0);
    };
    result.residual = relative(products.r_dot_z);
    double previous_r_dot_z = 0, previous_alpha = 0;
    bool is_start = true;
    int steps_of_thin_nodes = 0;
    while (result.iterations < settings.iterations) {
        if (products.r_dot_z == 0) break;
        if (result.residual < settings.tolerance) {
            const Corrections now = corrections(scheduler, x);
            const double limit = settings.tolerance * now.solution;
            if (now.correction <= limit) break;
            constexpr int most = 8;  // nodes that hang together are for conjugate gradients
            if (steps_of_thin_nodes < most &&
                correct_thin_nodes(scheduler, matrix, filter, x, limit, products.r_dot_z)) {
                ++steps_of_thin_nodes;
                ++result.iterations;
                products = precondition(scheduler, preconditioner, filter);
                result.residual = relative(products.r_dot_z);
                is_start = true;
                continue;
            }
        }
        const double z_dot_az = matrix.product(scheduler, z_.data());
        const double beta = is_start ? 0 : products.r_dot_z / previous_r_dot_z;
        const double curvature = is_start ? z_dot_az : z_dot_az - beta * products.r_dot_z / previous_alpha;
        is_start = false;
        if (!(curvature > 0) || !(products.r_dot_z > 0) || !std::isfinite(curvature)) {
            result.broke_down = true;
            break;
        }
        const double alpha = products.r_dot_z / curvature;
        previous_r_dot_z = products.r_dot_z;
        previous_alpha = alpha;
        products = advance(scheduler, matrix, preconditioner, filter, alpha, beta);
        result.residual = relative(products.r_dot_z);
        if (static_cast<std::size_t>(result.iterations) < history.size()) {
            history[static_cast<std::size_t>(result.iterations)] = result.residual;
        }
        ++result.iterations;
    }
    return result;
}

template <class Real, class Accumulate>
std::size_t ConjugateGradients<Real, Accumulate>::bytes() const noexcept {
    using kernels::heap_bytes;
    return heap_bytes(z_) + heap_bytes(p_) + heap_bytes(s_) + heap_bytes(r_) + heap_bytes(r_dot_z_) +
           heap_bytes(r_dot_r_);
}

template class ConjugateGradients<float, float>;
template class ConjugateGradients<float, double>;
template class ConjugateGradients<double, double>;

}  // namespace lancet::runtime
