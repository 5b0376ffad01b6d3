#include "lancet/experiments/stability/case.hpp"

#include <algorithm>
#include <exception>
#include <numeric>

#include "lancet/experiments/stability/subjects.hpp"
#include "lancet/kernels/error.hpp"

namespace lancet::experiments::stability {

const std::vector<Category>& categories() {
    static const std::vector<Category> all{fractions(),   critical_steps(), sequences(),
                                           progressive(), recovery(),       poisson_ratios(),
                                           stiff_parts(), flat_elements(),  not_finite()};
    return all;
}

std::string case_name(const Category& category, const Variant& variant) {
    std::string name = category.name;
    const auto add = [&](std::string_view word) {
        if (!word.empty()) name += "/" + std::string(word);
    };
    add(variant.detail);
    if (variant.enrichment != runtime::Enrichment::substituted) add(to_string(variant.enrichment));
    if (variant.fronts == mesh::Fronts::blended) add(to_string(variant.fronts));
    add(variant.lumping_name());
    add(kernels::to_string(variant.model));
    add(to_string(variant.scalar));
    if (!variant.has_dynamics) return name;
    if (variant.is_explicit()) {
        add(variant.stepping == Stepping::explicit_element ? "explicit" : "explicit-assembled");
    } else {
        add(to_string(variant.matrix));
        add(to_string(variant.preconditioner));
    }
    return name;
}

std::vector<Case> cases_of(const Selection& selection) {
    std::vector<Case> cases;
    for (std::size_t c = 0; c < categories().size(); ++c) {
        const Category& category = categories()[c];
        const auto& names = selection.categories;
        if (!names.empty() && std::find(names.begin(), names.end(), category.name) == names.end()) continue;
        const std::size_t own = static_cast<std::size_t>(selection.quick ? category.quick_cases : category.cases);
        const std::size_t count = selection.cases > 0 ? static_cast<std::size_t>(selection.cases) : own;
        const auto& scalars = selection.scalars;
        std::vector<std::size_t> variants;
        for (std::size_t v = 0; v < category.variants.size(); ++v) {
            const std::string scalar(to_string(category.variants[v].scalar));
            if (scalars.empty() || std::ranges::find(scalars, scalar) != scalars.end()) variants.push_back(v);
        }
        if (variants.empty()) continue;
        // The golden section spreads evenly; a stride without a common divisor meets every variant.
        auto stride = static_cast<std::size_t>(0.618 * static_cast<double>(variants.size())) + 1;
        while (std::gcd(stride, variants.size()) != 1) ++stride;
        for (std::size_t k = 0; k < count; ++k) {
            cases.push_back({c, variants[k * stride % variants.size()], selection.seed + k});
        }
    }
    return cases;
}

Case case_named(const std::string& name, std::uint64_t seed) {
    std::string near;
    for (std::size_t c = 0; c < categories().size(); ++c) {
        const Category& category = categories()[c];
        const bool is_category = name == category.name || name.starts_with(category.name + "/");
        for (std::size_t v = 0; v < category.variants.size(); ++v) {
            const std::string candidate = case_name(category, category.variants[v]);
            if (candidate == name) return {c, v, seed};
            if (is_category && near.size() < 400) near += (near.empty() ? "" : ", ") + candidate;
        }
        if (!is_category && near.size() < 400) near += (near.empty() ? "" : ", ") + category.name + "/...";
    }
    throw Error("--case: there is no '" + name + "'; expected a name such as " + near);
}

Verdict run_case(const Case& one, runtime::Scheduler& scheduler) {
    const Category& category = categories()[one.category];
    try {
        return category.run(category.variants[one.variant], one.seed, scheduler);
    } catch (const std::exception& error) {
        Verdict verdict;
        verdict.fail(std::string("exception: ") + error.what());
        return verdict;
    }
}

}  // namespace lancet::experiments::stability
