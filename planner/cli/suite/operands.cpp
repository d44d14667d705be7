// SPDX-License-Identifier: AGPL-3.0-or-later
//
// A question is A OP B with an optional answer C of another program. Both kernels compute it and are
// compared; then C is compared with each of them. A question is given as JSON or as a folder of files.
#include <CLI/CLI.hpp>
#include <algorithm>
#include <cmath>

#include "brep/mesh/solid.h"
#include "convert/surface/cuberille.h"
#include "planner/cli/suite/suites.h"
#include "planner/cli/verb/numbers.h"
#include "planner/operation/file/mesh_file.h"
#include "planner/operation/file/mesh_in.h"
#include "planner/operation/file/octree_in.h"
#include "planner/operation/file/path_checks.h"
#include "planner/operation/table/json_file.h"
#include "planner/operation/table/number_format.h"
#include "verify/certificate/certify_operation.h"
#include "verify/certificate/exact_agreement.h"
#include "verify/certificate/judge_answer.h"
#include "verify/certificate/sets_as_given.h"
#include "voxel/filter/label_map.h"
#include "voxel/scan/read_scene.h"
#include "voxel/solid/combine.h"

namespace octotomy::planner::cli {
namespace {

namespace fs = std::filesystem;

const std::vector<std::pair<const char*, brep::Operation>>& operations() {
  static const std::vector<std::pair<const char*, brep::Operation>> all{
      {"union", brep::Operation::Union},           {"intersection", brep::Operation::Intersection},
      {"difference", brep::Operation::Difference}, {"|", brep::Operation::Union},
      {"&", brep::Operation::Intersection},        {"-", brep::Operation::Difference}};
  return all;
}

brep::Operation operation_of(const std::string& word) {
  for (const auto& [name, operation] : operations())
    if (word == name) return operation;
  throw CLI::ValidationError("OP", "'" + word + "' is none of union, intersection, difference, |, & and -");
}

/// Two operands and an operation, and optionally the answer of another program that is checked.
struct Question {
  std::string name;
  fs::path a, b;
  std::string operation;
  std::optional<fs::path> answer;
};

/// The voxels of an .octree file, or the labelled samples of a label map. Sets `lattice` to theirs. A label
/// map is placed on the lattice `onto`, if that is given and contains its samples.
voxel::Octree labelled(const Program& program, const fs::path& path, Timings& timings,
                       voxel::Lattice& lattice, const voxel::Lattice* onto = nullptr,
                       bool may_be_empty = false) {
  if (is_octree(path)) {
    const voxel::OctreeFile file = read_timed(path, timings);
    const auto* const octree = std::get_if<voxel::Octree>(&file.tree);
    if (octree == nullptr)
      throw std::runtime_error(
          path.string() +
          ": contains grey values: make a binary octree of its scan first (octotomy octree SCAN --window "
          "LOW:)");
    lattice = octree->universe().lattice();
    if (octree->is_empty() && !may_be_empty) throw std::runtime_error(path.string() + ": holds no voxel");
    return *octree;
  }
  const Stopwatch watch(timings, "read");
  voxel::Scene scene = voxel::read_scene(path);
  program.note_scan(path, scene);
  if (onto != nullptr && !(scene.lattice == *onto))
    if (std::optional<voxel::Scene> laid = voxel::laid_on(scene, *onto)) scene = std::move(*laid);
  lattice = scene.lattice;
  const voxel::Universe universe = voxel::universe_on(scene.lattice);
  const std::vector<voxel::Label> labels = voxel::labels(scene);
  if (labels.empty() && may_be_empty) return voxel::Octree::empty(universe);
  if (labels.empty()) throw std::runtime_error(path.string() + ": no sample has a label");
  voxel::Expression all = voxel::octree_of_label(universe, scene, labels.front().number);
  for (std::size_t i = 1; i < labels.size(); ++i)
    all = all | voxel::octree_of_label(universe, scene, labels[i].number);
  return voxel::combine(universe, all);
}

/// The answers of both kernels to one question, and the certificates for them and for the answer to check.
struct Answered {
  verify::KernelAnswers kernels;
  std::vector<verify::Certificate> certificates;
  std::vector<std::string> not_covered;
  std::optional<voxel::Lattice> lattice = std::nullopt;  ///< of label maps
  double volume_mm3() const {
    return static_cast<double>(kernels.octree.voxel_count()) *
           kernels.octree.universe().lattice().voxel_mm3();
  }
};

Answered of_label_maps(Program& program, const Question& asked, Timings& timings) {
  // Both sets must have one lattice. That of the octree is preferred, because a label map can be placed on
  // it.
  voxel::Lattice lattice_a, lattice_b;
  const bool is_b_first = is_octree(asked.b) && !is_octree(asked.a);
  const voxel::Octree first = labelled(program, is_b_first ? asked.b : asked.a, timings, lattice_a),
                      second =
                          labelled(program, is_b_first ? asked.a : asked.b, timings, lattice_b, &lattice_a);
  const voxel::Octree &left = is_b_first ? second : first, &right = is_b_first ? first : second;
  if (!(left.universe() == right.universe()))
    throw std::runtime_error(
        asked.a.string() + " and " + asked.b.string() +
        " have different lattices: resample a label map onto the other's lattice first (octotomy convert)");
  const Stopwatch watch(timings, "verify");
  const voxel::Progress progress{program.stop.get_token(), {}};
  const brep::Operation operation = operation_of(asked.operation);
  verify::SetsAnswer given = verify::certify_sets(left, operation, right, progress);
  const voxel::Expression a = left, b = right;
  const voxel::Expression expression = operation == brep::Operation::Union          ? a | b
                                       : operation == brep::Operation::Intersection ? a & b
                                                                                    : a - b;
  Answered answered{
      {std::move(given.octree), std::move(given.solid), given.shift_mm, std::move(given.findings)}, {}, {}};
  const std::string question = asked.a.string() + " " + asked.operation + " " + asked.b.string();
  given.certificate.operation = question;
  // If sets touch themselves or each other at an edge, there may be no manifold Boolean. Then only the sets
  // in general position are certified.
  if (answered.kernels.solid)
    answered.certificates.push_back(std::move(given.certificate));
  else
    answered.not_covered.push_back(question + " on the sets as given: " + given.certificate.reasons.front());
  answered.certificates.push_back(verify::certify_exact(verify::exact_answers(expression, progress)));
  answered.certificates.back().operation =
      question +
      ", both sets refined and shrunk by a quarter of a voxel on all sides, so that they share no faces";
  answered.lattice = lattice_a;
  return answered;
}

/// The boundary of a set's voxels as a solid, and the set's universe.
struct SetAsSolid {
  brep::Solid solid;
  voxel::Universe universe;
};
SetAsSolid solid_of_set(const Program& program, const fs::path& path, Timings& timings) {
  voxel::Lattice lattice;
  const voxel::Octree set = labelled(program, path, timings, lattice);
  return {brep::trusted_solid(convert::triangles_of(convert::cuberille(set, convert::Touching::Apart,
                                                                       {program.stop.get_token(), {}})),
                              brep::Proof::Construction),
          set.universe()};
}

/// Whether a solid lies within a universe, so that voxelising loses no part of it.
bool holds(const voxel::Universe& universe, const brep::Solid& solid) {
  const voxel::Lattice lattice = universe.lattice();
  const brep::Size& size = solid.size();
  for (int corner = 0; corner < 8; ++corner) {
    const glm::dvec3 p_mm((corner & 1) != 0 ? size.high_mm.x : size.low_mm.x,
                          (corner & 2) != 0 ? size.high_mm.y : size.low_mm.y,
                          (corner & 4) != 0 ? size.high_mm.z : size.low_mm.z);
    const glm::dvec3 voxel = lattice.voxel(p_mm);
    if (glm::any(glm::lessThan(voxel, glm::dvec3(-0.5))) ||
        glm::any(glm::greaterThan(voxel, glm::dvec3(universe.side() - 0.5))))
      return false;
  }
  return true;
}

/// Answers a question on a mesh and a set of voxels. For the mesh kernel, the set is the boundary of its
/// voxels. If the set's universe contains the mesh and no --voxel is given, the voxel kernel uses that
/// universe, in which the set is exact.
Answered of_mesh_and_set(Program& program, const Question& asked, const VerifyText& text, Timings& timings) {
  const bool is_mesh_first = is_mesh(asked.a);
  const fs::path &mesh_file = is_mesh_first ? asked.a : asked.b,
                 &set_file = is_mesh_first ? asked.b : asked.a;
  const brep::Solid mesh = read_solid(mesh_file, timings);
  const SetAsSolid set = solid_of_set(program, set_file, timings);
  verify::MeshOperationOptions options{text.operand_voxel_mm, {}, {program.stop.get_token(), {}}};
  if (asked.answer && !is_mesh(*asked.answer) && !holds(set.universe, mesh))
    throw std::runtime_error(mesh_file.string() + ": reaches beyond the voxels of " + set_file.string() +
                             ", so that voxels cannot represent the answer: give the answer as a mesh");
  if (text.operand_voxel_mm && asked.answer && !is_mesh(*asked.answer))
    throw CLI::ValidationError("--voxel", "the answer's voxels are those of " + set_file.string());
  if (!text.operand_voxel_mm) {
    const glm::dvec3 spacing_mm = set.universe.lattice().spacing_mm();
    options.voxel_mm = std::min({spacing_mm.x, spacing_mm.y, spacing_mm.z});
    if (holds(set.universe, mesh)) options.universe = set.universe;
  }
  const Stopwatch watch(timings, "verify");
  verify::OperationAnswers answers =
      verify::certify_operation(is_mesh_first ? mesh : set.solid, operation_of(asked.operation),
                                is_mesh_first ? set.solid : mesh, options);
  answers.certificate.operation = asked.a.string() + " " + asked.operation + " " + asked.b.string() + ", " +
                                  set_file.filename().string() + " as the boundary of its voxels";
  return {{*answers.octree, answers.solid, answers.shift_mm, answers.findings},
          {answers.certificate},
          {},
          set.universe.lattice()};
}

Answered of_meshes(Program& program, const Question& asked, const VerifyText& text, Timings& timings) {
  const brep::Solid left = read_solid(asked.a, timings), right = read_solid(asked.b, timings);
  verify::MeshOperationOptions options{text.operand_voxel_mm, {}, {program.stop.get_token(), {}}};
  // If the answer consists of voxels, both kernels' answers are computed in its universe.
  if (asked.answer && is_octree(*asked.answer))
    options.universe = voxel::universe(voxel::read_octree(*asked.answer));
  else if (asked.answer && !is_mesh(*asked.answer))
    options.universe = voxel::universe_on(voxel::read_scene(*asked.answer).lattice);
  const Stopwatch watch(timings, "verify");
  verify::OperationAnswers answers =
      verify::certify_operation(left, operation_of(asked.operation), right, options);
  answers.certificate.operation = asked.a.string() + " " + asked.operation + " " + asked.b.string();
  return {{*answers.octree, answers.solid, answers.shift_mm, answers.findings}, {answers.certificate}, {}};
}

/// Compares another program's answer with the answers of both kernels. `operands` is the lattice of the
/// operands if these are label maps, else null.
std::vector<verify::Certificate> judged(const fs::path& answer, const verify::KernelAnswers& kernels,
                                        const voxel::Lattice* operands, Program& program, Timings& timings) {
  if (is_mesh(answer)) {
    brep::Triangles triangles;
    {
      const Stopwatch watch(timings, "read");
      triangles = read_mesh_in(answer);
    }
    const Stopwatch watch(timings, "judge");
    return verify::judge_mesh(kernels, triangles, {program.stop.get_token(), {}});
  }
  voxel::Lattice lattice;
  const voxel::Octree voxels = labelled(program, answer, timings, lattice, operands, true);
  if (!(voxels.universe() == kernels.octree.universe()))
    throw std::runtime_error(answer.string() +
                             ": has another lattice than the operands: resample it onto theirs first "
                             "(octotomy convert)");
  const Stopwatch watch(timings, "judge");
  return verify::judge_voxels(kernels, voxels);
}

/// Computes the certificates of a question: first those of the kernels' own answers, then those of the answer
/// to check.
Answered answered(Program& program, const Question& asked, const VerifyText& text, Timings& timings) {
  const bool a_is_mesh = is_mesh(asked.a), b_is_mesh = is_mesh(asked.b);
  if (!a_is_mesh && !b_is_mesh && text.operand_voxel_mm)
    throw CLI::ValidationError("--voxel", "label maps and octrees have voxels already: leave --voxel out");
  Answered found = a_is_mesh != b_is_mesh ? of_mesh_and_set(program, asked, text, timings)
                   : a_is_mesh            ? of_meshes(program, asked, text, timings)
                                          : of_label_maps(program, asked, timings);
  if (asked.answer)
    for (verify::Certificate& certificate :
         judged(*asked.answer, found.kernels, found.lattice ? &*found.lattice : nullptr, program, timings)) {
      certificate.operation = asked.answer->string() + ": " + certificate.operation;
      found.certificates.push_back(std::move(certificate));
    }
  return found;
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

/// Reads a question from JSON: "operands", "operation" and, optionally, "result". Paths are relative to
/// `folder`; `where` names the file in error messages.
Question question_of(const nlohmann::json& json, const std::string& where, const fs::path& folder) {
  check_keys(json, where, {"operands", "operation", "result", "name"});
  const nlohmann::json& operands = need(json, "operands", where);
  if (!operands.is_array() || operands.size() != 2) refuse(where + ": operands", "must be two paths");
  Question asked{"",
                 folder / word_of(operands[0], where + ": operands"),
                 folder / word_of(operands[1], where + ": operands"),
                 word_of(need(json, "operation", where), where + ": operation"),
                 {}};
  operation_of(asked.operation);
  if (json.contains("result") && !json["result"].is_null())
    asked.answer = folder / word_of(json["result"], where + ": result");
  asked.name = json.contains("name") ? word_of(json["name"], where + ": name") : where;
  return asked;
}

std::vector<Question> questions_of_file(const fs::path& path) {
  const nlohmann::json json = read_json(path);
  if (!json.is_array()) return {question_of(json, path.string(), path.parent_path())};
  std::vector<Question> all;
  for (std::size_t i = 0; i < json.size(); ++i)
    all.push_back(question_of(json[i], path.string() + "[" + std::to_string(i) + "]", path.parent_path()));
  return all;
}

/// The file of a folder with this name and any extension. None if there is none; throws if there are two.
std::optional<fs::path> file_called(const fs::path& folder, const std::string& stem) {
  std::vector<fs::path> found;
  for (const fs::directory_entry& entry : fs::directory_iterator(folder))
    if (entry.is_regular_file() && entry.path().filename().string().rfind(stem + ".", 0) == 0)
      found.push_back(entry.path());
  std::sort(found.begin(), found.end());
  if (found.size() > 1) refuse(folder.string(), "has two files called '" + stem + "': keep one");
  return found.empty() ? std::nullopt : std::optional(found.front());
}

/// The questions of a folder, in the order of their names: those in its .json files, and those in subfolders
/// that contain files a, b and at least one of union, intersection and difference.
std::vector<Question> questions_of_folder(const fs::path& folder) {
  std::vector<fs::path> entries;
  for (const fs::directory_entry& entry : fs::directory_iterator(folder)) entries.push_back(entry.path());
  std::sort(entries.begin(), entries.end());
  entries.push_back(folder);
  std::vector<Question> all;
  for (const fs::path& entry : entries) {
    if (entry.extension() == ".json" && fs::is_regular_file(entry))
      for (Question& asked : questions_of_file(entry)) all.push_back(std::move(asked));
    if (!fs::is_directory(entry)) continue;
    const std::optional<fs::path> a = file_called(entry, "a"), b = file_called(entry, "b");
    if (!a || !b) continue;
    for (const char* operation : {"union", "intersection", "difference"})
      if (std::optional<fs::path> answer = file_called(entry, operation))
        all.push_back({entry.filename().string() + " " + operation, *a, *b, operation, std::move(answer)});
  }
  if (all.empty())
    refuse(
        folder.string(),
        "contains no question: give .json files with operands, operation and result, or folders with files "
        "a, b and union, intersection or difference");
  return all;
}

std::string volume_text(double volume_mm3) {
  return grouped(volume_mm3, 3);
}

/// A row of the table of questions, with the worst verdict among the certificates of one question.
Json row_of(const Question& asked, const Answered& found) {
  const std::vector<verify::Certificate>& certificates = found.certificates;
  const auto worst = std::max_element(
      certificates.begin(), certificates.end(),
      [](const verify::Certificate& a, const verify::Certificate& b) { return verify::is_worse(b, a); });
  Json row{{"name", asked.name},
           {"operation", asked.operation},
           {"verdict", verify::to_string(worst->verdict)},
           {"resolved", worst->resolved()},
           {"voxel_mm3", found.volume_mm3()},
           {"mesh_mm3", certificates.front().mesh.volume_mm3},
           {"answer_mm3", nullptr},
           {"reason", worst->reasons.empty() ? "" : worst->reasons.front()}};
  if (asked.answer)
    row["answer_mm3"] = is_mesh(*asked.answer) ? certificates.back().mesh.volume_mm3
                                               : certificates[certificates.size() - 2].mesh.volume_mm3;
  return row;
}

}  // namespace

void need_evidence(SuiteAnswer& answer, const VerifyText& text) {
  if (answer.counts.without_evidence == 0 || text.accept_unresolved) return;
  warn("a PASS without evidence: voxels do not resolve the object (--accept-unresolved accepts it)");
  answer.held = false;
}

bool holds_questions(const fs::path& path) {
  if (fs::is_directory(path)) return true;
  if (path.extension() != ".json" || !fs::is_regular_file(path)) return false;
  const nlohmann::json json = read_json(path);
  return json.is_array() || (json.is_object() && !json.contains("octotomy_plan") &&
                             (json.contains("operands") || json.contains("operation")));
}

SuiteAnswer verify_questions(Program& program, const VerifyText& text) {
  const fs::path path = text.subject.front();
  SuiteAnswer answer;
  answer.more["questions"] = Json::array();
  std::vector<std::pair<std::string, std::string>> rows;
  const std::vector<Question> questions =
      fs::is_directory(path) ? questions_of_folder(path) : questions_of_file(path);
  const auto progress = program.progress();
  for (std::size_t i = 0; i < questions.size(); ++i) {
    const Question& asked = questions[i];
    if (progress) progress(asked.name, static_cast<double>(i) / static_cast<double>(questions.size()));
    const Answered found = answered(program, asked, text, answer.timings);
    for (const verify::Certificate& certificate : found.certificates) {
      answer.certificates.push_back(planner::to_json(certificate));
      add(answer.counts, certificate);
    }
    answer.not_covered.insert(answer.not_covered.end(), found.not_covered.begin(), found.not_covered.end());
    const Json row = row_of(asked, found);
    rows.emplace_back(
        asked.name,
        row["verdict"].get<std::string>() + (row["resolved"] ? "" : ", not resolved") + ", voxel " +
            volume_text(row["voxel_mm3"]) + ", mesh " + volume_text(row["mesh_mm3"]) +
            (row["answer_mm3"].is_null() ? std::string() : ", answer " + volume_text(row["answer_mm3"])) +
            " mm\u00b3" + (row["reason"] == "" ? "" : "; " + row["reason"].get<std::string>()));
    answer.more["questions"].push_back(row);
  }
  rows.emplace_back("verdicts", text_of(answer.counts));
  answer.text = lines(rows);
  need_evidence(answer, text);
  return answer;
}

SuiteAnswer verify_operands(Program& program, const VerifyText& text) {
  const Question asked{"", text.subject[0], text.subject[2], text.subject[1], text.answer};
  operation_of(asked.operation);
  SuiteAnswer answer;
  const Answered found = answered(program, asked, text, answer.timings);
  const verify::Certificate& kernels = found.certificates.front();
  if (found.kernels.solid) answer.worst = {kernels, found.kernels.octree, found.kernels.solid};
  answer.more["volume_mm3"] = found.volume_mm3();
  answer.not_covered = found.not_covered;
  for (const std::string& finding : found.not_covered) warn_finding(finding);
  answer.text = lines({{"volume", grouped(found.volume_mm3(), 3) + " mm\u00b3 by the voxel kernel"}});
  for (const verify::Certificate& certificate : found.certificates) {
    answer.certificates.push_back(planner::to_json(certificate));
    add(answer.counts, certificate);
    answer.text += what_of(certificate);
  }
  need_evidence(answer, text);
  return answer;
}

void add_operand_options(CLI::App& verb, VerifyText& text) {
  verb.add_option(
          "--voxel", text.operand_voxel_mm,
          "Edge of the voxels in which two meshes, or a mesh and a label map or octree, are compared, mm")
      ->check(above_zero());
  verb.add_option(
          "--answer", text.answer,
          "For A OP B: a result of another program (mesh, label map or octree) to compare with both kernels")
      ->check(CLI::ExistingFile);
}

}  // namespace octotomy::planner::cli
