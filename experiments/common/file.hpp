#pragma once

#include <filesystem>
#include <functional>
#include <iosfwd>
#include <string_view>

#include <nlohmann/json.hpp>

namespace lancet::experiments {

/// Writes a file as a whole or not at all: `write` fills a temporary file in the same folder, which then takes the
/// name `file` by rename. When anything fails, the temporary file is removed, an existing `file` is left as it was,
/// and lancet::Error names the file and the cause; what `write` itself throws passes through.
void write_file(const std::filesystem::path& file, const std::function<void(std::ostream&)>& write);

/// write_file() of ready text.
void write_file(const std::filesystem::path& file, std::string_view text);

/// write_file() of a JSON document, indented by 2, in the order of its keys. JSON has no number for what is not
/// finite: such a number is written as the string "nan", "inf" or "-inf", never as null.
void write_json_file(const std::filesystem::path& file, const nlohmann::ordered_json& document);

}  // namespace lancet::experiments
