#include "lancet/experiments/bar/rows.hpp"

#include <string>

#include <gtest/gtest.h>

#include "lancet/kernels/error.hpp"

namespace lancet::experiments::bar {
namespace {

WorkerReport report_of(const std::string& method, double seconds, int threads = 1) {
    WorkerReport report;
    report.method = method;
    report.scalar = "float";
    report.threads = threads;
    report.scheduler = threads == 1 ? "serial" : "openmp";
    report.elements = 1000;
    report.steps = 100;
    report.seconds_total = seconds;
    report.seconds_solve = seconds / 2;
    report.seconds_forces = seconds / 4;
    report.seconds_rest = seconds / 4;
    report.cg_iterations_total = 1000;
    report.bytes = 400'000;
    report.solve_flops = 1e9;
    report.solve_bytes = 2e9;
    return report;
}

Row row_of(const std::string& method, const std::string& setting, double seconds, int threads = 1) {
    return make_row({method, setting, {}, {}, threads}, {report_of(method, seconds, threads)}, {}, 0.04);
}

TEST(BarRows, TakeTheMedianAndItsSpread) {
    const Row row = make_row({"eigen", "original", {}, {}, 1},
                             {report_of("eigen", 3), report_of("eigen", 1), report_of("eigen", 2)}, {}, 0.04);
    EXPECT_EQ(row.seconds, 2);
    EXPECT_EQ(row.seconds_minimum, 1);
    EXPECT_EQ(row.seconds_maximum, 3);
    EXPECT_EQ(row.report.seconds_total, 2);
    EXPECT_THROW((void)make_row({}, {}, {}, 0.04), Error);
}

TEST(BarRows, CompareLikeWithLike) {
    std::vector<Row> rows{row_of("thesis", "original", 6),   row_of("eigen", "original", 4),
                          row_of("eigen", "original", 3, 2), row_of("eigen", "accurate", 9),
                          row_of("lancet", "original", 1),   row_of("lancet", "default", 1)};
    add_speedups(rows);
    EXPECT_EQ(rows[0].speedup_over_eigen, 4.0 / 6);
    EXPECT_EQ(rows[0].speedup_over_thesis, 1);
    EXPECT_EQ(rows[2].speedup_over_eigen, 4.0 / 3);
    EXPECT_EQ(rows[2].speedup_over_one_thread, 4.0 / 3);
    EXPECT_EQ(rows[3].speedup_over_eigen, 1);
    EXPECT_FALSE(rows[3].speedup_over_thesis);
    EXPECT_EQ(rows[4].speedup_over_thesis, 6);
    EXPECT_EQ(rows[4].speedup_over_eigen, 4);
    EXPECT_FALSE(rows[5].speedup_over_eigen);
}

TEST(BarRows, HoldWhatReadersOfTheFileExpect) {
    Row row = row_of("eigen", "original", 4);
    row.errors.t1 = 0.25;
    const auto json = make_table(std::vector<Row>{row}).to_json();
    ASSERT_EQ(json.size(), 1u);
    const auto& fields = json[0];
    EXPECT_EQ(fields.at("method"), "eigen");
    EXPECT_EQ(fields.at("setting"), "original");
    EXPECT_EQ(fields.at("threads"), 1);
    EXPECT_EQ(fields.at("elements"), 1000);
    EXPECT_DOUBLE_EQ(fields.at("ms_per_step").get<double>(), 40);
    EXPECT_DOUBLE_EQ(fields.at("times_real_time").get<double>(), 1);
    EXPECT_DOUBLE_EQ(fields.at("cg_iterations_per_step").get<double>(), 10);
    EXPECT_DOUBLE_EQ(fields.at("ns_per_element_iteration").get<double>(), 2000);
    EXPECT_DOUBLE_EQ(fields.at("share_solve_percent").get<double>(), 50);
    EXPECT_DOUBLE_EQ(fields.at("gflops").get<double>(), 0.5);
    EXPECT_DOUBLE_EQ(fields.at("gbytes_per_s").get<double>(), 1);
    EXPECT_DOUBLE_EQ(fields.at("bytes_per_element").get<double>(), 400);
    EXPECT_DOUBLE_EQ(fields.at("error_t1_percent").get<double>(), 0.25);
    EXPECT_TRUE(fields.at("error_t1_dt0_percent").is_null());
    EXPECT_TRUE(fields.at("error_rest_percent").is_null());
    for (const char* name : {"operator", "scalar", "isa", "scheduler"}) EXPECT_TRUE(fields.contains(name)) << name;
}

}  // namespace
}  // namespace lancet::experiments::bar
