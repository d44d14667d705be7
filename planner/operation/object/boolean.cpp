// SPDX-License-Identifier: AGPL-3.0-or-later
// The Boolean of two or more objects: by corefinement of their meshes, and of their octrees. `combine` evaluates
// whole expressions; this operation can prove its volumes by exact numbers.
#include "brep/boolean/boolean.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "brep/boolean/exact_boolean.h"
#include "brep/mesh/error.h"
#include "planner/operation/object/combine.h"
#include "planner/operation/table/json.h"
#include "planner/operation/table/number_format.h"
#include "planner/operation/table/operation.h"
#include "verify/witness/witness.h"

namespace octotomy::planner {
namespace {

struct Boolean {
  ObjectName a, b;
  std::string operation;
  std::vector<ObjectName> further;
  bool exact = false;

  std::vector<std::string> operands() const {
    std::vector<std::string> names{a.name, b.name};
    for (const ObjectName& object : further) names.push_back(object.name);
    return names;
  }
  brep::Operation kind() const {
    return operation == "union"          ? brep::Operation::Union
           : operation == "intersection" ? brep::Operation::Intersection
                                         : brep::Operation::Difference;
  }
  /// Its sign in expressions.
  char sign() const { return operation == "union" ? '|' : operation == "intersection" ? '&' : '-'; }
};

void check(const Boolean& asked, const FieldLocation& place) {
  if (asked.exact && !asked.further.empty())
    place.at("exact").refuse("applies only to two objects: leave 'with' out");
}

/// Text such as "the difference of skull and cut".
std::string definition(const Boolean& asked, const Objects&) {
  const std::vector<std::string> names = asked.operands();
  std::string text = "the " + asked.operation + " of " + names.front();
  for (std::size_t i = 1; i < names.size(); ++i) text += (i + 1 < names.size() ? ", " : " and ") + names[i];
  return text;
}

void voxels(const Boolean& asked, const VoxelBench& bench, VoxelSide& made) {
  combine_voxels(
      bench,
      [&](const voxel::Names& names) {
        const std::vector<std::string> operands = asked.operands();
        voxel::Expression whole = names.object(operands.front());
        for (std::size_t i = 1; i < operands.size(); ++i) {
          const voxel::Expression next = names.object(operands[i]);
          whole = asked.sign() == '|' ? whole | next : asked.sign() == '&' ? whole & next : whole - next;
        }
        return whole;
      },
      made);
}

/// Computes the Boolean with exact numbers. Replaces the result's solid by this mesh, and returns the proof
/// as JSON.
Json proven(const MeshBench& bench, const brep::Solid& a, brep::Operation operation, const brep::Solid& b,
            brep::BooleanResult& result) {
  brep::ExactBoolean exact =
      brep::exact_boolean(a, operation, b, {bench.progress.stop, bench.progress.report});
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

/// Whether a solid is so thin that the rounding of its points may have produced it. Exact arithmetic makes
/// such slivers between faces that coincide except for rounding.
bool is_film(const brep::Solid& solid) {
  const brep::Size& size = solid.size();
  double reach_mm = 0.0;
  for (const glm::dvec3& p : {size.low_mm, size.high_mm})
    reach_mm = std::max({reach_mm, std::abs(p.x), std::abs(p.y), std::abs(p.z)});
  constexpr double roundings = 8.0;  // rounding of a rotated corner, in units of epsilon; see common_frame.h
  return size.volume_mm3 <=
         roundings * std::numeric_limits<double>::epsilon() * reach_mm * 0.5 * size.area_mm2;
}

bool boxes_meet(const brep::Solid& a, const brep::Solid& b) {
  const brep::Size &p = a.size(), &q = b.size();
  return glm::all(glm::lessThanEqual(p.low_mm, q.high_mm)) &&
         glm::all(glm::lessThanEqual(q.low_mm, p.high_mm));
}

void triangles(const Boolean& asked, const MeshBench& bench, MeshSide& made) {
  std::vector<brep::Solid> operands;
  for (const std::string& name : asked.operands()) operands.push_back(bench.object(name));
  const Stopwatch watch(bench.timings, "boolean_mesh");
  brep::BooleanResult result;
  Json proof = nullptr;
  if (asked.exact)
    proof = proven(bench, operands[0], asked.kind(), operands[1], result);
  else
    result = brep::boolean(operands, asked.kind(), bench.progress.stop);
  // An empty result may be wrong, because a body thinner than the rounding of points vanishes.
  if (!asked.exact && result.solid.empty() && operands.size() == 2 && boxes_meet(operands[0], operands[1])) {
    try {
      proof = proven(bench, operands[0], asked.kind(), operands[1], result);
    } catch (const brep::Error& error) {
      // Between faces that coincide except for rounding, exact arithmetic makes gaps and overlaps that are
      // not a solid.
      if (error.code() != brep::ErrorCode::Geometry) throw;
      result.findings.emplace_back(
          "the result is empty, except perhaps for parts thinner than the rounding of points");
    }
    if (!result.solid.empty() && is_film(result.solid)) result.solid = brep::Solid();
    if (!result.solid.empty())
      result.findings.push_back(
          "the result is thinner than the rounding of points, so it was computed with exact numbers: " +
          three_figures(result.solid.size().volume_mm3) + " mm3");
  }
  if (result.solid.empty() && !proof.is_null())
    result.findings.emplace_back("the result is empty, which exact numbers prove for the rounded points");
  made.whole = std::move(result.solid);
  made.shift_mm = result.shift_mm;
  made.findings = std::move(result.findings);
  made.details = {
      {"residuals", {{"volume_relative", result.residual ? Json(*result.residual) : Json(nullptr)}}},
      {"exact", std::move(proof)}};
  made.lineage = "corefinement of meshes";
}

void bound(const Boolean& asked, const BoundBench& bench, Object& made) {
  const std::vector<std::string> names = asked.operands();
  bound_of_operands(names, bench, made);
  // The operands are numbered, because names of files are not valid names in an expression.
  std::string text = "_0";
  for (std::size_t i = 1; i < names.size(); ++i)
    text += std::string(" ") + asked.sign() + " _" + std::to_string(i);
  made.witness = verify::witness_of_expression(text, [&](const std::string& number) {
    return bench.objects.at(names[std::stoul(number.substr(1))]).witness;
  });
}

}  // namespace

Operation boolean_operation() {
  return Describe<Boolean>("boolean",
                           "Makes the union, the intersection or the difference of two or more objects.",
                           Makes::Object)
      .takes(field("a", &Boolean::a, "An object; on the command line a mesh or an octree.")
                 .required()
                 .positional("a"))
      .takes(field("op", &Boolean::operation, "union, intersection or difference.")
                 .required()
                 .one_of({"union", "intersection", "difference"})
                 .positional("op"))
      .takes(field("b", &Boolean::b, "Another object.").required().positional("b"))
      .takes(field("with", &Boolean::further,
                   "Further objects, which are united or intersected with the first two, or subtracted from "
                   "the first."))
      .takes(field("exact", &Boolean::exact,
                   "Computes new points of the mesh as exact numbers and proves in rational numbers that the "
                   "volumes add up. This is slower."))
      .example(R"({"id": "remainder", "do": "boolean", "a": "skull", "op": "difference", "b": "cut"})")
      .on_files(
          "octotomy boolean skull.stl difference box.stl -o rest.stl --json\n"
          "  octotomy boolean skull.stl difference box.stl -o rest.stl --certify")
      .check(check)
      .object(definition, voxels, triangles, bound);
}

}  // namespace octotomy::planner
