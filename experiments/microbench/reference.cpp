#include "lancet/experiments/microbench/reference.hpp"

#include "lancet/experiments/microbench/vector_pass.hpp"

namespace lancet::experiments {

Reference make_reference(const BentBar& bar, runtime::Scheduler& scheduler) {
    SolverParts<double> parts(bar, scheduler, kernels::InstructionSet::scalar, runtime::OperatorKind::edge_blocks,
                              {.method = kernels::RotationMethod::svd});
    const auto copy = [&](const double* nodal) { return std::vector<double>(nodal, nodal + bar.rest.size()); };
    Reference reference;
    parts.follow_to_later_state();
    reference.force = copy(parts.force());
    parts.settle();
    parts.multiply();
    reference.product = copy(parts.product());
    VectorPass<double, double> block_jacobi(parts, runtime::PreconditionerKind::block_jacobi);
    block_jacobi.run();
    reference.block_jacobi = copy(block_jacobi.z());
    VectorPass<double, double> coarse(parts, runtime::PreconditionerKind::coarse);
    coarse.run();
    reference.coarse = copy(coarse.z());
    return reference;
}

}  // namespace lancet::experiments
