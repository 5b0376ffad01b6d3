#include "lancet/experiments/common/options.hpp"

#include <algorithm>
#include <charconv>
#include <iostream>
#include <system_error>

#include <CLI/CLI.hpp>

#include "lancet/kernels/error.hpp"

namespace lancet::experiments {
namespace {

std::string join(const std::vector<std::string>& words) {
    std::string text;
    for (const std::string& word : words) text += (text.empty() ? "" : ", ") + word;
    return text;
}

[[noreturn]] void refuse(std::string_view option, std::string_view entry, const std::string& expected) {
    throw Error(std::string(option) + ": '" + std::string(entry) + "' found, expected " + expected);
}

std::vector<std::string_view> split(std::string_view text) {
    std::vector<std::string_view> entries;
    for (std::size_t begin = 0;;) {
        const std::size_t end = text.find(',', begin);
        entries.push_back(text.substr(begin, end - begin));
        if (end == std::string_view::npos) return entries;
        begin = end + 1;
    }
}

void check_result_file(const std::string& option, const std::filesystem::path& file) {
    std::error_code ignored;
    if (file.filename().empty() || std::filesystem::is_directory(file, ignored)) {
        refuse(option, file.string(), "the name of a file to write");
    }
    const std::filesystem::path folder = file.has_parent_path() ? file.parent_path() : std::filesystem::path(".");
    if (!std::filesystem::is_directory(folder, ignored)) {
        throw Error(option + ": cannot write '" + file.string() + "': there is no folder '" + folder.string() + "'");
    }
}

/// CLI11 spreads some messages over several lines; ours are one line.
std::string one_line(std::string text) {
    std::replace(text.begin(), text.end(), '\n', ' ');
    while (!text.empty() && text.back() == ' ') text.pop_back();
    return text;
}

}  // namespace

std::vector<int> parse_counts(std::string_view option, std::string_view text, int minimum) {
    std::vector<int> counts;
    for (const std::string_view entry : split(text)) {
        int count = 0;
        const auto [end, error] = std::from_chars(entry.data(), entry.data() + entry.size(), count);
        if (error != std::errc{} || end != entry.data() + entry.size() || count < minimum) {
            refuse(option, entry, "whole numbers of at least " + std::to_string(minimum) + ", such as 1,2");
        }
        if (std::find(counts.begin(), counts.end(), count) != counts.end()) {
            refuse(option, entry, "each number once");
        }
        counts.push_back(count);
    }
    return counts;
}

std::vector<std::string> parse_words(std::string_view option, std::string_view text,
                                     const std::vector<std::string>& choices) {
    std::vector<std::string> words;
    for (const std::string_view entry : split(text)) {
        if (std::find(choices.begin(), choices.end(), entry) == choices.end()) {
            refuse(option, entry, "a list out of " + join(choices));
        }
        if (std::find(words.begin(), words.end(), entry) != words.end()) refuse(option, entry, "each word once");
        words.emplace_back(entry);
    }
    return words;
}

void add_words(CLI::App& app, const std::string& option, std::vector<std::string>& target,
               const std::vector<std::string>& choices, const std::string& what) {
    app.add_option_function<std::string>(
           option, [option, &target, choices](const std::string& text) { target = parse_words(option, text, choices); },
           what + ", a list out of: " + join(choices))
        ->type_name("LIST");
}

void add_shared_options(CLI::App& app, SharedOptions& options, const Choices& choices) {
    app.add_flag("--quick", options.quick, "A short run that shows that everything works");

    const auto add_file = [&app](const std::string& option, std::optional<std::filesystem::path>& target,
                                 const std::string& what) {
        app.add_option_function<std::string>(
               option,
               [option, &target](const std::string& text) {
                   const std::filesystem::path file(text);
                   check_result_file(option, file);
                   target = file;
               },
               what)
            ->type_name("FILE");
    };

    app.add_option_function<std::string>(
           "--threads", [&options](const std::string& text) { options.threads = parse_counts("--threads", text); },
           "Thread counts, a list such as 1,2")
        ->type_name("LIST");
    add_words(app, "--scheduler", options.schedulers, choices.schedulers, "Schedulers");
    add_words(app, "--isa", options.instruction_sets, choices.instruction_sets, "Instruction sets");
    add_words(app, "--scalar", options.scalars, choices.scalars, "Scalar types");
    add_file("--json", options.json, "Write the results to FILE as JSON");
    add_file("--csv", options.csv, "Write the table to FILE as comma-separated values");
}

bool parse_command_line(CLI::App& app, int argc, const char* const* argv) {
    try {
        app.parse(argc, argv);
    } catch (const CLI::Success& request) {  // --help and --version
        app.exit(request, std::cout, std::cerr);
        return false;
    } catch (const CLI::ParseError& error) {
        throw Error(one_line(error.what()) + " (--help lists the options)");
    }
    return true;
}

}  // namespace lancet::experiments
