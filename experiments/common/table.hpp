#pragma once

#include <cstdint>
#include <filesystem>
#include <iosfwd>
#include <string>
#include <variant>
#include <vector>

#include <nlohmann/json.hpp>

namespace lancet::experiments {

/// A column of a result table.
struct Column {
    std::string key{};           ///< its name in CSV and JSON, such as ms_per_step
    std::string title{};         ///< its heading in the printed table, such as "time/step"
    std::string unit{};          ///< under the heading, such as "ms"; may be empty
    int significant_digits = 3;  ///< of numbers in the printed table; files carry all digits
    bool printed = true;         ///< whether the printed table shows the column; files always do
};

/// One value of a row. std::monostate is a missing one: '-' in print, empty in CSV, null in JSON.
using Cell = std::variant<std::monostate, std::string, double, std::int64_t>;

/// Results by rows and columns, for people (print) and for programs (CSV, JSON).
class Table {
  public:
    /// Throws lancet::Error without columns, for an empty or repeated key, and for less than one significant digit.
    explicit Table(std::vector<Column> columns);

    /// Appends a row of one cell per column; throws lancet::Error for another count.
    void add_row(std::vector<Cell> cells);

    [[nodiscard]] const std::vector<Column>& columns() const { return columns_; }
    [[nodiscard]] const std::vector<std::vector<Cell>>& rows() const { return rows_; }

    /// Prints headings, units, a rule and the rows. Columns that hold a number are aligned to the right, the others to
    /// the left; widths count Unicode code points.
    void print(std::ostream& stream) const;

    /// The table as RFC 4180 CSV: a heading of keys, fields quoted where they must be, numbers with all their digits.
    void print_csv(std::ostream& stream) const;

    /// print_csv() to a file that appears as a whole; throws lancet::Error when it cannot be written.
    void write_csv(const std::filesystem::path& file) const;

    /// One object per row, with the keys in column order.
    [[nodiscard]] nlohmann::ordered_json to_json() const;

  private:
    std::vector<Column> columns_;
    std::vector<std::vector<Cell>> rows_;
};

/// `value` with `significant_digits` digits: fixed notation where it is short, scientific below 1e-4 and from 1e7 on.
[[nodiscard]] std::string format_number(double value, int significant_digits);

/// The shortest text that reads back as the same number.
[[nodiscard]] std::string format_exact(double value);

/// `field` as RFC 4180 wants it: in double quotes, with inner ones doubled, if it holds a comma, a quote or a line end.
[[nodiscard]] std::string quote_csv(const std::string& field);

}  // namespace lancet::experiments
