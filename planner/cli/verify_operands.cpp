// SPDX-License-Identifier: AGPL-3.0-or-later
#include "planner/cli/numbers.h"
#include "planner/cli/verify_suites.h"
#include "planner/file/mesh_file.h"
#include "planner/table/number_format.h"
#include "verify/certify_operation.h"
#include "verify/exact_agreement.h"
#include "voxel/filter/label_map.h"
#include "voxel/scan/read_scene.h"
#include "voxel/solid/combine.h"

namespace octotomy::planner::cli {
namespace {

brep::Operation operation_of(const std::string& word) {
  if (word == "union" || word == "|") return brep::Operation::Union;
  if (word == "intersection" || word == "&") return brep::Operation::Intersection;
  if (word == "difference" || word == "-") return brep::Operation::Difference;
  throw CLI::ValidationError("OP", "'" + word + "' is none of union, intersection, difference, |, & and -");
}

/// All voxels that have a label.
voxel::Octree labelled(const Program& program, const std::filesystem::path& path, Timings& timings,
                       voxel::Lattice& lattice) {
  const Stopwatch watch(timings, "read");
  const voxel::Scene scene = voxel::read_scene(path);
  program.note_scan(path, scene);
  lattice = scene.lattice;
  const voxel::Universe universe = voxel::universe_on(scene.lattice);
  const std::vector<voxel::Label> labels = voxel::labels(scene);
  if (labels.empty()) throw std::runtime_error(path.string() + ": no sample has a label");
  voxel::Expression all = voxel::octree_of_label(universe, scene, labels.front().number);
  for (std::size_t i = 1; i < labels.size(); ++i)
    all = all | voxel::octree_of_label(universe, scene, labels[i].number);
  return voxel::combine(universe, all);
}

/// The certificate, and the operation's own volume: the exact tier's sets are refined and a little smaller.
struct LabelMaps {
  verify::Certificate certificate;
  double volume_mm3 = 0.0;
};

LabelMaps of_label_maps(Program& program, const std::filesystem::path& a, brep::Operation operation,
                        const std::filesystem::path& b, Timings& timings) {
  voxel::Lattice lattice_a, lattice_b;
  const voxel::Expression left = labelled(program, a, timings, lattice_a),
                          right = labelled(program, b, timings, lattice_b);
  if (!(lattice_a == lattice_b))
    throw std::runtime_error(
        a.string() + " and " + b.string() +
        " have different lattices: resample one onto the other first (octotomy convert)");
  const Stopwatch watch(timings, "verify");
  const voxel::Expression expression = operation == brep::Operation::Union          ? left | right
                                       : operation == brep::Operation::Intersection ? left & right
                                                                                    : left - right;
  const voxel::Universe universe = voxel::universe_on(lattice_a);
  return {verify::certify_exact(verify::exact_answers(expression, {program.stop.get_token(), {}})),
          static_cast<double>(voxel::combine(universe, expression).voxel_count()) * lattice_a.voxel_mm3()};
}

std::string what_of(const verify::Certificate& certificate) {
  std::vector<std::pair<std::string, std::string>> rows{
      {"operation", certificate.operation},
      {"tier", verify::to_string(certificate.tier)},
      {"voxel kernel",
       grouped(certificate.voxel.volume_mm3, 3) + " mm\u00b3 (" + certificate.voxel.lineage + ")"},
      {"mesh kernel",
       grouped(certificate.mesh.volume_mm3, 3) + " mm\u00b3 (" + certificate.mesh.lineage + ")"},
      {"difference", grouped(certificate.difference_mm3, 3) + " mm\u00b3, " +
                         grouped(certificate.tolerance_mm3, 3) + " mm\u00b3 allowed"},
      {"verdict", verify::verdict_text(certificate)}};
  for (const std::string& reason : certificate.reasons) rows.emplace_back("reason", reason);
  return lines(rows);
}

}  // namespace

SuiteAnswer verify_operands(Program& program, const VerifyText& text) {
  const std::filesystem::path a = text.subject[0], b = text.subject[2];
  const brep::Operation operation = operation_of(text.subject[1]);
  SuiteAnswer answer;
  verify::Certificate certificate;
  if (is_mesh(a) != is_mesh(b))
    throw CLI::ValidationError("verify", "two meshes or two label maps, not one of each");
  if (is_mesh(a)) {
    const brep::Solid left = read_solid(a, answer.timings), right = read_solid(b, answer.timings);
    const Stopwatch watch(answer.timings, "verify");
    verify::OperationAnswers answers = verify::certify_operation(
        left, operation, right, {text.operand_voxel_mm, {program.stop.get_token(), {}}});
    certificate = answers.certificate;
    if (answers.octree) answer.worst = {certificate, *answers.octree, answers.solid};
  } else {
    if (text.operand_voxel_mm) throw CLI::ValidationError("--voxel", "label maps have voxels of their own");
    const LabelMaps found = of_label_maps(program, a, operation, b, answer.timings);
    certificate = found.certificate;
    answer.more["volume_mm3"] = found.volume_mm3;
    answer.text = lines({{"volume", grouped(found.volume_mm3, 3) +
                                        " mm\u00b3 of the label maps' own voxels; below, of "
                                        "both sets refined and smaller by a quarter of a voxel all round"}});
  }
  certificate.operation = a.string() + " " + text.subject[1] + " " + b.string();
  answer.certificates.push_back(planner::to_json(certificate));
  add(answer.counts, certificate);
  answer.text += what_of(certificate);
  return answer;
}

void add_operand_options(CLI::App& verb, VerifyText& text) {
  verb.add_option("--voxel", text.operand_voxel_mm, "Edge of the voxels that two meshes are compared in, mm")
      ->check(above_zero());
}

}  // namespace octotomy::planner::cli
