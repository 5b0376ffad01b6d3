#pragma once

#include <span>

#include "lancet/runtime/schedule/function_reference.hpp"

namespace lancet::runtime {

/// An approximation of the largest eigenvalue of a symmetric matrix.
struct LargestEigenvalue {
    double estimate = 0;     ///< the largest Ritz value: never above the largest eigenvalue
    double upper_bound = 0;  ///< the estimate and the norm of its residual
    int iterations = 0;      ///< products with the matrix
};

/// When the iterations of Lanczos end.
struct LanczosSettings {
    double tolerance = 1e-6;  ///< of the residual's norm against the estimate
    int iterations = 150;     ///< at most; the bound holds wherever they end. Each keeps one vector
};

/// The largest eigenvalue of a symmetric matrix by the method of Lanczos with full reorthogonalisation (Parlett 1998,
/// chapter 13). With r = |A y - theta y| for the largest Ritz pair, an eigenvalue lies within r of theta; it is the
/// largest one, unless `start` has next to no share of that one's eigenvector: give a random one.
/// - start: not changed; the method stays in the space that products span from it. Zero gives the eigenvalue 0.
/// - product: y = A x
LargestEigenvalue largest_eigenvalue(std::span<const double> start,
                                     FunctionReference<void(std::span<const double> x, std::span<double> y)> product,
                                     const LanczosSettings& settings = {});

}  // namespace lancet::runtime
