// The program `stability` from its command line to its files.

#include <chrono>
#include <csignal>
#include <filesystem>
#include <fstream>
#include <set>
#include <string>
#include <thread>
#include <variant>
#include <vector>

#include "tests/experiments/common/temporary_folder.hpp"
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include "lancet/experiments/common/process.hpp"

namespace lancet::experiments::stability {
namespace {

int run(const std::vector<std::string>& arguments, std::string* output = nullptr) {
    const ProcessResult result = run_process({.program = LANCET_STABILITY_PROGRAM, .arguments = arguments});
    if (output != nullptr) *output = result.output;
    const auto* exited = std::get_if<Exited>(&result.end);
    return exited == nullptr ? -1 : exited->code;
}

nlohmann::json read_json(const std::filesystem::path& file) {
    return nlohmann::json::parse(std::ifstream(file));
}

TEST(StabilityProgram, CountsEveryCategoryAndNamesEveryFailure) {
    const test::TemporaryFolder folder;
    const auto json_file = folder.path() / "out.json";
    const auto csv_file = folder.path() / "out.csv";
    std::string output;
    const int code =
        run({"--quick", "--cases=3", "--threads=2", "--json", json_file.string(), "--csv", csv_file.string()}, &output);
    EXPECT_TRUE(code == 0 || code == 1) << code;
    EXPECT_THAT(output, testing::HasSubstr("What 'survived' means"));
    EXPECT_THAT(test::read_text(csv_file), testing::StartsWith("category,detail,"));
    const auto json = read_json(json_file);
    EXPECT_TRUE(json.at("machine").contains("cpu_model"));
    EXPECT_EQ(json.at("seed"), 1);
    EXPECT_EQ(json.at("complete"), true);
    EXPECT_EQ(json.at("run"), json.at("cases"));
    std::set<std::string> categories;
    int failed = 0, promised_failed = 0;
    for (const auto& row : json.at("categories")) {
        categories.insert(row.at("category"));
        EXPECT_EQ(row.at("run"), 3);
        EXPECT_EQ(row.at("survived").get<int>() + row.at("failed").get<int>(), 3);
        EXPECT_FALSE(row.at("criterion").get<std::string>().empty());
        failed += row.at("failed").get<int>();
        promised_failed += row.at("promised_failed").get<int>();
    }
    EXPECT_EQ(categories, (std::set<std::string>{"fractions", "critical-steps", "sequences", "progressive", "recovery",
                                                 "poisson", "stiffness-ratio", "quality", "not-finite"}));
    EXPECT_EQ(code, promised_failed > 0 ? 1 : 0);
    ASSERT_EQ(json.at("failures").size(), static_cast<std::size_t>(failed));
    for (const auto& failure : json.at("failures")) {
        EXPECT_FALSE(failure.at("reason").get<std::string>().empty());
        EXPECT_THAT(output, testing::HasSubstr(failure.at("case").get<std::string>()));
        // What failed fails again, by its name and seed.
        EXPECT_EQ(run({"--case", failure.at("case").get<std::string>(), "--seed",
                       std::to_string(failure.at("seed").get<std::int64_t>())}),
                  1);
    }
    int rows = 0;
    for (const auto& row : json.at("rows")) rows += row.at("run").get<int>();
    EXPECT_EQ(rows, 27);
}

TEST(StabilityProgram, GivesTheSameOutcomesHoweverManyProcesses) {
    const test::TemporaryFolder folder;
    std::vector<nlohmann::json> rows;
    for (const std::string processes : {"1", "3"}) {
        const auto file = folder.path() / (processes + ".json");
        ASSERT_NE(run({"--category=sequences", "--cases=41", "--seed=1000", "--threads=" + processes, "--json",
                       file.string()}),
                  2);
        rows.push_back(read_json(file));
    }
    EXPECT_EQ(rows[0].at("rows"), rows[1].at("rows"));
    EXPECT_EQ(rows[0].at("failures"), rows[1].at("failures"));
}

TEST(StabilityProgram, ASignalEndsItWithWhatThereIs) {
    const test::TemporaryFolder folder;
    const auto file = folder.path() / "out.json";
    // More cases than could come to an end before the signal.
    std::vector<std::string> arguments{LANCET_STABILITY_PROGRAM, "--category=not-finite", "--cases=10000000",
                                       "--threads=1", "--json=" + file.string()};
    std::vector<char*> pointers;
    for (std::string& argument : arguments) pointers.push_back(argument.data());
    pointers.push_back(nullptr);
    pid_t program = 0;
    ASSERT_EQ(::posix_spawn(&program, LANCET_STABILITY_PROGRAM, nullptr, nullptr, pointers.data(), environ), 0);
    while (!std::filesystem::exists(file)) {
        ASSERT_EQ(::waitpid(program, nullptr, WNOHANG), 0);
        std::this_thread::sleep_for(std::chrono::milliseconds(20));
    }
    const auto interim = read_json(file);
    ::kill(program, SIGTERM);
    int status = 0;
    ASSERT_EQ(::waitpid(program, &status, 0), program);
    ASSERT_TRUE(WIFEXITED(status));
    EXPECT_EQ(WEXITSTATUS(status), 3);
    const auto last = read_json(file);
    for (const auto& json : {interim, last}) {
        EXPECT_EQ(json.at("complete"), false);
        EXPECT_EQ(json.at("cases"), 10000000);
        EXPECT_GT(json.at("run"), 0);
        EXPECT_EQ(json.at("categories").at(0).at("run"), json.at("run"));
    }
    EXPECT_GE(last.at("run"), interim.at("run"));
}

TEST(StabilityProgram, RefusesBadInputWithExitCode2) {
    EXPECT_EQ(run({"--help"}), 0);
    for (const std::string bad :
         {"--category=fire", "--cases=0", "--case=sequences/nothing", "--seed=x", "--threads=1,2", "--scalar=half",
          "--isa=mmx", "--isa=scalar,scalar", "--limit=0", "--worker=1", "--json=/nowhere/out.json", "--unknown"}) {
        EXPECT_EQ(run({bad}), 2) << bad;
    }
}

}  // namespace
}  // namespace lancet::experiments::stability
