#pragma once

#include <nlohmann/json_fwd.hpp>

#include "lancet/runtime/observe/machine_stamp.hpp"

namespace lancet::runtime {

/// Writes the stamp as an object whose keys are the names of its members; nlohmann::json finds it by itself.
void to_json(nlohmann::json& json, const MachineStamp& stamp);

/// The same, for objects that keep the order of their keys.
void to_json(nlohmann::ordered_json& json, const MachineStamp& stamp);

}  // namespace lancet::runtime
