// SPDX-License-Identifier: AGPL-3.0-or-later
#include "planner/cli/program/verb_groups.h"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <array>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

namespace octotomy::planner::cli {
namespace {

struct GroupedVerb {
  std::string_view group;
  std::string_view verb;
};

constexpr std::string_view looking = "Look at files";
constexpr std::string_view scans = "Prepare and segment scans";
constexpr std::string_view planning = "Plan an operation";
constexpr std::string_view cutting = "Cut, join and move objects";
constexpr std::string_view shaping = "Change surfaces and forms";
constexpr std::string_view measuring = "Measure and compare";
constexpr std::string_view elements = "Finite elements";
constexpr std::string_view checking = "Check the kernels";
constexpr std::string_view exchanging = "Exchange with an archive";
constexpr std::string_view many = "Many scans";

/// The groups, in the order in which help prints them.
constexpr std::array group_order{looking,  planning,  scans,      cutting,  shaping,
                                 elements, measuring, exchanging, checking, many};

constexpr std::array verb_table{
    GroupedVerb{looking, "look"},
    GroupedVerb{looking, "info"},
    GroupedVerb{looking, "render"},
    GroupedVerb{looking, "slice"},
    GroupedVerb{looking, "montage"},
    GroupedVerb{looking, "draw"},
    GroupedVerb{looking, "mark"},
    GroupedVerb{planning, "procedure"},
    GroupedVerb{planning, "find_landmarks"},
    GroupedVerb{planning, "run"},
    GroupedVerb{planning, "preview"},
    GroupedVerb{planning, "serve"},
    GroupedVerb{planning, "plan"},
    GroupedVerb{planning, "schema"},
    GroupedVerb{planning, "outcome"},
    GroupedVerb{planning, "pack"},
    GroupedVerb{planning, "scene"},
    GroupedVerb{scans, "prepare"},
    GroupedVerb{scans, "segment"},
    GroupedVerb{scans, "convert"},
    GroupedVerb{cutting, "boolean"},
    GroupedVerb{cutting, "eval"},
    GroupedVerb{cutting, "saw"},
    GroupedVerb{cutting, "brush"},
    GroupedVerb{cutting, "mask"},
    GroupedVerb{cutting, "parts"},
    GroupedVerb{cutting, "separate"},
    GroupedVerb{cutting, "mirror"},
    GroupedVerb{cutting, "register"},
    GroupedVerb{cutting, "transform"},
    GroupedVerb{cutting, "affine"},
    GroupedVerb{shaping, "mesh"},
    GroupedVerb{shaping, "octree"},
    GroupedVerb{shaping, "voxelise"},
    GroupedVerb{shaping, "surfaces"},
    GroupedVerb{shaping, "contours"},
    GroupedVerb{shaping, "outline"},
    GroupedVerb{shaping, "repair"},
    GroupedVerb{shaping, "decimate"},
    GroupedVerb{shaping, "smooth"},
    GroupedVerb{shaping, "fill"},
    GroupedVerb{shaping, "offset"},
    GroupedVerb{shaping, "shell"},
    GroupedVerb{shaping, "shadow"},
    GroupedVerb{shaping, "splint"},
    GroupedVerb{shaping, "guide"},
    GroupedVerb{shaping, "plate"},
    GroupedVerb{shaping, "tooth_scan"},
    GroupedVerb{elements, "tet"},
    GroupedVerb{elements, "warp"},
    GroupedVerb{elements, "landmark_ratios"},
    GroupedVerb{measuring, "measure"},
    GroupedVerb{measuring, "compare"},
    GroupedVerb{measuring, "printable"},
    GroupedVerb{measuring, "cephalometry"},
    GroupedVerb{exchanging, "send"},
    GroupedVerb{exchanging, "receive"},
    GroupedVerb{checking, "verify"},
    GroupedVerb{checking, "phantom"},
    GroupedVerb{many, "cohort"},
    GroupedVerb{many, "table"},
};

constexpr bool each_verb_stands_once() {
  for (std::size_t i = 0; i < verb_table.size(); ++i)
    for (std::size_t j = 0; j < i; ++j)
      if (verb_table[i].verb == verb_table[j].verb) return false;
  return true;
}
static_assert(each_verb_stands_once());

/// Prints the groups of verbs in the order of the table, then other groups. CLI11 itself prints them in the
/// order in which verbs were added.
class GroupedHelp : public CLI::Formatter {
 public:
  std::string make_subcommands(const CLI::App* app, CLI::AppFormatMode mode) const override {
    if (app->get_parent() != nullptr) return CLI::Formatter::make_subcommands(app, mode);
    std::string text;
    for (const std::string_view group : group_order) {
      text += "\n" + std::string(group) + ":\n";
      for (const GroupedVerb& row : verb_table)
        if (row.group == group) text += line_of_verb(*app->get_subcommand(std::string(row.verb)));
    }
    std::string others;
    for (const CLI::App* verb : app->get_subcommands([](const CLI::App*) { return true; }))
      if (verb->get_group() == "Subcommands") others += line_of_verb(*verb);
    return others.empty() ? text : text + "\nSubcommands:\n" + others;
  }

 private:
  /// A verb's name and description, without a line break.
  static std::string line_of_verb(const CLI::App& verb) {
    constexpr std::size_t name_width = 16;
    std::string line = "  " + verb.get_name();
    line.resize(std::max(line.size() + 1, name_width + 2), ' ');
    return line + verb.get_description() + "\n";
  }
};

}  // namespace

void group_verbs(CLI::App& app) {
  for (const GroupedVerb& row : verb_table)
    app.get_subcommand(std::string(row.verb))->group(std::string(row.group));
  app.formatter(std::make_shared<GroupedHelp>());
}

}  // namespace octotomy::planner::cli
