#include "lancet/runtime/solve/lanczos.hpp"

#include <cmath>
#include <vector>

#include <Eigen/Eigenvalues>

namespace lancet::runtime {

namespace {

/// The largest Ritz value of a tridiagonal matrix, and the last component of its eigenvector.
struct RitzPair {
    double value;
    double last_component;
};

RitzPair largest_ritz_pair(const std::vector<double>& diagonal, const std::vector<double>& off_diagonal) {
    const auto size = static_cast<Eigen::Index>(diagonal.size());
    const Eigen::VectorXd d = Eigen::VectorXd::Map(diagonal.data(), size);
    const Eigen::VectorXd e = Eigen::VectorXd::Map(off_diagonal.data(), size - 1);
    Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> eigen;
    eigen.computeFromTridiagonal(d, e);
    return {eigen.eigenvalues()[size - 1], eigen.eigenvectors()(size - 1, size - 1)};
}

}  // namespace

LargestEigenvalue largest_eigenvalue(std::span<const double> start,
                                     FunctionReference<void(std::span<const double>, std::span<double>)> product,
                                     const LanczosSettings& settings) {
    const auto size = static_cast<Eigen::Index>(start.size());
    std::vector<Eigen::VectorXd> basis;
    std::vector<double> diagonal, off_diagonal;
    Eigen::VectorXd next = Eigen::VectorXd::Map(start.data(), size), image(size);
    double norm = next.norm();
    LargestEigenvalue result;
    if (norm == 0) return result;
    constexpr int check_interval = 5;
    while (result.iterations < settings.iterations) {
        if (!basis.empty()) off_diagonal.push_back(norm);
        basis.emplace_back(next / norm);
        const Eigen::VectorXd& newest = basis.back();
        product(std::span<const double>(newest.data(), start.size()), std::span<double>(image.data(), start.size()));
        ++result.iterations;
        diagonal.push_back(newest.dot(image));
        next = image;
        for (int sweep = 0; sweep < 2; ++sweep) {  // twice is enough (Parlett 1998, section 6.9)
            for (const Eigen::VectorXd& direction : basis) next -= direction.dot(next) * direction;
        }
        norm = next.norm();
        // An invariant subspace: what is left is rounding.
        const bool is_invariant = norm <= 1e-14 * image.norm();
        const bool is_last = is_invariant || result.iterations == settings.iterations;
        if (!is_last && result.iterations % check_interval != 0) continue;
        const RitzPair ritz = largest_ritz_pair(diagonal, off_diagonal);
        const double residual = norm * std::abs(ritz.last_component);
        result.estimate = ritz.value;
        result.upper_bound = ritz.value + residual;
        if (is_invariant || residual <= settings.tolerance * std::abs(ritz.value)) break;
    }
    return result;
}

}  // namespace lancet::runtime
