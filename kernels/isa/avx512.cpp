#include "lancet/kernels/isa/instantiate.hpp"

namespace lancet::kernels {

template <>
const KernelSet<float>& kernel_set_instance<isa::avx512, float>() {
    static constexpr KernelSet<float> instance = make_kernel_set<isa::avx512, float>(InstructionSet::avx512);
    return instance;
}

template <>
const KernelSet<double>& kernel_set_instance<isa::avx512, double>() {
    static constexpr KernelSet<double> instance = make_kernel_set<isa::avx512, double>(InstructionSet::avx512);
    return instance;
}

}  // namespace lancet::kernels
