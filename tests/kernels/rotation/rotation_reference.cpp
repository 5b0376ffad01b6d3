#include "tests/kernels/rotation/rotation_reference.hpp"

#include <random>

namespace lancet::kernels::test {

RotationReference rotation_reference(const Eigen::Matrix3d& f) {
    using Matrix = Eigen::Matrix<long double, 3, 3>;
    using Vector = Eigen::Matrix<long double, 3, 1>;
    const long double scale = f.cwiseAbs().maxCoeff();
    if (scale == 0) return {Eigen::Matrix3d::Identity(), 0, 0, INFINITY};
    const Matrix scaled = f.cast<long double>() / scale;
    const Eigen::JacobiSVD<Matrix> svd(scaled, Eigen::ComputeFullU | Eigen::ComputeFullV);
    const long double sign = svd.matrixU().determinant() * svd.matrixV().determinant() > 0 ? 1 : -1;
    const Matrix rotation = svd.matrixU() * Vector(1, 1, sign).asDiagonal() * svd.matrixV().transpose();
    const Vector s = svd.singularValues();
    const long double gap = s[1] + sign * s[2];
    return {rotation.cast<double>(), static_cast<double>((s[0] + gap) * scale), static_cast<double>(s[0] * scale),
            static_cast<double>(2 * s[0] / gap)};
}

Eigen::Quaterniond random_rotation(unsigned seed) {
    std::mt19937 generator(seed);
    std::normal_distribution<double> normal;
    Eigen::Quaterniond q(normal(generator), normal(generator), normal(generator), normal(generator));
    return q.normalized();
}

}  // namespace lancet::kernels::test
