#include "lancet/experiments/scaling/report.hpp"

#include <cmath>
#include <string>

#include <nlohmann/json.hpp>

#include "lancet/kernels/error.hpp"

namespace lancet::experiments::scaling {
namespace {

/// The one list of the fields that are not those of bar::WorkerReport, for writing and reading.
template <class Given, class Visit>
void visit_fields(Given& report, const Visit& visit) {
    visit("state", report.state);
    visit("waited", report.load.waited);
    visit("stolen", report.load.stolen);
    visit("others", report.load.others);
    visit("spin_seconds", report.load.spin_seconds);
    visit("cores", report.cores);
    visit("pinned_threads", report.pinned_threads);
    visit("omp_wait_policy", report.omp_wait_policy);
    visit("peak_gflops", report.peak_gflops);
    visit("read_gbytes_per_s", report.read_gbytes_per_s);
}

}  // namespace

std::string to_line(const Report& report) {
    auto json = nlohmann::ordered_json::parse(bar::to_line(report.run));
    visit_fields(report, [&json](const char* name, const auto& value) { json[name] = value; });
    auto& error = json["error_percent"];  // null where there is none
    if (report.error_percent && std::isfinite(*report.error_percent)) {
        error = *report.error_percent;
    } else if (report.error_percent) {
        error = "nan";  // a run that diverged: JSON has no number for it
    }
    return json.dump();
}

Report report_from_line(const std::string& line, const std::string& worker) {
    Report report;
    report.run = bar::report_from_line(line, worker);
    try {
        const nlohmann::json json = nlohmann::json::parse(line);
        visit_fields(report, [&json](const char* name, auto& value) { json.at(name).get_to(value); });
        const nlohmann::json& error = json.at("error_percent");
        if (error.is_number()) report.error_percent = error.get<double>();
        if (error.is_string()) report.error_percent = std::stod(error.get<std::string>());
    } catch (const std::exception& error) {
        throw Error(worker + ": '" + line.substr(0, 200) + "' printed, expected a report in JSON (" + error.what() +
                    ")");
    }
    return report;
}

}  // namespace lancet::experiments::scaling
