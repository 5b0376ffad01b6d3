#include "lancet/experiments/common/table.hpp"

#include <limits>
#include <sstream>

#include "tests/experiments/common/temporary_folder.hpp"
#include <gtest/gtest.h>

#include "lancet/kernels/error.hpp"

namespace lancet::experiments {
namespace {

Table small_table() {
    Table table({{.key = "method", .title = "method", .unit = ""},
                 {.key = "ms_per_step", .title = "time/step", .unit = "ms"},
                 {.key = "threads", .title = "threads", .unit = ""},
                 {.key = "note", .title = "note", .unit = "", .printed = false}});
    table.add_row({"lancet", 0.123456, 2, "a, \"b\""});
    table.add_row({"µ", std::monostate{}, 12, std::monostate{}});
    return table;
}

TEST(Table, PrintsAlignedColumns) {
    std::ostringstream stream;
    small_table().print(stream);
    EXPECT_EQ(stream.str(),
              "method  time/step  threads\n"
              "               ms\n"
              "------  ---------  -------\n"
              "lancet      0.123        2\n"
              "µ               -       12\n");
}

TEST(Table, PrintsCsvWithAllDigitsAndQuotes) {
    std::ostringstream stream;
    small_table().print_csv(stream);
    EXPECT_EQ(stream.str(),
              "method,ms_per_step,threads,note\r\n"
              "lancet,0.123456,2,\"a, \"\"b\"\"\"\r\n"
              "µ,,12,\r\n");
}

TEST(Table, WritesTheSameCsvToAFile) {
    const test::TemporaryFolder folder;
    std::ostringstream stream;
    small_table().print_csv(stream);
    small_table().write_csv(folder.path() / "a.csv");
    EXPECT_EQ(test::read_text(folder.path() / "a.csv"), stream.str());
}

TEST(Table, GivesJsonRowsInColumnOrder) {
    EXPECT_EQ(small_table().to_json().dump(),
              R"([{"method":"lancet","ms_per_step":0.123456,"threads":2,"note":"a, \"b\""},)"
              R"({"method":"µ","ms_per_step":null,"threads":12,"note":null}])");
}

TEST(Table, RefusesWhatDoesNotFit) {
    EXPECT_THROW(Table({}), Error);
    EXPECT_THROW(Table({{.key = "", .title = "a", .unit = ""}}), Error);
    EXPECT_THROW(Table({{.key = "a", .title = "a", .unit = ""}, {.key = "a", .title = "b", .unit = ""}}), Error);
    EXPECT_THROW(Table({{.key = "a", .title = "a", .unit = "", .significant_digits = 0}}), Error);
    Table table = small_table();
    EXPECT_THROW(table.add_row({"one"}), Error);
    EXPECT_EQ(table.rows().size(), 2u);
}

TEST(Table, FormatsNumbersExactly) {
    for (const double value : {0.1, 1.0 / 3, -1e300}) EXPECT_EQ(std::stod(format_exact(value)), value);
    EXPECT_EQ(format_exact(0.005), "0.005");
}

TEST(FormatNumber, HasItsSignificantDigits) {
    EXPECT_EQ(format_number(3.14159, 3), "3.14");
    EXPECT_EQ(format_number(-3.14159, 1), "-3");
    EXPECT_EQ(format_number(0.00123456, 3), "0.00123");
    EXPECT_EQ(format_number(12345.6, 3), "12346");
    EXPECT_EQ(format_number(9.9996, 4), "10.00");
    EXPECT_EQ(format_number(0, 3), "0");
}

TEST(FormatNumber, VerySmallAndLargeAreScientific) {
    EXPECT_EQ(format_number(1.234e-5, 3), "1.23e-05");
    EXPECT_EQ(format_number(12345678, 3), "1.23e+07");
    EXPECT_EQ(format_number(9999999.9, 3), "1.00e+07");
}

TEST(FormatNumber, SaysWhatIsNotFinite) {
    EXPECT_EQ(format_number(std::numeric_limits<double>::quiet_NaN(), 3), "nan");
    EXPECT_EQ(format_number(-std::numeric_limits<double>::infinity(), 3), "-inf");
}

TEST(QuoteCsv, OnlyWhereItMust) {
    EXPECT_EQ(quote_csv("plain text"), "plain text");
    EXPECT_EQ(quote_csv("a,b"), "\"a,b\"");
    EXPECT_EQ(quote_csv("say \"x\""), "\"say \"\"x\"\"\"");
    EXPECT_EQ(quote_csv("two\nlines"), "\"two\nlines\"");
}

}  // namespace
}  // namespace lancet::experiments
