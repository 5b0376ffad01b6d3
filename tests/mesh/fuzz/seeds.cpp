// Writes one valid file of each kind for the fuzzer to start from.
#include <filesystem>
#include <fstream>
#include <iostream>

#include "tests/mesh/samples.hpp"

int main(int count, char** arguments) {
    if (count != 2) {
        std::cerr << "usage: fuzz_seeds FOLDER\n";
        return 2;
    }
    const std::filesystem::path folder = arguments[1];
    std::filesystem::create_directories(folder);
    for (const auto& sample : lancet::mesh::test::samples()) {
        std::string name = sample.name;
        for (char& c : name) c = c == ' ' ? '_' : c;
        std::ofstream file(folder / name, std::ios::binary);
        file << static_cast<char>(sample.format) << sample.content;
        if (!sample.second.empty()) file << '\0' << sample.second;
        if (!file) {
            std::cerr << "cannot write " << (folder / name) << '\n';
            return 1;
        }
    }
    return 0;
}
