#pragma once

#include "lancet/kernels/element/tetrahedron_kernels_simd.hpp"
#include "lancet/kernels/operator/element_blocks_simd.hpp"
#include "lancet/kernels/operator/operator_kernels.hpp"

namespace lancet::kernels {

template <class P>
LANCET_INLINE P dot(const Vector3<P>& a, const Vector3<P>& b) {
    return fma(a.z, b.z, fma(a.y, b.y, a.x * b.x));
}

template <class P>
LANCET_INLINE Vector3<P> operator-(const Vector3<P>& a, const Vector3<P>& b) {
    return {a.x - b.x, a.y - b.y, a.z - b.z};
}

template <class P>
void open_block(const OpenArguments<typename P::Real>& a, int block) {
    using Real = typename P::Real;
    using Q = Quad<typename P::Isa, Real>;
    const Real none[4] = {0, 0, 0, 0};
    const Q zero = Q::load(none);
    if (a.mass == nullptr) {
        for (std::int64_t node = a.block_begin[block]; node < a.block_begin[block + 1]; ++node) {
            zero.store(a.y + 4 * node);
        }
    } else {
        P quadratic(Real(0));
        for (std::int64_t node = a.block_begin[block]; node < a.block_begin[block + 1]; node += P::width) {
            const P mass = P::load(a.mass + node);
            const Vector3<P> z = load_nodes<P>(a.z + 4 * node);
            const Vector3<P> y{mass * z.x, mass * z.y, mass * z.z};
            store_nodes(a.y + 4 * node, y);
            quadratic += dot(y, z);
        }
        if (a.quadratic != nullptr) a.quadratic[block] = static_cast<double>(sum(quadratic));
    }
    if (!a.clear_slots) return;
    for (std::int64_t slot = a.slot_begin[block]; slot < a.slot_end[block]; ++slot) zero.store(a.y + 4 * slot);
}

template <class P>
void merge_block(const std::int32_t* merge_begin, const ScatterPlan::Merge* merges, typename P::Real* y, int block) {
    using Q = Quad<typename P::Isa, typename P::Real>;
    for (std::int32_t k = merge_begin[block]; k < merge_begin[block + 1]; ++k) {
        typename P::Real* node = y + 4 * static_cast<std::int64_t>(merges[k].node);
        (Q::load(node) + Q::load(y + 4 * static_cast<std::int64_t>(merges[k].slot))).store(node);
    }
}

/// K d of a batch of elements on corners 1, 2, 3, times a factor, from the differences d to corner 0; adds d . K d to
/// `quadratic`.
template <class P, GradientLayout layout>
LANCET_INLINE Corners<P> multiply_elements(const MatrixFreeArguments<typename P::Real>& matrix, std::int64_t batch,
                                           P factor, const Corners<P>& d, P& quadratic) {
    using Real = typename P::Real;
    constexpr int W = P::width;
    Corners<P> f;
    if constexpr (layout == GradientLayout::element_blocks) {
        f = multiply_element_blocks(matrix.rotated, batch, d);
        for (int i = 0; i < 3; ++i) {
            f.of[i] = {factor * f.of[i].x, factor * f.of[i].y, factor * f.of[i].z};
            quadratic += dot(f.of[i], d.of[i]);
        }
    } else {
        const Corners<P> b = load_corners<P>(matrix.rotated + batch * 9 * W);
        const Matrix3<P> g = gradient(d, b);
        const P lambda_over_mu = P::load(matrix.rest + batch * ElementBatches<Real>::rest_entries * W + 10 * W);
        Symmetric3<P> stress = hooke_stress(g, lambda_over_mu);
        stress = {factor * stress.xx, factor * stress.yy, factor * stress.zz,
                  factor * stress.xy, factor * stress.xz, factor * stress.yz};
        quadratic += P(Real(2)) * hooke_energy(g, stress);
        for (int j = 0; j < 3; ++j) f.of[j] = multiply(stress, b.of[j]);
    }
    return f;
}

template <class P, GradientLayout layout, bool ConsistentMass>
LANCET_INLINE void matrix_free_loop(const ProductArguments<typename P::Real>& product,
                                    const MatrixFreeArguments<typename P::Real>& matrix, int block) {
    using Real = typename P::Real;
    constexpr int W = P::width;
    const P factor(matrix.stiffness_factor);
    P quadratic(Real(0));
    for (std::int64_t batch = matrix.block_batch_begin[block]; batch < matrix.block_batch_begin[block + 1]; ++batch) {
        const std::int32_t* nodes = matrix.nodes + batch * 4 * W;
        const Vector3<P> origin = load_nodes<P>(product.z, nodes);
        Corners<P> d;
        for (int j = 0; j < 3; ++j) d.of[j] = load_nodes<P>(product.z, nodes + (j + 1) * W) - origin;
        Corners<P> f = multiply_elements<P, layout>(matrix, batch, factor, d, quadratic);
        if constexpr (ConsistentMass) {
            // The consistent mass is its row sum on the diagonal, which open_block adds, and m_ij (z_j - z_i) for each
            // pair of corners. Of the pairs with corner 0, whose d is zero, the other corner is -m_0i d_i.
            const Real* masses = matrix.pair_mass + batch * 6 * W;
            Vector3<P> pull[3];
            for (int i = 0; i < 3; ++i) {
                const P mass = P::load(masses + i * W);
                pull[i] = {-(mass * d.of[i].x), -(mass * d.of[i].y), -(mass * d.of[i].z)};
            }
            for (int i = 0, pair = 3; i < 3; ++i) {
                for (int j = i + 1; j < 3; ++j, ++pair) {
                    const P mass = P::load(masses + pair * W);
                    const Vector3<P> apart = d.of[j] - d.of[i];
                    const Vector3<P> towards{mass * apart.x, mass * apart.y, mass * apart.z};
                    pull[i] = {pull[i].x + towards.x, pull[i].y + towards.y, pull[i].z + towards.z};
                    pull[j] = {pull[j].x - towards.x, pull[j].y - towards.y, pull[j].z - towards.z};
                }
            }
            for (int i = 0; i < 3; ++i) {
                f.of[i] = {f.of[i].x + pull[i].x, f.of[i].y + pull[i].y, f.of[i].z + pull[i].z};
                quadratic += dot(pull[i], d.of[i]);
            }
        }
        scatter(product.y, matrix.targets + batch * 4 * W, f, product.exclusive_slots);
    }
    product.quadratic[block] += static_cast<double>(sum(quadratic));
}

template <class P, GradientLayout layout>
void matrix_free_with(const ProductArguments<typename P::Real>& product,
                      const MatrixFreeArguments<typename P::Real>& matrix, int block) {
    if (matrix.pair_mass != nullptr) {
        matrix_free_loop<P, layout, true>(product, matrix, block);
    } else {
        matrix_free_loop<P, layout, false>(product, matrix, block);
    }
}

template <class P>
void matrix_free(const ProductArguments<typename P::Real>& product, const MatrixFreeArguments<typename P::Real>& matrix,
                 int block) {
    if (matrix.layout == GradientLayout::element_blocks) {
        matrix_free_with<P, GradientLayout::element_blocks>(product, matrix, block);
    } else {
        matrix_free_with<P, GradientLayout::batches>(product, matrix, block);
    }
}

template <class P>
void edge_blocks(const ProductArguments<typename P::Real>& product, const RowArguments<typename P::Real>& matrix,
                 int block) {
    using Real = typename P::Real;
    constexpr int W = P::width;
    P quadratic(Real(0));
    for (std::int64_t chunk = matrix.block_chunk_begin[block]; chunk < matrix.block_chunk_begin[block + 1]; ++chunk) {
        const Vector3<P> zi = load_nodes<P>(product.z, matrix.row + chunk * W);
        Vector3<P> yi{P(Real(0)), P(Real(0)), P(Real(0))};
        for (std::int64_t entry = matrix.chunk_entry_begin[chunk]; entry < matrix.chunk_entry_begin[chunk + 1];
             ++entry) {
            const Vector3<P> zj = load_nodes<P>(product.z, matrix.column + entry * W), d = zj - zi;
            const Real* values = matrix.values + entry * 9 * W;
            const P k00 = P::load(values), k01 = P::load(values + W), k02 = P::load(values + 2 * W);
            const P k10 = P::load(values + 3 * W), k11 = P::load(values + 4 * W), k12 = P::load(values + 5 * W);
            const P k20 = P::load(values + 6 * W), k21 = P::load(values + 7 * W), k22 = P::load(values + 8 * W);
            const Vector3<P> f{fma(k02, d.z, fma(k01, d.y, k00 * d.x)), fma(k12, d.z, fma(k11, d.y, k10 * d.x)),
                               fma(k22, d.z, fma(k21, d.y, k20 * d.x))};
            yi = {yi.x + f.x, yi.y + f.y, yi.z + f.z};
            const Vector3<P> minus{-d.x, -d.y, -d.z};
            const Vector3<P> back{fma(k20, minus.z, fma(k10, minus.y, k00 * minus.x)),
                                  fma(k21, minus.z, fma(k11, minus.y, k01 * minus.x)),
                                  fma(k22, minus.z, fma(k12, minus.y, k02 * minus.x))};
            quadratic += dot(zj, back);
            if (product.exclusive_slots) {
                store_nodes(product.y, matrix.column_target + entry * W, back);
            } else {
                add_to_nodes(product.y, matrix.column_target + entry * W, back);
            }
        }
        quadratic += dot(zi, yi);
        add_to_nodes(product.y, matrix.row_target + chunk * W, yi);
    }
    product.quadratic[block] += static_cast<double>(sum(quadratic));
}

template <class P>
void block_rows(const ProductArguments<typename P::Real>& product, const RowArguments<typename P::Real>& matrix,
                int block) {
    using Real = typename P::Real;
    constexpr int W = P::width;
    P quadratic(Real(0));
    for (std::int64_t chunk = matrix.block_chunk_begin[block]; chunk < matrix.block_chunk_begin[block + 1]; ++chunk) {
        Vector3<P> yi{P(Real(0)), P(Real(0)), P(Real(0))};
        for (std::int64_t entry = matrix.chunk_entry_begin[chunk]; entry < matrix.chunk_entry_begin[chunk + 1];
             ++entry) {
            const Vector3<P> z = load_nodes<P>(product.z, matrix.column + entry * W);
            const Real* values = matrix.values + entry * 9 * W;
            const auto component = [&](int i, P start) {
                return fma(P::load(values + (3 * i + 2) * W), z.z,
                           fma(P::load(values + (3 * i + 1) * W), z.y, fma(P::load(values + 3 * i * W), z.x, start)));
            };
            yi = {component(0, yi.x), component(1, yi.y), component(2, yi.z)};
        }
        quadratic += dot(yi, load_nodes<P>(product.z, matrix.row + chunk * W));
        add_to_nodes(product.y, matrix.row_target + chunk * W, yi);
    }
    product.quadratic[block] += static_cast<double>(sum(quadratic));
}

/// The rotated gradients at `width` corners and lambda / mu of their elements.
template <class P>
struct CornerGradients {
    Vector3<P> b;
    P lambda_over_mu;
};

template <class P, GradientLayout layout>
LANCET_INLINE CornerGradients<P> load_gradients(const AssemblyArguments<typename P::Real>& a,
                                                const std::int32_t* corners) {
    using Real = typename P::Real;
    constexpr int W = P::width;
    if constexpr (layout == GradientLayout::corners) {
        Quad<typename P::Isa, Real> quads[W];
        for (int lane = 0; lane < W; ++lane) {
            quads[lane] = Quad<typename P::Isa, Real>::load(a.rotated + static_cast<std::int64_t>(corners[lane]));
        }
        P c[4];
        transpose(quads, c);
        return {{c[0], c[1], c[2]}, c[3]};
    } else {
        Real lanes[4][W];
        for (int lane = 0; lane < W; ++lane) {
            const std::int64_t slot = corners[lane] >> 4;
            const int corner = (corners[lane] >> 2) & 3;
            const Real* b = a.rotated + (slot / W) * 9 * W + slot % W;
            for (int axis = 0; axis < 3; ++axis) {
                const Real first = b[axis * W], second = b[(3 + axis) * W], third = b[(6 + axis) * W];
                const Real other = corner == 1 ? first : corner == 2 ? second : third;
                lanes[axis][lane] = corner == 0 ? -(first + second + third) : other;
            }
            lanes[3][lane] = a.rest[((slot / W) * ElementBatches<Real>::rest_entries + 10) * W + slot % W];
        }
        return {{P::load(lanes[0]), P::load(lanes[1]), P::load(lanes[2])}, P::load(lanes[3])};
    }
}

/// Adds to k the blocks V (lambda b'_i b'_j^T + mu b'_j b'_i^T + mu (b'_i . b'_j) 1) of one element per lane.
template <class P, GradientLayout layout>
LANCET_INLINE void add_gradient_blocks(const AssemblyArguments<typename P::Real>& a, const std::int32_t* row_corners,
                                       const std::int32_t* column_corners, P (&k)[3][3]) {
    const CornerGradients<P> of_row = load_gradients<P, layout>(a, row_corners);
    const Vector3<P> u = of_row.b, v = load_gradients<P, layout>(a, column_corners).b;
    const P lambda = of_row.lambda_over_mu;
    const P bi[3] = {u.x, u.y, u.z}, bj[3] = {v.x, v.y, v.z};
    const P trace = dot(u, v);
    for (int i = 0; i < 3; ++i) {
        const P scaled = lambda * bi[i];
        for (int j = 0; j < 3; ++j) k[i][j] = fma(scaled, bj[j], fma(bj[i], bi[j], k[i][j]));
        k[i][i] += trace;
    }
}

template <class P, GradientLayout layout>
LANCET_INLINE void assemble_loop(const AssemblyArguments<typename P::Real>& a, int block) {
    using Real = typename P::Real;
    constexpr int W = P::width;
    const P factor(a.stiffness_factor);
    for (std::int64_t entry = a.chunk_entry_begin[a.block_chunk_begin[block]];
         entry < a.chunk_entry_begin[a.block_chunk_begin[block + 1]]; ++entry) {
        P k[3][3];
        for (int i = 0; i < 3; ++i) {
            for (int j = 0; j < 3; ++j) k[i][j] = P(Real(0));
        }
        for (std::int64_t n = a.incidence_begin[entry]; n < a.incidence_begin[entry + 1]; ++n) {
            const std::int32_t* row_corners = a.incidence + 2 * n * W;
            if constexpr (layout == GradientLayout::element_blocks) {
                add_incident_blocks(a.rotated, row_corners, row_corners + W, k);
            } else {
                add_gradient_blocks<P, layout>(a, row_corners, row_corners + W, k);
            }
        }
        const P mass = a.entry_mass != nullptr ? P::load(a.entry_mass + entry * W) : P(Real(0));
        Real* values = a.values + entry * 9 * W;
        for (int i = 0; i < 3; ++i) {
            for (int j = 0; j < 3; ++j) {
                const P value = i == j ? fma(factor, k[i][j], mass) : factor * k[i][j];
                value.store(values + (3 * i + j) * W);
            }
        }
    }
}

template <class P>
void assemble(const AssemblyArguments<typename P::Real>& a, int block) {
    switch (a.layout) {
        case GradientLayout::batches:
            return assemble_loop<P, GradientLayout::batches>(a, block);
        case GradientLayout::corners:
            return assemble_loop<P, GradientLayout::corners>(a, block);
        case GradientLayout::element_blocks:
            return assemble_loop<P, GradientLayout::element_blocks>(a, block);
    }
}

template <class P>
constexpr OperatorKernels<typename P::Real> make_operator_kernels() {
    return {.open = &open_block<P>,
            .merge = &merge_block<P>,
            .matrix_free = &matrix_free<P>,
            .edge_blocks = &edge_blocks<P>,
            .block_rows = &block_rows<P>,
            .assemble = &assemble<P>};
}

}  // namespace lancet::kernels
