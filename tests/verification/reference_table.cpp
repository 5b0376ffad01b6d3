#include "tests/verification/reference_table.hpp"

#include <charconv>
#include <fstream>
#include <limits>
#include <sstream>

namespace lancet::test {

std::filesystem::path reference_folder() {
    return std::filesystem::path(LANCET_SHARED_DIR) / "reference";
}

std::vector<std::vector<double>> read_numbers(const std::filesystem::path& file) {
    std::ifstream stream(file);
    std::vector<std::vector<double>> rows;
    std::string line;
    bool is_heading = true;
    while (std::getline(stream, line)) {
        if (line.empty() || line.front() == '#') continue;
        if (is_heading) {
            is_heading = false;
            continue;
        }
        rows.emplace_back();
        std::istringstream fields(line);
        for (std::string field; std::getline(fields, field, ',');) {
            double number = std::numeric_limits<double>::quiet_NaN();
            std::from_chars(field.data(), field.data() + field.size(), number);
            rows.back().push_back(number);
        }
    }
    return rows;
}

}  // namespace lancet::test
