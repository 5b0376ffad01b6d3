#include "tests/kernels/simd/simd_probe.hpp"

#include "lancet/kernels/simd/instruction_set.hpp"

namespace lancet::kernels::test {

template <class Real>
const SimdProbe<Real>& simd_probe(InstructionSet instruction_set) {
    switch (require(instruction_set)) {
#if defined(LANCET_HAS_SSE2)
        case InstructionSet::sse2:
            return simd_probe_instance<isa::sse2, Real>();
#endif
#if defined(LANCET_HAS_AVX2)
        case InstructionSet::avx2:
            return simd_probe_instance<isa::avx2, Real>();
#endif
#if defined(LANCET_HAS_AVX512)
        case InstructionSet::avx512:
            return simd_probe_instance<isa::avx512, Real>();
#endif
#if defined(LANCET_HAS_NEON)
        case InstructionSet::neon:
            return simd_probe_instance<isa::neon, Real>();
#endif
        default:
            return simd_probe_instance<isa::scalar, Real>();
    }
}

template const SimdProbe<float>& simd_probe<float>(InstructionSet);
template const SimdProbe<double>& simd_probe<double>(InstructionSet);

}  // namespace lancet::kernels::test
