// SPDX-License-Identifier: AGPL-3.0-or-later
// Whether an object can be printed, one line for each check: closed, without self-crossings, outward, one
// piece, without closed cavities; its smallest wall and gap; overhangs for a build direction; the printer's
// bed. Both kernels check pieces, walls and gaps; the mesh's result is reported, and voxels must agree within
// their resolution. The other checks are exact on triangles; the cavities of voxels are counted, too.

#include "planner/operation/file/mesh_in.h"
#include "planner/operation/measure/result_json.h"
#include "planner/operation/object/provenance.h"
#include "planner/operation/part/print_checks.h"
#include "planner/operation/table/number_format.h"
#include "planner/operation/table/operation.h"

namespace octotomy::planner {
namespace {

struct Printable {
  ObjectName object;
  glm::dvec3 build_direction{0.0, 0.0, 1.0};
  double overhang_deg = 45.0;
  double least_wall_mm = 0.6, least_gap_mm = 0.5;
  glm::dvec3 bed_mm{145.0, 145.0, 185.0};
  std::optional<double> voxel_mm;  ///< of the verb
};

void check(const Printable& asked, const FieldLocation& place) {
  for (int axis = 0; axis < 3; ++axis)
    if (!(asked.bed_mm[axis] > 0.0))
      place.at("bed_mm").refuse("must be three lengths above 0: width, depth and height");
}

PrintLimits limits_of(const Printable& asked) {
  return {glm::normalize(asked.build_direction), asked.overhang_deg, asked.least_wall_mm, asked.least_gap_mm,
          asked.bed_mm};
}

Json answer_of(const std::string& object, const PrintLimits& limits, const std::vector<PrintCheck>& checks) {
  Json json{{"object", object},
            {"verdict", worst_verdict(checks)},
            {"build_direction", to_json(limits.up)},
            {"checks", to_json(checks)},
            {"findings", Json::array()}};
  for (const PrintCheck& line : checks)
    if (line.verdict != "PASS")
      json["findings"].push_back((line.verdict ? *line.verdict + ", " : "") + line.check + ": " + line.says);
  return json;
}

/// All checks of one surface. `voxels_of` may return null.
std::vector<PrintCheck> checks_of(const brep::Triangles& triangles, const brep::Solid* known,
                                  const PrintLimits& limits,
                                  const std::function<const voxel::Octree*(const brep::Solid&)>& voxels_of,
                                  const voxel::Progress& progress) {
  const brep::Health health = brep::health(triangles);
  std::vector<PrintCheck> checks = health_checks(triangles, health);
  const auto add = [&](std::vector<PrintCheck> more) {
    checks.insert(checks.end(), std::make_move_iterator(more.begin()), std::make_move_iterator(more.end()));
  };
  if (health.solid()) {
    const brep::Solid solid = known != nullptr ? *known : brep::trusted_solid(triangles, brep::Proof::Health);
    add(solid_checks(solid, voxels_of(solid), limits, progress));
    add(build_checks(solid.linked(), limits));
    return checks;
  }
  add(missing_solid_checks("the surface encloses no solid: mend it first by octotomy repair --solid"));
  if (health.faces > 0 && health.nonmanifold_edges == 0 && health.misoriented_edges == 0 &&
      health.first_defect != brep::Defect::InsideOut)
    add(build_checks(brep::linked(triangles), limits));
  return checks;
}

Json measure(const Printable& asked, const AnswerBench& bench) {
  const Stopwatch watch(bench.timings, "printable");
  const Object& object = bench.objects.at(asked.object.name);
  const PrintLimits limits = limits_of(asked);
  if (!object.mesh.within || object.mesh.within->empty())
    return {{"object", object.id},
            {"verdict", nullptr},
            {"build_direction", to_json(limits.up)},
            {"checks", Json::array()},
            {"findings", Json::array({"'" + object.id + "' has no mesh to print: see its findings"})}};
  const brep::Solid& solid = *object.mesh.within;
  return answer_of(
      object.id, limits,
      checks_of(
          solid.triangles(), &solid, limits, [&](const brep::Solid&) { return &object.voxel.octree; },
          bench.progress("printable")));
}

/// The edge of voxels for a part in a file: half of the least wall or gap, but with at most 256 voxels a
/// side.
double voxel_mm_of(const Printable& asked, const brep::Solid& solid) {
  const glm::dvec3 size_mm = solid.size().high_mm - solid.size().low_mm;
  return asked.voxel_mm.value_or(std::max(0.5 * std::min(asked.least_wall_mm, asked.least_gap_mm),
                                          std::max({size_mm.x, size_mm.y, size_mm.z}) / 256.0));
}

FileAnswer on_files(const Printable& asked, const FileBench& bench) {
  const brep::Triangles triangles = [&] {
    const Stopwatch watch(bench.timings, "read");
    return read_mesh_in(asked.object.name);
  }();
  const Stopwatch watch(bench.timings, "printable");
  const PrintLimits limits = limits_of(asked);
  std::optional<voxel::Octree> octree;
  const auto voxels_of = [&](const brep::Solid& solid) -> const voxel::Octree* {
    const double margin_mm = std::max(5.0 * asked.least_gap_mm, 3.0);
    const voxel::Universe universe = voxel::universe_around(
        {solid.size().low_mm - margin_mm, solid.size().high_mm + margin_mm}, voxel_mm_of(asked, solid));
    VoxelSide made(universe);
    voxelise(solid, universe, made);
    octree = made.octree;
    return &*octree;
  };
  FileAnswer made;
  const std::vector<PrintCheck> checks =
      checks_of(triangles, nullptr, limits, voxels_of, bench.progress("printable"));
  made.json = answer_of(asked.object.name, limits, checks);
  made.rows.emplace_back("verdict", worst_verdict(checks));
  for (const PrintCheck& line : checks)
    made.rows.emplace_back(line.check, (line.verdict ? *line.verdict + "  " : "") + line.says);
  return made;
}

}  // namespace

Operation printable_operation() {
  return Describe<Printable>("printable",
                             "Checks whether an object can be printed: its surface, pieces, walls, gaps, "
                             "overhangs and size on the printer's bed.",
                             Makes::Measurement)
      .takes(field("object", &Printable::object, "The part; for the verb, a mesh in a file.")
                 .required()
                 .positional("file"))
      .takes(
          field("build_direction", &Printable::build_direction,
                "The direction from the printer's bed to the layers above, as an LPS vector of any length.")
              .direction())
      .takes(field("overhang_deg", &Printable::overhang_deg,
                   "Downward faces need support if their angle to the bed is smaller than this. Printing "
                   "services state 45 for filament.")
                 .from(0.0)
                 .to(90.0))
      .takes(field("least_wall_mm", &Printable::least_wall_mm,
                   "The thinnest wall that can be printed; 0.6 is the least thickness published for splints.")
                 .greater_than(0.0)
                 .to(10.0))
      .takes(field("least_gap_mm", &Printable::least_gap_mm,
                   "The smallest gap or hole that stays open in print; 0.5 is the smallest hole that "
                   "printing services state for resin.")
                 .greater_than(0.0)
                 .to(10.0))
      .takes(field("bed_mm", &Printable::bed_mm,
                   "Width, depth and height of the printer's build space. Default: that of a desktop printer "
                   "for dental resin."))
      .verb_takes(field("voxel_mm", &Printable::voxel_mm,
                        "Edge of the voxels with which walls and gaps are measured a second time. Default: "
                        "half of the least wall or gap, or a 256th of the extent if that is larger.")
                      .greater_than(0.0))
      .example(R"({"id": "prints", "do": "printable", "object": "advanced", "build_direction": [0, 0, 1]})")
      .on_files(
          "octotomy printable splint.stl\n"
          "  octotomy printable guide.stl --build-direction 0,1,0 --least-wall 1 --json",
          on_files)
      .check(check)
      .measure(measure);
}

}  // namespace octotomy::planner
