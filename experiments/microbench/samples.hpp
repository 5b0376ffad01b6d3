#pragma once

#include <array>
#include <map>
#include <memory>
#include <tuple>
#include <vector>

#include "lancet/experiments/common/machine_limits.hpp"
#include "lancet/experiments/microbench/reference.hpp"
#include "lancet/experiments/microbench/solver_parts.hpp"

namespace lancet::experiments {

/// What the benchmarks measure on, built when it is first asked for. Bars and references are kept, of the solver parts
/// only the last: benchmarks of the same ones are run one after the other.
class Samples {
  public:
    /// `cells` of the bars along their axes.
    explicit Samples(const std::vector<std::array<int, 3>>& cells);

    const BentBar& bar(int elements);
    const Reference& reference(int elements);
    template <class Real>
    SolverParts<Real>& parts(int elements, kernels::InstructionSet instruction_set, runtime::OperatorKind kind);

    MachineLimits& limits() noexcept { return limits_; }

    /// Counts a result whose error is too large.
    void add_failure() noexcept { ++failures_; }
    int failures() const noexcept { return failures_; }

  private:
    using Key = std::tuple<int, kernels::InstructionSet, runtime::OperatorKind>;
    template <class Real>
    struct Kept {
        Key key{};
        std::unique_ptr<SolverParts<Real>> parts;
    };

    std::unique_ptr<runtime::Scheduler> scheduler_;
    MachineLimits limits_;
    std::map<int, std::array<int, 3>> cells_;  ///< by elements
    std::map<int, BentBar> bars_;
    std::map<int, Reference> references_;
    Kept<float> float_;
    Kept<double> double_;
    int failures_ = 0;
};

/// The elements of a bar of that many cells.
constexpr int elements_of(const std::array<int, 3>& cells) {
    return 5 * cells[0] * cells[1] * cells[2];
}

}  // namespace lancet::experiments
