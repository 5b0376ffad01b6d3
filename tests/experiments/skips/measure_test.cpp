#include "lancet/experiments/skips/measure.hpp"

#include <cmath>

#include <gtest/gtest.h>

#include "lancet/experiments/skips/tables.hpp"
#include "lancet/kernels/error.hpp"

namespace lancet::experiments::skips {
namespace {

/// Takes as long as it is told to, and ends where it is told to.
class Told final : public Runner {
  public:
    Told(double seconds, std::vector<mesh::Point> end) : seconds_(seconds), end_(std::move(end)) {}
    double advance() override { return seconds_ * ++units_; }
    std::vector<mesh::Point> positions() override { return end_; }

  private:
    double seconds_;
    int units_ = 0;
    std::vector<mesh::Point> end_;
};

Item told(double with, double without, const mesh::Point& end_with, const mesh::Point& end_without) {
    return {.name = "told",
            .toggle = "none",
            .scene = "none",
            .with = [=] { return std::make_unique<Told>(with, std::vector{end_with}); },
            .without = [=] { return std::make_unique<Told>(without, std::vector{end_without}); }};
}

TEST(Measure, ComparesTheSameUnits) {
    const Gain gain = measure(told(1, 4, {1, 2, 3}, {1, 2, 3}), 5, 2);
    EXPECT_DOUBLE_EQ(gain.ratio, 0.25);
    EXPECT_DOUBLE_EQ(gain.ms_with, 2e3);  // the lower quartile of 1, 1, 2, 2, ... 5, 5 s
    EXPECT_TRUE(gain.is_above_noise());
    EXPECT_TRUE(gain.same_bits);
    EXPECT_EQ(gain.error_percent, 0);
}

TEST(Measure, OneBitMakesADifference) {
    const Gain gain = measure(told(2, 2, {1, 2, 3}, {1, 2, std::nextafter(3.0, 4.0)}), 1, 1);
    EXPECT_FALSE(gain.same_bits);
    EXPECT_GT(gain.error_percent, 0);
    EXPECT_FALSE(gain.is_above_noise());
    EXPECT_NEAR(measure(told(1, 1, {0, 0, 0}, {0, 0.03, 0.04}), 1, 1).error_percent, 100 * 0.05 / 4, 1e-12);
}

TEST(Measure, TheTableSaysWhatIsNoise) {
    const std::vector items{told(1, 4, {}, {}), told(2, 2, {}, {}), told(4, 1, {}, {})};
    std::vector<Gain> gains;
    for (const Item& item : items) gains.push_back(measure(item, 2, 2));
    const Table table = gain_table(items, gains);
    ASSERT_EQ(table.rows().size(), 3U);
    EXPECT_EQ(std::get<std::string>(table.rows()[0][9]), "yes");
    EXPECT_EQ(std::get<std::string>(table.rows()[1][9]), "within noise");
    EXPECT_EQ(std::get<std::string>(table.rows()[2][9]), "slower");
}

}  // namespace
}  // namespace lancet::experiments::skips
