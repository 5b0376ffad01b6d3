#include "lancet/experiments/precision/choice.hpp"

#include <algorithm>

namespace lancet::experiments::precision {

bool Choice::has_scalar(const std::string& scalar) const {
    return std::find(scalars.begin(), scalars.end(), scalar) != scalars.end();
}

std::vector<Setting> Choice::machines(const Setting& setting) const {
    std::vector<Setting> settings;
    for (const std::string& instruction_set : instruction_sets) {
        for (const std::string& scheduler : schedulers) {
            for (const int count : threads) {
                if (scheduler == "serial" && count != 1) continue;
                settings.push_back(setting);
                settings.back().scheduler = scheduler;
                settings.back().threads = count;
                settings.back().instruction_set = instruction_set;
            }
        }
    }
    return settings;
}

std::vector<Setting> Choice::baseline_machines(const Setting& setting) const {
    std::vector<Setting> settings;
    for (const int count : threads) {
        settings.push_back(setting);
        settings.back().scheduler = count == 1 ? "serial" : "openmp";
        settings.back().threads = count;
        settings.back().instruction_set = "native";
    }
    return settings;
}

}  // namespace lancet::experiments::precision
