#include "lancet/experiments/common/gnuplot.hpp"

#include <system_error>

#include <unistd.h>

#include "lancet/experiments/common/process.hpp"
#include "lancet/kernels/error.hpp"

namespace lancet::experiments {

std::string quoted(const std::string& text) {
    std::string result = "'";
    for (const char c : text) result += c == '\'' ? std::string("''") : std::string(1, c);
    return result + "'";
}

void make_plot_folder(const std::filesystem::path& folder) {
    std::error_code failed;
    std::filesystem::create_directories(folder, failed);
    if (failed) throw Error("--plot: the folder '" + folder.string() + "' cannot be made: " + failed.message());
}

std::string run_gnuplot(const std::filesystem::path& folder, const std::string& name,
                        std::span<const std::string> endings) {
    const std::string part = ".part" + std::to_string(::getpid());
    const auto drawn = [&](const std::string& ending) { return folder / (name + ending + part); };
    const Command command{
        .program = "gnuplot",
        .arguments = {"-e", "cd " + quoted(std::filesystem::absolute(folder).string()), "-e", "part = " + quoted(part),
                      std::filesystem::absolute(folder / (name + ".gp")).string()}};
    std::error_code failed;
    try {
        const ProcessResult result = run_process(command);
        if (!result.succeeded()) {
            for (const std::string& ending : endings) std::filesystem::remove(drawn(ending), failed);
            return "gnuplot ended with " + describe(result.end);
        }
    } catch (const Error& error) {
        return error.what();
    }
    for (const std::string& ending : endings) {
        std::filesystem::rename(drawn(ending), folder / (name + ending), failed);
        if (failed) return "gnuplot drew no " + name + ending + ": " + failed.message();
    }
    return {};
}

}  // namespace lancet::experiments
