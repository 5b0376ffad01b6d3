#include "lancet/experiments/common/main.hpp"

#include <exception>
#include <filesystem>
#include <iostream>
#include <new>

#include <CLI/CLI.hpp>

#include "lancet/kernels/error.hpp"

namespace lancet::experiments {
namespace {

void print_line(std::ostream& errors, int argc, const char* const* argv, std::string message) {
    for (char& character : message) {
        if (character == '\n' || character == '\r') character = ' ';
    }
    const std::string program = argc > 0 ? std::filesystem::path(argv[0]).filename().string() : "lancet";
    std::cout.flush();
    errors << program << ": " << message << std::endl;
}

}  // namespace

int run_main(int argc, const char* const* argv, const MainFunction& body, std::ostream& errors) {
    const auto fail = [&](ExitCode code, const std::string& message) {
        print_line(errors, argc, argv, message);
        return static_cast<int>(code);
    };
    try {
        return static_cast<int>(body(argc, argv));
    } catch (const CheckFailed& failure) {
        return fail(ExitCode::check_failed, std::string("check failed: ") + failure.what());
    } catch (const std::bad_alloc&) {
        return fail(ExitCode::bad_input, "error: not enough memory for this run; ask for fewer elements or rows");
    } catch (const std::exception& error) {  // lancet::Error, and CLI::Error where a program parses by itself
        return fail(ExitCode::bad_input, std::string("error: ") + error.what());
    }
}

int run_main(int argc, const char* const* argv, const MainFunction& body) {
    return run_main(argc, argv, body, std::cerr);
}

}  // namespace lancet::experiments
