#include "lancet/experiments/precision/advice.hpp"

#include <gtest/gtest.h>

#include "lancet/experiments/precision/report.hpp"

namespace lancet::experiments::precision {
namespace {

Row row(const std::string& problem, double seconds, double l2, double quantity) {
    Row result;
    result.problem = problem;
    result.seconds = seconds;
    result.errors.l2 = l2;
    result.errors.quantity = quantity;
    return result;
}

TEST(Advice, IsTheFastestWithinTheTarget) {
    const std::vector<Row> rows{row("a", 3, 0.5, 0.1), row("a", 1, 4, 0.01), row("b", 9, 0.009, 0.001),
                                row("a", 2, 0.9, 0.2)};
    const std::vector<Advice> advice = give_advice(rows);
    ASSERT_EQ(advice.size(), 8u);
    EXPECT_EQ(advice[0].row, 1u);  // 10 %: judged by the larger of both errors, 4 %
    EXPECT_TRUE(advice[0].reached);
    EXPECT_EQ(advice[1].row, 3u);  // 1 %: the faster of two
    EXPECT_EQ(advice[2].row, 0u);  // 0.1 %: nobody; the most accurate
    EXPECT_FALSE(advice[2].reached);
    EXPECT_EQ(advice[3].target_percent, 0.01);
    for (std::size_t i = 4; i < 8; ++i) {
        EXPECT_EQ(advice[i].problem, "b");
        EXPECT_EQ(advice[i].row, 2u);
        EXPECT_TRUE(advice[i].reached);
    }
}

TEST(Advice, OfEquallyAccurateOnesIsTheFastest) {
    const std::vector<Row> rows{row("a", 3, 50, 0), row("a", 1, 50.1, 0), row("a", 2, 60, 0)};
    EXPECT_EQ(give_advice(rows)[0].row, 1u);
}

TEST(Errors, AreJudgedByTheLarger) {
    EXPECT_EQ((Errors{.l2 = 1, .energy = 30, .quantity = 2}).judged(), 2);
    EXPECT_EQ((Errors{.l2 = 3, .energy = {}, .quantity = 2}).judged(), 3);
    EXPECT_EQ((Errors{.l2 = {}, .energy = {}, .quantity = 2}).judged(), 2);
}

TEST(Budget, NamesItsLargestPart) {
    BudgetLine line;
    EXPECT_EQ(line.dominating(), "nothing");
    line.scalar = 0.1;
    EXPECT_EQ(line.dominating(), "float");
    line.time_step = 3;
    line.mesh = 2;
    EXPECT_EQ(line.dominating(), "time step");
    line.mesh = 5;
    EXPECT_EQ(line.dominating(), "mesh");
    line.linearisation = 6;
    EXPECT_EQ(line.dominating(), "linearisation");
    line.solve = 7;
    EXPECT_EQ(line.dominating(), "linear solve");
}

TEST(Report, HasTheColumnsAndTheFront) {
    std::vector<Row> rows{row("a", 3, 0.5, 0.1), row("a", 1, 4, 0.01)};
    rows[1].pareto = true;
    const nlohmann::ordered_json json = rows_json(rows);
    for (const char* key : {"problem", "method", "operator", "scalar", "preconditioner", "cells", "dt", "tolerance",
                            "seconds", "iterations", "error_l2", "error_energy", "error_qoi", "pareto"}) {
        EXPECT_TRUE(json.at(0).contains(key)) << key;
    }
    EXPECT_FALSE(json.at(0).at("pareto").get<bool>());
    EXPECT_TRUE(json.at(1).at("pareto").get<bool>());
    EXPECT_TRUE(json.at(0).at("error_energy").is_null());
    const nlohmann::ordered_json front = pareto_json(rows);
    ASSERT_EQ(front.size(), 1u);
    EXPECT_EQ(front.at(0).at("row"), 1);
}

}  // namespace
}  // namespace lancet::experiments::precision
