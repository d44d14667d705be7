// SPDX-License-Identifier: AGPL-3.0-or-later
// A scan of teeth aligned with an object, and the object's crowns replaced by the scan's.
//
// settle() reads the scan and aligns it by points, then by the crowns' surfaces. Patches that the fit did not
// use measure the error. Only the mesh kernel blends surfaces: its result is voxelised, so that later steps
// have it in both kernels. The certificate reads the scan's triangles and the object's own samples by other
// code.
#include "brep/align/tooth_scan.h"

#include <algorithm>
#include <cmath>
#include <memory>
#include <stdexcept>

#include "brep/io/read_mesh.h"
#include "brep/mesh/move.h"
#include "brep/mesh/split_fans.h"
#include "brep/mesh/triangles.h"
#include "brep/shape/scan_blend.h"
#include "planner/operation/file/mesh_in.h"
#include "planner/operation/measure/result_json.h"
#include "planner/operation/object/provenance.h"
#include "planner/operation/table/number_format.h"
#include "planner/operation/table/operation.h"
#include "verify/witness/scan_blend_witness.h"

namespace octotomy::planner {
namespace {

struct ToothScan {
  ObjectName object;
  std::filesystem::path path;
  std::vector<Mark> points;
  std::vector<glm::dvec3> scan_points;
  std::vector<Mark> crowns;
  double radius_mm = brep::ScanBlendOptions{}.radius_mm;
  double depth_mm = brep::ToothScanOptions{}.depth_mm;
  double blend_mm = brep::ScanBlendOptions{}.blend_mm, reach_mm = brep::ScanBlendOptions{}.reach_mm;
  double cell_mm = brep::ScanBlendOptions{}.cell_mm;
  std::optional<std::string> frame, unit;
  // Settled.
  brep::LaidToothScan laid;
  std::shared_ptr<const brep::Mesh> scan;  ///< where it was laid
  std::vector<glm::dvec3> about_mm;        ///< of the chosen crowns
};

std::string file_name(const ToothScan& asked) {
  return "'" + asked.path.filename().string() + "'";
}

void check(const ToothScan& asked, const FieldLocation& place) {
  if (asked.points.size() != asked.scan_points.size())
    place.at("scan_points")
        .refuse("has " + std::to_string(asked.scan_points.size()) + " points and 'points' has " +
                std::to_string(asked.points.size()) + ": state the same places on both, in the same order");
  if (asked.frame && !brep::frame_named(*asked.frame))
    place.at("frame").refuse(
        "'" + *asked.frame +
        "' is not a frame: write three letters for the directions of x, y and z, such as LPS or RAS");
}

std::vector<glm::dvec3> places_of(const std::vector<Mark>& marks, const Objects& objects) {
  std::vector<glm::dvec3> places_mm;
  for (const Mark& mark : marks) places_mm.push_back(mark_mm(mark, objects));
  return places_mm;
}

brep::ScanBlendOptions blend_of(const ToothScan& asked, const brep::Progress& progress = {}) {
  brep::ScanBlendOptions options;
  options.to_roots = asked.laid.to_roots;
  options.tips_mm = asked.laid.tips_mm;
  options.depth_mm = asked.depth_mm;
  options.blend_mm = asked.blend_mm;
  options.reach_mm = asked.reach_mm;
  options.about_mm = asked.about_mm;
  options.radius_mm = asked.radius_mm;
  options.cell_mm = asked.cell_mm;
  options.progress = progress;
  return options;
}

/// The scan's triangles, joined where points coincide.
brep::Mesh read_scan(const ToothScan& asked, const SettleBench& bench) {
  const Stopwatch watch(bench.timings, "read");
  const std::filesystem::path path = asked.path.is_absolute() ? asked.path : bench.folder / asked.path;
  const brep::MeshFile file = brep::read_mesh(path, {asked.frame, asked.unit});
  bench.details["audit"] = to_json(file.audit);
  for (const std::string& line : warnings_of(file.audit))
    bench.findings.push_back(asked.path.filename().string() + ": " + line);
  const brep::JoinedSurface joined = brep::joined_surface(file.triangles);
  bench.findings.insert(bench.findings.end(), joined.findings.begin(), joined.findings.end());
  return brep::mesh_of(joined.surface);
}

void report(const ToothScan& made, const SettleBench& bench) {
  const brep::LaidToothScan& laid = made.laid;
  nlohmann::ordered_json& details = bench.details;
  details["object_from_scan"] = to_json(laid.fixed_from_scan);
  details["points_rms_mm"] = laid.points_rms_mm;
  details["error"] = {{"value", laid.error_mm},
                      {"unit", "mm"},
                      {"half_width", laid.half_width_mm},
                      {"coverage", 0.99},
                      {"sources", {"patches that the fit did not use", "the spacing of the scan's samples"}}};
  details["matched_share"] = laid.matched_share;
  details["held_distance_mm"] = laid.distance_mm;
  details["fitted_patches"] = laid.fitted_patches;
  details["held_patches"] = nlohmann::ordered_json::array();
  std::size_t left_out = 0;
  for (const brep::HeldPatch& patch : laid.held) {
    left_out += patch.is_left_out ? 1 : 0;
    details["held_patches"].push_back({{"at_mm", to_json(patch.at_mm)},
                                       {"mean_mm", patch.mean_mm},
                                       {"rms_mm", std::sqrt(patch.mean_mm2)},
                                       {"is_left_out", patch.is_left_out}});
  }
  details["definition"] =
      "error is the root mean square distance of the scan's points after the fit from their true places; "
      "held patches are those that the fit did not use, and their distances are to the object's surface";
  bench.findings.push_back(file_name(made) + " lies " + three_figures(laid.error_mm) + " \u00b1 " +
                           three_figures(laid.half_width_mm) + " mm off its true place in 99 of 100 cases");
  if (left_out > 0)
    bench.findings.push_back(std::to_string(left_out) + " of " + std::to_string(laid.held.size()) +
                             " patches lie much farther off than the others and are left out of that error: "
                             "look there for streaks, fillings or moved teeth");
}

ToothScan settle(const ToothScan& asked, const SettleBench& bench) {
  ToothScan made = asked;
  const Object& object = bench.objects.at(asked.object.name);
  const brep::Solid& solid = bench.object(asked.object.name);
  if (solid.empty()) throw std::runtime_error("'" + asked.object.name + "' is empty, so it has no teeth");
  const brep::Mesh scan = read_scan(asked, bench);
  const Stopwatch watch(bench.timings, "tooth_scan_fit");
  brep::ToothScanOptions options;
  options.depth_mm = asked.depth_mm;
  const glm::dvec3 spacing_mm = object.bound.spacing_mm;
  if (const double sample_mm = std::max({spacing_mm.x, spacing_mm.y, spacing_mm.z}); sample_mm > 0.0)
    options.sample_mm = sample_mm;
  else
    bench.findings.push_back("WARN error: '" + asked.object.name + "' comes from no scan, so samples of " +
                             plain(options.sample_mm) + " mm are assumed for the error of its surface");
  options.scan = file_name(asked);
  options.fixed = "'" + asked.object.name + "'";
  options.progress = {bench.progress.stop, bench.progress.report};
  made.laid =
      brep::lay_tooth_scan(scan, solid, {places_of(asked.points, bench.objects), asked.scan_points}, options);
  made.scan = std::make_shared<const brep::Mesh>(brep::moved(scan, made.laid.fixed_from_scan));
  made.about_mm = places_of(asked.crowns, bench.objects);
  report(made, bench);
  return made;
}

std::string definition(const ToothScan& asked, const Objects&) {
  return asked.object.name + " with the crowns of " + asked.path.filename().string();
}

void triangles(const ToothScan& asked, const MeshBench& bench, MeshSide& made) {
  const Stopwatch watch(bench.timings, "tooth_scan");
  const brep::ScanBlend blend =
      brep::blended_with_scan(bench.object(asked.object.name), *asked.scan,
                              blend_of(asked, {bench.progress.stop, bench.progress.report}));
  made.whole = blend.solid;
  made.shift_mm += blend.shift_mm;
  made.findings.insert(made.findings.end(), blend.findings.begin(), blend.findings.end());
  const brep::SurfaceSources& of = blend.sources;
  made.lineage = three_figures(of.scan_mm2) + " mm\u00b2 of the surface are of " + file_name(asked) + ", " +
                 three_figures(of.border_mm2) + " mm\u00b2 the border between both, " +
                 three_figures(of.solid_mm2) + " mm\u00b2 of '" + asked.object.name + "'";
  made.details["surface_from"] = {
      {"scan_mm2", of.scan_mm2}, {"border_mm2", of.border_mm2}, {"object_mm2", of.solid_mm2}};
  made.details["largest_move_mm"] = blend.largest_move_mm;
  made.findings.push_back(made.lineage);
  if (of.scan_mm2 == 0.0)
    made.findings.push_back(
        "WARN no crown's surface comes from the scan alone: choose a smaller 'blend_mm', or a larger "
        "'depth_mm' or 'radius_mm'");
}

void bound(const ToothScan& asked, const BoundBench& bench, Object& made) {
  const Object& object = bench.objects.at(asked.object.name);
  inherit(object, made);
  const brep::ScanBlendOptions options = blend_of(asked);
  if (made.mesh.whole && object.mesh.whole && asked.scan)
    made.witness =
        verify::witness_of_scan_blend(object.witness, {.scan = brep::triangles_of(*asked.scan),
                                                       .to_roots = options.to_roots,
                                                       .tips_mm = options.tips_mm,
                                                       .depth_mm = options.depth_mm,
                                                       .blend_mm = options.blend_mm,
                                                       .reach_mm = options.reach_mm,
                                                       .about_mm = options.about_mm,
                                                       .radius_mm = options.radius_mm,
                                                       .apart_mm = brep::scan_blend_allowance_mm(options)});
  made.bound.reshaped = {asked.object.name};
  made.shared_values.push_back("the position in which the scan of teeth was fitted");
  made.ends_with_universe = true;
}

}  // namespace

Operation tooth_scan_operation() {
  return Describe<ToothScan>(
             "tooth_scan",
             "Fits a scan of teeth to an object and replaces the object's crowns by those of the scan.",
             Makes::Object)
      .takes(field("object", &ToothScan::object,
                   "The object with the teeth: one jaw alone, because the scan would also replace the other "
                   "jaw's teeth within 'reach_mm' of it.")
                 .required()
                 .positional("object"))
      .takes(field("path", &ToothScan::path,
                   std::string("The mesh of the scan, which may be open, have holes and be in any pose: ") +
                       brep::mesh_formats_read + ", relative to the plan's folder.")
                 .required()
                 .positional("scan")
                 .a_file())
      .takes(
          field(
              "points", &ToothScan::points,
              "Three or more points on the biting surfaces of the object's teeth, not on one line: [x, y, z] "
              "or landmarks.")
              .required()
              .from(3))
      .takes(field("scan_points", &ToothScan::scan_points,
                   "The same places on the scan, in the same order, in mm in the scan's own frame converted "
                   "to LPS.")
                 .required()
                 .from(3))
      .takes(field("crowns", &ToothScan::crowns,
                   "Points on the crowns that are replaced. Default: all crowns that the scan shows."))
      .takes(field("radius_mm", &ToothScan::radius_mm,
                   "The surface within this distance of each point of 'crowns' is replaced; half a molar is "
                   "about 6.")
                 .from(2.0)
                 .to(30.0)
                 .read_if<ToothScan>([](const ToothScan& asked) { return !asked.crowns.empty(); },
                                     "applies only to 'crowns': add 'crowns'"))
      .takes(
          field(
              "depth_mm", &ToothScan::depth_mm,
              "Crowns are fitted and replaced from their tips to this depth, below which the scan shows gum.")
              .from(2.0)
              .to(12.0))
      .takes(field("blend_mm", &ToothScan::blend_mm,
                   "The width of the border in which the surface changes gradually from that of the scan to "
                   "that of the object, also around holes of the scan.")
                 .from(0.3)
                 .to(5.0))
      .takes(field("reach_mm", &ToothScan::reach_mm,
                   "The object's surface within this distance of the scan is replaced. Increase it if "
                   "streaks protrude farther.")
                 .from(0.5)
                 .to(8.0))
      .takes(field("cell_mm", &ToothScan::cell_mm,
                   "The size of the cells of the new triangles. The surface lies within 0.87 of a cell from "
                   "the scan. Smaller cells show narrower gaps between teeth and take longer.")
                 .from(0.1)
                 .to(1.0))
      .takes(field(
          "frame", &ToothScan::frame,
          "Directions of x, y and z in the scan's file: LPS, RAS, or other letters of L or R, A or P, S or "
          "I. It overrides the file's statement. Default: the file's statement, or LPS if there is none."))
      .takes(field("unit", &ToothScan::unit,
                   "The unit of the file's lengths. It overrides the file's statement. Default: the file's "
                   "statement, or mm if there is none.")
                 .one_of({"um", "mm", "cm", "m", "inch", "foot"}))
      .example(R"({"id": "sharp", "do": "tooth_scan", "object": "maxilla", "path": "upper_scan.stl",
        "points": [[-24, -52, -58], [0, -83, -58], [24, -52, -58]],
        "scan_points": [[-22.1, 3.4, 10.2], [1.5, 34.7, 9.8], [25.6, 3.9, 10.4]]})")
      .on_files(
          "octotomy tooth_scan upper.stl scan.stl --points -24,-52,-58 0,-83,-58 24,-52,-58 --scan-points "
          "-22.1,3.4,10.2 1.5,34.7,9.8 25.6,3.9,10.4 -o sharp.stl")
      .check(check)
      .settle(settle)
      .object(definition, nullptr, triangles, bound);
}

}  // namespace octotomy::planner
