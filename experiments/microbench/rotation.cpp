#include <algorithm>
#include <cmath>
#include <random>
#include <string>
#include <vector>

#include <Eigen/Dense>
#include <benchmark/benchmark.h>

#include "lancet/experiments/microbench/subjects.hpp"
#include "lancet/kernels/isa/kernel_set.hpp"

namespace lancet::experiments {

namespace {

constexpr std::size_t matrices = 1024;    // a multiple of every width; in the first-level cache with their quaternions
constexpr double warm_start_angle = 0.1;  // between start and solution, about any axis: a fast motion per time step
constexpr double strain = 0.1;            // standard deviation of every entry of the displacement gradient

/// Deformation gradients, their rotations by a singular value decomposition in double, and warm starts.
template <class Real>
struct Problem {
    std::vector<Real> f;     // [batch][entry][lane]
    std::vector<Real> warm;  // [batch][w, x, y, z][lane]
    std::vector<Real> cold;  // the identity
    std::vector<Eigen::Matrix3d> rotation;

    explicit Problem(std::size_t width) : f(9 * matrices), warm(4 * matrices), cold(4 * matrices), rotation(matrices) {
        std::mt19937 generator(2018);
        std::normal_distribution<double> normal;
        const auto random = [&] { return normal(generator); };
        for (std::size_t i = 0; i < matrices; ++i) {
            const Eigen::Quaterniond turn = Eigen::Quaterniond(random(), random(), random(), random()).normalized();
            const Eigen::Matrix3d gradient =
                turn * (Eigen::Matrix3d::Identity() + strain * Eigen::Matrix3d::NullaryExpr(random));
            const Eigen::Matrix3d seen = gradient.cast<Real>().template cast<double>();
            const Eigen::JacobiSVD<Eigen::Matrix3d> svd(seen, Eigen::ComputeFullU | Eigen::ComputeFullV);
            const double sign = svd.matrixU().determinant() * svd.matrixV().determinant() > 0 ? 1 : -1;
            rotation[i] = svd.matrixU() * Eigen::Vector3d(1, 1, sign).asDiagonal() * svd.matrixV().transpose();
            const Eigen::Vector3d axis = Eigen::Vector3d(random(), random(), random()).normalized();
            const Eigen::Quaterniond start =
                Eigen::Quaterniond(rotation[i]) * Eigen::AngleAxisd(warm_start_angle, axis);
            const double components[4] = {start.w(), start.x(), start.y(), start.z()};
            const std::size_t lane = i % width;
            for (std::size_t c = 0; c < 9; ++c) {
                f[(i / width * 9 + c) * width + lane] =
                    static_cast<Real>(seen(static_cast<int>(c / 3), static_cast<int>(c % 3)));
            }
            for (std::size_t c = 0; c < 4; ++c) {
                warm[(i / width * 4 + c) * width + lane] = static_cast<Real>(components[c]);
                cold[(i / width * 4 + c) * width + lane] = c == 0 ? Real(1) : Real(0);
            }
        }
    }

    /// |R - reference| (Frobenius) of every matrix, in order of size.
    std::vector<double> errors(const std::vector<Real>& quaternions, std::size_t width) const {
        std::vector<double> all;
        for (std::size_t i = 0; i < matrices; ++i) {
            const Real* q = quaternions.data() + i / width * 4 * width + i % width;
            const Eigen::Quaterniond found(q[0], q[width], q[2 * width], q[3 * width]);
            all.push_back((found.toRotationMatrix() - rotation[i]).norm());
        }
        std::sort(all.begin(), all.end());
        return all;
    }
};

struct Setting {
    kernels::RotationMethod method;
    int steps;
    bool cold;
    const char* name;
};

/// What has a start is measured from a near one and from the identity.
constexpr Setting settings[] = {{kernels::RotationMethod::quaternion, 1, false, "quaternion-1"},
                                {kernels::RotationMethod::quaternion, 2, false, "quaternion-2"},
                                {kernels::RotationMethod::quaternion, 2, true, "quaternion-2"},
                                {kernels::RotationMethod::robust, 2, false, "robust-2"},
                                {kernels::RotationMethod::robust, 2, true, "robust-2"},
                                {kernels::RotationMethod::polar, 0, true, "polar"},
                                {kernels::RotationMethod::svd, 0, true, "svd"}};

bool has_start(const Setting& setting) {
    return setting.method == kernels::RotationMethod::quaternion || setting.method == kernels::RotationMethod::robust;
}

/// Time of one decomposition. A start is copied before every pass over the matrices, which is part of the time.
template <class Real>
void measure_rotation(benchmark::State& state, kernels::InstructionSet set, const Setting& setting) {
    const auto& kernels = kernels::kernel_set<Real>(set);
    const std::size_t width = static_cast<std::size_t>(kernels.width);
    const int batches = static_cast<int>(matrices / width);
    const Problem<Real> problem(width);
    const std::vector<Real>& start = setting.cold ? problem.cold : problem.warm;
    std::vector<Real> q = start;
    while (state.KeepRunningBatch(matrices)) {
        if (has_start(setting)) std::copy(start.begin(), start.end(), q.begin());
        kernels.rotation.decompose(setting.method, setting.steps, problem.f.data(), q.data(), 0, batches);
        benchmark::DoNotOptimize(q.data());
        benchmark::ClobberMemory();
    }
    const std::vector<double> errors = problem.errors(q, width);
    state.counters["rotation_error_max"] = errors.back();
    state.counters["rotation_error_median"] = errors[errors.size() / 2];
    state.counters["lanes"] = kernels.width;
}

template <class Real>
void register_scalar(kernels::InstructionSet set, const Setting& setting) {
    std::string name = std::string("rotation/") + setting.name + "/" + scalar_name<Real>() + "/" +
                       std::string(kernels::to_string(set));
    if (has_start(setting)) name += setting.cold ? "/cold" : "/warm";
    benchmark::RegisterBenchmark(
        name.c_str(), [set, setting](benchmark::State& state) { measure_rotation<Real>(state, set, setting); });
}

}  // namespace

void register_rotation() {
    for (const Setting& setting : settings) {
        for (const kernels::InstructionSet set : instruction_sets_to_measure()) {
            register_scalar<float>(set, setting);
            register_scalar<double>(set, setting);
        }
    }
}

}  // namespace lancet::experiments
