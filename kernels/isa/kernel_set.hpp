#pragma once

#include "lancet/kernels/element/hyperelastic_kernels.hpp"
#include "lancet/kernels/element/tetrahedron_kernels.hpp"
#include "lancet/kernels/isa/instruction_set.hpp"
#include "lancet/kernels/operator/coarse_kernels.hpp"
#include "lancet/kernels/operator/diagonal_kernels.hpp"
#include "lancet/kernels/operator/operator_kernels.hpp"
#include "lancet/kernels/peak/peak_kernels.hpp"
#include "lancet/kernels/rotation/rotation_kernels.hpp"
#include "lancet/kernels/surface/normal_kernels.hpp"
#include "lancet/kernels/vector/vector_kernels.hpp"

namespace lancet::kernels {

/// All kernels of one instruction set and scalar type, as pointers to out-of-line functions over a range of blocks or
/// batches. Asked for once, when an object is built; no dispatch happens in a loop.
template <class Real>
struct KernelSet {
    InstructionSet instruction_set;
    int width;  ///< lanes of a batch
    RotationKernels<Real> rotation;
    TetrahedronKernels<Real> tetrahedron;    ///< corotational and linear elements: the fast path
    HyperelasticKernels<Real> hyperelastic;  ///< elements of every material
    OperatorKernels<Real> matrix;
    DiagonalKernels<Real> diagonal;
    CoarseKernels<Real> coarse;
    VectorKernels<Real, Real> vector;
    VectorKernels<Real, double> vector_mixed;  ///< operator in Real, solution and residual in double
    NormalKernels normals;                     ///< of surfaces, in float for both
    PeakKernels<Real> peak;                    ///< the machine's limit, to stand beside what is reached
};

/// The kernels of an instruction set, for Real = float or double. Throws Error unless it is compiled in and executable.
template <class Real>
const KernelSet<Real>& kernel_set(InstructionSet instruction_set);

}  // namespace lancet::kernels
