#include "lancet/experiments/bar/thesis_solver.hpp"

using namespace lancet::experiments::bar;

int main(int argc, char** argv) {
    return run_baseline(
        argc, argv,
        {.method = "thesis",
         .description = "Baseline of the Bar: scalar corotational tetrahedra in arrays of structures, "
                        "OpenMP with private force vectors (Jerabkova 2007)",
         .operator_ = "block_rows",
         .preconditioners = {"none"},
         .newton = false,
         .make_float = [](const Problem& problem, const BaselineOptions& options) -> std::unique_ptr<BaselineSolver> {
             return std::make_unique<ThesisSolver<float>>(problem, options);
         },
         .make_double = [](const Problem& problem, const BaselineOptions& options) -> std::unique_ptr<BaselineSolver> {
             return std::make_unique<ThesisSolver<double>>(problem, options);
         }});
}
