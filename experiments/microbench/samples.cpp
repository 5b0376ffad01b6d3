#include "lancet/experiments/microbench/samples.hpp"

#include <type_traits>

namespace lancet::experiments {

Samples::Samples(const std::vector<std::array<int, 3>>& cells)
    : scheduler_(runtime::make_scheduler(runtime::SchedulerKind::serial, 1)), limits_(*scheduler_) {
    for (const auto& one : cells) cells_[elements_of(one)] = one;
}

const BentBar& Samples::bar(int elements) {
    const auto found = bars_.find(elements);
    if (found != bars_.end()) return found->second;
    return bars_.emplace(elements, make_bent_bar(cells_.at(elements))).first->second;
}

const Reference& Samples::reference(int elements) {
    const auto found = references_.find(elements);
    if (found != references_.end()) return found->second;
    return references_.emplace(elements, make_reference(bar(elements), *scheduler_)).first->second;
}

template <class Real>
SolverParts<Real>& Samples::parts(int elements, kernels::InstructionSet instruction_set, runtime::OperatorKind kind) {
    const Key key{elements, instruction_set, kind};
    const auto kept = [this]() -> Kept<Real>& {
        if constexpr (std::is_same_v<Real, float>) {
            return float_;
        } else {
            return double_;
        }
    };
    if (!kept().parts || kept().key != key) {
        float_.parts.reset();
        double_.parts.reset();
        reference(elements);  // before the parts, so that both are not held at the same time
        kept() = {key, std::make_unique<SolverParts<Real>>(bar(elements), *scheduler_, instruction_set, kind)};
    }
    return *kept().parts;
}

template SolverParts<float>& Samples::parts<float>(int, kernels::InstructionSet, runtime::OperatorKind);
template SolverParts<double>& Samples::parts<double>(int, kernels::InstructionSet, runtime::OperatorKind);

}  // namespace lancet::experiments
