#include "lancet/kernels/isa/instantiate.hpp"

namespace lancet::kernels {

template <>
const KernelSet<float>& kernel_set_instance<isa::neon, float>() {
    static constexpr KernelSet<float> instance = make_kernel_set<isa::neon, float>(InstructionSet::neon);
    return instance;
}

template <>
const KernelSet<double>& kernel_set_instance<isa::neon, double>() {
    static constexpr KernelSet<double> instance = make_kernel_set<isa::neon, double>(InstructionSet::neon);
    return instance;
}

}  // namespace lancet::kernels
