// SPDX-License-Identifier: AGPL-3.0-or-later
#include <array>
#include <fstream>
#include <gtest/gtest.h>
#include <iterator>

#include "planner/plan/plan.h"
#include "tests/file_bytes.h"
#include "verify/phantom/chance.h"

namespace octotomy::planner {
namespace {

/// A plan's text with one to three places spoiled.
std::string spoiled(std::string text, verify::Chance& chance) {
  const auto any = [&](std::size_t count) {
    return std::min(count - 1, static_cast<std::size_t>((chance.even() + 0.5) * static_cast<double>(count)));
  };
  static const std::array<std::string, 16> words{"null", "-1",  "1e999",    "[]",        "{}", "\"\"",
                                                 "true", "NaN", "\"",       "\"skull\"", ",",  "]",
                                                 "}",    "0",   "\xff\xfe", "1e-320"};
  const std::size_t edits = 1 + any(3);
  for (std::size_t edit = 0; edit < edits && text.size() > 2; ++edit) {
    const std::size_t at = any(text.size()), length = std::min(1 + any(12), text.size() - at);
    switch (any(6)) {
      case 0:
        text.erase(at, length);
        break;
      case 1:
        text[at] = static_cast<char>(any(256));
        break;
      case 2:
        text.insert(at, text.substr(any(text.size()), length));
        break;
      case 3:
        text.insert(at, words[any(words.size())]);
        break;
      case 4: {
        // A whole value, from one delimiter to the next.
        const std::size_t from = text.find_first_of(":[", at), to = text.find_first_of(",]}", from);
        if (from != std::string::npos && to != std::string::npos)
          text.replace(from + 1, to - from - 1, words[any(words.size())]);
        break;
      }
      default:
        text.resize(at);
        break;
    }
  }
  return text;
}

// OCTOTOMY_PLANS=100000 is the long run.
TEST(MutatedPlans, AreReadOrRefusedInOneLine) {
  const char* asked = std::getenv("OCTOTOMY_PLANS");
  const int count = asked != nullptr ? std::atoi(asked) : 2000;
  const std::filesystem::path source = OCTOTOMY_SOURCE_DIR;
  const std::array<std::string, 2> plans{tests::bytes_of(source / "planner/le_fort_i.plan.json"),
                                         tests::bytes_of(source / "tests/planner/data/unc_cthead.plan.json")};
  int read = 0, refused = 0;
  for (int seed = 0; seed < count; ++seed) {
    verify::Chance chance(static_cast<std::uint64_t>(seed));
    const std::string text = spoiled(plans[static_cast<std::size_t>(seed) % plans.size()], chance);
    try {
      parse_plan(text, ".");
      ++read;
    } catch (const std::runtime_error& error) {
      const std::string said = error.what();
      EXPECT_FALSE(said.empty()) << "seed " << seed;
      EXPECT_EQ(said.find('\n'), std::string::npos) << "seed " << seed << ": " << said;
      EXPECT_LT(said.size(), 2000u) << "seed " << seed << ": " << said;
      ++refused;
    } catch (const std::exception& error) {
      ADD_FAILURE() << "seed " << seed << ": not a refusal: " << error.what();
    }
  }
  EXPECT_GT(refused, count / 2);
  EXPECT_GT(read, 0) << "every change spoils: nothing shows that plans are read";
}

}  // namespace
}  // namespace octotomy::planner
