#include "lancet/experiments/scaling/rows.hpp"

#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "lancet/experiments/scaling/thesis.hpp"
#include "lancet/kernels/error.hpp"

namespace lancet::experiments::scaling {
namespace {

Job some_job(const std::string& scheduler, int threads, bool is_natural_order = false) {
    return {.benchmark = "bar",
            .elements = 1000,
            .steps = 10,
            .setting = "default",
            .scheduler = scheduler,
            .threads = threads,
            .isa = "avx2",
            .scalar = "float",
            .matrix = "edge-blocks",
            .scatter = "private-copies",
            .is_natural_order = is_natural_order};
}

Report some_report(const Job& job, double seconds, double waited = 0, const std::string& state = "same") {
    Report report;
    report.run.scheduler = job.scheduler;
    report.run.threads = job.threads;
    report.run.elements = job.elements;
    report.run.steps = job.steps;
    report.run.seconds_total = seconds;
    report.run.seconds_solve = seconds / 2;
    report.run.solve_flops = 1e9 * seconds;
    report.run.solve_bytes = 2e9 * seconds;
    report.state = state;
    report.cores = 4;
    report.load = {.waited = waited, .spin_seconds = 0.001};
    report.peak_gflops = 20;
    report.read_gbytes_per_s = 8;
    return report;
}

/// A strong series on 1, 2, 4 and 8 threads, of which the machine has 4.
struct Series {
    Plan plan;
    Measurement measurement;

