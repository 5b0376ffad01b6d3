// The program `scheduler` from its command line to its files.

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <set>
#include <string>
#include <variant>
#include <vector>

#include "tests/experiments/common/temporary_folder.hpp"
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "lancet/experiments/common/process.hpp"
#include "lancet/runtime/schedule/scheduler.hpp"

namespace lancet::experiments::scheduler {
namespace {

int run(const std::vector<std::string>& arguments, std::string* output = nullptr) {
    const ProcessResult result = run_process({.program = LANCET_SCHEDULER_PROGRAM, .arguments = arguments});
    if (output != nullptr) *output = result.output;
    const auto* exited = std::get_if<Exited>(&result.end);
    return exited == nullptr ? -1 : exited->code;
}

TEST(SchedulerProgram, MeasuresAllForms) {
    const test::TemporaryFolder folder;
    const auto json_file = folder.path() / "out.json", csv_file = folder.path() / "out.csv";
    std::string output;
    const auto kinds = runtime::available_schedulers();
    const bool has_tbb = std::ranges::find(kinds, runtime::SchedulerKind::tbb) != kinds.end();
    const std::string asked = has_tbb ? "--scheduler=serial,tbb" : "--scheduler=serial";
    ASSERT_EQ(run({"--quick", "--elements=1600", "--repetitions=2", asked, "--json", json_file.string(), "--csv",
                   csv_file.string()},
                  &output),
              0);
    EXPECT_THAT(output, testing::HasSubstr("Verdict"));
    EXPECT_THAT(output, testing::HasSubstr("to the bit"));
    EXPECT_THAT(test::read_text(csv_file), testing::StartsWith("elements,threads,extras,form,steps,p50_us,"));
    const auto json = nlohmann::json::parse(std::ifstream(json_file));
    EXPECT_TRUE(json.at("machine").contains("load_average"));
    EXPECT_FALSE(json.at("verdict").empty());
    std::set<std::string> forms;
    for (const auto& row : json.at("rows")) {
        forms.insert(row.at("form"));
        EXPECT_EQ(row.at("elements"), 1600);
        EXPECT_EQ(row.at("steps"), 50);
        EXPECT_EQ(row.at("bit_identical"), "yes") << row;
        EXPECT_GT(row.at("p50_us").get<double>(), 0);
        EXPECT_LE(row.at("p50_us").get<double>(), row.at("p95_us").get<double>());
        EXPECT_LE(row.at("p95_us").get<double>(), row.at("p999_us").get<double>());
        EXPECT_EQ(row.at("tasks").is_null(), row.at("us_per_task").is_null()) << row;
    }
    std::set<std::string> expected{"serial", "serial-tasks"};
    if (has_tbb) expected.insert({"loops", "graph"});
    EXPECT_EQ(forms, expected);
    EXPECT_EQ(json.at("rows").size(), has_tbb ? 4U + 4 + 4 : 4U);
    EXPECT_EQ(json.at("targets").size(), has_tbb ? 5U : 2U);
}

TEST(SchedulerProgram, TakesShortSteps) {
    const test::TemporaryFolder folder;
    const auto json_file = folder.path() / "out.json";
    std::string output;
    ASSERT_EQ(run({"--quick", "--elements=1600", "--repetitions=1", "--scheduler=serial", "--time-step=0.005", "--json",
                   json_file.string()},
                  &output),
              0);
    EXPECT_THAT(output, testing::HasSubstr("a step of 5 ms"));
    const auto json = nlohmann::json::parse(std::ifstream(json_file));
    EXPECT_EQ(json.at("rows").size(), 4U);
    for (const auto& row : json.at("rows")) EXPECT_EQ(row.at("steps"), 40) << "two windows of 0.1 s";
}

TEST(SchedulerProgram, RefusesBadInputWithExitCode2) {
    EXPECT_EQ(run({"--help"}), 0);
    for (const std::string bad :
         {"--elements=1000", "--elements=", "--threads=0", "--scalar=half", "--isa=mmx", "--scheduler=cron",
          "--repetitions=0", "--time-step=0", "--json=/nowhere/out.json", "--unknown"}) {
        EXPECT_EQ(run({bad}), 2) << bad;
    }
    EXPECT_EQ(run({"--scheduler=serial", "--threads=2"}), 2);
}

}  // namespace
}  // namespace lancet::experiments::scheduler
