// SPDX-License-Identifier: AGPL-3.0-or-later
#include "voxel/view/mark.h"

#include <CLI/CLI.hpp>

#include "planner/cli/program/verbs.h"
#include "planner/cli/verb/numbers.h"
#include "planner/cli/verb/verb.h"
#include "planner/operation/measure/result_json.h"
#include "planner/operation/table/number_format.h"

namespace octotomy::planner::cli {
namespace {

voxel::SightLine sight_line_of(const std::string& text) {
  const auto colon = text.find(':');
  if (colon == std::string::npos)
    throw CLI::ValidationError("--in",
                               "'" + text + "' is not a mark: give VIEW:U,V, for example left:-20,16.5");
  const auto position = numbers_of<2>("--in", text.substr(colon + 1), "-20,16.5");
  return voxel::sight_line(voxel::parse_view(text.substr(0, colon)), {position[0], position[1]});
}

int mark(const Program& program, const std::vector<std::string>& marks) {
  if (marks.size() != 2)
    throw CLI::ValidationError("--in", "give it twice: a point in space needs two views");
  const voxel::SpaceMark found = voxel::mark_between(sight_line_of(marks[0]), sight_line_of(marks[1]));
  Json json = answer({});
  json["point_mm"] = to_json(found.point_mm);
  json["miss_mm"] = found.miss_mm;
  const glm::dvec3& p = found.point_mm;
  program.say(json,
              lines({{"point", grouped(p.x, 2) + ", " + grouped(p.y, 2) + ", " + grouped(p.z, 2) + " mm"},
                     {"miss", grouped(found.miss_mm, 2) + " mm"}}));
  return done;
}

}  // namespace

void add_mark(Program& program) {
  const auto marks = std::make_shared<std::vector<std::string>>();
  CLI::App& verb = program.verb("mark", "A point in space, marked in two views",
                                "octotomy mark --in anterior:5,10 --in left:-20,16",
                                [&program, marks] { return mark(program, *marks); });
  verb.add_option("--in", *marks,
                  "VIEW:U,V, twice: a view and a position in it, mm along its right and up; render --pick "
                  "prints a pixel's position as view_mm")
      ->required()
      ->expected(1)
      ->take_all();
}

}  // namespace octotomy::planner::cli
