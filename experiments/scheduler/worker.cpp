#include "lancet/experiments/scheduler/worker.hpp"

#include <bit>
#include <chrono>
#include <sstream>
#include <thread>

#include <nlohmann/json.hpp>

#include "lancet/experiments/scheduler/empty_graph.hpp"
#include "lancet/kernels/error.hpp"
#include "lancet/runtime/observe/clock.hpp"

namespace lancet::experiments::scheduler {
namespace {

/// libgomp's threads spin for some 4 ms after a parallel region (300,000 rounds) where OMP_WAIT_POLICY is not set.
constexpr auto until_spinning_ends = std::chrono::milliseconds(10);

/// FNV-1a over the bits.
std::string checksum(const std::vector<mesh::Point>& positions) {
    std::uint64_t hash = 14695981039346656037U;
    for (const mesh::Point& point : positions) {
        for (const double value : point) hash = (hash ^ std::bit_cast<std::uint64_t>(value)) * 1099511628211U;
    }
    std::ostringstream text;
    text << std::hex << hash;
    return text.str();
}

bool same_bits(const std::vector<mesh::Point>& a, const std::vector<mesh::Point>& b) {
    if (a.size() != b.size()) return false;
    for (std::size_t node = 0; node < a.size(); ++node) {
        for (std::size_t axis = 0; axis < 3; ++axis) {
            if (std::bit_cast<std::uint64_t>(a[node][axis]) != std::bit_cast<std::uint64_t>(b[node][axis]))
                return false;
        }
    }
    return true;
}

/// What a worker compares: the serial step first.
std::vector<SubjectReport> subjects_of(const WorkerJob& job) {
    std::vector<SubjectReport> subjects{{}};
    if (job.kind != runtime::SchedulerKind::serial) subjects.push_back({});
    for (const Extras extras : {Extras::nothing, Extras::frames, Extras::everything}) {
        subjects.push_back({.is_tasks = true, .extras = std::string(to_string(extras))});
    }
    for (SubjectReport& subject : subjects) subject.bit_identical = true;
    return subjects;
}

void take_step(Subject& subject, SubjectReport& report) {
    const double begin = runtime::steady_seconds();
    subject.step();
    report.seconds.push_back(runtime::steady_seconds() - begin);
    const TaskSeconds tasks = subject.task_seconds();
    report.frame_seconds.push_back(tasks.frames);
    report.frame_seconds_beside.push_back(tasks.frames_beside);
    report.side_seconds.push_back(tasks.side);
    report.task_seconds.push_back(tasks.all);
}

}  // namespace

WorkerReport measure(const WorkerJob& job) {
    const auto serial = runtime::make_scheduler(runtime::SchedulerKind::serial, 1);
    const auto scheduler = runtime::make_scheduler(job.kind, job.threads);
    WorkerReport report{.motion = {}, .subjects = subjects_of(job)};
    for (int run = 0; run < job.runs; ++run) {
        std::vector<std::unique_ptr<Subject>> subjects;
        for (std::size_t k = 0; k < report.subjects.size(); ++k) {
            const SubjectReport& of = report.subjects[k];
            runtime::Scheduler& its = k == 0 ? *serial : *scheduler;
            subjects.push_back(of.is_tasks ? make_tasks(job.problem, its, extras_from_string(of.extras))
                                           : make_loops(job.problem, its));
        }
        std::size_t turn = 0;
        for (int begin = 0; begin < job.steps; begin += job.block, ++turn) {
            const int steps = std::min(job.block, job.steps - begin);
            for (std::size_t k = 0; k < subjects.size(); ++k) {
                const std::size_t at = (turn + k) % subjects.size();
                std::this_thread::sleep_for(until_spinning_ends);
                for (int step = 0; step < steps; ++step) take_step(*subjects[at], report.subjects[at]);
            }
        }
        const auto positions = subjects.front()->positions();
        report.motion = checksum(positions);
        for (std::size_t k = 0; k < subjects.size(); ++k) {
            SubjectReport& of = report.subjects[k];
            of.bit_identical = of.bit_identical && same_bits(subjects[k]->positions(), positions);
            if (!of.is_tasks || run > 0) continue;
            runtime::StepGraph graph = empty_graph(subjects[k]->graph());
            of.tasks = graph.size();
            constexpr int batches = 200;
            of.empty_graph_seconds = seconds_of_run(graph, *scheduler, batches);
        }
    }
    return report;
}

std::string to_line(const WorkerReport& report) {
    nlohmann::ordered_json json{{"motion", report.motion}, {"subjects", nlohmann::ordered_json::array()}};
    for (const SubjectReport& subject : report.subjects) {
        json["subjects"].push_back({{"is_tasks", subject.is_tasks},
                                    {"extras", subject.extras},
                                    {"seconds", subject.seconds},
                                    {"frame_seconds", subject.frame_seconds},
                                    {"frame_seconds_beside", subject.frame_seconds_beside},
                                    {"side_seconds", subject.side_seconds},
                                    {"task_seconds", subject.task_seconds},
                                    {"bit_identical", subject.bit_identical},
                                    {"tasks", subject.tasks},
                                    {"empty_graph_seconds", subject.empty_graph_seconds}});
    }
    return json.dump();
}

WorkerReport report_from_line(const std::string& line) {
    try {
        const auto json = nlohmann::json::parse(line);
        WorkerReport report{.motion = json.at("motion")};
        for (const auto& subject : json.at("subjects")) {
            report.subjects.push_back({.is_tasks = subject.at("is_tasks"),
                                       .extras = subject.at("extras"),
                                       .seconds = subject.at("seconds"),
                                       .frame_seconds = subject.at("frame_seconds"),
                                       .frame_seconds_beside = subject.at("frame_seconds_beside"),
                                       .side_seconds = subject.at("side_seconds"),
                                       .task_seconds = subject.at("task_seconds"),
                                       .bit_identical = subject.at("bit_identical"),
                                       .tasks = subject.at("tasks"),
                                       .empty_graph_seconds = subject.at("empty_graph_seconds")});
        }
        return report;
    } catch (const nlohmann::json::exception& error) {
        throw Error("worker: '" + line.substr(0, 200) + "' printed, expected a report in JSON (" + error.what() + ")");
    }
}

}  // namespace lancet::experiments::scheduler
