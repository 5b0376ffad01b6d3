// The critical step of a cut element over that of the uncut one, against an independent linear-tetrahedron/XFEM code
// whose eigenvalues were checked by time stepping: shared/reference/critical-step.
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <vector>

#include "tests/verification/reference_table.hpp"
#include <gtest/gtest.h>

#include "lancet/runtime/cut/critical_step_study.hpp"

namespace lancet::test {
namespace {

using runtime::CutElement;
using runtime::Enrichment;
using runtime::StudyLumping;
using Corners = std::array<mesh::Point, 4>;

struct Column {
    Enrichment enrichment;
    StudyLumping lumping;
    /// The reference took the eigenvalues of the consistent mass in the Heaviside basis, where that mass has a
    /// condition of the inverse of the smaller fraction and more, and so lost digits (and one value) with slivers; they
    /// are those of every basis.
    bool is_rounded = false;
};

constexpr Column shifted(StudyLumping lumping) {
    return {Enrichment::shifted, lumping};
}
constexpr Column heaviside(StudyLumping lumping) {
    return {Enrichment::heaviside, lumping, lumping == StudyLumping::consistent};
}
constexpr Column substituted(StudyLumping lumping) {
    return {Enrichment::substituted, lumping};
}

using enum StudyLumping;
/// After the column c.
constexpr std::array bar_columns{shifted(enrichment),          shifted(row_sum),      shifted(weighted_diagonal),
                                 shifted(consistent),          heaviside(enrichment), heaviside(row_sum),
                                 heaviside(weighted_diagonal), heaviside(consistent), substituted(row_sum),
                                 substituted(consistent)};
/// After the columns cut (its first number), v, v_check.
constexpr std::array tetrahedron_columns{shifted(enrichment),   shifted(row_sum),      shifted(weighted_diagonal),
                                         shifted(consistent),   heaviside(enrichment), heaviside(row_sum),
                                         heaviside(consistent), substituted(row_sum),  substituted(consistent)};

constexpr Corners regular{{{1, 1, 1}, {1, -1, -1}, {-1, -1, 1}, {-1, 1, -1}}};

CutElement cut_bar(double place) {
    const auto parts = runtime::cut_bar(place);
    return {runtime::study_bar(), {parts[0], parts[1]}, {{.from = 0}}, {0, 1}};
}

CutElement cut_tetrahedron(bool at_edge, double fraction) {
    const auto parts = at_edge ? runtime::cut_off_edge(fraction) : runtime::cut_off_corner(fraction);
    return {runtime::study_tetrahedron(regular, 0.33),
            {runtime::study_part(parts[0]), runtime::study_part(parts[1])},
            {{.from = 0}},
            {0, at_edge ? 0 : 1, 1, 1}};
}

/// The columns of one row, from `first` on. The tables have nine significant digits.
template <std::size_t Count>
void expect_row(const CutElement& cut, const std::array<Column, Count>& columns, const std::vector<double>& row,
                std::size_t first) {
    ASSERT_EQ(row.size(), first + Count);
    for (std::size_t k = 0; k < Count; ++k) {
        const double expected = row[first + k];
        const double ratio = critical_step_ratio(cut, columns[k].enrichment, columns[k].lumping);
        if (columns[k].is_rounded) {
            EXPECT_DOUBLE_EQ(ratio, critical_step_ratio(cut, Enrichment::substituted, columns[k].lumping));
            if (std::isnan(expected)) continue;
        }
        EXPECT_NEAR(ratio, expected, columns[k].is_rounded ? 1e-6 : 1e-6 * expected)
            << to_string(columns[k].enrichment) << ", " << to_string(columns[k].lumping);
    }
}

TEST(CriticalStepCurves, Bar) {
    const auto table = read_numbers(reference_folder() / "critical-step" / "xfem_dt_ratio_1d.csv");
    if (table.empty()) GTEST_SKIP() << "no references in " << reference_folder();
    EXPECT_GE(table.size(), 100U);
    for (const std::vector<double>& row : table) {
        SCOPED_TRACE(row[0]);
        expect_row(cut_bar(row[0]), bar_columns, row, 1);
    }
}

TEST(CriticalStepCurves, Tetrahedron) {
    const auto table = read_numbers(reference_folder() / "critical-step" / "xfem_dt_ratio_tet.csv");
    if (table.empty()) GTEST_SKIP() << "no references in " << reference_folder();
    EXPECT_GE(table.size(), 200U);
    for (const std::vector<double>& row : table) {
        const bool at_edge = row[0] == 2;
        SCOPED_TRACE(row[1]);
        const CutElement cut = cut_tetrahedron(at_edge, row[1]);
        EXPECT_NEAR(cut.parts[0].fraction, row[2], 1e-9 * row[2]);
        expect_row(cut, tetrahedron_columns, row, 3);
    }
}

TEST(CriticalStepCurves, RowsThatAreAlwaysAtHand) {
    // Of the tables above: xfem_dt_ratio_1d.csv and xfem_dt_ratio_tet.csv.
    const std::vector<std::vector<double>> bar{
        {0.01, 0.816496581, 0.0115469977, 0.0203037419, 0.00577350269, 0.710669055, 0.710669055, 0.710669055,
         0.00577350269, 0.14106736, 0.00577350269},
        {0.3, 0.816496581, 0.33969685, 0.786550689, 0.173205081, 0.845154255, 0.845154255, 0.845154255, 0.173205081,
         0.714142843, 0.173205081},
        {0.5, 0.816496581, 0.5, 0.894427191, 0.288675135, 1, 1, 1, 0.288675135, 0.866025404, 0.288675135},
        {0.9, 0.816496581, 0.115392207, 0.233410378, 0.0577350269, 0.745355992, 0.745355992, 0.745355992, 0.0577350269,
         0.435889894, 0.0577350269}};
    const std::vector<std::vector<double>> tetrahedron{
        {1, 0.0001, 0.0001, 0.881984621, 0.0464826861, 0.103986821, 0.0207578163, 0.707142139, 0.707142139,
         0.0207578163, 0.240941441, 0.0207578163},
        {1, 0.2, 0.2, 0.83667253, 0.547604909, 0.937949463, 0.261532097, 0.790569415, 0.790569415, 0.261532097,
         0.833975722, 0.261532097},
        {1, 0.5, 0.5, 0.795242398, 0.355358451, 0.821036547, 0.189100571, 1, 1, 0.189100571, 0.849213999, 0.189100571},
        {1, 0.9, 0.9, 0.758426622, 0.0642496681, 0.127998559, 0.032397027, 0.745355992, 0.745355992, 0.032397027,
         0.413993269, 0.032397027},
        {2, 0.0001, 0.0001, 0.806587527, 0.00750402435, 0.0137026776, 0.00341155061, 0.707142139, 0.707142139,
         0.00341155071, 0.113840337, 0.00341155061},
        {2, 0.2, 0.2, 0.807691528, 0.359039416, 0.767371275, 0.169327479, 0.790569415, 0.790569415, 0.169327479,
         0.747618036, 0.169327479},
        {2, 0.5, 0.5, 0.808325641, 0.533605531, 0.891251362, 0.289046191, 1, 1, 0.289046191, 0.912952666, 0.289046191},
        {2, 0.9, 0.9, 0.807204734, 0.249531125, 0.518550626, 0.115700637, 0.745355992, 0.745355992, 0.115700637,
         0.633826716, 0.115700637}};
    for (const auto& row : bar) expect_row(cut_bar(row[0]), bar_columns, row, 1);
    for (const auto& row : tetrahedron) expect_row(cut_tetrahedron(row[0] == 2, row[1]), tetrahedron_columns, row, 3);
}

/// The smallest ratio over the fractions of the two sides, for the shifted enrichment with the enrichment lumping,
/// which depends on the fractions alone: on a grid in log(v / (1 - v)) from 1e-8 to 1 - 1e-8, then by sections around
/// its least point. At the ends the ratio differs from its limit by less than the fraction there.
double smallest_ratio(const runtime::StudyElement& element, const std::vector<int>& corner_parts) {
    const auto ratio = [&](double logit) {
        const auto parts = runtime::cut_off_corner(1 / (1 + std::exp(-logit)));
        const CutElement cut{
            element, {runtime::study_part(parts[0]), runtime::study_part(parts[1])}, {{.from = 0}}, corner_parts};
        return critical_step_ratio(cut, Enrichment::shifted, enrichment);
    };
    const double end = std::log(1e8);
    const int steps = 24;
    const double width = 2 * end / steps;
    double least = 0, smallest = std::numeric_limits<double>::infinity();
    for (int k = 0; k <= steps; ++k) {
        const double at = k * width - end;
        if (const double value = ratio(at); value < smallest) least = at, smallest = value;
    }
    double low = std::max(least - width, -end), high = std::min(least + width, end);
    for (int iteration = 0; iteration < 60; ++iteration) {
        const double a = low + (high - low) / 3, b = high - (high - low) / 3;
        (ratio(a) < ratio(b) ? high : low) = ratio(a) < ratio(b) ? b : a;
    }
    return std::min(smallest, ratio((low + high) / 2));
}

TEST(CriticalStepCurves, SmallestRatioOfOtherShapes) {
    // xfem_dt_ratio_shape_nu.csv, the shapes that are defined by their names: six digits behind the point.
    struct Row {
        double poisson_ratio, one_and_three, two_and_two;
    };
    struct Shape {
        const char* name;
        Corners corners;
        std::vector<Row> rows;
    };
    const std::vector<Shape> shapes{{"regular",
                                     regular,
                                     {{0.0, 0.707107, 0.707107},
                                      {0.3, 0.749702, 0.803858},
                                      {0.33, 0.751011, 0.806587},
                                      {0.45, 0.754804, 0.814278},
                                      {0.49, 0.755720, 0.816086},
                                      {0.499, 0.755908, 0.816456}}},
                                    {"right-angled corner",
                                     {{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}}},
                                     {{0.0, 0.720677, 0.736596},
                                      {0.3, 0.727354, 0.750245},
                                      {0.33, 0.728900, 0.753492},
                                      {0.45, 0.735731, 0.768290},
                                      {0.49, 0.737996, 0.773352},
                                      {0.499, 0.738494, 0.774473}}},
                                    {"Kuhn",
                                     {{{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {1, 1, 1}}},
                                     {{0.0, 0.717816, 0.731978},
                                      {0.3, 0.729159, 0.754384},
                                      {0.33, 0.730757, 0.757755},
                                      {0.45, 0.736490, 0.770102},
                                      {0.49, 0.738152, 0.773729},
                                      {0.499, 0.738510, 0.774511}}}};
    for (const Shape& shape : shapes) {
        for (const Row& row : shape.rows) {
            SCOPED_TRACE(shape.name);
            SCOPED_TRACE(row.poisson_ratio);
            const runtime::StudyElement element = runtime::study_tetrahedron(shape.corners, row.poisson_ratio);
            double one_and_three = 1, two_and_two = 1;
            for (std::size_t node = 0; node < 4; ++node) {
                std::vector<int> parts{1, 1, 1, 1};
                parts[node] = 0;
                one_and_three = std::min(one_and_three, smallest_ratio(element, parts));
                // Node 0 with one other; both sides are tried, for v runs from 0 to 1.
                parts[0] = 0;
                if (node > 0) two_and_two = std::min(two_and_two, smallest_ratio(element, parts));
            }
            EXPECT_NEAR(one_and_three, row.one_and_three, 1e-6);
            EXPECT_NEAR(two_and_two, row.two_and_two, 1e-6);
        }
    }
}

}  // namespace
}  // namespace lancet::test
