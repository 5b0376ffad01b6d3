// The program `pipeline` from its command line to its files.

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

namespace lancet::experiments::pipeline {
namespace {

int run(std::vector<std::string> arguments, std::string* output = nullptr) {
    const ProcessResult result = run_process({.program = LANCET_PIPELINE_PROGRAM, .arguments = std::move(arguments)});
    if (output != nullptr) *output = result.output;
    const auto* exited = std::get_if<Exited>(&result.end);
    return exited == nullptr ? -1 : exited->code;
}

TEST(PipelineProgram, ShowsRatesTasksTraceGraphAndPictures) {
    const test::TemporaryFolder folder;
    const auto at = [&](const char* name) { return (folder.path() / name).string(); };
    std::string output;
    ASSERT_EQ(run({"--scene",    "organ",      "--seconds", "1.5",     "--threads",  "2",           "--json",
                   at("p.json"), "--csv",      at("p.csv"), "--trace", at("t.json"), "--dot",       at("g.dot"),
                   "--frames",   at("frames"), "--size",    "160x90",  "--record",   at("path.txt")},
                  &output),
              0);
    EXPECT_THAT(output, testing::HasSubstr("rate held"));
    const auto document = nlohmann::json::parse(std::ifstream(at("p.json")));
    EXPECT_TRUE(document.at("machine").contains("cpu_model"));
    std::set<std::string> tasks;
    for (const auto& row : document.at("rows")) {
        tasks.insert(row.at("task").get<std::string>());
        for (const char* key : {"rate_asked", "rate_held", "due", "missed", "latency_p50_ms"}) {
            EXPECT_TRUE(row.contains(key)) << key;
        }
        EXPECT_GT(row.at("rate_held").get<double>(), 0);
    }
    EXPECT_EQ(tasks, (std::set<std::string>{"step", "collision", "frame", "force"}));
    const auto trace = nlohmann::json::parse(std::ifstream(at("t.json")));
    std::set<std::string> events;
    for (const auto& event : trace.at("traceEvents")) events.insert(event.at("name").get<std::string>());
    for (const char* name : {"organ: solve", "organ: surface", "tool collision", "picture", "force feedback"}) {
        EXPECT_TRUE(events.contains(name)) << name;
    }
    EXPECT_THAT(test::read_text(at("g.dot")), testing::HasSubstr("\"organ: forces\" -> \"organ: matrix\""));
    EXPECT_THAT(test::read_text(at("frames/000000.png")), testing::StartsWith("\x89PNG"));
    EXPECT_TRUE(std::filesystem::exists(at("frames/frames.pvd")));
    EXPECT_GT(std::filesystem::file_size(at("path.txt")), 1000U);
}

TEST(PipelineProgram, ARecordedPathIsPlayedToTheSameBits) {
    const test::TemporaryFolder folder;
    const std::string json = (folder.path() / "p.json").string();
    const auto fingerprint = [&](const std::vector<std::string>& more) {
        std::vector<std::string> arguments{"--scene", "organ", "--seconds", "1.5", "--unpaced", "--json", json};
        arguments.insert(arguments.end(), more.begin(), more.end());
        EXPECT_EQ(run(arguments), 0);
        return nlohmann::json::parse(std::ifstream(json)).at("fingerprint").get<std::string>();
    };
    const std::string serial = fingerprint({"--scheduler", "serial"});
    EXPECT_EQ(fingerprint({"--scheduler", "tbb", "--threads", "2"}), serial);
    EXPECT_EQ(fingerprint({"--scheduler", "threads", "--threads", "2"}), serial);
}

TEST(PipelineProgram, SoaksAndSaysWhatItFound) {
    std::string output;
    EXPECT_EQ(run({"--scene", "organ", "--soak", "0.05", "--step", "0.01", "--threads", "1"}, &output), 0);
    EXPECT_THAT(output, testing::HasSubstr("All states finite"));
}

TEST(PipelineProgram, BadInputEndsWithTwoAndWritesNothing) {
    const test::TemporaryFolder folder;
    const std::string json = (folder.path() / "p.json").string();
    const std::string path = (folder.path() / "path.txt").string();
    std::ofstream(path) << "0 0 0 0 1 0 0 0 touch\n1 0 0 0 1 0 0 0 hit\n";
    for (const std::vector<std::string>& arguments : {std::vector<std::string>{"--scene", "moon"},
                                                      {"--seconds", "-1"},
                                                      {"--step", "0"},
                                                      {"--size", "10"},
                                                      {"--size", "0x10"},
                                                      {"--path", path},
                                                      {"--path", "/no/such/file"},
                                                      {"--threads", "1,2"},
                                                      {"--soak", "0"},
                                                      {"--scalar", "double"},
                                                      {"--seconds", "0.1", "--frames", path}}) {
        std::vector<std::string> all = arguments;
        all.insert(all.end(), {"--json", json});
        EXPECT_EQ(run(all), 2) << arguments.front();
    }
    EXPECT_FALSE(std::filesystem::exists(json));
}

}  // namespace
}  // namespace lancet::experiments::pipeline
