#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace lancet::test {

/// The folder of reference solutions; it may be absent.
std::filesystem::path reference_folder();

/// The numbers of a file of comma-separated values without its heading. Fields that are not numbers are not a number.
/// Empty if there is no such file.
std::vector<std::vector<double>> read_numbers(const std::filesystem::path& file);

}  // namespace lancet::test
