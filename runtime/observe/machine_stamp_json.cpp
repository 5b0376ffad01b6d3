#include "lancet/runtime/observe/machine_stamp_json.hpp"

#include <nlohmann/json.hpp>

namespace lancet::runtime {
namespace {

template <class Json>
Json object_of(const MachineStamp& stamp) {
    return Json{
        {"version", stamp.version},
        {"commit", stamp.commit},
        {"dirty", stamp.dirty},
        {"compiler", stamp.compiler},
        {"flags", stamp.flags},
        {"build_type", stamp.build_type},
        {"instruction_set", stamp.instruction_set},
        {"scheduler", stamp.scheduler},
        {"threads", stamp.threads},
        {"load_average", stamp.load_average},
        {"cpu_model", stamp.cpu_model},
        {"cores_online", stamp.cores_online},
        {"cores_allowed", stamp.cores_allowed},
        {"kernel", stamp.kernel},
        {"l1_bytes", stamp.l1_bytes},
        {"l2_bytes", stamp.l2_bytes},
        {"l3_bytes", stamp.l3_bytes},
        {"omp_wait_policy", stamp.omp_wait_policy},
        {"date", stamp.date},
    };
}

}  // namespace

void to_json(nlohmann::json& json, const MachineStamp& stamp) {
    json = object_of<nlohmann::json>(stamp);
}
void to_json(nlohmann::ordered_json& json, const MachineStamp& stamp) {
    json = object_of<nlohmann::ordered_json>(stamp);
}

}  // namespace lancet::runtime
