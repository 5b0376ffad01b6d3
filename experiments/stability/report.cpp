#include "lancet/experiments/stability/report.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <ostream>
#include <set>

namespace lancet::experiments::stability {

namespace {

const Category& category_of(const Outcome& outcome) {
    return categories()[outcome.one.category];
}

const Variant& variant_of(const Outcome& outcome) {
    return category_of(outcome).variants[outcome.one.variant];
}

struct Count {
    std::int64_t run = 0, survived = 0;
    std::optional<double> ratio{}, error{}, excess{}, iterations{};
    bool is_promised = true;

    void add(const Outcome& outcome) {
        const Verdict& verdict = outcome.verdict;
        ++run;
        survived += verdict.survived ? 1 : 0;
        is_promised = variant_of(outcome).is_promised;
        const auto take_larger = [](std::optional<double>& largest, const std::optional<double>& value) {
            if (value && (!largest || *value > *largest)) largest = value;
        };
        take_larger(ratio, verdict.iteration_ratio);
        take_larger(error, verdict.error);
        take_larger(excess, verdict.energy_excess);
        take_larger(iterations, verdict.iterations);
    }
};

Cell cell(const std::optional<double>& value) {
    return value ? Cell(*value) : Cell();
}

std::string time_of(const Variant& variant) {
    if (!variant.has_dynamics) return "-";
    switch (variant.stepping) {
        case Stepping::explicit_element:
            return "explicit";
        case Stepping::explicit_assembled:
            return "explicit-assembled";
        default:
            return "implicit";
    }
}

/// Details and solvers together, as far as they do not tell what survives: the words of a row.
using Key = std::array<std::string, 7>;
Key key_of(const Outcome& outcome) {
    const Variant& v = variant_of(outcome);
    return {v.detail,
            std::string(to_string(v.enrichment)),
            v.has_dynamics ? std::string(to_string(v.fronts)) : "-",
            v.lumping_name(),
            std::string(kernels::to_string(v.model)),
            std::string(to_string(v.scalar)),
            time_of(v)};
}

}  // namespace

nlohmann::ordered_json verdict_json(const Verdict& verdict) {
    nlohmann::ordered_json document{{"survived", verdict.survived}, {"reason", verdict.reason}, {"body", verdict.body}};
    // Numbers that are not finite are left out: JSON has none.
    const auto put = [&](const char* key, const std::optional<double>& value) {
        if (value && std::isfinite(*value)) document[key] = *value;
    };
    put("iterations", verdict.iterations);
    put("iteration_ratio", verdict.iteration_ratio);
    put("error", verdict.error);
    put("energy_excess", verdict.energy_excess);
    put("repeats", verdict.repeats);
    return document;
}

Verdict verdict_of(const nlohmann::ordered_json& document) {
    Verdict verdict;
    verdict.survived = document.at("survived");
    verdict.reason = document.at("reason");
    verdict.body = document.at("body");
    const auto get = [&](const char* key, std::optional<double>& value) {
        if (document.contains(key)) value = document.at(key).get<double>();
    };
    get("iterations", verdict.iterations);
    get("iteration_ratio", verdict.iteration_ratio);
    get("error", verdict.error);
    get("energy_excess", verdict.energy_excess);
    get("repeats", verdict.repeats);
    return verdict;
}

Table survival_table(std::span<const Outcome> outcomes) {
    Table table({{"category", "category"},
                 {"detail", "detail"},
                 {"enrichment", "enrichment"},
                 {"fronts", "fronts"},
                 {"lumping", "lumping"},
                 {"material", "material"},
                 {"scalar", "scalar"},
                 {"time", "time"},
                 {"run", "run"},
                 {"survived", "survived"},
                 {"failed", "failed"},
                 {"promised", "promised"},
                 {"iterations", "iterations", "at most"},
                 {"iteration_ratio", "ratio", "at most"},
                 {"error", "error", "at most"},
                 {"energy_excess", "energy excess", "at most"}});
    for (std::size_t c = 0; c < categories().size(); ++c) {
        std::vector<Key> order;
        std::map<Key, Count> counts;
        for (const Outcome& outcome : outcomes) {
            if (outcome.one.category != c) continue;
            const Key key = key_of(outcome);
            if (!counts.contains(key)) order.push_back(key);
            counts[key].add(outcome);
        }
        std::ranges::sort(order);
        for (const Key& key : order) {
            const Count& count = counts.at(key);
            table.add_row({categories()[c].name, key[0], key[1], key[2], key[3], key[4], key[5], key[6], count.run,
                           count.survived, count.run - count.survived, std::string(count.is_promised ? "yes" : "no"),
                           cell(count.iterations), cell(count.ratio), cell(count.error), cell(count.excess)});
        }
    }
    return table;
}

Table category_table(std::span<const Outcome> outcomes) {
    Table table({{"category", "category"},
                 {"run", "run"},
                 {"survived", "survived"},
                 {"failed", "failed"},
                 {"promised_failed", "of which promised"}});
    for (std::size_t c = 0; c < categories().size(); ++c) {
        std::int64_t run = 0, survived = 0, promised = 0;
        for (const Outcome& outcome : outcomes) {
            if (outcome.one.category != c) continue;
            ++run;
            survived += outcome.verdict.survived ? 1 : 0;
            promised += !outcome.verdict.survived && variant_of(outcome).is_promised ? 1 : 0;
        }
        if (run > 0) table.add_row({categories()[c].name, run, survived, run - survived, promised});
    }
    return table;
}

Table failure_table(std::span<const Outcome> outcomes) {
    Table table({{"case", "case"}, {"seed", "seed"}, {"promised", "promised"}, {"reason", "reason"}, {"body", "body"}});
    for (const Outcome& outcome : outcomes) {
        if (outcome.verdict.survived) continue;
        table.add_row({outcome.one.name(), static_cast<std::int64_t>(outcome.one.seed),
                       std::string(variant_of(outcome).is_promised ? "yes" : "no"), outcome.verdict.reason,
                       outcome.verdict.body});
    }
    return table;
}

std::size_t promised_failures(std::span<const Outcome> outcomes) {
    return static_cast<std::size_t>(std::ranges::count_if(
        outcomes, [](const Outcome& outcome) { return !outcome.verdict.survived && variant_of(outcome).is_promised; }));
}

void print_report(std::ostream& stream, std::span<const Outcome> outcomes) {
    survival_table(outcomes).print(stream);
    stream << '\n';
    category_table(outcomes).print(stream);
    stream << "\nWhat 'survived' means\n";
    std::set<std::size_t> shown;
    for (const Outcome& outcome : outcomes) {
        if (shown.insert(outcome.one.category).second) {
            stream << "- " << category_of(outcome).name << ": " << category_of(outcome).criterion << '\n';
        }
    }
    stream << "Bodies compute in the substituted basis whatever the enrichment (a node-local change of basis); other "
              "bases stand where the study of critical steps has them.\n\n";
    const Table failures = failure_table(outcomes);
    stream << (failures.rows().empty() ? "Failures: none\n" : "Failures; to repeat one: --case NAME --seed N\n");
    if (!failures.rows().empty()) failures.print(stream);
}

nlohmann::ordered_json report_json(std::span<const Outcome> outcomes) {
    nlohmann::ordered_json document;
    document["categories"] = category_table(outcomes).to_json();
    for (auto& row : document["categories"]) {
        const auto category = std::ranges::find(categories(), row.at("category").get<std::string>(), &Category::name);
        row["criterion"] = category->criterion;
    }
    document["rows"] = survival_table(outcomes).to_json();
    document["failures"] = failure_table(outcomes).to_json();
    return document;
}

}  // namespace lancet::experiments::stability
