#include "lancet/experiments/bar/worker.hpp"

#include <bit>
#include <cmath>
#include <cstring>
#include <fstream>
#include <ostream>
#include <utility>

#include <CLI/CLI.hpp>

#include "lancet/experiments/common/file.hpp"
#include "lancet/kernels/error.hpp"

namespace lancet::experiments::bar {
namespace {

static_assert(std::endian::native == std::endian::little, "snapshot files are little-endian");

/// The one list of the fields of a report, for writing and reading.
template <class Report, class Visit>
void visit_fields(Report& report, const Visit& visit) {
    visit("method", report.method);
    visit("variant", report.variant);
    visit("operator", report.operator_);
    visit("scalar", report.scalar);
    visit("isa", report.isa);
    visit("scheduler", report.scheduler);
    visit("threads", report.threads);
    visit("elements", report.elements);
    visit("nodes", report.nodes);
    visit("steps", report.steps);
    visit("seconds_total", report.seconds_total);
    visit("seconds_setup", report.seconds_setup);
    visit("seconds_forces", report.seconds_forces);
    visit("seconds_solve", report.seconds_solve);
    visit("seconds_rest", report.seconds_rest);
    visit("cg_iterations_total", report.cg_iterations_total);
    visit("repeats_total", report.repeats_total);
    visit("bytes", report.bytes);
    visit("solve_flops", report.solve_flops);
    visit("solve_bytes", report.solve_bytes);
    visit("energy_final", report.energy_final);
}

/// JSON has no number for what is not finite; a diverged run says so as a string.
void put(nlohmann::ordered_json& json, const char* name, double value) {
    if (std::isfinite(value)) {
        json[name] = value;
    } else {
        json[name] = std::isnan(value) ? "nan" : (value > 0 ? "inf" : "-inf");
    }
}
void put(nlohmann::ordered_json& json, const char* name, const auto& value) {
    json[name] = value;
}

void get(const nlohmann::json& json, double& value) {
    if (json.is_string()) {
        value = std::stod(json.get<std::string>());
    } else {
        value = json.get<double>();
    }
}
void get(const nlohmann::json& json, auto& value) {
    json.get_to(value);
}

}  // namespace

WorkerReport baseline_report(const std::string& method, const std::string& operator_name, const std::string& scalar,
                             int threads, const Problem& problem) {
    WorkerReport report;
    report.method = method;
    report.operator_ = operator_name;
    report.scalar = scalar;
    report.isa = "native";
    report.scheduler = threads == 1 ? "serial" : "openmp";
    report.threads = threads;
    report.elements = static_cast<std::int64_t>(problem.mesh.tetrahedra().size());
    report.nodes = static_cast<std::int64_t>(problem.mesh.nodes().size());
    report.steps = problem.steps;
    return report;
}

std::string to_line(const WorkerReport& report) {
    nlohmann::ordered_json json;
    visit_fields(report, [&json](const char* name, const auto& value) { put(json, name, value); });
    return json.dump();
}

WorkerReport report_from_line(const std::string& line, const std::string& worker) {
    WorkerReport report;
    try {
        const nlohmann::json json = nlohmann::json::parse(line);
        visit_fields(report, [&json](const char* name, auto& value) { get(json.at(name), value); });
    } catch (const std::exception& error) {
        throw Error(worker + ": '" + line.substr(0, 200) + "' printed, expected a report in JSON (" + error.what() +
                    ")");
    }
    return report;
}

void add_snapshot_options(CLI::App& app, SnapshotOptions& options) {
    app.add_option("--snapshots", options.file, "Write node positions to FILE (raw little-endian doubles)")
        ->type_name("FILE");
    app.add_option("--snapshot-times", options.times, "Times of the snapshots in s, a list such as 1,5")
        ->delimiter(',')
        ->type_name("LIST");
}

Snapshots::Snapshots(const SnapshotOptions& options, const Problem& problem) : file_(options.file) {
    if (options.file.empty() != options.times.empty()) {
        throw Error("--snapshots and --snapshot-times: one found without the other, expected both or none");
    }
    for (const double time : options.times) {
        const double step = std::round(time / problem.time_step);
        if (!std::isfinite(time) || std::abs(step * problem.time_step - time) > 1e-6 * problem.time_step || step < 1 ||
            step > problem.steps) {
            throw Error("--snapshot-times: " + std::to_string(time) + " found, expected multiples of the time step " +
                        std::to_string(problem.time_step) + " up to " +
                        std::to_string(problem.steps * problem.time_step));
        }
        if (!steps_.empty() && static_cast<int>(step) <= steps_.back()) {
            throw Error("--snapshot-times: " + std::to_string(time) + " found, expected ascending times");
        }
        steps_.push_back(static_cast<int>(step));
    }
    values_.reserve(3 * problem.mesh.nodes().size() * steps_.size());
}

bool Snapshots::wanted(int steps_done) const {
    for (const int step : steps_) {
        if (step == steps_done) return true;
    }
    return false;
}

void Snapshots::add(std::span<const double> positions) {
    values_.insert(values_.end(), positions.begin(), positions.end());
}

void Snapshots::write() const {
    if (file_.empty()) return;
    write_file(file_, [this](std::ostream& stream) {
        stream.write(reinterpret_cast<const char*>(values_.data()),
                     static_cast<std::streamsize>(values_.size() * sizeof(double)));
    });
}

std::vector<std::vector<double>> read_snapshots(const std::filesystem::path& file, std::size_t times,
                                                std::size_t nodes) {
    std::ifstream stream(file, std::ios::binary | std::ios::ate);
    if (!stream) throw Error(file.string() + ": cannot be read, expected snapshots of node positions");
    const auto size = static_cast<std::size_t>(stream.tellg());
    const std::size_t expected = times * nodes * 3 * sizeof(double);
    if (size != expected) {
        throw Error(file.string() + ": " + std::to_string(size) + " bytes found, expected " + std::to_string(expected) +
                    " (" + std::to_string(times) + " snapshots of " + std::to_string(nodes) + " nodes)");
    }
    stream.seekg(0);
    std::vector<std::vector<double>> snapshots(times, std::vector<double>(3 * nodes));
    for (auto& snapshot : snapshots) {
        stream.read(reinterpret_cast<char*>(snapshot.data()),
                    static_cast<std::streamsize>(snapshot.size() * sizeof(double)));
    }
    if (!stream) throw Error(file.string() + ": ends early, expected " + std::to_string(expected) + " bytes");
    return snapshots;
}

}  // namespace lancet::experiments::bar
