#pragma once

#include <limits>

#include "lancet/kernels/element/hyperelastic_kernels.hpp"
#include "lancet/kernels/element/tetrahedron_geometry_simd.hpp"
#include "lancet/kernels/material/corotational.hpp"
#include "lancet/kernels/material/linear.hpp"
#include "lancet/kernels/material/projected_tangent.hpp"
#include "lancet/kernels/material/st_venant_kirchhoff.hpp"
#include "lancet/kernels/rotation/robust_rotation.hpp"

namespace lancet::kernels {

/// The rest data of a batch.
template <class P>
struct RestBatch {
    Corners<P> gradients;
    P weight;  ///< V mu
    P lambda_over_mu;
};

template <class P>
LANCET_INLINE RestBatch<P> load_rest(const HyperelasticArguments<typename P::Real>& a, std::int64_t batch) {
    constexpr int W = P::width;
    const typename P::Real* rest = a.rest + batch * ElementBatches<typename P::Real>::rest_entries * W;
    const P root = P::load(rest + 9 * W);
    return {load_corners<P>(rest), root * root, P::load(rest + 10 * W)};
}

/// The deformations of the batches [first, first + count), with the rotations where they are asked for: from the warm
/// start, which is renewed.
template <class P, bool UsesRotation, int count>
LANCET_INLINE void load_deformations(const HyperelasticArguments<typename P::Real>& a, std::int64_t first,
                                     const RestBatch<P> (&rest)[count], Deformation<P> (&at)[count]) {
    constexpr int W = P::width;
    for (int k = 0; k < count; ++k) {
        const std::int32_t* nodes = a.nodes + (first + k) * 4 * W;
        at[k].gradient = gradient(load_corner_differences<P>(a.positions, nodes), rest[k].gradients);
    }
    if constexpr (UsesRotation) {
        Matrix3<P> f[count];
        Quaternion<P> q[count];
        for (int k = 0; k < count; ++k) {
            f[k] = at[k].gradient;
            q[k] = load_quaternion<P>(a.quaternion + (first + k) * 4 * W);
        }
        robust_rotations(f, q, a.rotation_steps);
        for (int k = 0; k < count; ++k) {
            store_quaternion(a.quaternion + (first + k) * 4 * W, q[k]);
            at[k].rotation = to_matrix(q[k]);
        }
    }
}

/// Force and energy of the batches [first, first + count), which are rotated together.
template <class P, template <class> class Material, int count>
LANCET_INLINE void evaluate_together(const HyperelasticArguments<typename P::Real>& a, std::int64_t first, P& energy) {
    RestBatch<P> rest[count];
    Deformation<P> at[count];
    for (int k = 0; k < count; ++k) rest[k] = load_rest<P>(a, first + k);
    load_deformations<P, Material<P>::uses_rotation>(a, first, rest, at);
    for (int k = 0; k < count; ++k) {
        const Material<P> material(at[k], rest[k].lambda_over_mu);
        if (a.energy != nullptr) energy += rest[k].weight * material.energy();
        if (a.force == nullptr) continue;
        Matrix3<P> stress = material.stress();
        if constexpr (requires { material.average_stress(stress); }) {
            if (a.start != nullptr) {
                const std::int32_t* nodes = a.nodes + (first + k) * 4 * P::width;
                const Matrix3<P> from = gradient(load_corner_differences<P>(a.start, nodes), rest[k].gradients);
                stress = material.average_stress(subtract(at[k].gradient, from));
            }
        }
        const Matrix3<P> pull = scale(stress, -rest[k].weight);
        Corners<P> f;
        for (int j = 0; j < 3; ++j) f.of[j] = multiply(pull, rest[k].gradients.of[j]);
        scatter(a.force, a.targets + (first + k) * 4 * P::width, f, a.exclusive_slots);
    }
}

/// The loop of HyperelasticKernels::evaluate for one material.
template <class P, template <class> class Material>
void evaluate_loop(const HyperelasticArguments<typename P::Real>& a, int block) {
    // A rotation is one long chain of dependent operations: two of them keep the processor busy.
    constexpr int together = Material<P>::uses_rotation ? 2 : 1;
    P energy(typename P::Real(0));
    std::int64_t batch = a.block_batch_begin[block];
    const std::int64_t end = a.block_batch_begin[block + 1];
    for (; batch + together <= end; batch += together) evaluate_together<P, Material, together>(a, batch, energy);
    for (; batch < end; ++batch) evaluate_together<P, Material, 1>(a, batch, energy);
    if (a.energy != nullptr) a.energy[block] = static_cast<double>(sum(energy));
}

template <class P>
void evaluate(const HyperelasticArguments<typename P::Real>& a, int block) {
    switch (a.model) {
        case MaterialModel::linear:
            return evaluate_loop<P, LinearMaterial>(a, block);
        case MaterialModel::corotational:
            return evaluate_loop<P, CorotationalMaterial>(a, block);
        case MaterialModel::st_venant_kirchhoff:
            return evaluate_loop<P, StVenantKirchhoffMaterial>(a, block);
    }
}

/// The edge blocks of a batch from a law that knows the product of its tangent with a change of F.
template <class P, class Product>
LANCET_INLINE void store_element_blocks(typename P::Real* blocks, const RestBatch<P>& rest, Product product) {
    const P zero(typename P::Real(0));
    const Vector3<P> total = rest.gradients.sum();
    const Vector3<P> b[4] = {
        {-total.x, -total.y, -total.z}, rest.gradients.of[0], rest.gradients.of[1], rest.gradients.of[2]};
    Matrix3<P> change;
    for (int i = 0; i < 3; ++i) {
        for (int j = 0; j < 3; ++j) change.entry[i][j] = zero;
    }
    for (int j = 1; j < 4; ++j) {
        const P weighted[3] = {rest.weight * b[j].x, rest.weight * b[j].y, rest.weight * b[j].z};
        for (int axis = 0; axis < 3; ++axis) {
            for (int k = 0; k < 3; ++k) change.entry[axis][k] = weighted[k];
            const Matrix3<P> stress = product(change);
            for (int k = 0; k < 3; ++k) change.entry[axis][k] = zero;
            for (int i = 0; i < j; ++i) {
                const Vector3<P> column = multiply(stress, b[i]);
                typename P::Real* destination = blocks + (9 * element_block_index(i, j) + axis) * P::width;
                column.x.store(destination);
                column.y.store(destination + 3 * P::width);
                column.z.store(destination + 6 * P::width);
            }
        }
    }
}

/// The loop of HyperelasticKernels::tangent for one material and kind.
template <class P, template <class> class Material, TangentKind kind>
void tangent_loop(const HyperelasticArguments<typename P::Real>& a, int block) {
    for (std::int64_t batch = a.block_batch_begin[block]; batch < a.block_batch_begin[block + 1]; ++batch) {
        const RestBatch<P> rest[1] = {load_rest<P>(a, batch)};
        Deformation<P> at[1];
        load_deformations<P, Material<P>::uses_rotation>(a, batch, rest, at);
        typename P::Real* blocks = a.element_blocks + batch * element_block_entries * P::width;
        if constexpr (kind == TangentKind::projected && !Material<P>::is_convex) {
            if constexpr (!Material<P>::uses_rotation) at[0].rotation = to_matrix(distant_svd_rotation(at[0].gradient));
            const ProjectedTangent<P> law = projected_tangent<Material>(at[0], rest[0].lambda_over_mu);
            store_element_blocks(blocks, rest[0], [&](const Matrix3<P>& change) { return law.tangent(change); });
        } else {
            const Material<P> law(at[0], rest[0].lambda_over_mu);
            store_element_blocks(blocks, rest[0], [&](const Matrix3<P>& change) {
                if constexpr (kind == TangentKind::rotated) {
                    return law.rotated_tangent(change);
                } else {
                    return law.tangent(change);
                }
            });
        }
    }
}

/// What stands for a tangent that does not exist.
template <class P>
void store_no_tangent(const HyperelasticArguments<typename P::Real>& a, int block) {
    const P nothing(std::numeric_limits<typename P::Real>::quiet_NaN());
    for (std::int64_t place = static_cast<std::int64_t>(a.block_batch_begin[block]) * element_block_entries;
         place < static_cast<std::int64_t>(a.block_batch_begin[block + 1]) * element_block_entries; ++place) {
        nothing.store(a.element_blocks + place * P::width);
    }
}

template <class P>
void tangent(const HyperelasticArguments<typename P::Real>& a, int block) {
    switch (a.model) {
        case MaterialModel::linear:
            // Without a rotation and convex: all three kinds are one.
            return tangent_loop<P, LinearMaterial, TangentKind::exact>(a, block);
        case MaterialModel::corotational:
            if (a.tangent == TangentKind::rotated) {
                return tangent_loop<P, CorotationalMaterial, TangentKind::rotated>(a, block);
            }
            if (a.tangent == TangentKind::exact) {
                return tangent_loop<P, CorotationalMaterial, TangentKind::exact>(a, block);
            }
            return tangent_loop<P, CorotationalMaterial, TangentKind::projected>(a, block);
        case MaterialModel::st_venant_kirchhoff:
            if (a.tangent == TangentKind::exact) {
                return tangent_loop<P, StVenantKirchhoffMaterial, TangentKind::exact>(a, block);
            }
            if (a.tangent == TangentKind::projected) {
                return tangent_loop<P, StVenantKirchhoffMaterial, TangentKind::projected>(a, block);
            }
            return store_no_tangent<P>(a, block);
    }
}

template <class P>
constexpr HyperelasticKernels<typename P::Real> make_hyperelastic_kernels() {
    return {.evaluate = &evaluate<P>, .tangent = &tangent<P>};
}

}  // namespace lancet::kernels
