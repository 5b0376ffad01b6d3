#include "lancet/experiments/common/file.hpp"

#include <limits>
#include <ostream>
#include <stdexcept>

#include "tests/experiments/common/temporary_folder.hpp"
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "lancet/kernels/error.hpp"

namespace lancet::experiments {
namespace {

using test::read_text;
using test::TemporaryFolder;
using testing::HasSubstr;
using testing::ThrowsMessage;

TEST(WriteFile, HoldsTheTextAndNothingElseIsLeft) {
    const TemporaryFolder folder;
    const auto file = folder.path() / "result.txt";
    write_file(file, "first");
    write_file(file, "second\n");
    EXPECT_EQ(read_text(file), "second\n");
    EXPECT_EQ(folder.entries(), 1u);
}

TEST(WriteFile, AnExceptionLeavesTheOldFileAsItWas) {
    const TemporaryFolder folder;
    const auto file = folder.path() / "result.txt";
    write_file(file, "old");
    const auto interrupted = [&] {
        write_file(file, [](std::ostream& stream) {
            stream << "half of it" << std::flush;
            throw std::runtime_error("interrupted");
        });
    };
    EXPECT_THROW(interrupted(), std::runtime_error);
    EXPECT_EQ(read_text(file), "old");
    EXPECT_EQ(folder.entries(), 1u);
}

TEST(WriteFile, NeverHalfWrittenUnderItsFinalName) {
    const TemporaryFolder folder;
    const auto file = folder.path() / "result.txt";
    write_file(file, [&](std::ostream& stream) {
        stream << "half of it" << std::flush;
        EXPECT_FALSE(std::filesystem::exists(file));
        EXPECT_EQ(folder.entries(), 1u);  // the temporary file is in the same folder: a rename cannot cross devices
    });
    EXPECT_TRUE(std::filesystem::exists(file));
}

TEST(WriteFile, NamesTheFileItCannotWrite) {
    const TemporaryFolder folder;
    EXPECT_THAT([&] { write_file(folder.path() / "missing" / "a.txt", "text"); },
                ThrowsMessage<Error>(HasSubstr("missing/a.txt': No such file or directory")));
    std::filesystem::create_directory(folder.path() / "taken");
    EXPECT_THAT([&] { write_file(folder.path() / "taken", "text"); }, ThrowsMessage<Error>(HasSubstr("taken")));
    EXPECT_EQ(folder.entries(), 1u);
}

TEST(WriteFile, AFailedStreamIsAnErrorAndLeavesNothing) {
    const TemporaryFolder folder;
    const auto file = folder.path() / "result.txt";
    EXPECT_THROW(write_file(file, [](std::ostream& stream) { stream.setstate(std::ios::badbit); }), Error);
    EXPECT_EQ(folder.entries(), 0u);
}

TEST(WriteJsonFile, KeepsTheOrderOfKeysAndAllDigits) {
    const TemporaryFolder folder;
    const auto file = folder.path() / "result.json";
    write_json_file(file, {{"zeta", 0.1}, {"alpha", {1, 2}}});
    EXPECT_EQ(read_text(file), "{\n  \"zeta\": 0.1,\n  \"alpha\": [\n    1,\n    2\n  ]\n}\n");
}

TEST(WriteJsonFile, SaysWhatIsNotFinite) {
    constexpr double infinity = std::numeric_limits<double>::infinity();
    const TemporaryFolder folder;
    const auto file = folder.path() / "result.json";
    write_json_file(file, {{"rows", {{{"a", std::numeric_limits<double>::quiet_NaN()}, {"b", -infinity}}}},
                           {"c", infinity},
                           {"d", nullptr}});
    const auto read = nlohmann::json::parse(read_text(file));
    EXPECT_EQ(read["rows"][0]["a"], "nan");
    EXPECT_EQ(read["rows"][0]["b"], "-inf");
    EXPECT_EQ(read["c"], "inf");
    EXPECT_TRUE(read["d"].is_null());
}

}  // namespace
}  // namespace lancet::experiments
