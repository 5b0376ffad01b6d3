#include "lancet/runtime/observe/machine_stamp.hpp"

#include <cstdlib>
#include <ctime>

#include "lancet_build_facts.hpp"
#include "lancet_commit.hpp"

#include "lancet/runtime/observe/machine.hpp"

namespace lancet::runtime {
namespace {

std::string utc_now() {
    const std::time_t now = std::time(nullptr);
    std::tm calendar{};
    gmtime_r(&now, &calendar);
    std::array<char, 32> text{};
    const std::size_t length = std::strftime(text.data(), text.size(), "%Y-%m-%dT%H:%M:%SZ", &calendar);
    return {text.data(), length};
}

std::string environment(const char* name) {
    const char* value = std::getenv(name);
    return value == nullptr ? "unset" : value;
}

std::string flags_for(std::string_view instruction_set) {
    std::string flags(build_facts::flags);
    for (const auto& entry : build_facts::instruction_set_flags) {
        if (entry.name == instruction_set && !entry.flags.empty()) flags.append(" ").append(entry.flags);
    }
    return flags;
}

}  // namespace

MachineStamp machine_stamp(std::string_view instruction_set, SchedulerKind scheduler, int threads) {
    MachineStamp stamp;
    stamp.version = build_facts::version;
    stamp.commit = build_facts::commit;
    stamp.dirty = build_facts::dirty;
    stamp.compiler = build_facts::compiler;
    stamp.flags = flags_for(instruction_set);
    stamp.build_type = build_facts::build_type;
    stamp.instruction_set = instruction_set;
    stamp.scheduler = to_string(scheduler);
    stamp.threads = threads;
    stamp.load_average = load_averages();
    stamp.cpu_model = cpu_model();
    stamp.cores_online = cores_online();
    stamp.cores_allowed = cores_allowed();
    stamp.kernel = kernel_release();
    stamp.l1_bytes = cache_bytes(1);
    stamp.l2_bytes = cache_bytes(2);
    stamp.l3_bytes = cache_bytes(3);
    stamp.omp_wait_policy = environment("OMP_WAIT_POLICY");
    stamp.date = utc_now();
    return stamp;
}

}  // namespace lancet::runtime
