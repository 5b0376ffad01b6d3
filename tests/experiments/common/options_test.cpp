#include "lancet/experiments/common/options.hpp"

#include "tests/experiments/common/temporary_folder.hpp"
#include <CLI/CLI.hpp>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "lancet/kernels/error.hpp"

namespace lancet::experiments {
namespace {

using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::Not;
using testing::ThrowsMessage;

SharedOptions parse(std::vector<std::string> arguments, const Choices& choices = {}) {
    CLI::App app("a test", "test");
    SharedOptions options;
    add_shared_options(app, options, choices);
    arguments.insert(arguments.begin(), "test");
    std::vector<const char*> argv;
    for (const std::string& argument : arguments) argv.push_back(argument.c_str());
    EXPECT_TRUE(parse_command_line(app, static_cast<int>(argv.size()), argv.data()));
    return options;
}

auto refused_with(const std::string& text) {
    return ThrowsMessage<Error>(AllOf(HasSubstr(text), Not(HasSubstr("\n"))));
}

TEST(SharedOptions, NothingGivenIsNothingSet) {
    const SharedOptions options = parse({});
    EXPECT_FALSE(options.quick);
    EXPECT_THAT(options.threads, IsEmpty());
    EXPECT_THAT(options.schedulers, IsEmpty());
    EXPECT_THAT(options.instruction_sets, IsEmpty());
    EXPECT_THAT(options.scalars, IsEmpty());
    EXPECT_FALSE(options.json.has_value());
    EXPECT_FALSE(options.csv.has_value());
}

TEST(SharedOptions, AllOfThem) {
    const test::TemporaryFolder folder;
    const std::string json = (folder.path() / "a.json").string();
    const SharedOptions options = parse({"--quick", "--threads", "2,1", "--scheduler=tbb,serial", "--isa", "avx2",
                                         "--scalar", "double,float", "--json", json, "--csv", "b.csv"});
    EXPECT_TRUE(options.quick);
    EXPECT_THAT(options.threads, ElementsAre(2, 1));
    EXPECT_THAT(options.schedulers, ElementsAre("tbb", "serial"));
    EXPECT_THAT(options.instruction_sets, ElementsAre("avx2"));
    EXPECT_THAT(options.scalars, ElementsAre("double", "float"));
    EXPECT_EQ(options.json, json);
    EXPECT_EQ(options.csv, "b.csv");
}

TEST(SharedOptions, BadListsAreRefusedWithWhatWasExpected) {
    EXPECT_THAT([] { parse({"--threads", "0"}); }, refused_with("--threads: '0' found, expected whole numbers"));
    EXPECT_THAT([] { parse({"--threads", "1,x"}); }, refused_with("--threads: 'x' found"));
    EXPECT_THAT([] { parse({"--threads", "1,"}); }, refused_with("--threads: '' found"));
    EXPECT_THAT([] { parse({"--threads", "1.5"}); }, refused_with("--threads: '1.5' found"));
    EXPECT_THAT([] { parse({"--threads", "2,2"}); }, refused_with("each number once"));
    EXPECT_THAT([] { parse({"--threads", "99999999999"}); }, refused_with("'99999999999' found"));
    EXPECT_THAT([] { parse({"--threads=-1"}); }, refused_with("'-1' found"));
    EXPECT_THAT(
        [] {
            parse({"--scheduler", "cilk"});
        },
        refused_with("--scheduler: 'cilk' found, expected a list out of serial, openmp, tbb"));
    EXPECT_THAT([] { parse({"--isa", "avx2,avx2"}); }, refused_with("each word once"));
    EXPECT_THAT([] { parse({"--scalar", ""}); }, refused_with("--scalar"));
}

TEST(SharedOptions, ChoicesCanBeNarrowed) {
    Choices choices;
    choices.scalars = {"mixed"};
    EXPECT_THAT(parse({"--scalar", "mixed"}, choices).scalars, ElementsAre("mixed"));
    EXPECT_THAT([&] { parse({"--scalar", "float"}, choices); }, refused_with("expected a list out of mixed"));
}

TEST(SharedOptions, AResultFileNeedsItsFolder) {
    const test::TemporaryFolder folder;
    EXPECT_THAT(
        [&] {
            parse({"--json", (folder.path() / "no" / "a.json").string()});
        },
        refused_with("there is no folder"));
    EXPECT_THAT([&] { parse({"--csv", folder.path().string()}); }, refused_with("the name of a file"));
}

TEST(SharedOptions, WhatTheParserRefusesIsOneLine) {
    EXPECT_THAT([] { parse({"--thread", "1"}); }, refused_with("--thread"));
    EXPECT_THAT([] { parse({"--threads"}); }, refused_with("--threads"));
    EXPECT_THAT([] { parse({"--threads", "1", "--threads", "2"}); }, refused_with("--threads"));
    EXPECT_THAT([] { parse({"extra"}); }, refused_with("extra"));
}

TEST(SharedOptions, HelpListsThemAndEndsTheProgram) {
    CLI::App app("a test", "test");
    SharedOptions options;
    add_shared_options(app, options);
    const std::vector<const char*> argv{"test", "--help"};
    testing::internal::CaptureStdout();
    const bool go_on = parse_command_line(app, 2, argv.data());
    const std::string help = testing::internal::GetCapturedStdout();
    EXPECT_FALSE(go_on);
    for (const char* option : {"--quick", "--threads", "--scheduler", "--isa", "--scalar", "--json", "--csv"}) {
        EXPECT_THAT(help, HasSubstr(option));
    }
}

TEST(ParseCounts, HonoursItsMinimum) {
    EXPECT_THAT(parse_counts("--layers", "0,3", 0), ElementsAre(0, 3));
    EXPECT_THAT([] { return parse_counts("--cells", "1,3", 2); }, refused_with("at least 2"));
}

}  // namespace
}  // namespace lancet::experiments
