#pragma once

#include <cstdint>
#include <functional>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "lancet/mesh/cut/lanes.hpp"
#include "lancet/runtime/cut/enrichment.hpp"
#include "lancet/runtime/schedule/scheduler.hpp"
#include "lancet/runtime/simulate/settings.hpp"

/// A stress test is a case: a variant, which says what computes, and a seed, from which all else follows.
namespace lancet::experiments::stability {

/// How a body goes through time, and where an explicit time step comes from.
enum class Stepping {
    implicit,
    /// 0.95 of the critical step of the elements, each by itself: the bound that fraction lumping keeps.
    explicit_element,
    /// 0.95 of the critical step of the assembled body before it was cut: longer, for neighbours hold each other back,
    /// which a cut ends.
    explicit_assembled
};

/// What a case computes with.
struct Variant {
    std::string detail{};  ///< what is special to the category; may be empty
    double number = 0;     ///< that goes with the detail
    runtime::Enrichment enrichment = runtime::Enrichment::substituted;
    mesh::Fronts fronts = mesh::Fronts::sharp;
    /// Masses; nothing where the category chooses them in words of its own, see `lumping`.
    runtime::MassKind mass = runtime::MassKind::lumped;
    std::string lumping{};  ///< instead of `mass`, for what bodies do not have
    runtime::ElementModel model = runtime::ElementModel::corotational;
    runtime::ScalarMode scalar = runtime::ScalarMode::double_precision;
    runtime::OperatorKind matrix = runtime::OperatorKind::edge_blocks;
    runtime::PreconditionerKind preconditioner = runtime::PreconditionerKind::coarse;
    Stepping stepping = Stepping::implicit;
    bool has_dynamics = true;
    /// Whether the method is made for it. What is not is run, judged and reported like the rest, but it does not make
    /// the program fail.
    bool is_promised = true;

    bool is_explicit() const { return stepping != Stepping::implicit; }
    std::string lumping_name() const { return lumping.empty() ? std::string(to_string(mass)) : lumping; }
};

/// How a case ended.
struct Verdict {
    bool survived = true;
    std::string reason{};                     ///< of the first criterion that was not met
    std::string body{};                       ///< what was simulated, in a few words
    std::optional<double> iterations{};       ///< of conjugate gradients: the most in one step, or of one solution
    std::optional<double> iteration_ratio{};  ///< over those of the same problem without cuts
    std::optional<double> error{};            ///< as the category's criterion measures it
    std::optional<double> energy_excess{};    ///< beyond what the loads have put in, over the larger of both
    std::optional<double> repeats{};          ///< share of the steps that the energy safeguard repeated

    /// Notes a criterion that was not met, unless one has been noted before.
    void fail(const std::string& why) {
        if (survived) reason = why;
        survived = false;
    }
};

/// A kind of stress test.
struct Category {
    std::string name;
    std::string criterion;  ///< what 'survives' means, and where the bound comes from
    std::vector<Variant> variants;
    int cases = 0;        ///< variants take turns
    int quick_cases = 0;  ///< with --quick
    std::function<Verdict(const Variant&, std::uint64_t seed, runtime::Scheduler&)> run;
};

/// All of them.
const std::vector<Category>& categories();

/// The name by which --case finds a variant again, such as fractions/1e-14/linear/lumped/float/edge-blocks/coarse.
std::string case_name(const Category& category, const Variant& variant);

/// One case to run.
struct Case {
    std::size_t category = 0;
    std::size_t variant = 0;
    std::uint64_t seed = 0;
    std::string name() const { return case_name(categories()[category], categories()[category].variants[variant]); }
};

/// How many cases of which categories.
struct Selection {
    std::vector<std::string> categories{};  ///< by name; empty: all
    std::vector<std::string> scalars{};     ///< "float", "mixed", "double"; empty: all
    bool quick = false;
    int cases = 0;  ///< of each category; 0: its own number
    std::uint64_t seed = 1;
};

/// The cases of a selection. Case k of a category has seed seed + k; variants take turns, in strides that spread the
/// first few over all of them.
std::vector<Case> cases_of(const Selection& selection);

/// The case with this name. Throws lancet::Error where there is none, and lists what is near.
Case case_named(const std::string& name, std::uint64_t seed);

/// Runs a case. What it throws is a failure, too.
Verdict run_case(const Case& one, runtime::Scheduler& scheduler);

}  // namespace lancet::experiments::stability
