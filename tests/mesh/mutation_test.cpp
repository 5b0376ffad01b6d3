// Thousands of damaged files: each reads as a valid mesh or fails with lancet::Error, nothing else.
#include <cstdint>
#include <exception>
#include <random>
#include <string>
#include <string_view>

#include "tests/mesh/samples.hpp"
#include <gtest/gtest.h>

#include "lancet/kernels/error.hpp"
#include "lancet/mesh/inspect.hpp"
#include "lancet/mesh/io/read.hpp"

namespace {

using lancet::mesh::read_from_memory;
using lancet::mesh::ReadOptions;
using lancet::mesh::test::Sample;
using lancet::mesh::test::samples;

/// Words that have broken readers before.
constexpr std::string_view words[] = {"0",
                                      "-1",
                                      "1",
                                      "4294967295",
                                      "2147483647",
                                      "2147483648",
                                      "-2147483648",
                                      "9223372036854775807",
                                      "-9223372036854775808",
                                      "18446744073709551615",
                                      "1e308",
                                      "1e-320",
                                      "nan",
                                      "-inf",
                                      "\"",
                                      "$EndNodes",
                                      "<",
                                      ">",
                                      "&amp;",
                                      "*NSET, NSET=a, GENERATE\n1, 9223372036854775807, 1\n",
                                      "METADATA\n",
                                      "FIELD f 1000\n",
                                      ",",
                                      "=",
                                      "\n",
                                      "\r\n",
                                      "#"};

class Mutator {
  public:
    explicit Mutator(std::uint32_t seed) : random_(seed) {}

    std::size_t below(std::size_t bound) { return bound == 0 ? 0 : random_() % bound; }

    void mutate(std::string& text, const std::string& other) {
        switch (below(9)) {
            case 0:
                if (!text.empty()) text[below(text.size())] = static_cast<char>(below(256));
                break;
            case 1:
                if (!text.empty()) text[below(text.size())] ^= static_cast<char>(1U << below(8));
                break;
            case 2:
                text.resize(below(text.size() + 1));
                break;
            case 3: {
                const std::size_t at = below(text.size() + 1);
                text.erase(at, below(std::min<std::size_t>(64, text.size() - at) + 1));
                break;
            }
            case 4: {
                const std::size_t at = below(text.size() + 1);
                const std::string piece = text.substr(at, below(64));
                text.insert(below(text.size() + 1), piece);
                break;
            }
            case 5:
                replace_word(text, words[below(std::size(words))]);
                break;
            case 6:
                text.insert(below(text.size() + 1), words[below(std::size(words))]);
                break;
            case 7: {
                const std::size_t at = below(other.size() + 1);
                text.insert(below(text.size() + 1), other.substr(at, below(64)));
                break;
            }
            default: {
                // A whole binary number of extreme value.
                constexpr std::uint64_t values[] = {
                    0, 1, 0xFFFFFFFFU, 0x7FFFFFFFU, ~std::uint64_t{0}, 0x7FF0000000000000U};
                const std::uint64_t value = values[below(std::size(values))];
                const std::size_t size = below(2) == 0 ? 4 : 8;
                if (text.size() < size) break;
                const std::size_t at = below(text.size() - size + 1);
                for (std::size_t n = 0; n < size; ++n) text[at + n] = static_cast<char>(value >> (8 * n));
                break;
            }
        }
    }

  private:
    void replace_word(std::string& text, std::string_view word) {
        constexpr std::string_view separators = " \t\n\r,\"<>=";
        const std::size_t begin = text.find_first_not_of(separators, below(text.size() + 1));
        if (begin == std::string::npos) return;
        const std::size_t end = std::min(text.find_first_of(separators, begin), text.size());
        text.replace(begin, end - begin, word);
    }

    std::mt19937 random_;
};

TEST(Mutation, EveryDamagedFileIsAValidMeshOrAnError) {
    const auto all = samples();
    constexpr int rounds = 1500;
    std::size_t read_well = 0;
    std::size_t refused = 0;
    for (std::size_t s = 0; s < all.size(); ++s) {
        Mutator mutator(static_cast<std::uint32_t>(1000 + s));
        for (int round = 0; round < rounds; ++round) {
            Sample one = all[s];
            const Sample& other = all[mutator.below(all.size())];
            const std::size_t changes = 1 + mutator.below(4);
            for (std::size_t n = 0; n < changes; ++n) {
                const bool second = !one.second.empty() && mutator.below(2) == 0;
                mutator.mutate(second ? one.second : one.content, other.content);
            }
            const ReadOptions options{.repair = mutator.below(4) != 0,
                                      .drop_flat = mutator.below(2) == 0,
                                      .drop_duplicates = mutator.below(2) == 0};
            try {
                const auto result = read_from_memory(one.format, one.content, one.second, "file", options);
                ASSERT_TRUE(lancet::mesh::inspect(result.mesh.definition()).clean()) << one.name << " round " << round;
                ++read_well;
            } catch (const lancet::Error& error) {
                const std::string message = error.what();
                ASSERT_EQ(message.find('\n'), std::string::npos) << message;
                ASSERT_TRUE(message.starts_with("file")) << message;
                ++refused;
            } catch (const std::exception& error) {
                FAIL() << one.name << " round " << round << ": " << error.what();
            }
        }
    }
    // Both outcomes occur, or the test would not look where it should.
    EXPECT_GT(read_well, all.size() * rounds / 50);
    EXPECT_GT(refused, all.size() * rounds / 4);
}

}  // namespace
