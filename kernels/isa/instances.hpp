#pragma once

#include "lancet/kernels/isa/kernel_set.hpp"
#include "lancet/kernels/simd/instruction_set.hpp"

namespace lancet::kernels {

/// Defined in the file of each instruction set that is compiled in.
template <class Isa, class Real>
const KernelSet<Real>& kernel_set_instance();

}  // namespace lancet::kernels
