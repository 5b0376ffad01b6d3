#include "lancet/experiments/bar/eigen_solver.hpp"

using namespace lancet::experiments::bar;

int main(int argc, char** argv) {
    return run_baseline(
        argc, argv,
        {.method = "eigen",
         .description = "Baseline of the Bar: corotational tetrahedra with an assembled "
                        "Eigen::SparseMatrix and Eigen's conjugate gradients",
         .operator_ = "csr",
         .preconditioners = {"none", "diagonal", "incomplete-cholesky"},
         .newton = true,
         .make_float = [](const Problem& problem, const BaselineOptions& options) -> std::unique_ptr<BaselineSolver> {
             return std::make_unique<EigenSolver<float>>(problem, options);
         },
         .make_double = [](const Problem& problem, const BaselineOptions& options) -> std::unique_ptr<BaselineSolver> {
             return std::make_unique<EigenSolver<double>>(problem, options);
         }});
}
