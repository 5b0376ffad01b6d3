#pragma once

// Included only by the files of the instruction sets (scalar.cpp, sse2.cpp, ...): makes their kernels.

#include "lancet/kernels/element/hyperelastic_kernels_simd.hpp"
#include "lancet/kernels/element/tetrahedron_kernels_simd.hpp"
#include "lancet/kernels/isa/instances.hpp"
#include "lancet/kernels/operator/coarse_kernels_simd.hpp"
#include "lancet/kernels/operator/diagonal_kernels_simd.hpp"
#include "lancet/kernels/operator/operator_kernels_simd.hpp"
#include "lancet/kernels/peak/peak_kernels_simd.hpp"
#include "lancet/kernels/rotation/rotation_kernels_simd.hpp"
#include "lancet/kernels/simd/pack.hpp"
#include "lancet/kernels/surface/normal_kernels_simd.hpp"
#include "lancet/kernels/vector/vector_kernels_simd.hpp"

namespace lancet::kernels {

/// The kernels compiled with this file's flags.
template <class Isa, class Real>
constexpr KernelSet<Real> make_kernel_set(InstructionSet instruction_set) {
    using P = Pack<Isa, Real>;
    return {.instruction_set = instruction_set,
            .width = P::width,
            .rotation = make_rotation_kernels<P>(),
            .tetrahedron = make_tetrahedron_kernels<P>(),
            .hyperelastic = make_hyperelastic_kernels<P>(),
            .matrix = make_operator_kernels<P>(),
            .diagonal = make_diagonal_kernels<P>(),
            .coarse = make_coarse_kernels<P>(),
            .vector = make_vector_kernels<P, P>(),
            .vector_mixed = make_vector_kernels<P, Pack<Isa, double>>(),
            .normals = make_normal_kernels<Pack<Isa, float>>(),
            .peak = make_peak_kernels<P>()};
}

}  // namespace lancet::kernels
