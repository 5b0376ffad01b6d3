#pragma once

#include "lancet/kernels/isa/instruction_set.hpp"
#include "lancet/kernels/material/material_model.hpp"

namespace lancet::kernels::test {

/// The pointwise laws of kernels/material as out-of-line functions of one instruction set. Arrays hold [entry][lane],
/// matrices row by row, symmetric ones as xx, yy, zz, xy, xz, yz; all is divided by mu.
template <class Real>
struct MaterialProbe {
    int width;
    /// Energy density and stress at F, with the rotation of the singular value decomposition.
    void (*evaluate)(MaterialModel model, Real lambda_over_mu, const Real* f, Real* energy, Real* stress);
    /// The product of a tangent with a change of F.
    void (*tangent)(MaterialModel model, TangentKind kind, Real lambda_over_mu, const Real* f, const Real* change,
                    Real* product);
    /// PrincipalDerivatives: first, second, flip and twist behind each other, 15 numbers per lane. Not for the linear
    /// material, which is no function of the stretches.
    void (*principal)(MaterialModel model, Real lambda_over_mu, const Real* stretch, Real* derivatives);
    /// Stretches, U and V of F.
    void (*decompose)(const Real* f, Real* stretch, Real* left, Real* right);
    void (*positive_part)(const Real* symmetric, Real* result);
};

/// The table of an instruction set that is compiled in and executable.
template <class Real>
const MaterialProbe<Real>& material_probe(InstructionSet instruction_set);

/// Defined by the object of each instruction set.
template <class Isa, class Real>
const MaterialProbe<Real>& material_probe_instance();

}  // namespace lancet::kernels::test
