// The program `bar` from its command line to its files.

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

namespace lancet::experiments::bar {
namespace {

struct Outcome {
    int code = -1;
    std::string output;
};

Outcome run_bar(const std::vector<std::string>& arguments) {
    Command command;
    command.program = std::filesystem::path(LANCET_BAR_FOLDER) / "bar";
    command.arguments = arguments;
    const ProcessResult result = run_process(command);
    const auto* exited = std::get_if<Exited>(&result.end);
    return {exited == nullptr ? -1 : exited->code, result.output};
}

TEST(BarProgram, MeasuresWritesAndKeepsItsReference) {
    const test::TemporaryFolder folder;
    const std::string cache = "--cache=" + (folder.path() / "cache").string();
    const auto json_file = folder.path() / "out.json";
    const auto csv_file = folder.path() / "out.csv";
    const auto pictures = folder.path() / "pictures";
    const std::vector<std::string> arguments{"--quick",
                                             "--cells=8,2,2",
                                             "--method=eigen,thesis",
                                             "--threads=1",
                                             "--scalar=float,double",
                                             cache,
                                             "--json=" + json_file.string(),
                                             "--csv=" + csv_file.string(),
                                             "--pvd=" + pictures.string()};
    const Outcome first = run_bar(arguments);
    ASSERT_EQ(first.code, 0);
    EXPECT_THAT(first.output, testing::HasSubstr("thesis"));
    const auto json = nlohmann::json::parse(std::ifstream(json_file));
    EXPECT_TRUE(json.at("machine").contains("cpu_model"));
    EXPECT_TRUE(json.at("machine").contains("omp_wait_policy"));
    ASSERT_EQ(json.at("rows").size(), 16u);  // two methods, four settings, two scalar types
    std::set<std::string> settings;
    for (const auto& row : json.at("rows")) {
        settings.insert(row.at("setting"));
        EXPECT_GT(row.at("ms_per_step").get<double>(), 0.0);
        EXPECT_TRUE(row.at("error_t1_percent").is_number());
        EXPECT_GT(row.at("speedup_over_eigen").get<double>(), 0.0);
        if (row.at("setting") == "accurate") {
            EXPECT_LE(row.at("error_t1_percent").get<double>(), 0.5);
        }
    }
    EXPECT_EQ(settings, (std::set<std::string>{"original", "original-every-step", "default", "accurate"}));
    EXPECT_THAT(test::read_text(csv_file), testing::StartsWith("method,setting,"));
    EXPECT_TRUE(std::filesystem::exists(pictures / "eigen-original-float-1.pvd"));
    const auto kept = std::distance(std::filesystem::directory_iterator(folder.path() / "cache"), {});
    EXPECT_EQ(kept, 1);
    EXPECT_EQ(run_bar({"--quick", "--cells=8,2,2", "--original", "--method=eigen", cache}).code, 0);
    EXPECT_EQ(std::distance(std::filesystem::directory_iterator(folder.path() / "cache"), {}), kept);
}

TEST(BarProgram, RefusesBadInputWithExitCode2) {
    EXPECT_EQ(run_bar({"--help"}).code, 0);
    for (const std::vector<std::string>& bad : std::vector<std::vector<std::string>>{{"--threads=0"},
                                                                                     {"--threads=1,x"},
                                                                                     {"--scalar=half"},
                                                                                     {"--isa=mmx"},
                                                                                     {"--scheduler=cron"},
                                                                                     {"--operator=magic"},
                                                                                     {"--method=bullet"},
                                                                                     {"--repetitions=0"},
                                                                                     {"--poisson=0.6"},
                                                                                     {"--mesh=absent.vtu"},
                                                                                     {"--accurate", "--no-errors"},
                                                                                     {"--json=/nowhere/out.json"},
                                                                                     {"--unknown"}}) {
        EXPECT_EQ(run_bar(bad).code, 2) << bad.front();
    }
    const test::TemporaryFolder folder;
    EXPECT_EQ(run_bar({"--accurate", "--time-step=0.03", "--cells=2,1,1", "--cache=" + folder.path().string()}).code,
              2);
}

}  // namespace
}  // namespace lancet::experiments::bar