    void add(const Job& job, const std::vector<Report>& reports) {
        plan.jobs.push_back(job);
        measurement.push_back(reports);
        const std::size_t place = plan.jobs.size() - 1;
        plan.entries.push_back({"strong", place, job.scheduler == "tbb" ? std::size_t{2} : place, 0, 1});
    }
    Series() {
        const Job natural = some_job("serial", 1, true), serial = some_job("serial", 1);
        add(natural, {some_report(natural, 0.9, 0, "natural")});
        add(serial, {some_report(serial, 1.1)});
        for (const int threads : {1, 2, 4, 8}) {
            const Job job = some_job("tbb", threads);
            add(job, {some_report(job, 0.2 + 0.8 / threads)});
        }
    }
};

TEST(Rows, SpeedUpsAreAgainstOneThreadAndAgainstTheNaturalOrder) {
    const std::vector<Row> rows = make_rows(Series().plan, Series().measurement, 1);
    ASSERT_EQ(rows.size(), 6U);
    EXPECT_DOUBLE_EQ(rows[3].ms_per_step, 60);
    EXPECT_DOUBLE_EQ(rows[3].speedup.value(), 1 / 0.6);
    EXPECT_DOUBLE_EQ(rows[3].speedup_over_serial.value(), 0.9 / 0.6);
    EXPECT_FALSE(rows[0].is_bit_identical) << "another order of sums";
    for (std::size_t i = 1; i < rows.size(); ++i) EXPECT_TRUE(rows[i].is_bit_identical.value());
    EXPECT_FALSE(rows[4].is_oversubscribed);
    EXPECT_TRUE(rows[5].is_oversubscribed);
    EXPECT_EQ(rows[5].note(), "oversubscribed");
    const auto json = make_table(rows).to_json();
    EXPECT_DOUBLE_EQ(json[3].at("efficiency_percent").get<double>(), 100 / 0.6 / 2);
    EXPECT_DOUBLE_EQ(json[3].at("gflops").get<double>(), 2);
    EXPECT_DOUBLE_EQ(json[3].at("gflops_share_percent").get<double>(), 10);
    EXPECT_DOUBLE_EQ(json[3].at("gbytes_per_s_share_percent").get<double>(), 50);
    EXPECT_TRUE(json[0].at("bit_identical").is_null());
}

TEST(Rows, OneOtherBitInOneRepetitionShows) {
    Series series;
    series.measurement[4].push_back(some_report(series.plan.jobs[4], 0.5, 0, "other"));
    EXPECT_FALSE(make_rows(series.plan, series.measurement, 1)[4].is_bit_identical.value());
}

TEST(Rows, TheMedianIsThatOfQuietRepetitions) {
    Series series;
    const Job& job = series.plan.jobs[3];
    series.measurement[3] = {some_report(job, 0.60), some_report(job, 9.0, 0.4), some_report(job, 0.62),
                             some_report(job, 0.64)};
    const Row row = make_rows(series.plan, series.measurement, 4)[3];
    EXPECT_EQ(row.mark, LoadMark::quiet);
    EXPECT_EQ(row.repetitions, 4U);
    EXPECT_EQ(row.counted, 3U);
    EXPECT_DOUBLE_EQ(row.ms_per_step, 62);
    EXPECT_DOUBLE_EQ(row.ms_maximum, 64);
}

TEST(Rows, WithMeaninglessOnesNoSpeedUpIsFormed) {
    Series series;
    series.measurement[3] = {some_report(series.plan.jobs[3], 0.6, 0.3)};
    std::vector<Row> rows = make_rows(series.plan, series.measurement, 1);
    EXPECT_EQ(rows[3].note(), "meaningless");
    EXPECT_FALSE(rows[3].speedup);
    EXPECT_FALSE(rows[3].speedup_over_serial);
    EXPECT_TRUE(rows[4].speedup);

    series.measurement[0] = {some_report(series.plan.jobs[0], 0.9, 0.3)};
    rows = make_rows(series.plan, series.measurement, 1);
    EXPECT_TRUE(rows[4].speedup);
    EXPECT_FALSE(rows[4].speedup_over_serial) << "the base is meaningless";
}

TEST(Rows, SayThatTheirBaseIsLoaded) {
    Series series;
    series.measurement[0] = {some_report(series.plan.jobs[0], 0.9, 0.1)};
    const std::vector<Row> rows = make_rows(series.plan, series.measurement, 1);
    EXPECT_EQ(rows[0].note(), "loaded");
    EXPECT_EQ(rows[1].note(), "base loaded");
    EXPECT_EQ(rows[5].note(), "base loaded, oversubscribed");
    EXPECT_TRUE(rows[5].speedup_over_serial);
}

// 1, 2 and 4 threads of a law of 20 %; eight are more than there are cores.
TEST(Rows, TheSerialFractionIsFittedToWhatMeansSomething) {
    Series series;
    auto fractions = fit_serial_fractions(make_rows(series.plan, series.measurement, 1));
    ASSERT_EQ(fractions.size(), 1U);
    EXPECT_EQ(fractions[0].counts, 3);
    ASSERT_TRUE(fractions[0].fit);
    EXPECT_NEAR(fractions[0].fit->serial_fraction, 0.2, 1e-10);
    EXPECT_EQ(make_table(fractions).rows().size(), 1U);

    series.measurement[3] = {some_report(series.plan.jobs[3], 0.6, 0.3)};
    fractions = fit_serial_fractions(make_rows(series.plan, series.measurement, 1));
    EXPECT_EQ(fractions[0].counts, 2);
    EXPECT_FALSE(fractions[0].fit);
    EXPECT_TRUE(make_table(fractions).to_json()[0].at("serial_fraction_percent").is_null());
}

TEST(Rows, TableFiveOneHasTheThesisFirst) {
    Series series;
    for (Entry& entry : series.plan.entries) entry.series = "thesis";
    const auto rows = make_rows(series.plan, series.measurement, 1);
    const auto table = make_table_5_1(rows).to_json();
    ASSERT_EQ(table.size(), 4U);
    EXPECT_EQ(table[0].at("program"), "thesis");
    EXPECT_DOUBLE_EQ(table[0].at("seconds_1").get<double>(), 36.4);
    EXPECT_DOUBLE_EQ(table[0].at("highest_speedup").get<double>(), 6.5);
    EXPECT_TRUE(table[0].at("seconds_2").is_null());
    EXPECT_EQ(table[3].at("program"), "tbb");
    EXPECT_DOUBLE_EQ(table[3].at("seconds_4").get<double>(), 0.4);
    const auto figures = make_figures_5_8_and_5_9(rows).to_json();
    EXPECT_EQ(figures.size(), 2U + 6U);
    EXPECT_DOUBLE_EQ(figures[0].at("cg_share_percent").get<double>(), 88);
    EXPECT_DOUBLE_EQ(figures[4].at("cg_share_percent").get<double>(), 50);
}

TEST(Rows, RefuseJobsWithoutReports) {
    Series series;
    series.measurement[2].clear();
    EXPECT_THROW((void)make_rows(series.plan, series.measurement, 1), Error);
    const std::vector<std::string_view> unknown{"speed"};
    EXPECT_THROW((void)make_table(std::span<const Row>(), unknown), Error);
}

}  // namespace
}  // namespace lancet::experiments::scaling
