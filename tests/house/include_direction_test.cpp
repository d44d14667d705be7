// SPDX-License-Identifier: AGPL-3.0-or-later
// The folders depend in one direction: voxel and brep, which never meet, then convert, verify, planner,
// tests.
#include <algorithm>
#include <filesystem>
#include <fstream>
#include <gtest/gtest.h>
#include <map>
#include <regex>
#include <set>
#include <string>
#include <vector>

namespace {

namespace fs = std::filesystem;

const std::map<std::string, std::set<std::string>> allowed{
    {"voxel", {"voxel"}},
    {"brep", {"brep"}},
    {"convert", {"convert", "voxel", "brep"}},
    {"verify", {"verify", "convert", "voxel", "brep"}},
    {"planner", {"planner", "verify", "convert", "voxel", "brep"}},
};

// The folders that a source text includes from, with the lines that do.
std::vector<std::pair<std::string, std::string>> project_includes(const std::string& text) {
  static const std::regex include(R"re((?:^|\n)\s*#\s*include\s*"(\w+)/([^"]*)")re");
  std::vector<std::pair<std::string, std::string>> found;
  for (std::sregex_iterator match(text.begin(), text.end(), include), end; match != end; ++match)
    found.emplace_back((*match)[1], (*match)[1].str() + "/" + (*match)[2].str());
  return found;
}

std::string forbidden_arrows(const std::string& folder, const std::string& text) {
  std::string arrows;
  for (const auto& [to, path] : project_includes(text))
    if (!allowed.at(folder).contains(to)) arrows += " \"" + path + "\"";
  return arrows;
}

TEST(IncludeDirection, NoSourceReachesAgainstTheArrows) {
  int sources = 0;
  int includes = 0;
  for (const auto& [folder, may] : allowed)
    for (const fs::directory_entry& entry :
         fs::recursive_directory_iterator(fs::path(OCTOTOMY_SOURCE_DIR) / folder)) {
      if (entry.path().extension() != ".h" && entry.path().extension() != ".cpp") continue;
      std::ifstream file(entry.path());
      const std::string text((std::istreambuf_iterator<char>(file)), std::istreambuf_iterator<char>());
      EXPECT_EQ(forbidden_arrows(folder, text), "") << entry.path();
      ++sources;
      includes += static_cast<int>(project_includes(text).size());
    }
  EXPECT_GT(sources, 40) << "the test looks in the wrong place";
  EXPECT_GT(includes, 100);
}

TEST(IncludeDirection, AnArrowBetweenTheKernelsIsSeen) {
  EXPECT_EQ(forbidden_arrows("voxel", "#pragma once\n#include \"brep/mesh.h\"\n"), " \"brep/mesh.h\"");
  EXPECT_EQ(forbidden_arrows("brep", "#include <vector>\n  # include \"voxel/scene.h\""),
            " \"voxel/scene.h\"");
  EXPECT_EQ(forbidden_arrows("convert", "#include \"planner/plan.h\""), " \"planner/plan.h\"");
  EXPECT_EQ(forbidden_arrows("convert", "#include \"brep/mesh.h\"\n#include \"voxel/scene.h\""), "");
}

// Libraries, too: what one folder's target links decides what its sources could reach.
TEST(IncludeDirection, NoTargetLinksAgainstTheArrows) {
  static const std::regex link(R"(octotomy_(voxel|brep|convert|verify|planner)\b)");
  for (const auto& [folder, may] : allowed) {
    std::ifstream file(fs::path(OCTOTOMY_SOURCE_DIR) / folder / "CMakeLists.txt");
    std::string text((std::istreambuf_iterator<char>(file)), std::istreambuf_iterator<char>());
    ASSERT_FALSE(text.empty()) << folder;
    text = std::regex_replace(text, std::regex("#[^\n]*"), "");
    for (std::sregex_iterator match(text.begin(), text.end(), link), end; match != end; ++match)
      EXPECT_TRUE(may.contains((*match)[1])) << folder << "/CMakeLists.txt names octotomy_" << (*match)[1];
  }
}

TEST(TopLevel, HoldsWhatTheHouseNamesAndNothingElse) {
  const std::set<std::string> house{"CMakeLists.txt", "README.md", "LICENSE", "voxel", "brep",
                                    "convert",        "verify",    "planner", "tests"};
  for (const fs::directory_entry& entry : fs::directory_iterator(OCTOTOMY_SOURCE_DIR)) {
    const std::string name = entry.path().filename();
    if (name.starts_with(".") || name == "build") continue;
    EXPECT_TRUE(house.contains(name)) << name;
  }
  for (const std::string& name : house) EXPECT_TRUE(fs::exists(fs::path(OCTOTOMY_SOURCE_DIR) / name)) << name;
}

}  // namespace
