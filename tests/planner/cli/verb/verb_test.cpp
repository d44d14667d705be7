// SPDX-License-Identifier: AGPL-3.0-or-later
#include "planner/cli/verb/verb.h"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <gtest/gtest.h>

namespace octotomy::planner::cli {
namespace {

/// The options that a verb called `name` gets from a command line.
std::size_t option_count(const std::string& name, const std::vector<std::string>& words) {
  CLI::App app;
  app.add_subcommand("plan", "");
  Program program(app, words);
  return program.verb(name, "", "", [] { return 0; }).get_options().size();
}

TEST(Verb, HasItsOptionsWhereTheCommandLineMayMeanIt) {
  const std::size_t all = option_count("info", {"info", "head.nrrd"});
  EXPECT_GE(all, 5u);
  EXPECT_EQ(option_count("info", {"--manual", "man"}), all);
  EXPECT_EQ(option_count("info", {"--json", "info"}), all);
  EXPECT_EQ(option_count("info", {}), all);
  EXPECT_EQ(option_count("plan diff", {"plan", "diff", "a", "b"}), all);
  EXPECT_EQ(option_count("info", {"look", "head.nrrd"}), 1u) << "its --help alone";
  EXPECT_EQ(option_count("plan diff", {"plan", "merge", "a", "b"}), 1u);
}

TEST(Verb, OfAnUnknownNameTheNearestIsSaid) {
  CLI::App app;
  app.add_subcommand("measure", "");
  EXPECT_EQ(unknown_verb(app, "mesure"),
            "there is no verb 'mesure', did you mean 'measure'?; see octotomy --help");
}

TEST(Verb, OfManyFindingsThatAreToldAPageIsSaidAndHowManyMore) {
  for (int run = 0; run < 2; ++run) {
    testing::internal::CaptureStderr();
    {
      const FindingsOfRun findings;
      for (int i = 0; i < 1000; ++i) warn_finding("finding " + std::to_string(i));
      warn("what matters");
    }
    const std::string said = testing::internal::GetCapturedStderr();
    const auto lines = std::count(said.begin(), said.end(), '\n');
    EXPECT_LE(lines, 60);
    EXPECT_NE(said.find("what matters\n"), std::string::npos);
    EXPECT_NE(said.find(std::to_string(1002 - lines) + " more findings: --json "), std::string::npos);
  }
}

}  // namespace
}  // namespace octotomy::planner::cli
