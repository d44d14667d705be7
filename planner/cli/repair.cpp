// SPDX-License-Identifier: AGPL-3.0-or-later
#include "brep/shape/repair.h"

#include "brep/io/read_mesh.h"
#include "brep/mesh/health.h"
#include "planner/cli/mesh_file.h"
#include "planner/cli/numbers.h"
#include "planner/measure/result_json.h"
#include "planner/table/number_format.h"

namespace octotomy::planner::cli {
namespace {

struct RepairText {
  std::filesystem::path mesh, out;
  brep::RepairOptions options;
};

Json to_json(const std::vector<brep::Change>& changes) {
  Json list = Json::array();
  for (const brep::Change& change : changes)
    list.push_back({{"step", change.step}, {"what", change.what}, {"at_mm", planner::to_json(change.at_mm)}});
  return list;
}

bool asks_for_any(const brep::RepairOptions& options) {
  return options.weld_mm || options.remove_duplicates || options.remove_flat || options.orient ||
         options.fill_holes || options.remove_intersections;
}

int repair(const Program& program, const RepairText& text) {
  need_mesh_extension(text.out);
  need_folder_of(text.out);
  if (!asks_for_any(text.options))
    throw std::runtime_error(
        "repair does only what it is asked for: say --weld MM, --duplicates, --flat, --orient, --holes or "
        "--intersections; octotomy info tells what a mesh lacks");
  Timings timings;
  brep::Triangles triangles;
  {
    const Stopwatch watch(timings, "read");
    triangles = brep::read_triangles(text.mesh);
  }
  brep::Repair repaired;
  {
    const Stopwatch watch(timings, "repair");
    repaired = brep::repair(triangles, text.options);
  }
  const brep::Health before = brep::health(triangles), after = brep::health(repaired.surface);
  write_surface(brep::mesh_of(repaired.surface), text.out, timings);
  for (const brep::Change& left : repaired.left) warn(left.step + ": " + left.what);
  Json json = answer(timings);
  json["path"] = text.out.string();
  json["changes"] = to_json(repaired.changes);
  json["left"] = to_json(repaired.left);
  json["before"] = planner::to_json(before);
  json["health"] = planner::to_json(after);
  std::vector<std::pair<std::string, std::string>> rows = {
      {"written", text.out.string()},
      {"changes", grouped(static_cast<double>(repaired.changes.size()), 0)},
      {"solid", after.solid() ? "yes" : "no: " + after.findings.front()}};
  constexpr std::size_t shown = 20;
  for (std::size_t i = 0; i < std::min(shown, repaired.changes.size()); ++i)
    rows.emplace_back(repaired.changes[i].step, repaired.changes[i].what);
  if (repaired.changes.size() > shown) rows.emplace_back("...", "the rest with --json");
  program.say(json, lines(rows));
  return done;
}

}  // namespace

void add_repair(Program& program) {
  const auto text = std::make_shared<RepairText>();
  CLI::App& verb =
      program.verb("repair", "Mends a mesh in the ways asked for and lists each change",
                   "octotomy repair scan.stl --weld 0.001 --duplicates --flat --orient --holes -o mended.ply",
                   [&program, text] { return repair(program, *text); });
  verb.add_option("mesh", text->mesh, "A mesh")->required()->check(CLI::ExistingFile);
  verb.add_option("-o,--out", text->out, "A .stl, .ply, .obj, .off, .vtp or .glb file")->required();
  verb.add_option("--weld", text->options.weld_mm,
                  "Points no further apart than this, mm, become one; 0 joins equal points")
      ->check(between(0.0, 1e6));
  verb.add_flag("--duplicates", text->options.remove_duplicates,
                "Of triangles with the same points keep the first");
  verb.add_flag("--orient", text->options.orient, "Neighbours alike, shells outward, cavities inward");
  verb.add_flag("--flat", text->options.remove_flat, "Take out triangles without area");
  verb.add_flag("--holes", text->options.fill_holes, "Close holes");
  verb.add_option("--longest-hole", text->options.longest_hole_mm,
                  "Leave holes open whose border is longer, mm")
      ->check(above_zero());
  verb.add_flag("--intersections", text->options.remove_intersections,
                "Take out triangles that intersect and close what they leave: moves the surface there");
}

}  // namespace octotomy::planner::cli
