#include "tests/kernels/element/reference_material.hpp"

#include <Eigen/SVD>

namespace lancet::test {

using kernels::MaterialModel;
using kernels::TangentKind;

namespace {

/// F = U diag(s) V^T with proper U and V.
struct ProperDecomposition {
    Eigen::Matrix3d u, v;
    Eigen::Vector3d s;

    explicit ProperDecomposition(const Eigen::Matrix3d& f) {
        const Eigen::JacobiSVD<Eigen::Matrix3d> svd(f, Eigen::ComputeFullU | Eigen::ComputeFullV);
        u = svd.matrixU();
        v = svd.matrixV();
        s = svd.singularValues();
        for (Eigen::Matrix3d* side : {&u, &v}) {
            if (side->determinant() > 0) continue;
            side->col(2) *= -1;
            s[2] *= -1;
        }
    }
    Eigen::Matrix3d rotation() const { return u * v.transpose(); }
    /// The change of the rotation with F.
    Eigen::Matrix3d rotation_change(const Eigen::Matrix3d& change) const {
        const Eigen::Matrix3d m = u.transpose() * change * v;
        Eigen::Matrix3d spin = Eigen::Matrix3d::Zero();
        for (int i = 0; i < 3; ++i) {
            for (int j = 0; j < 3; ++j) {
                if (i != j) spin(i, j) = (m(i, j) - m(j, i)) / (s[i] + s[j]);
            }
        }
        return u * spin * v.transpose();
    }
};

Eigen::Matrix3d identity() {
    return Eigen::Matrix3d::Identity();
}

Eigen::Matrix3d greens_strain(const Eigen::Matrix3d& f) {
    return 0.5 * (f.transpose() * f - identity());
}

}  // namespace

Eigen::Matrix3d nearest_rotation(const Eigen::Matrix3d& f) {
    return ProperDecomposition(f).rotation();
}

Eigen::Vector3d proper_stretches(const Eigen::Matrix3d& f) {
    return ProperDecomposition(f).s;
}

double PointwiseReference::energy(const Eigen::Matrix3d& f) const {
    const Eigen::Matrix3d strain =
        model == MaterialModel::linear         ? Eigen::Matrix3d(0.5 * (f + f.transpose()) - identity())
        : model == MaterialModel::corotational ? Eigen::Matrix3d(nearest_rotation(f).transpose() * f - identity())
                                               : greens_strain(f);
    return mu * strain.squaredNorm() + lambda / 2 * strain.trace() * strain.trace();
}

Eigen::Matrix3d PointwiseReference::stress(const Eigen::Matrix3d& f) const {
    const auto hooke = [&](const Eigen::Matrix3d& e) {
        return Eigen::Matrix3d(2 * mu * e + lambda * e.trace() * identity());
    };
    switch (model) {
        case MaterialModel::linear:
            return hooke(0.5 * (f + f.transpose()) - identity());
        case MaterialModel::corotational: {
            const Eigen::Matrix3d r = nearest_rotation(f);
            return r * hooke(r.transpose() * f - identity());
        }
        default:
            return f * hooke(greens_strain(f));
    }
}

Tangent PointwiseReference::tangent(const Eigen::Matrix3d& f, TangentKind kind) const {
    if (kind == TangentKind::projected) return clamped(tangent(f, TangentKind::exact));
    const ProperDecomposition decomposition(f);
    const Eigen::Matrix3d r = decomposition.rotation();
    const auto product = [&](const Eigen::Matrix3d& d) -> Eigen::Matrix3d {
        if (model == MaterialModel::linear) return mu * (d + d.transpose()) + lambda * d.trace() * identity();
        if (model == MaterialModel::st_venant_kirchhoff) {
            const Eigen::Matrix3d e = greens_strain(f), de = 0.5 * (d.transpose() * f + f.transpose() * d);
            return d * (2 * mu * e + lambda * e.trace() * identity()) +
                   f * (2 * mu * de + lambda * de.trace() * identity());
        }
        const Eigen::Matrix3d back = r.transpose() * d;
        if (kind == TangentKind::rotated) {
            return r * (mu * (back + back.transpose()) + lambda * back.trace() * identity());
        }
        const double trace = (r.transpose() * f).trace() - 3;
        return 2 * mu * d + lambda * back.trace() * r + (lambda * trace - 2 * mu) * decomposition.rotation_change(d);
    };
    Tangent result;
    for (int column = 0; column < 9; ++column) {
        Eigen::Matrix3d d = Eigen::Matrix3d::Zero();
        d(column / 3, column % 3) = 1;
        result.col(column) = flattened(product(d));
    }
    return result;
}

Tangent clamped(const Tangent& symmetric) {
    const Eigen::SelfAdjointEigenSolver<Tangent> eigen(0.5 * (symmetric + symmetric.transpose()));
    return eigen.eigenvectors() * eigen.eigenvalues().cwiseMax(0).asDiagonal() * eigen.eigenvectors().transpose();
}

Eigen::Matrix<double, 9, 1> flattened(const Eigen::Matrix3d& a) {
    Eigen::Matrix<double, 9, 1> entries;
    for (Eigen::Index i = 0; i < 3; ++i) entries.segment<3>(3 * i) = a.row(i).transpose();
    return entries;
}

Eigen::Matrix3d unflattened(const Eigen::Matrix<double, 9, 1>& a) {
    Eigen::Matrix3d matrix;
    for (Eigen::Index i = 0; i < 3; ++i) matrix.row(i) = a.segment<3>(3 * i).transpose();
    return matrix;
}

}  // namespace lancet::test
