// SPDX-License-Identifier: AGPL-3.0-or-later
// The Boolean of meshes in files, by corefinement. In a plan, the mesh kernel of `combine` does this.
#include "brep/boolean/boolean.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "brep/boolean/exact_boolean.h"
#include "brep/mesh/error.h"
#include "brep/mesh/health.h"
#include "brep/mesh/measure.h"
#include "planner/operation/file/mesh_file.h"
#include "planner/operation/measure/result_json.h"
#include "planner/operation/table/number_format.h"
#include "planner/operation/table/operation.h"

namespace octotomy::planner {
namespace {

struct Boolean {
  ObjectName a, b;
  std::string operation;
  std::vector<ObjectName> further;
  bool exact = false, mend = false, orient = false;
  std::filesystem::path out;
};

/// The proof as JSON. Replaces the result's solid by the proven mesh.
Json proven(const FileBench& bench, const brep::Solid& a, brep::Operation operation, const brep::Solid& b,
            brep::BooleanResult& result) {
  const voxel::Progress progress = bench.progress("exact");
  brep::ExactBoolean exact = brep::exact_boolean(a, operation, b, {progress.stop, progress.report});
  result.solid = std::move(exact.solid);
  result.residual = 0.0;
  return {{"identity", "|A| + |B| = |A u B| + |A n B|, as rational numbers"},
          {"a_mm3", exact.a_mm3},
          {"b_mm3", exact.b_mm3},
          {"union_mm3", exact.united_mm3},
          {"intersection_mm3", exact.intersection_mm3},
          {"result_mm3", exact.result_mm3},
          {"rounding_mm3", exact.rounding_mm3},
          {"rounded_points", exact.points}};
}

/// Whether a solid is no thicker than what the points' last places leave open: what exact numbers find between
/// faces that lie on one plane but for rounding.
bool is_film(const brep::Solid& solid) {
  const brep::Size& size = solid.size();
  double reach_mm = 0.0;
  for (const glm::dvec3& p : {size.low_mm, size.high_mm})
    reach_mm = std::max({reach_mm, std::abs(p.x), std::abs(p.y), std::abs(p.z)});
  constexpr double roundings = 8.0;  // of turned corners, see common_frame.h
  return size.volume_mm3 <=
         roundings * std::numeric_limits<double>::epsilon() * reach_mm * 0.5 * size.area_mm2;
}

bool boxes_meet(const brep::Solid& a, const brep::Solid& b) {
  const brep::Size &p = a.size(), &q = b.size();
  return glm::all(glm::lessThanEqual(p.low_mm, q.high_mm)) &&
         glm::all(glm::lessThanEqual(q.low_mm, p.high_mm));
}

FileAnswer on_files(const Boolean& asked, const FileBench& bench) {
  need_mesh_extension(asked.out);
  need_folder_of(asked.out);
  if (asked.exact && !asked.further.empty())
    throw std::runtime_error("--exact proves one step at a time: leave --with out");
  std::vector<std::string> mended;
  const auto solid = [&](const ObjectName& path) {
    if (asked.mend) {
      const voxel::Progress progress = bench.progress("repair");
      return read_mended_solid(path.name, bench.timings, mended, {progress.stop, progress.report});
    }
    try {
      return asked.orient ? read_turned_solid(path.name, bench.timings, mended)
                          : read_solid(path.name, bench.timings);
    } catch (const brep::Error& error) {
      throw brep::Error(
          error.code(),
          std::string(error.what()) + (asked.orient ? "; or take --mend"
                                                    : "; or take --mend, or --orient where triangles only "
                                                      "face the wrong way"));
    }
  };
  std::vector<brep::Solid> operands = {solid(asked.a), solid(asked.b)};
  for (const ObjectName& path : asked.further) operands.push_back(solid(path));
  const brep::Operation operation = asked.operation == "union"          ? brep::Operation::Union
                                    : asked.operation == "intersection" ? brep::Operation::Intersection
                                                                        : brep::Operation::Difference;
  brep::BooleanResult result;
  Json proof = nullptr;
  {
    const Stopwatch watch(bench.timings, "boolean_mesh");
    if (asked.exact)
      proof = proven(bench, operands[0], operation, operands[1], result);
    else
      result = brep::boolean(operands, operation, bench.stop);
    // An empty result may be due to rounding: a body thinner than the rounding of points vanishes.
    if (!asked.exact && result.solid.empty() && operands.size() == 2 &&
        boxes_meet(operands[0], operands[1])) {
      proof = proven(bench, operands[0], operation, operands[1], result);
      if (!result.solid.empty() && is_film(result.solid)) result.solid = brep::Solid();
      if (!result.solid.empty())
        result.findings.push_back("thinner than the rounding of points, so made with exact numbers: " +
                                  three_figures(result.solid.size().volume_mm3) + " mm3");
    }
  }
  if (result.solid.empty())
    throw std::runtime_error(
        "the " + asked.operation + " of " + asked.a.name + " and " + asked.b.name + " is empty" +
        (proof.is_null() ? "" : ", as exact numbers prove but for the rounding of points") +
        ": there is no surface to write");
  result.findings.insert(result.findings.begin(), mended.begin(), mended.end());
  const brep::Health health = brep::health(result.solid.triangles());
  const brep::Measures& measures = result.solid.measures();
  write_surface(result.solid.triangles(), asked.out, bench.timings);
  if (auto finding = rounding_finding(asked.out, bench.timings))
    result.findings.push_back(std::move(*finding));
  FileAnswer answer{{{"path", asked.out.string()}}};
  answer.findings = result.findings;
  answer.json.update(to_json(measures));
  answer.json["area_estimator"] = "triangles";
  answer.json["health"] = to_json(health);
  answer.json["residuals"] = {{"volume_relative", result.residual ? Json(*result.residual) : Json(nullptr)}};
  answer.json["exact"] = proof;
  answer.json["findings"] = result.findings;
  answer.rows = {{"written", asked.out.string()},
                 {"volume", grouped(measures.volume_mm3, 3) + " mm\u00b3"},
                 {"area", grouped(measures.area_mm2, 3) + " mm\u00b2"}};
  return answer;
}

}  // namespace

Operation boolean_operation() {
  return Describe<Boolean>("boolean", "Makes the Boolean of two solids, by corefinement of their meshes.",
                           Makes::File)
      .takes(field("a", &Boolean::a, "A mesh.").required().positional("a"))
      .takes(field("op", &Boolean::operation, "union, intersection or difference.")
                 .required()
                 .one_of({"union", "intersection", "difference"})
                 .positional("op"))
      .takes(field("b", &Boolean::b, "A mesh.").required().positional("b"))
      .takes(field("with", &Boolean::further,
                   "Further meshes: all are united, intersected, or taken from the first."))
      .takes(field("exact", &Boolean::exact,
                   "New points as exact numbers, and proof that the volumes add up as rationals; slower."))
      .takes(field("mend", &Boolean::mend,
                   "Meshes that are no solids are mended first, as repair --solid does."))
      .takes(field("orient", &Boolean::orient,
                   "Triangles that face the wrong way are turned first, as repair --orient does."))
      .takes(field("out", &Boolean::out, "A .stl, .ply, .obj, .off, .vtp or .glb file.").required())
      .example(
          R"({"id": "rest", "do": "boolean", "a": "skull", "op": "difference", "b": "cut",
        "out": "rest.stl"})")
      .on_files("octotomy boolean skull.stl difference box.stl -o rest.stl --json", on_files);
}

}  // namespace octotomy::planner
