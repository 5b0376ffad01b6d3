#pragma once

#include "lancet/kernels/operator/coarse_kernels.hpp"
#include "lancet/kernels/simd/nodes.hpp"

namespace lancet::kernels {

template <class P>
LANCET_INLINE Vector3<P> cross(const Vector3<P>& a, const Vector3<P>& b) {
    return {fnma(a.z, b.y, a.y * b.z), fnma(a.x, b.z, a.z * b.x), fnma(a.y, b.x, a.x * b.y)};
}

/// Sums in registers for the aggregate that a run of chunks belongs to.
template <class P>
struct CoarseDiagonalSums {
    P of[coarse_diagonal_sums];

    LANCET_INLINE void clear() {
        for (P& value : of) value = P(typename P::Real(0));
    }
    LANCET_INLINE void add_to(double* sums, std::int32_t aggregate) const {
        if (aggregate < 0) return;
        for (int k = 0; k < coarse_diagonal_sums; ++k) {
            sums[static_cast<std::int64_t>(aggregate) * coarse_diagonal_sums + k] += static_cast<double>(sum(of[k]));
        }
    }
    LANCET_INLINE void add_lanes_to(double* sums, const std::int32_t* aggregates) const {
        for (int k = 0; k < coarse_diagonal_sums; ++k) {
            typename P::Real lanes[P::width];
            of[k].store(lanes);
            for (int lane = 0; lane < P::width; ++lane) {
                sums[static_cast<std::int64_t>(aggregates[lane]) * coarse_diagonal_sums + k] +=
                    static_cast<double>(lanes[lane]);
            }
        }
    }
};

/// Adds one chunk of rows.
template <class P>
LANCET_INLINE void add_coarse_chunk(const CoarseDiagonalArguments<typename P::Real>& a, std::int64_t chunk,
                                    const std::int32_t* aggregates, CoarseDiagonalSums<P>& sums) {
    using Real = typename P::Real;
    constexpr int W = P::width;
    const Vector3<P> ri = load_nodes<P>(a.offset, a.row + chunk * W);
    for (std::int64_t entry = a.chunk_entry_begin[chunk]; entry < a.chunk_entry_begin[chunk + 1]; ++entry) {
        const std::int32_t* column = a.column + entry * W;
        Real inside[W];
        for (int lane = 0; lane < W; ++lane) {
            inside[lane] = a.aggregate[column[lane] / 4] == aggregates[lane] ? Real(1) : Real(0);
        }
        const P weight = P::load(inside);
        const Vector3<P> rj = load_nodes<P>(a.offset, column);
        const Vector3<P> d{weight * (rj.x - ri.x), weight * (rj.y - ri.y), weight * (rj.z - ri.z)};
        P k[3][3];
        for (int i = 0; i < 3; ++i) {
            for (int j = 0; j < 3; ++j) k[i][j] = P::load(a.values + (entry * 9 + 3 * i + j) * W);
        }
        // Row i of K [d]x^T and of K^T [d]x^T is d x (row i of K, of K^T).
        Vector3<P> pull[3], back[3];
        for (int i = 0; i < 3; ++i) {
            pull[i] = cross(d, Vector3<P>{k[i][0], k[i][1], k[i][2]});
            back[i] = cross(d, Vector3<P>{k[0][i], k[1][i], k[2][i]});
            sums.of[3 * i] += pull[i].x - back[i].x;
            sums.of[3 * i + 1] += pull[i].y - back[i].y;
            sums.of[3 * i + 2] += pull[i].z - back[i].z;
        }
        // Torques [r_i]x pull - [r_j]x back, column by column; their symmetric part is what the sum over edges has.
        const auto torque = [&](P pull0, P pull1, P pull2, P back0, P back1, P back2) {
            const Vector3<P> at_i = cross(ri, Vector3<P>{pull0, pull1, pull2});
            const Vector3<P> at_j = cross(rj, Vector3<P>{back0, back1, back2});
            return Vector3<P>{at_i.x - at_j.x, at_i.y - at_j.y, at_i.z - at_j.z};
        };
        const Vector3<P> x = torque(pull[0].x, pull[1].x, pull[2].x, back[0].x, back[1].x, back[2].x);
        const Vector3<P> y = torque(pull[0].y, pull[1].y, pull[2].y, back[0].y, back[1].y, back[2].y);
        const Vector3<P> z = torque(pull[0].z, pull[1].z, pull[2].z, back[0].z, back[1].z, back[2].z);
        const P half(Real(0.5));
        sums.of[9] += x.x;
        sums.of[10] += y.y;
        sums.of[11] += z.z;
        sums.of[12] = fma(half, x.y + y.x, sums.of[12]);
        sums.of[13] = fma(half, x.z + z.x, sums.of[13]);
        sums.of[14] = fma(half, y.z + z.y, sums.of[14]);
    }
}

template <class P>
void coarse_diagonal(const CoarseDiagonalArguments<typename P::Real>& a, int block) {
    constexpr int W = P::width;
    CoarseDiagonalSums<P> run;
    run.clear();
    std::int32_t current = -1;
    for (std::int64_t chunk = a.block_chunk_begin[block]; chunk < a.block_chunk_begin[block + 1]; ++chunk) {
        std::int32_t aggregates[W];
        bool is_uniform = true;
        for (int lane = 0; lane < W; ++lane) {
            aggregates[lane] = a.aggregate[a.row[chunk * W + lane] / 4];
            is_uniform = is_uniform && aggregates[lane] == aggregates[0];
        }
        if (!is_uniform) {
            CoarseDiagonalSums<P> mixed;
            mixed.clear();
            add_coarse_chunk(a, chunk, aggregates, mixed);
            mixed.add_lanes_to(a.sums, aggregates);
            continue;
        }
        if (aggregates[0] != current) {
            run.add_to(a.sums, current);
            run.clear();
            current = aggregates[0];
        }
        add_coarse_chunk(a, chunk, aggregates, run);
    }
    run.add_to(a.sums, current);
}

template <class P>
constexpr CoarseKernels<typename P::Real> make_coarse_kernels() {
    return {.diagonal = &coarse_diagonal<P>};
}

}  // namespace lancet::kernels
