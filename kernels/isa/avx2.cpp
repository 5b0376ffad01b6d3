#include "lancet/kernels/isa/instantiate.hpp"

namespace lancet::kernels {

template <>
const KernelSet<float>& kernel_set_instance<isa::avx2, float>() {
    static constexpr KernelSet<float> instance = make_kernel_set<isa::avx2, float>(InstructionSet::avx2);
    return instance;
}

template <>
const KernelSet<double>& kernel_set_instance<isa::avx2, double>() {
    static constexpr KernelSet<double> instance = make_kernel_set<isa::avx2, double>(InstructionSet::avx2);
    return instance;
}

}  // namespace lancet::kernels
