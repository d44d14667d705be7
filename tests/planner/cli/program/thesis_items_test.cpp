// SPDX-License-Identifier: AGPL-3.0-or-later
#include <filesystem>
#include <set>

#include "tests/file_bytes.h"
#include "tests/planner/cli/program/command_line.h"

// Walks the list of the thesis's items, tests/golden/thesis/items.json. A row names a section, an item, the
// commands that show it, and values that the last command's answer is held to:
//   json   pointers into standard output, each with a value or [lowest, highest]
//   text   pieces of standard output
//   file   files in the commands' folder, each with its whole text
// The values are closed forms, counts of another program, or printed in the thesis; a range is as wide as
// digitisation allows. A row without commands says what is missing. Commands find the program in OCTOTOMY_PROGRAM
// and the sources in OCTOTOMY_SOURCE_DIR, too.

namespace octotomy::planner {
namespace {

std::filesystem::path list_path() {
  return std::filesystem::path(OCTOTOMY_SOURCE_DIR) / "tests" / "golden" / "thesis" / "items.json";
}

/// Rows without commands: none may come back.
constexpr int missing_count = 0;

class ThesisItems : public tests::CommandLine {
 protected:
  ThesisItems() : list_(tests::SortedJson::parse(tests::bytes_of(list_path()))) {}

  /// Runs a command of the list in the test's folder.
  tests::CommandAnswer walk(std::string command) const {
    const std::string name = "octotomy ";
    if (command.rfind(name, 0) == 0)
      command = std::string(OCTOTOMY_BINARY_DIR) + "/octotomy " + command.substr(name.size());
    return tests::run_command("export OCTOTOMY_SOURCE_DIR='" OCTOTOMY_SOURCE_DIR
                              "' OCTOTOMY_PROGRAM='" OCTOTOMY_BINARY_DIR "/octotomy'; cd " +
                                  at("") + " && " + command,
                              folder_ / "");
  }

  /// A text whose columns are one space apart: their widths follow the longest name in a table.
  static std::string without_widths(const std::string& text) {
    std::string narrow;
    for (const char letter : text)
      if (letter != ' ' || narrow.empty() || narrow.back() != ' ') narrow += letter;
    return narrow;
  }

  /// How an answer differs from a row's values; empty if it does not.
  std::string difference(const tests::SortedJson& row, const tests::CommandAnswer& answer) const {
    const tests::SortedJson files = row.value("file", tests::SortedJson::object());
    const tests::SortedJson wanted_json = row.value("json", tests::SortedJson::object());
    const std::string out = without_widths(answer.out);
    std::string different;
    for (const auto& piece : row.value("text", tests::SortedJson::array()))
      if (out.find(without_widths(piece.get<std::string>())) == std::string::npos)
        different += "standard output lacks " + piece.dump() + "\n";
    for (const auto& [name, text] : files.items())
      if (tests::bytes_of(folder_ / name) != text.get<std::string>())
        different += name + " holds " + tests::bytes_of(folder_ / name) + "\n";
    if (wanted_json.empty()) return different;
    const tests::SortedJson json = tests::SortedJson::parse(answer.out);
    for (const auto& [pointer, wanted] : wanted_json.items()) {
      const auto at = tests::SortedJson::json_pointer(pointer);
      const bool holds =
          json.contains(at) &&
          (wanted.is_array() ? json[at].is_number() && wanted[0] <= json[at] && json[at] <= wanted[1]
                             : json[at] == wanted);
      if (!holds)
        different += pointer + " is " + (json.contains(at) ? json[at].dump() : "missing") + ", not " +
                     wanted.dump() + "\n";
    }
    return different;
  }

  tests::SortedJson list_;
};

TEST_F(ThesisItems, EachIsShownByItsCommandAndItsValue) {
  for (const auto& command : list_["setup"]) {
    const tests::CommandAnswer answer = walk(command.get<std::string>());
    ASSERT_EQ(answer.status, 0) << command << "\n" << answer.errors;
  }
  int walked = 0;
  for (const auto& row : list_["items"]) {
    if (!row.contains("run")) continue;
    ++walked;
    tests::CommandAnswer answer;
    std::string replay;
    for (const auto& command : row["run"]) {
      replay += (replay.empty() ? "" : " && ") + command.get<std::string>();
      answer = walk(command.get<std::string>());
      if (answer.status != 0) break;
    }
    EXPECT_EQ(answer.status, 0) << row["where"] << ", " << row["item"] << "\n"
                                << replay << "\n"
                                << answer.errors;
    if (answer.status != 0) continue;
    EXPECT_EQ(difference(row, answer), "") << row["where"] << ", " << row["item"] << "\n" << replay;
  }
  EXPECT_GT(walked, 100);
}

TEST_F(ThesisItems, AValueThatIsWrongIsFound) {
  tests::CommandAnswer answer;
  answer.out = R"({"voxels": 13})";
  const auto differs = [&](const char* row) {
    return !difference(tests::SortedJson::parse(row), answer).empty();
  };
  EXPECT_FALSE(differs(R"({"json": {"/voxels": 13}})"));
  EXPECT_FALSE(differs(R"({"json": {"/voxels": [13, 14]}})"));
  EXPECT_TRUE(differs(R"({"json": {"/voxels": 14}})"));
  EXPECT_TRUE(differs(R"({"json": {"/voxels": [14, 15]}})"));
  EXPECT_TRUE(differs(R"({"json": {"/volume": 13}})"));
  EXPECT_TRUE(differs(R"({"text": ["fourteen"]})"));
  write("runs.txt", "8:9\n");
  EXPECT_FALSE(differs(R"({"file": {"runs.txt": "8:9\n"}})"));
  EXPECT_TRUE(differs(R"({"file": {"runs.txt": "8:10\n"}})"));
}

TEST_F(ThesisItems, EachRowHasAValueOrSaysWhatIsMissing) {
  std::set<std::string> names;
  int missing = 0;
  for (const auto& row : list_["items"]) {
    const std::string name = row["where"].get<std::string>() + ", " + row["item"].get<std::string>();
    EXPECT_TRUE(names.insert(name).second) << name << " stands twice";
    if (row.contains("missing")) {
      ++missing;
      EXPECT_FALSE(row.contains("run")) << name;
      EXPECT_FALSE(row["missing"].get<std::string>().empty()) << name;
    } else {
      EXPECT_TRUE(row.contains("json") || row.contains("text") || row.contains("file")) << name;
    }
  }
  EXPECT_EQ(missing, missing_count);
}

}  // namespace
}  // namespace octotomy::planner
