#include "lancet/experiments/scaling/report.hpp"

#include <cmath>
#include <limits>
#include <string>

#include <gtest/gtest.h>

#include "lancet/kernels/error.hpp"

namespace lancet::experiments::scaling {
namespace {

Report some_report() {
    Report report;
    report.run.scheduler = "tbb";
    report.run.threads = 3;
    report.run.seconds_total = 0.1;  // no short binary fraction: all digits must be written
    report.state = "0123456789abcdef";
    report.error_percent = 0.3;
    report.load = {.waited = 0.1, .stolen = 0.2, .others = 0.7, .spin_seconds = 0.003};
    report.cores = 2;
    report.pinned_threads = 3;
    report.omp_wait_policy = "passive";
    report.peak_gflops = 100.1;
    report.read_gbytes_per_s = 20.3;
    return report;
}

TEST(Report, ComesBackFromItsLine) {
    const Report report = some_report();
    const std::string line = to_line(report);
    EXPECT_EQ(line.find('\n'), std::string::npos);
    const Report read = report_from_line(line, "test");
    EXPECT_EQ(to_line(read), line);
    EXPECT_EQ(read.run.scheduler, "tbb");
    EXPECT_EQ(read.run.threads, 3);
    EXPECT_EQ(read.run.seconds_total, 0.1);
    EXPECT_EQ(read.state, report.state);
    EXPECT_EQ(read.error_percent, 0.3);
    EXPECT_EQ(read.load.waited, 0.1);
    EXPECT_EQ(read.load.stolen, 0.2);
    EXPECT_EQ(read.load.others, 0.7);
    EXPECT_EQ(read.load.spin_seconds, 0.003);
    EXPECT_EQ(read.cores, 2);
    EXPECT_EQ(read.pinned_threads, 3);
    EXPECT_EQ(read.omp_wait_policy, "passive");
    EXPECT_EQ(read.peak_gflops, 100.1);
    EXPECT_EQ(read.read_gbytes_per_s, 20.3);
}

TEST(Report, AMissingErrorIsNoDivergedRun) {
    Report report = some_report();
    report.error_percent = std::nullopt;
    EXPECT_FALSE(report_from_line(to_line(report), "test").error_percent);
    for (const double lost : {std::nan(""), std::numeric_limits<double>::infinity()}) {
        report.error_percent = lost;
        EXPECT_TRUE(std::isnan(report_from_line(to_line(report), "test").error_percent.value()));
    }
}

TEST(Report, RefusesOtherLines) {
    EXPECT_THROW((void)report_from_line("", "test"), Error);
    EXPECT_THROW((void)report_from_line("{}", "test"), Error);
    EXPECT_THROW((void)report_from_line(bar::to_line(bar::WorkerReport{}), "test"), Error);
}

}  // namespace
}  // namespace lancet::experiments::scaling
