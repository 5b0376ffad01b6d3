#pragma once

#include <array>
#include <span>
#include <vector>

#include "lancet/runtime/integrate/line_search.hpp"

namespace lancet::runtime {

/// The energy safeguard of implicit Euler. A step that was linearised once may gain energy that neither loads nor holds
/// have given. Such a step is repeated from its start by Newton's method with a line search, and where that does not
/// bring the energy down, slowed down until it does.
template <class Real, class Accumulate>
class EnergySafeguard {
  public:
    /// What a repeated step is solved with; all must outlive the safeguard.
    struct Parts {
        const kernels::NodeNumbering& numbering;
        const Inertia& inertia;
        const StepEquations& equations;
        StepEnergy<Real>& energy;
        StepSystem<Real, Accumulate>& system;
        LineSearch<Real, Accumulate>& line_search;
    };
    /// `iterations`: of Newton's method in a repeat, at most.
    EnergySafeguard(const Parts& parts, int iterations);

    /// Before a step: takes up the energy of the motion, where it is not that of the last step's end.
    void begin(Scheduler& scheduler, const BodyMotion& motion, std::span<const double> before_hold, StepTotals& totals);
    /// After a step: repeats it if it has gained energy, which the report tells, and keeps the energy of the motion.
    void check(Scheduler& scheduler, const StepSubject& subject, StepReport& report, StepTotals& totals);

    /// Tells that the motion was changed from outside.
    void forget() noexcept { is_known_ = false; }

    std::size_t bytes() const noexcept { return kernels::heap_bytes(partial_); }
    void save(std::vector<double>& numbers) const;
    /// Reads back what save wrote, from the front of `numbers`, which it removes.
    void restore(std::span<const double>& numbers);

  private:
    using Inner = typename StepEnergy<Real>::Inner;

    /// Whether the step has gained energy over what it had `before`; leaves what it has in inner_.
    bool gains(Scheduler& scheduler, const StepSubject& subject, const Inner& before);
    /// Newton's method from the start of the step or from where it has come, whichever is lower in potential. Returns
    /// whether the step gains still.
    bool minimise(Scheduler& scheduler, const StepSubject& subject, const Inner& before, StepReport& report,
                  StepTotals& totals);
    /// Slows the motion down until it does not gain.
    void brake(Scheduler& scheduler, const StepSubject& subject, const Inner& before);
    /// The mean velocity at the end of a step of a body that nothing holds, from its momentum; zero for one that
    /// something holds.
    std::array<double, 4> free_velocity(Scheduler& scheduler, const BodyLoads& loads, const ConstraintFilter& filter);
    /// v = share v + (1 - share) limit where no hold prescribes it.
    void slow_down(Scheduler& scheduler, BodyMotion& motion, const ConstraintFilter& filter, double share,
                   const std::array<double, 4>& limit);
    void move(Scheduler& scheduler, BodyMotion& motion);

    Parts parts_;
    int iterations_;
    Inner inner_;  ///< at the end of the last step
    bool is_known_ = false;
    std::vector<double> partial_;
};

}  // namespace lancet::runtime
