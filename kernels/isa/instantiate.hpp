#pragma once

// Included only by the files of the instruction sets (scalar.cpp, sse2.cpp, ...): makes their kernels.

#include "lancet/kernels/isa/instances.hpp"
#include "lancet/kernels/rotation/rotation_kernels_simd.hpp"
#include "lancet/kernels/simd/pack.hpp"

namespace lancet::kernels {

/// The kernels compiled with this file's flags.
template <class Isa, class Real>
constexpr KernelSet<Real> make_kernel_set(InstructionSet instruction_set) {
    using P = Pack<Isa, Real>;
    return {.instruction_set = instruction_set, .width = P::width, .rotation = make_rotation_kernels<P>()};
}

}  // namespace lancet::kernels
