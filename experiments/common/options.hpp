#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "lancet/kernels/error.hpp"

namespace CLI {
class App;
}

namespace lancet::experiments {

/// The words that an experiment accepts in its lists; anything else is refused with a message that shows them.
struct Choices {
    std::vector<std::string> schedulers{"serial", "openmp", "tbb"};
    std::vector<std::string> instruction_sets{"scalar", "sse2", "avx2", "avx512", "neon"};
    std::vector<std::string> scalars{"float", "double"};
};

/// The options that all experiments share. An empty list means that the user did not give the option: the experiment
/// then takes its own default.
struct SharedOptions {
    bool quick = false;                         ///< a short run that shows that everything works
    std::vector<int> threads;                   ///< thread counts, each at least 1
    std::vector<std::string> schedulers;        ///< out of Choices::schedulers
    std::vector<std::string> instruction_sets;  ///< out of Choices::instruction_sets
    std::vector<std::string> scalars;           ///< out of Choices::scalars
    std::optional<std::filesystem::path> json;  ///< result file to write
    std::optional<std::filesystem::path> csv;   ///< result file to write
};

/// Adds --quick, --threads, --scheduler, --isa, --scalar, --json and --csv to `app`. `options` must outlive the parse.
/// Parsing throws lancet::Error for a list that is empty, repeats an entry or holds one that is not among `choices`,
/// and for a result file whose folder does not exist.
void add_shared_options(CLI::App& app, SharedOptions& options, const Choices& choices = {});

/// Adds an option for a comma-separated list out of `choices`, which its help shows after `what`; parse_words() reads
/// it. `target` must outlive the parse.
void add_words(CLI::App& app, const std::string& option, std::vector<std::string>& target,
               const std::vector<std::string>& choices, const std::string& what);

/// The entry of a list that may have one, or `otherwise` where it has none: for experiments that measure one at a time.
/// Throws lancet::Error, naming `option`, for more.
template <class Value>
[[nodiscard]] Value only(const std::vector<Value>& list, const Value& otherwise, const std::string& option) {
    if (list.size() > 1) throw Error(option + ": this experiment takes one at a time, expected one entry");
    return list.empty() ? otherwise : list.front();
}

/// Parses the command line. Returns false when --help was asked for and has been printed to standard output: the
/// program then ends with success. Throws lancet::Error with one line for whatever CLI11 refuses.
[[nodiscard]] bool parse_command_line(CLI::App& app, int argc, const char* const* argv);

/// The whole numbers of a comma-separated list such as "1,2,8". Throws lancet::Error, naming `option`, for an empty
/// list or entry, for something that is not a whole number of at least `minimum`, and for a repeated entry.
[[nodiscard]] std::vector<int> parse_counts(std::string_view option, std::string_view text, int minimum = 1);

/// The words of a comma-separated list such as "serial,tbb". Throws lancet::Error, naming `option` and the choices, for
/// an empty list or entry, for a word that is not among `choices`, and for a repeated one.
[[nodiscard]] std::vector<std::string> parse_words(std::string_view option, std::string_view text,
                                                   const std::vector<std::string>& choices);

}  // namespace lancet::experiments
