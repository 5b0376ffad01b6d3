// The program `scaling` from its command line to its files.

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

namespace lancet::experiments::scaling {
namespace {

int run(const std::vector<std::string>& arguments, std::string* output = nullptr) {
    const ProcessResult result =
        run_process({.program = LANCET_SCALING_PROGRAM, .arguments = arguments, .environment = {}, .timeout = {}});
    if (output != nullptr) *output = result.output;
    const auto* exited = std::get_if<Exited>(&result.end);
    return exited == nullptr ? -1 : exited->code;
}

const std::vector<std::string> asked_for{"series",
                                         "problem",
                                         "scheduler",
                                         "threads",
                                         "isa",
                                         "scalar",
                                         "operator",
                                         "scatter",
                                         "elements",
                                         "ms_per_step",
                                         "spread_percent",
                                         "speedup",
                                         "speedup_over_serial",
                                         "efficiency_percent",
                                         "bytes_per_element",
                                         "gflops",
                                         "gflops_share_percent",
                                         "gbytes_per_s",
                                         "gbytes_per_s_share_percent",
                                         "error_t1_percent",
                                         "bit_identical",
                                         "lost_percent",
                                         "omp_wait_policy",
                                         "note"};

// All series of both problems at a size that takes moments; more threads than most machines have cores are among them.
TEST(ScalingProgram, MeasuresAllSeriesOfTinyProblems) {
    const test::TemporaryFolder folder;
    const auto json_file = folder.path() / "out.json", csv_file = folder.path() / "out.csv";
    const std::string cache = "--cache=" + (folder.path() / "cache").string();
    std::string output;
    ASSERT_EQ(
        run({"--quick", "--series=strong,weak", "--elements=400", "--threads=1,2,3", "--repetitions=1",
             "--scatter=private-copies,coloring", cache, "--json", json_file.string(), "--csv", csv_file.string()},
            &output),
        0);
    for (const std::string text : {"Strong scaling", "Weak scaling", "Amdahl", "rows are meaningless"}) {
        EXPECT_THAT(output, testing::HasSubstr(text));
    }
    const auto json = nlohmann::json::parse(std::ifstream(json_file));
    EXPECT_TRUE(json.at("machine").contains("cpu_model"));
    EXPECT_TRUE(json.at("machine").contains("omp_wait_policy"));
    EXPECT_TRUE(json.at("machine").contains("load_average_before"));
    EXPECT_TRUE(json.at("load_rule").is_string());
    EXPECT_TRUE(json.at("table_5_1").empty());
    EXPECT_FALSE(json.at("serial_fractions").empty());
    std::set<std::string> problems, series, scatters;
    for (const auto& row : json.at("rows")) {
        for (const std::string& key : asked_for) EXPECT_TRUE(row.contains(key)) << key << " is not in " << row;
        problems.insert(row.at("problem"));
        series.insert(row.at("series"));
        if (row.at("scatter").is_string()) scatters.insert(row.at("scatter"));
        EXPECT_GT(row.at("ms_per_step").get<double>(), 0) << row;
        EXPECT_GT(row.at("bytes_per_element").get<double>(), 0) << row;
        EXPECT_GT(row.at("peak_gflops").get<double>(), 0) << row;
        EXPECT_GT(row.at("read_gbytes_per_s").get<double>(), 0) << row;
        // Ten iterations with the coarse space leave 0.03 to 0.12 %; a wrong reference or step shows as percents.
        EXPECT_LT(row.at("error_t1_percent").get<double>(), 0.5) << row;
        if (row.at("scheduler") == "natural order") {
            EXPECT_TRUE(row.at("bit_identical").is_null());
        } else {
            EXPECT_EQ(row.at("bit_identical"), "equal") << row;
        }
        const bool is_meaningless = row.at("note").get<std::string>().find("meaningless") != std::string::npos;
        if (is_meaningless) {
            EXPECT_TRUE(row.at("speedup").is_null()) << row;
        }
    }
    EXPECT_EQ(problems, (std::set<std::string>{"bar", "organ"}));
    EXPECT_EQ(series, (std::set<std::string>{"strong", "weak"}));
    EXPECT_EQ(scatters, (std::set<std::string>{"private-copies", "coloring"}));
    EXPECT_THAT(test::read_text(csv_file), testing::StartsWith("series,problem,setting,elements,"));
}

TEST(ScalingProgram, HoldsThreadsToCoresAndDrawsPictures) {
    const test::TemporaryFolder folder;
    const auto json_file = folder.path() / "out.json", plots = folder.path() / "plots";
    ASSERT_EQ(run({"--quick", "--series=thesis", "--problem=bar", "--threads=2", "--repetitions=1", "--pin",
                   "--no-errors", "--json", json_file.string(), "--plot", plots.string()}),
              0);
    const auto json = nlohmann::json::parse(std::ifstream(json_file));
    for (const auto& row : json.at("rows")) {
        EXPECT_GE(row.at("pinned_threads").get<int>(), row.at("threads").get<int>()) << row;
        const std::string note = row.at("note");
        EXPECT_THAT(note, testing::HasSubstr("pinned"));
        const bool is_oversubscribed = row.at("threads") > json.at("machine").at("cores_allowed");
        EXPECT_EQ(note.find("oversubscribed") != std::string::npos, is_oversubscribed) << row;
        EXPECT_TRUE(row.at("error_t1_percent").is_null());
        EXPECT_EQ(row.at("elements"), 12'800);
    }
    EXPECT_EQ(json.at("table_5_1")[0].at("program"), "thesis");
    EXPECT_EQ(json.at("table_5_1")[0].at("seconds_1"), 36.4);
    EXPECT_TRUE(std::filesystem::exists(plots / "figure-5-9.gp"));
    EXPECT_TRUE(std::filesystem::exists(plots / "figure-5-9.dat"));
}

TEST(ScalingProgram, RefusesBadInputWithExitCode2) {
    EXPECT_EQ(run({"--help"}), 0);
    for (const std::string bad :
         {"--series=fast", "--problem=liver", "--elements=99", "--setting=best", "--scatter=luck", "--operator=dense",
          "--threads=0", "--scalar=half", "--isa=mmx", "--scheduler=cron", "--repetitions=0", "--steps=0",
          "--json=/nowhere/out.json", "--unknown"}) {
        EXPECT_EQ(run({bad}), 2) << bad;
    }
}

}  // namespace
}  // namespace lancet::experiments::scaling
