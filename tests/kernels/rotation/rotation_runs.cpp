#include "tests/kernels/rotation/rotation_runs.hpp"

namespace lancet::kernels::test {

namespace {

template <class Real>
std::vector<Eigen::Quaterniond> decompose_in(const RotationRun& run, const std::vector<Eigen::Matrix3d>& f,
                                             const std::vector<Eigen::Quaterniond>& start, int steps) {
    const KernelSet<Real>& kernels = kernel_set<Real>(run.instruction_set);
    const std::size_t width = static_cast<std::size_t>(kernels.width);
    const std::size_t batches = (f.size() + width - 1) / width;
    std::vector<Real> matrices(9 * width * batches);
    std::vector<Real> quaternions(4 * width * batches);
    for (std::size_t i = 0; i < width * batches; ++i) {
        const std::size_t source = std::min(i, f.size() - 1);
        const Eigen::Quaterniond& q = start[source];
        const double components[4] = {q.w(), q.x(), q.y(), q.z()};
        for (std::size_t c = 0; c < 9; ++c) {
            matrices[(i / width * 9 + c) * width + i % width] =
                static_cast<Real>(f[source](static_cast<int>(c / 3), static_cast<int>(c % 3)));
        }
        for (std::size_t c = 0; c < 4; ++c) {
            quaternions[(i / width * 4 + c) * width + i % width] = static_cast<Real>(components[c]);
        }
    }
    kernels.rotation.decompose(run.method, steps, matrices.data(), quaternions.data(), 0, static_cast<int>(batches));
    std::vector<Eigen::Quaterniond> result;
    for (std::size_t i = 0; i < f.size(); ++i) {
        const Real* q = quaternions.data() + i / width * 4 * width + i % width;
        result.emplace_back(q[0], q[width], q[2 * width], q[3 * width]);
    }
    return result;
}

}  // namespace

Eigen::Matrix3d RotationRun::rounded(const Eigen::Matrix3d& f) const {
    return single ? Eigen::Matrix3d(f.cast<float>().cast<double>()) : f;
}

std::vector<RotationRun> rotation_runs() {
    std::vector<RotationRun> runs;
    for (const InstructionSet instruction_set : compiled_instruction_sets()) {
        for (const bool single : {true, false}) {
            for (const RotationMethod method :
                 {RotationMethod::quaternion, RotationMethod::polar, RotationMethod::svd, RotationMethod::robust}) {
                runs.push_back({instruction_set, single, method});
            }
        }
    }
    return runs;
}

std::string run_name(const ::testing::TestParamInfo<RotationRun>& info) {
    return std::string(to_string(info.param.instruction_set)) + (info.param.single ? "_float_" : "_double_") +
           std::string(to_string(info.param.method));
}

std::vector<Eigen::Quaterniond> decompose(const RotationRun& run, const std::vector<Eigen::Matrix3d>& f,
                                          const std::vector<Eigen::Quaterniond>& start, int steps) {
    return run.single ? decompose_in<float>(run, f, start, steps) : decompose_in<double>(run, f, start, steps);
}

std::vector<Eigen::Quaterniond> decompose_cold(const RotationRun& run, const std::vector<Eigen::Matrix3d>& f,
                                               int steps) {
    return decompose(run, f, std::vector<Eigen::Quaterniond>(f.size(), Eigen::Quaterniond::Identity()), steps);
}

}  // namespace lancet::kernels::test
