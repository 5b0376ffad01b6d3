#include "lancet/experiments/bar/pictures.hpp"

#include <string>
#include <system_error>
#include <vector>

#include "lancet/experiments/bar/workers.hpp"
#include "lancet/kernels/error.hpp"
#include "lancet/mesh/io/write_pvd.hpp"
#include "lancet/mesh/io/write_vtu.hpp"

namespace lancet::experiments::bar {
namespace {

void write_frame(const std::filesystem::path& file, const mesh::TetMesh& mesh, const std::vector<double>& positions) {
    std::vector<mesh::Point> points(mesh.nodes().size());
    std::vector<double> displacement(positions.size());
    for (std::size_t i = 0; i < positions.size(); ++i) {
        points[i / 3][i % 3] = positions[i];
        displacement[i] = positions[i] - mesh.nodes()[i / 3][i % 3];
    }
    mesh::VtuContent content;
    content.positions = points;
    content.point_data.push_back({"displacement", 3, std::span<const double>(displacement)});
    mesh::write_vtu(file, mesh, content);
}

}  // namespace

std::string picture_name(const Job& job, const std::string& scalar) {
    std::string name = job.method + "-" + job.setting + "-" + scalar;
    for (const std::string& argument : job.arguments) {
        for (const std::string option : {"--operator=", "--isa=", "--scheduler="}) {
            if (argument.rfind(option, 0) == 0) name += "-" + argument.substr(option.size());
        }
    }
    return name + "-" + std::to_string(job.threads);
}

void write_pictures(const Job& job, const ProblemOptions& options, const Problem& problem,
                    const std::filesystem::path& folder, const std::string& name) {
    constexpr int most_frames = 25;
    const int stride = (problem.steps + most_frames - 1) / most_frames;
    std::vector<double> times;
    for (int step = stride; step <= problem.steps; step += stride) times.push_back(step * problem.time_step);
    std::vector<std::vector<double>> states;
    run_worker(job, options, times, problem.mesh.nodes().size(), states);

    std::error_code error;
    std::filesystem::create_directories(folder / name, error);
    if (error) throw Error((folder / name).string() + ": cannot be made: " + error.message());
    std::vector<double> rest;
    for (const mesh::Point& p : problem.mesh.nodes()) rest.insert(rest.end(), p.begin(), p.end());
    states.insert(states.begin(), rest);
    times.insert(times.begin(), 0.0);
    std::vector<mesh::PvdFrame> frames;
    for (std::size_t i = 0; i < states.size(); ++i) {
        const std::filesystem::path file = std::filesystem::path(name) / (std::to_string(i) + ".vtu");
        write_frame(folder / file, problem.mesh, states[i]);
        frames.push_back({times[i], file});
    }
    mesh::write_pvd(folder / (name + ".pvd"), frames);
}

}  // namespace lancet::experiments::bar
