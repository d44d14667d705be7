// SPDX-License-Identifier: AGPL-3.0-or-later
#include "planner/operation/object/combine.h"

#include "planner/operation/object/provenance.h"
#include "planner/operation/table/operation.h"
#include "verify/question/expression_on_meshes.h"
#include "verify/question/expression_tree.h"
#include "verify/witness/witness.h"
#include "voxel/solid/combine.h"
#include "voxel/solid/expression.h"
#include "voxel/space/error.h"

namespace octotomy::planner {
namespace {

constexpr const char* operation_name = "combine";

std::vector<std::string> uses(const Combine& combine) {
  return voxel::names_in(combine.expression);
}

void check(const Combine& combine, const FieldLocation& place) {
  check_expression(combine.expression, place.at("expression"));
}

std::string definition(const Combine& combine, const Objects&) {
  return combine.expression;
}

void voxels(const Combine& combine, const VoxelBench& bench, VoxelSide& made) {
  combine_voxels(
      bench, [&](const voxel::Names& names) { return voxel::parse_expression(combine.expression, names); },
      made);
}

void triangles(const Combine& combine, const MeshBench& bench, MeshSide& made) {
  const Stopwatch watch(bench.timings, "boolean_mesh");
  const auto origin = [&](std::string_view name) -> std::string {
    const Object& object = bench.objects.at(std::string(name));
    return object.kind == operation_name ? object.definition : "";
  };
  const auto choice = [&](std::string_view name) -> std::optional<verify::MeshExpressions::PartsOf> {
    const auto& parts_of = bench.objects.at(std::string(name)).mesh.parts_of;
    if (!parts_of) return std::nullopt;
    return verify::MeshExpressions::PartsOf{parts_of->first, parts_of->second};
  };
  made.whole = bench.expressions.evaluate(
      combine.expression, [&](std::string_view name) { return bench.object(std::string(name)); },
      bench.progress.stop, origin, choice);
  made.shift_mm = bench.expressions.shift_mm();
  made.findings = bench.expressions.findings();
  made.lineage = "corefinement of meshes";
}

/// Whether a point lies in an expression. Bit i of `held` states whether it lies in object i.
bool holds(const verify::ExpressionTree& tree, unsigned held) {
  if (tree.parts.empty()) return ((held >> static_cast<unsigned>(tree.leaf)) & 1U) != 0;
  bool made = holds(tree.parts.front(), held);
  if (tree.symbol == '~') return !made;
  for (std::size_t i = 1; i < tree.parts.size(); ++i) {
    const bool next = holds(tree.parts[i], held);
    made = tree.symbol == '&'   ? made && next
           : tree.symbol == '|' ? made || next
           : tree.symbol == '-' ? made && !next
                                : made != next;
  }
  return made;
}

/// Whether an expression such as a - a is empty for any objects, because no row of its truth table is true.
/// Returns false for expressions of more than 10 objects.
bool is_empty_of_any(const std::string& expression) {
  constexpr std::size_t most_objects = 10;
  std::vector<std::string> names;
  const verify::ExpressionTree tree = verify::expression_tree_of(expression, names);
  if (names.size() > most_objects) return false;
  for (unsigned held = 0; held < 1U << names.size(); ++held)
    if (holds(tree, held)) return false;
  return true;
}

void bound(const Combine& combine, const BoundBench& bench, Object& made) {
  bound_of_operands(uses(combine), bench, made);
  made.is_surely_empty = is_empty_of_any(combine.expression);
  if (made.is_surely_empty)
    made.findings.push_back("'" + combine.expression + "' is empty for any objects: check the expression");
  else if (made.voxel.octree.is_empty())
    made.findings.push_back("no voxel lies in '" + combine.expression +
                            "': it is empty, or thinner than the distance between voxels");
  made.witness = verify::witness_of_expression(
      combine.expression, [&](const std::string& name) { return bench.objects.at(name).witness; });
}

/// Adds a finding for each mask that contains nothing or everything of an object in the expression.
void tell_idle_masks(const std::vector<std::string>& names, const BoundBench& bench, Object& made) {
  for (const std::string& tool : names) {
    if (!bench.objects.at(tool).is_tool) continue;
    const voxel::Expression mask(*bench.objects.at(tool).voxel.symbol);
    for (const std::string& name : names) {
      const Object& object = bench.objects.at(name);
      if (object.is_tool || object.voxel.octree.is_empty()) continue;
      const voxel::Expression bone(object.voxel.octree);
      if (voxel::combine(bench.universe, bone & mask).is_empty())
        made.findings.push_back("the mask '" + tool + "' contains nothing of '" + name +
                                "', so it cuts nothing: view it by octotomy preview, and redraw its regions");
      else if (voxel::combine(bench.universe, bone - mask).is_empty())
        made.findings.push_back("the mask '" + tool + "' contains all of '" + name + "' and cuts nothing");
    }
  }
}

}  // namespace

void combine_voxels(const VoxelBench& bench,
                    const std::function<voxel::Expression(const voxel::Names& names)>& expression,
                    VoxelSide& made) {
  voxel::Names operands, symbols;
  operands.object = [&](std::string_view name) {
    // A mask is evaluated by its expression, which selects the same voxel centres as its octree without a
    // traversal.
    const VoxelSide& operand = bench.object(std::string(name));
    return bench.is_tool(std::string(name)) ? *operand.symbol : voxel::Expression(operand.octree);
  };
  symbols.object = [&](std::string_view name) { return *bench.object(std::string(name)).symbol; };
  made.octree = bench.combined(expression(operands));
  made.symbol = bench.within_universe(expression(symbols));
  made.lineage = "Boolean of octrees";
}

void bound_of_operands(const std::vector<std::string>& names, const BoundBench& bench, Object& made) {
  tell_idle_masks(names, bench, made);
  made.shown = shown_in_common(bench.objects, names);
  for (const std::string& name : names) inherit(bench.objects.at(name), made);
  // Both kernels cut the result of an expression at the universe's border, so a later motion moves the cut
  // object.
  made.ends_with_universe = true;
}

void check_expression(const std::string& expression, const FieldLocation& place) {
  // To check grammar and names any object is sufficient. Motions are separate steps in plans, so names of
  // motions are refused.
  voxel::Names names;
  names.object = [&](std::string_view name) -> voxel::Expression {
    place.need_object(std::string(name));
    return voxel::Sphere{};
  };
  try {
    voxel::parse_expression(expression, names);
  } catch (const voxel::InvalidInput& error) {
    place.refuse(error.what());
  }
}

Operation combine_operation() {
  return Describe<Combine>(operation_name, "Combines earlier objects by a Boolean expression.", Makes::Object)
      .takes(field("expression", &Combine::expression,
                   "Names of objects under & (and), | (or), - (less), ^ (either), ~ (not) and parentheses.")
                 .required())
      .example(R"({"id": "maxilla", "do": "combine", "expression": "skull & cut"})")
      .check(check)
      .uses(uses)
      .object(definition, voxels, triangles, bound);
}

}  // namespace octotomy::planner
