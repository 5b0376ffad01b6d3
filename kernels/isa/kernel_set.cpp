#include "lancet/kernels/isa/kernel_set.hpp"

#include "lancet/kernels/error.hpp"
#include "lancet/kernels/isa/instances.hpp"

namespace lancet::kernels {

template <class Real>
const KernelSet<Real>& kernel_set(InstructionSet instruction_set) {
    switch (require(instruction_set)) {
#if defined(LANCET_HAS_SSE2)
        case InstructionSet::sse2:
            return kernel_set_instance<isa::sse2, Real>();
#endif
#if defined(LANCET_HAS_AVX2)
        case InstructionSet::avx2:
            return kernel_set_instance<isa::avx2, Real>();
#endif
#if defined(LANCET_HAS_AVX512)
        case InstructionSet::avx512:
            return kernel_set_instance<isa::avx512, Real>();
#endif
#if defined(LANCET_HAS_NEON)
        case InstructionSet::neon:
            return kernel_set_instance<isa::neon, Real>();
#endif
        default:
            return kernel_set_instance<isa::scalar, Real>();
    }
}

template const KernelSet<float>& kernel_set<float>(InstructionSet);
template const KernelSet<double>& kernel_set<double>(InstructionSet);

}  // namespace lancet::kernels
