#include "tests/kernels/material/material_probe.hpp"

#include "lancet/kernels/simd/instruction_set.hpp"

namespace lancet::kernels::test {

template <class Real>
const MaterialProbe<Real>& material_probe(InstructionSet instruction_set) {
    switch (require(instruction_set)) {
#if defined(LANCET_HAS_SSE2)
        case InstructionSet::sse2:
            return material_probe_instance<isa::sse2, Real>();
#endif
#if defined(LANCET_HAS_AVX2)
        case InstructionSet::avx2:
            return material_probe_instance<isa::avx2, Real>();
#endif
#if defined(LANCET_HAS_AVX512)
        case InstructionSet::avx512:
            return material_probe_instance<isa::avx512, Real>();
#endif
#if defined(LANCET_HAS_NEON)
        case InstructionSet::neon:
            return material_probe_instance<isa::neon, Real>();
#endif
        default:
            return material_probe_instance<isa::scalar, Real>();
    }
}

template const MaterialProbe<float>& material_probe<float>(InstructionSet);
template const MaterialProbe<double>& material_probe<double>(InstructionSet);

}  // namespace lancet::kernels::test
