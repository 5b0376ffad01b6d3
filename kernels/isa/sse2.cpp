#include "lancet/kernels/isa/instantiate.hpp"

namespace lancet::kernels {

template <>
const KernelSet<float>& kernel_set_instance<isa::sse2, float>() {
    static constexpr KernelSet<float> instance = make_kernel_set<isa::sse2, float>(InstructionSet::sse2);
    return instance;
}

template <>
const KernelSet<double>& kernel_set_instance<isa::sse2, double>() {
    static constexpr KernelSet<double> instance = make_kernel_set<isa::sse2, double>(InstructionSet::sse2);
    return instance;
}

}  // namespace lancet::kernels
