#include "lancet/experiments/bar/worker.hpp"

#include <cmath>
#include <fstream>
#include <limits>

#include "tests/experiments/common/temporary_folder.hpp"
#include <gtest/gtest.h>

#include "lancet/kernels/error.hpp"

namespace lancet::experiments::bar {
namespace {

TEST(WorkerReport, SurvivesItsOwnLine) {
    WorkerReport report;
    report.method = "eigen";
    report.operator_ = "csr";
    report.scalar = "double";
    report.threads = 3;
    report.elements = 5'000'000'000;
    report.seconds_total = 0.1;
    report.cg_iterations_total = 1250;
    report.energy_final = std::numeric_limits<double>::quiet_NaN();
    const std::string line = to_line(report);
    EXPECT_EQ(line.find('\n'), std::string::npos);
    const WorkerReport again = report_from_line(line + "\n", "worker");
    EXPECT_EQ(again.method, "eigen");
    EXPECT_EQ(again.operator_, "csr");
    EXPECT_EQ(again.threads, 3);
    EXPECT_EQ(again.elements, 5'000'000'000);
    EXPECT_EQ(again.seconds_total, 0.1);
    EXPECT_EQ(again.cg_iterations_total, 1250);
    EXPECT_TRUE(std::isnan(again.energy_final));
}

TEST(WorkerReport, RefusesWhatIsNoReport) {
    EXPECT_THROW((void)report_from_line("", "worker"), Error);
    EXPECT_THROW((void)report_from_line("hello", "worker"), Error);
    EXPECT_THROW((void)report_from_line("{}", "worker"), Error);
    std::string line = to_line(WorkerReport{});
    line.replace(line.find("\"threads\":1"), 11, "\"threads\":\"one\"");
    EXPECT_THROW((void)report_from_line(line, "worker"), Error);
}

Problem small_problem() {
    ProblemOptions options;
    options.cells = {2, 1, 1};
    return make_problem(options);
}

TEST(Snapshots, AreReadAsTheyWereWritten) {
    const test::TemporaryFolder folder;
    const auto file = folder.path() / "snapshots";
    const Problem problem = small_problem();
    Snapshots snapshots({file.string(), {1.0, 5.0}}, problem);
    EXPECT_FALSE(snapshots.wanted(24));
    EXPECT_TRUE(snapshots.wanted(25));
    EXPECT_TRUE(snapshots.wanted(125));
    std::vector<double> first(3 * problem.mesh.nodes().size(), 1.5);
    std::vector<double> second(first.size(), -2.25);
    second.back() = std::numeric_limits<double>::infinity();
    snapshots.add(first);
    snapshots.add(second);
    snapshots.write();
    const auto read = read_snapshots(file, 2, problem.mesh.nodes().size());
    EXPECT_EQ(read, (std::vector<std::vector<double>>{first, second}));
    EXPECT_EQ(folder.entries(), 1u);
    EXPECT_THROW((void)read_snapshots(file, 3, problem.mesh.nodes().size()), Error);
    EXPECT_THROW((void)read_snapshots(folder.path() / "absent", 1, 1), Error);
}

TEST(Snapshots, RefuseTimesThatNoStepReaches) {
    const Problem problem = small_problem();
    EXPECT_THROW(Snapshots({"file", {}}, problem), Error);
    EXPECT_THROW(Snapshots({"", {1.0}}, problem), Error);
    EXPECT_THROW(Snapshots({"file", {1.01}}, problem), Error);
    EXPECT_THROW(Snapshots({"file", {0.0}}, problem), Error);
    EXPECT_THROW(Snapshots({"file", {5.04}}, problem), Error);
    EXPECT_THROW(Snapshots({"file", {2.0, 1.0}}, problem), Error);
    EXPECT_THROW(Snapshots({"file", {std::numeric_limits<double>::quiet_NaN()}}, problem), Error);
}

}  // namespace
}  // namespace lancet::experiments::bar
