#include "lancet/experiments/precision/run.hpp"

#include <algorithm>

#include "lancet/experiments/common/table.hpp"

namespace lancet::experiments::precision {

std::string Setting::label() const {
    std::string text = method;
    const auto add = [&text](const std::string& word) {
        if (!word.empty()) text += " " + word;
    };
    const auto number = [](double value) { return format_number(value, 3); };
    add(std::to_string(cells[0]) + "x" + std::to_string(cells[1]) + "x" + std::to_string(cells[2]));
    for (const std::string* word : {&scalar, &operator_, &preconditioner, &integrator}) add(*word);
    if (time_step > 0) add("dt=" + number(time_step));
    if (linearisation != "prediction") add(linearisation.empty() ? "" : "at-" + linearisation);
    if (!tangent.empty() && tangent != "exact") add(tangent + "-tangent");
    if (!rotation.empty() && rotation != "robust") add(rotation);
    if (rotation_interval > 1) add("every-" + std::to_string(rotation_interval));
    if (tolerance > 0) add("tol=" + number(tolerance));
    if (iterations > 0) add("its<=" + std::to_string(iterations));
    if (newton_tolerance > 0) add("newton=" + number(newton_tolerance));
    if (threads > 1) add(scheduler + " " + std::to_string(threads) + " threads");
    return text;
}

double Errors::judged() const {
    if (l2 && quantity) return std::max(*l2, *quantity);
    return l2 ? *l2 : quantity.value_or(0);
}

}  // namespace lancet::experiments::precision
