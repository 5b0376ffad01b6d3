#include "tests/kernels/element/reference_solid.hpp"

#include <algorithm>
#include <random>

namespace lancet::test {

namespace {

Eigen::Vector3d node(const Eigen::VectorXd& positions, std::int32_t index) {
    return positions.segment<3>(3 * static_cast<Eigen::Index>(index));
}

Eigen::Matrix3d edges(const Eigen::VectorXd& positions, const Tetrahedron& t) {
    Eigen::Matrix3d d;
    for (int j = 0; j < 3; ++j) d.col(j) = node(positions, t[j + 1]) - node(positions, t[0]);
    return d;
}

Eigen::Matrix<double, 12, 1> gathered(const Eigen::VectorXd& vector, const Tetrahedron& t) {
    Eigen::Matrix<double, 12, 1> values;
    for (int i = 0; i < 4; ++i) values.segment<3>(3 * i) = node(vector, t[i]);
    return values;
}

Eigen::Matrix<double, 12, 12> four_times(const Eigen::Matrix3d& r) {
    Eigen::Matrix<double, 12, 12> blocks = Eigen::Matrix<double, 12, 12>::Zero();
    for (int i = 0; i < 4; ++i) blocks.block<3, 3>(3 * i, 3 * i) = r;
    return blocks;
}

/// dF/dx of an element: entry (3 a + b, 3 i + a) is the derivative of shape function i by coordinate b.
Eigen::Matrix<double, 9, 12> gradient_operator(const Eigen::Matrix3d& rest_edges) {
    const Eigen::Matrix3d inverse = rest_edges.inverse();
    Eigen::Matrix<double, 9, 12> b = Eigen::Matrix<double, 9, 12>::Zero();
    for (int a = 0; a < 3; ++a) {
        for (int j = 0; j < 3; ++j) {
            b.block<3, 1>(3 * a, 3 * (j + 1) + a) = inverse.row(j).transpose();
            b.block<3, 1>(3 * a, a) -= inverse.row(j).transpose();
        }
    }
    return b;
}

}  // namespace

double ReferenceSolid::volume(std::size_t element) const {
    return edges(rest(), tetrahedra[element]).determinant() / 6;
}

Eigen::Matrix3d ReferenceSolid::deformation_gradient(std::size_t element, const Eigen::VectorXd& positions) const {
    return edges(positions, tetrahedra[element]) * edges(rest(), tetrahedra[element]).inverse();
}

Eigen::Matrix<double, 12, 12> ReferenceSolid::element_stiffness(std::size_t element) const {
    // Shape functions phi_i = a_i + b_i . X: the rows of the inverse of [1 X_i].
    Eigen::Matrix4d corners;
    for (int i = 0; i < 4; ++i) {
        const Point& x = nodes[tetrahedra[element][i]];
        corners.row(i) << 1, x[0], x[1], x[2];
    }
    const Eigen::Matrix4d coefficients = corners.inverse();
    Eigen::Matrix<double, 6, 12> strain = Eigen::Matrix<double, 6, 12>::Zero();
    for (int i = 0; i < 4; ++i) {
        const double x = coefficients(1, i), y = coefficients(2, i), z = coefficients(3, i);
        strain.block<6, 3>(0, 3 * i) << x, 0, 0, 0, y, 0, 0, 0, z, y, x, 0, 0, z, y, z, 0, x;
    }
    const double lambda = material(element).lambda(), mu = material(element).mu();
    Eigen::Matrix<double, 6, 6> elasticity = Eigen::Matrix<double, 6, 6>::Zero();
    elasticity.topLeftCorner<3, 3>().setConstant(lambda);
    elasticity.diagonal() << lambda + 2 * mu, lambda + 2 * mu, lambda + 2 * mu, mu, mu, mu;
    return volume(element) * strain.transpose() * elasticity * strain;
}

Eigen::VectorXd ReferenceSolid::rest() const {
    return as_vector(nodes);
}

Eigen::MatrixXd ReferenceSolid::mass(bool consistent) const {
    Eigen::MatrixXd mass = Eigen::MatrixXd::Zero(unknowns(), unknowns());
    for (std::size_t e = 0; e < tetrahedra.size(); ++e) {
        const double weight = material(e).density * volume(e);
        for (int i = 0; i < 4; ++i) {
            for (int j = 0; j < 4; ++j) {
                // int phi_i phi_j over a tetrahedron is V / 10 for i = j, V / 20 else.
                const double share = consistent ? (i == j ? 0.1 : 0.05) : (i == j ? 0.25 : 0.0);
                for (int axis = 0; axis < 3; ++axis) {
                    mass(3 * tetrahedra[e][i] + axis, 3 * tetrahedra[e][j] + axis) += share * weight;
                }
            }
        }
    }
    return mass;
}

Eigen::MatrixXd ReferenceSolid::stiffness(const Eigen::VectorXd& positions, bool corotational) const {
    Eigen::MatrixXd stiffness = Eigen::MatrixXd::Zero(unknowns(), unknowns());
    for (std::size_t e = 0; e < tetrahedra.size(); ++e) {
        Eigen::Matrix<double, 12, 12> k = element_stiffness(e);
        if (corotational) {
            const auto r = four_times(nearest_rotation(deformation_gradient(e, positions)));
            k = (r * k * r.transpose()).eval();
        }
        for (int i = 0; i < 4; ++i) {
            for (int j = 0; j < 4; ++j) {
                stiffness.block<3, 3>(3 * tetrahedra[e][i], 3 * tetrahedra[e][j]) += k.block<3, 3>(3 * i, 3 * j);
            }
        }
    }
    return stiffness;
}

Eigen::VectorXd ReferenceSolid::elastic_force(const Eigen::VectorXd& positions, bool corotational) const {
    Eigen::VectorXd force = Eigen::VectorXd::Zero(unknowns());
    const Eigen::VectorXd undeformed = rest();
    for (std::size_t e = 0; e < tetrahedra.size(); ++e) {
        Eigen::Matrix<double, 12, 12> r = Eigen::Matrix<double, 12, 12>::Identity();
        if (corotational) r = four_times(nearest_rotation(deformation_gradient(e, positions)));
        // Differences to the first corner: K does not see a translation, and nothing is lost far from the origin.
        Eigen::Matrix<double, 12, 1> x = gathered(positions, tetrahedra[e]),
                                     rest_x = gathered(undeformed, tetrahedra[e]);
        for (int i = 3; i >= 0; --i) {
            x.segment<3>(3 * i) -= x.segment<3>(0).eval();
            rest_x.segment<3>(3 * i) -= rest_x.segment<3>(0).eval();
        }
        const Eigen::Matrix<double, 12, 1> f = -r * (element_stiffness(e) * (r.transpose() * x - rest_x));
        for (int i = 0; i < 4; ++i) force.segment<3>(3 * tetrahedra[e][i]) += f.segment<3>(3 * i);
    }
    return force;
}

double ReferenceSolid::elastic_energy(const Eigen::VectorXd& positions, bool corotational) const {
    double energy = 0;
    for (std::size_t e = 0; e < tetrahedra.size(); ++e) {
        const Eigen::Matrix3d f = deformation_gradient(e, positions);
        const Eigen::Matrix3d strain =
            corotational ? Eigen::Matrix3d(nearest_rotation(f).transpose() * f - Eigen::Matrix3d::Identity())
                         : Eigen::Matrix3d(0.5 * (f + f.transpose()) - Eigen::Matrix3d::Identity());
        energy += volume(e) * (material(e).mu() * strain.squaredNorm() +
                               material(e).lambda() / 2 * strain.trace() * strain.trace());
    }
    return energy;
}

double ReferenceSolid::elastic_energy(const Eigen::VectorXd& positions, kernels::MaterialModel model) const {
    double energy = 0;
    for (std::size_t e = 0; e < tetrahedra.size(); ++e) {
        energy += volume(e) * law(e, model).energy(deformation_gradient(e, positions));
    }
    return energy;
}

Eigen::VectorXd ReferenceSolid::elastic_force(const Eigen::VectorXd& positions, kernels::MaterialModel model) const {
    Eigen::VectorXd force = Eigen::VectorXd::Zero(unknowns());
    const Eigen::VectorXd undeformed = rest();
    for (std::size_t e = 0; e < tetrahedra.size(); ++e) {
        const Eigen::Matrix3d stress = law(e, model).stress(deformation_gradient(e, positions));
        const Eigen::Matrix<double, 12, 1> f =
            -volume(e) * gradient_operator(edges(undeformed, tetrahedra[e])).transpose() * flattened(stress);
        for (int i = 0; i < 4; ++i) force.segment<3>(3 * tetrahedra[e][i]) += f.segment<3>(3 * i);
    }
    return force;
}

Eigen::Matrix<double, 12, 12> ReferenceSolid::element_stiffness(std::size_t element, const Eigen::VectorXd& positions,
                                                                kernels::MaterialModel model,
                                                                kernels::TangentKind kind) const {
    const Eigen::Matrix<double, 9, 12> b = gradient_operator(edges(rest(), tetrahedra[element]));
    const Tangent tangent = law(element, model).tangent(deformation_gradient(element, positions), kind);
    return volume(element) * b.transpose() * tangent * b;
}

Eigen::MatrixXd ReferenceSolid::stiffness(const Eigen::VectorXd& positions, kernels::MaterialModel model,
                                          kernels::TangentKind kind) const {
    Eigen::MatrixXd stiffness = Eigen::MatrixXd::Zero(unknowns(), unknowns());
    for (std::size_t e = 0; e < tetrahedra.size(); ++e) {
        const Eigen::Matrix<double, 12, 12> k = element_stiffness(e, positions, model, kind);
        for (int i = 0; i < 4; ++i) {
            for (int j = 0; j < 4; ++j) {
                stiffness.block<3, 3>(3 * tetrahedra[e][i], 3 * tetrahedra[e][j]) += k.block<3, 3>(3 * i, 3 * j);
            }
        }
    }
    return stiffness;
}

std::vector<std::uint8_t> ReferenceSolid::free_unknowns() const {
    std::vector<std::uint8_t> is_free(static_cast<std::size_t>(unknowns()), 1);
    for (const std::int32_t index : fixed) {
        for (std::size_t axis = 0; axis < 3; ++axis) is_free[3 * static_cast<std::size_t>(index) + axis] = 0;
    }
    return is_free;
}

namespace {

std::vector<Eigen::Index> places(const std::vector<std::uint8_t>& marked) {
    std::vector<Eigen::Index> places;
    for (std::size_t i = 0; i < marked.size(); ++i) {
        if (marked[i] != 0) places.push_back(static_cast<Eigen::Index>(i));
    }
    return places;
}

}  // namespace

Eigen::MatrixXd restricted(const Eigen::MatrixXd& matrix, const std::vector<std::uint8_t>& marked) {
    const std::vector<Eigen::Index> at = places(marked);
    const auto size = static_cast<Eigen::Index>(at.size());
    Eigen::MatrixXd result(size, size);
    for (Eigen::Index j = 0; j < size; ++j) {
        for (Eigen::Index i = 0; i < size; ++i) result(i, j) = matrix(at[i], at[j]);
    }
    return result;
}

Eigen::VectorXd restricted(const Eigen::VectorXd& vector, const std::vector<std::uint8_t>& marked) {
    const std::vector<Eigen::Index> at = places(marked);
    Eigen::VectorXd result(static_cast<Eigen::Index>(at.size()));
    for (std::size_t i = 0; i < at.size(); ++i) result[static_cast<Eigen::Index>(i)] = vector[at[i]];
    return result;
}

Eigen::VectorXd extended(const Eigen::VectorXd& vector, const std::vector<std::uint8_t>& marked) {
    Eigen::VectorXd all = Eigen::VectorXd::Zero(static_cast<Eigen::Index>(marked.size()));
    Eigen::Index next = 0;
    for (const Eigen::Index place : places(marked)) all[place] = vector[next++];
    return all;
}

ReferenceSolid jittered_bar(const std::array<int, 3>& cells, double spacing, double jitter, unsigned seed) {
    ReferenceSolid solid;
    solid.materials = {{.young_modulus = 1e5, .poisson_ratio = 0.33, .density = 1000},
                       {.young_modulus = 4e5, .poisson_ratio = 0.4, .density = 1500}};
    const auto [nx, ny, nz] = cells;
    const auto at = [nx = nx, ny = ny](int i, int j, int k) { return i + (nx + 1) * (j + (ny + 1) * k); };
    for (int k = 0; k <= nz; ++k) {
        for (int j = 0; j <= ny; ++j) {
            for (int i = 0; i <= nx; ++i) solid.nodes.push_back({spacing * i, spacing * j, spacing * k});
        }
    }
    const Eigen::VectorXd shift = random_vector(solid.unknowns(), jitter * spacing, seed);
    solid.nodes = as_points(solid.rest() + shift);
    // Kuhn's subdivision: the paths from corner 0 to corner 7 along the axes, in every order.
    constexpr std::array<std::array<int, 3>, 6> paths{
        {{0, 1, 2}, {1, 2, 0}, {2, 0, 1}, {0, 2, 1}, {2, 1, 0}, {1, 0, 2}}};
    for (int k = 0; k < nz; ++k) {
        for (int j = 0; j < ny; ++j) {
            for (int i = 0; i < nx; ++i) {
                for (std::size_t path = 0; path < paths.size(); ++path) {
                    std::array<int, 3> corner{i, j, k};
                    Tetrahedron t{at(i, j, k), 0, 0, 0};
                    for (std::size_t step = 0; step < 3; ++step) {
                        ++corner[static_cast<std::size_t>(paths[path][step])];
                        t[step + 1] = at(corner[0], corner[1], corner[2]);
                    }
                    if (path >= 3) std::swap(t[2], t[3]);
                    solid.tetrahedra.push_back(t);
                    solid.regions.push_back(2 * i >= nx ? 1 : 0);
                }
            }
        }
    }
    return solid;
}

void fix_first_section(ReferenceSolid& solid, const std::array<int, 3>& cells) {
    for (std::int32_t index = 0; index < static_cast<std::int32_t>(solid.nodes.size()); index += cells[0] + 1) {
        solid.fixed.push_back(index);
    }
}

Eigen::VectorXd as_vector(std::span<const Point> points) {
    Eigen::VectorXd vector(3 * static_cast<Eigen::Index>(points.size()));
    for (std::size_t i = 0; i < points.size(); ++i) {
        vector.segment<3>(3 * static_cast<Eigen::Index>(i)) = Eigen::Map<const Eigen::Vector3d>(points[i].data());
    }
    return vector;
}

std::vector<Point> as_points(const Eigen::VectorXd& vector) {
    std::vector<Point> points(static_cast<std::size_t>(vector.size()) / 3);
    for (std::size_t i = 0; i < points.size(); ++i) {
        Eigen::Map<Eigen::Vector3d>(points[i].data()) = vector.segment<3>(3 * static_cast<Eigen::Index>(i));
    }
    return points;
}

Eigen::VectorXd random_vector(Eigen::Index size, double amplitude, unsigned seed) {
    std::mt19937 generator(seed);
    std::uniform_real_distribution<double> number(-amplitude, amplitude);
    Eigen::VectorXd vector(size);
    for (double& value : vector) value = number(generator);
    return vector;
}

Eigen::VectorXd moved(const Eigen::VectorXd& positions, const Eigen::Matrix3d& rotation, const Eigen::Vector3d& shift) {
    Eigen::VectorXd result(positions.size());
    for (Eigen::Index i = 0; i < positions.size(); i += 3) {
        result.segment<3>(i) = rotation * positions.segment<3>(i) + shift;
    }
    return result;
}

Eigen::Vector3d total_force(const Eigen::VectorXd& force) {
    Eigen::Vector3d total = Eigen::Vector3d::Zero();
    for (Eigen::Index i = 0; i < force.size(); i += 3) total += force.segment<3>(i);
    return total;
}

Eigen::Vector3d total_torque(const Eigen::VectorXd& positions, const Eigen::VectorXd& force) {
    Eigen::Vector3d total = Eigen::Vector3d::Zero();
    for (Eigen::Index i = 0; i < force.size(); i += 3) {
        total += Eigen::Vector3d(positions.segment<3>(i)).cross(Eigen::Vector3d(force.segment<3>(i)));
    }
    return total;
}

}  // namespace lancet::test
