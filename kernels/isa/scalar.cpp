#include "lancet/kernels/isa/instantiate.hpp"

namespace lancet::kernels {

template <>
const KernelSet<float>& kernel_set_instance<isa::scalar, float>() {
    static constexpr KernelSet<float> instance = make_kernel_set<isa::scalar, float>(InstructionSet::scalar);
    return instance;
}

template <>
const KernelSet<double>& kernel_set_instance<isa::scalar, double>() {
    static constexpr KernelSet<double> instance = make_kernel_set<isa::scalar, double>(InstructionSet::scalar);
    return instance;
}

}  // namespace lancet::kernels
