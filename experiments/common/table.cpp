#include "lancet/experiments/common/table.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <cstdio>
#include <ostream>
#include <set>

#include "lancet/experiments/common/file.hpp"
#include "lancet/kernels/error.hpp"

namespace lancet::experiments {
namespace {

std::string print_with(const char* format, int precision, double value) {
    const int length = std::snprintf(nullptr, 0, format, precision, value);
    std::string text(static_cast<std::size_t>(length) + 1, '\0');
    std::snprintf(text.data(), text.size(), format, precision, value);
    text.pop_back();
    return text;
}

std::string printed_text(const Cell& cell, int significant_digits) {
    if (const auto* text = std::get_if<std::string>(&cell)) return *text;
    if (const auto* number = std::get_if<double>(&cell)) return format_number(*number, significant_digits);
    if (const auto* count = std::get_if<std::int64_t>(&cell)) return std::to_string(*count);
    return "-";
}

std::string csv_text(const Cell& cell) {
    if (const auto* text = std::get_if<std::string>(&cell)) return quote_csv(*text);
    if (const auto* number = std::get_if<double>(&cell)) return format_exact(*number);
    if (const auto* count = std::get_if<std::int64_t>(&cell)) return std::to_string(*count);
    return {};
}

/// Code points: every byte of UTF-8 that does not continue one.
std::size_t width(const std::string& text) {
    return static_cast<std::size_t>(
        std::count_if(text.begin(), text.end(), [](char byte) { return (byte & 0xC0) != 0x80; }));
}

bool is_number(const Cell& cell) {
    return std::holds_alternative<double>(cell) || std::holds_alternative<std::int64_t>(cell);
}

}  // namespace

Table::Table(std::vector<Column> columns) : columns_(std::move(columns)) {
    if (columns_.empty()) throw Error("a table needs at least one column");
    std::set<std::string> keys;
    for (const Column& column : columns_) {
        if (column.key.empty()) throw Error("table column '" + column.title + "' has no key");
        if (!keys.insert(column.key).second) throw Error("two table columns have the key '" + column.key + "'");
        if (column.significant_digits < 1) throw Error("table column '" + column.key + "' has no significant digits");
    }
}

void Table::add_row(std::vector<Cell> cells) {
    if (cells.size() != columns_.size()) {
        throw Error("a table row has " + std::to_string(cells.size()) + " cells, expected " +
                    std::to_string(columns_.size()));
    }
    rows_.push_back(std::move(cells));
}

void Table::print(std::ostream& stream) const {
    struct Printed {
        std::vector<std::string> lines;  // title, unit, one per row
        std::size_t width = 0;
        bool right = false;
    };
    std::vector<Printed> printed;
    for (std::size_t c = 0; c < columns_.size(); ++c) {
        if (!columns_[c].printed) continue;
        Printed column;
        column.lines = {columns_[c].title, columns_[c].unit};
        for (const std::vector<Cell>& row : rows_) {
            column.lines.push_back(printed_text(row[c], columns_[c].significant_digits));
            column.right = column.right || is_number(row[c]);
        }
        for (const std::string& line : column.lines) column.width = std::max(column.width, width(line));
        printed.push_back(std::move(column));
    }

    for (std::size_t line = 0; line < rows_.size() + 2; ++line) {
        std::string text;
        for (const Printed& column : printed) {
            const std::string& cell = column.lines[line];
            const std::string padding(column.width - width(cell), ' ');
            text += (text.empty() ? "" : "  ") + (column.right ? padding + cell : cell + padding);
        }
        text.erase(text.find_last_not_of(' ') + 1);
        stream << text << '\n';
        if (line == 1) {
            std::string rule;
            for (const Printed& column : printed) rule += (rule.empty() ? "" : "  ") + std::string(column.width, '-');
            stream << rule << '\n';
        }
    }
}

void Table::print_csv(std::ostream& stream) const {
    const auto print_fields = [&](auto&& field) {
        for (std::size_t c = 0; c < columns_.size(); ++c) stream << (c == 0 ? "" : ",") << field(c);
        stream << "\r\n";
    };
    print_fields([&](std::size_t c) { return quote_csv(columns_[c].key); });
    for (const std::vector<Cell>& row : rows_) print_fields([&](std::size_t c) { return csv_text(row[c]); });
}

void Table::write_csv(const std::filesystem::path& file) const {
    write_file(file, [this](std::ostream& stream) { print_csv(stream); });
}

nlohmann::ordered_json Table::to_json() const {
    nlohmann::ordered_json rows = nlohmann::ordered_json::array();
    for (const std::vector<Cell>& row : rows_) {
        nlohmann::ordered_json object = nlohmann::ordered_json::object();
        for (std::size_t c = 0; c < columns_.size(); ++c) {
            nlohmann::ordered_json& value = object[columns_[c].key];  // null: a missing cell stays so
            if (const auto* text = std::get_if<std::string>(&row[c])) value = *text;
            if (const auto* number = std::get_if<double>(&row[c])) value = *number;
            if (const auto* count = std::get_if<std::int64_t>(&row[c])) value = *count;
        }
        rows.push_back(std::move(object));
    }
    return rows;
}

std::string format_exact(double value) {
    std::array<char, 32> buffer{};
    return {buffer.data(), std::to_chars(buffer.data(), buffer.data() + buffer.size(), value).ptr};
}

std::string format_number(double value, int significant_digits) {
    if (std::isnan(value)) return "nan";
    if (std::isinf(value)) return value > 0 ? "inf" : "-inf";
    if (value == 0) return "0";
    // Rounding first: it may carry into a new leading digit (9.9996 -> 10.00).
    std::string scientific = print_with("%.*e", significant_digits - 1, value);
    const int exponent = std::stoi(scientific.substr(scientific.find('e') + 1));
    if (exponent < -4 || exponent >= 7) return scientific;
    return print_with("%.*f", std::max(0, significant_digits - 1 - exponent), value);
}

std::string quote_csv(const std::string& field) {
    if (field.find_first_of(",\"\r\n") == std::string::npos) return field;
    std::string quoted = "\"";
    for (const char character : field) {
        if (character == '"') quoted += '"';
        quoted += character;
    }
    return quoted + '"';
}

}  // namespace lancet::experiments
