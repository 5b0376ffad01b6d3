#pragma once

#include <array>
#include <cstddef>
#include <string>
#include <string_view>

#include "lancet/runtime/schedule/scheduler.hpp"

namespace lancet::runtime {

/// What a measurement was made with: it stands beside the numbers in every result file.
struct MachineStamp {
    std::string version;   ///< of Lancet
    std::string commit;    ///< full hash of the sources at build time; "unknown" outside of a git checkout
    bool dirty = false;    ///< the sources differed from that commit
    std::string compiler;  ///< name and version
    std::string flags;     ///< of every source file, then those of the kernels for the active instruction set
    std::string build_type;
    std::string instruction_set;  ///< the active one
    std::string scheduler;
    int threads = 0;
    std::array<double, 3> load_average{};  ///< over 1, 5 and 15 minutes
    std::string cpu_model;
    int cores_online = 0;
    int cores_allowed = 0;     ///< to this process
    std::string kernel;        ///< name, release and machine, as uname gives them
    std::size_t l1_bytes = 0;  ///< data cache of one core; 0 where the system does not tell, as in the following ones
    std::size_t l2_bytes = 0;  ///< one instance
    std::size_t l3_bytes = 0;  ///< one instance
    std::string omp_wait_policy;  ///< the environment variable OMP_WAIT_POLICY, or "unset"
    std::string date;             ///< UTC, as in 2024-02-29T12:00:00Z
};

/// The stamp of this program on this machine now. `instruction_set` is the name of the active one.
MachineStamp machine_stamp(std::string_view instruction_set, SchedulerKind scheduler, int threads);

}  // namespace lancet::runtime
