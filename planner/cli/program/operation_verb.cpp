// SPDX-License-Identifier: AGPL-3.0-or-later
//
// A verb made from an operation:
//   1 The words of its options become the JSON of a step, which is read like a step of a plan.
//   2 The files that it names become objects: meshes, checked to be solids, or octrees. Where both kinds meet,
//     each kernel gets all of them: meshes by the voxels whose centres they hold, octrees by the boundary of
//     their voxels. Both kernels then share their operands, as they do where a motion moves a mesh; the
//     certificate states this.
//   3 The kernel that the output's format needs computes the answer; with --certify both do and are
//     compared. If only the mesh kernel has an answer, an octree is made from its voxels.
//   4 The answer is written, measured and printed.
#include <CLI/CLI.hpp>
#include <algorithm>
#include <nlohmann/json.hpp>

#include "brep/mesh/health.h"
#include "convert/surface/cuberille.h"
#include "convert/voxel/voxelise.h"
#include "planner/cli/program/verbs.h"
#include "planner/cli/verb/field_options.h"
#include "planner/cli/verb/mesh_options.h"
#include "planner/cli/verb/numbers.h"
#include "planner/cli/verb/octree_out.h"
#include "planner/cli/verb/scan_in.h"
#include "planner/operation/file/mesh_file.h"
#include "planner/operation/measure/octree_summary.h"
#include "planner/operation/measure/result_json.h"
#include "planner/operation/object/certify.h"
#include "planner/operation/object/provenance.h"
#include "planner/operation/table/field_json.h"
#include "planner/operation/table/json_file.h"
#include "planner/operation/table/number_format.h"
#include "planner/operation/table/operation.h"
#include "voxel/scan/dicom_source.h"

namespace octotomy::planner::cli {
namespace {

namespace fs = std::filesystem;

/// The command line of an operation's verb.
struct OperationText {
  FieldWords words;
  fs::path out;
  std::optional<double> voxel_mm;
  bool certify = false, mend = false, orient = false;
  ScanIn scan;
  CLI::App* verb = nullptr;
};

/// The fields of an operation that its verb has as positionals and options: all but those that only plans
/// have.
std::vector<Field> fields_of(const Operation& operation) {
  std::vector<Field> fields;
  for (const std::vector<Field>* all : {&operation.fields, &operation.verb_fields})
    for (const Field& field : *all)
      if (!field.is_of_plans) fields.push_back(field);
  return fields;
}

/// One run of a verb that makes an object in both kernels.
class OperationRun {
 public:
  OperationRun(const Program& program, const Action& action, const OperationText& text)
      : program_(program), action_(action), operation_(action.operation()), text_(text) {}

  int run() {
    const bool wants_octree = is_octree(text_.out);
    if (!wants_octree) need_mesh_extension(text_.out);
    need_folder_of(text_.out);
    if (text_.certify && !operation_.voxel)
      throw std::runtime_error(
          operation_.name +
          " is done only by the mesh kernel, so there is no certificate: leave --certify out");
    read_objects();
    const bool with_voxels = operation_.voxel && (wants_octree || text_.certify);
    const bool with_mesh = !wants_octree || !with_voxels || text_.certify;
    const bool is_mixed = operation_.voxel && has_octree_ && has_mesh_;
    // The voxels of a mesh that a motion moves are those of the moved mesh.
    const bool is_shared = is_mixed || (operation_.is_motion && has_mesh_);
    if (with_voxels) choose_universe();
    for (Object& object : inputs_) {
      if (is_shared) add_file_maker(object);
      if (with_voxels && is_mixed) check_room(object);
      if (with_voxels) add_voxels(object);
      if (with_mesh && is_mixed) add_surface(object);
      objects_.add(std::move(object));
    }
    Object made("answer", operation_.name, universe_);
    settle(made);
    made.definition = operation_.definition(value(), objects_);
    if (with_voxels)
      operation_.voxel(value(), {universe_, objects_, no_scan_, timings_, progress(), {}, no_scans_},
                       made.voxel);
    if (with_mesh) answer_by_mesh(made);
    if (wants_octree && !with_voxels) voxelise_answer(made);
    if (is_shared) add_makers(made);
    if (text_.certify) certify_answer(made);
    made.findings.insert(made.findings.begin(), mended_.begin(), mended_.end());
    made.findings.insert(made.findings.end(), beyond_.begin(), beyond_.end());
    return wants_octree ? write_voxels(made) : write_mesh(made);
  }

 private:
  /// Computes values of the operation that both kernels then use, such as a fitted plane.
  void settle(Object& made) {
    if (!operation_.settle) return;
    settled_ = operation_.settle(
        action_.value(), {objects_, no_scan_, timings_, progress(), {}, settled_details_, made.findings});
  }
  const void* value() const { return settled_ ? settled_.get() : action_.value(); }

  voxel::Progress progress() const { return {program_.stop.get_token(), program_.progress(operation_.name)}; }

  void read_objects() {
    for (const std::string& path : objects_used(action_)) {
      Object object(path, "file", universe_);
      object.definition = fs::path(path).filename().string();
      if (is_octree(path)) {
        voxel::OctreeFile file = read_timed(path, timings_);
        auto* octree = std::get_if<voxel::Octree>(&file.tree);
        if (octree == nullptr)
          throw std::runtime_error(path + ": only a binary octree is an object: make one by octotomy octree");
        object.voxel.octree = std::move(*octree);
        object.voxel.symbol = voxel::Expression(object.voxel.octree);
        object.voxel.lineage = "voxels of " + object.definition;
        universe_ = object.voxel.octree.universe();
        has_octree_ = true;
      } else {
        object.mesh.whole = solid_of(path);
        object.mesh.lineage = "triangles of " + object.definition;
        has_mesh_ = true;
      }
      inputs_.push_back(std::move(object));
    }
  }

  brep::Solid solid_of(const fs::path& path) {
    if (text_.mend) {
      const voxel::Progress mending = progress();
      return read_mended_solid(path, timings_, mended_, {mending.stop, mending.report});
    }
    try {
      return text_.orient ? read_turned_solid(path, timings_, mended_) : read_solid(path, timings_);
    } catch (const brep::Error& error) {
      throw brep::Error(
          error.code(),
          std::string(error.what()) +
              (text_.orient ? "; or take --mend"
                            : "; or use --mend, or --orient if triangles only face the wrong way"));
    }
  }

  /// Chooses a universe around all operands, unless an operand is an octree, whose universe is used.
  void choose_universe() {
    if (has_octree_) return;
    voxel::Box box{glm::dvec3(1e300), glm::dvec3(-1e300)};
    for (const Object& object : inputs_) {
      const brep::Size& size = object.mesh.whole->size();
      box = {glm::min(box.low_mm, size.low_mm), glm::max(box.high_mm, size.high_mm)};
    }
    const double room_mm = 0.25 * longest_side_mm(box);  // some operations add a margin
    universe_ = universe_around({box.low_mm - room_mm, box.high_mm + room_mm}, longest_side_mm(box));
  }

  static double longest_side_mm(const voxel::Box& box) {
    const glm::dvec3 extent = box.high_mm - box.low_mm;
    return std::max({extent.x, extent.y, extent.z});
  }

  /// A universe around a box, with voxels of the size --voxel or, by default, a 128th of `shown_mm`.
  voxel::Universe universe_around(const voxel::Box& box, double shown_mm) const {
    return voxel::universe_around(box, text_.voxel_mm.value_or(shown_mm / 128.0));
  }

  void add_voxels(Object& object) {
    if (object.voxel.symbol) return;
    const Stopwatch watch(timings_, "voxelise");
    voxelise(*object.mesh.whole, universe_, object.voxel, progress());
  }

  /// Makes a mesh of an octree that is combined with meshes: the boundary of its voxels.
  void add_surface(Object& object) {
    if (object.mesh.whole) return;
    if (object.voxel.octree.is_empty()) throw std::runtime_error(object.id + ": holds no voxel");
    const Stopwatch watch(timings_, "cuberille");
    object.mesh.whole = brep::trusted_solid(
        convert::triangles_of(convert::cuberille(object.voxel.octree, convert::Touching::Apart, progress())),
        brep::Proof::Construction);
    object.mesh.lineage = "boundary of the voxels of " + object.definition;
  }

  /// Records for both kernels that the operand comes from a file.
  static void add_file_maker(Object& object) {
    const std::string lineage = object.mesh.whole ? object.mesh.lineage : object.voxel.lineage;
    object.voxel.makers = object.mesh.makers = {"file: " + lineage};
  }

  /// Records where each kernel's answer comes from: the operation with the kernel's lineage, and the
  /// operands' origins. Sorted, without repetitions.
  void add_makers(Object& made) const {
    const auto add = [&](std::vector<std::string>& all, const std::string& lineage, auto of_operand) {
      all.push_back(operation_.name + ": " + lineage);
      for (const Object& object : objects_) {
        const std::vector<std::string>& more = of_operand(object);
        all.insert(all.end(), more.begin(), more.end());
      }
      std::sort(all.begin(), all.end());
      all.erase(std::unique(all.begin(), all.end()), all.end());
    };
    add(
        made.voxel.makers, made.voxel.lineage,
        [](const Object& object) -> const auto& { return object.voxel.makers; });
    add(
        made.mesh.makers, made.mesh.lineage,
        [](const Object& object) -> const auto& { return object.mesh.makers; });
  }

  /// Checks that a mesh lies within the octree's universe, in which the answer's voxels are made. Beyond it,
  /// voxels are cut off: throws with --certify, otherwise adds a warning.
  void check_room(const Object& object) {
    if (!object.mesh.whole || object.mesh.whole->empty()) return;
    const voxel::Lattice lattice = universe_.lattice();
    const brep::Size& size = object.mesh.whole->size();
    double beyond_mm = 0.0;
    for (int corner = 0; corner < 8; ++corner) {
      const glm::dvec3 p_voxel = lattice.voxel({corner & 1 ? size.high_mm.x : size.low_mm.x,
                                                corner & 2 ? size.high_mm.y : size.low_mm.y,
                                                corner & 4 ? size.high_mm.z : size.low_mm.z});
      const glm::dvec3 out =
          lattice.spacing_mm() * glm::max(-0.5 - p_voxel, p_voxel - (universe_.side() - 0.5));
      beyond_mm = std::max({beyond_mm, out.x, out.y, out.z});
    }
    if (!(beyond_mm > 0.0)) return;
    const std::string what =
        object.id + ": reaches " + three_figures(beyond_mm) + " mm beyond the voxels of the octree";
    if (text_.certify)
      throw std::runtime_error(what + ", so that the kernels cannot be compared there: leave --certify out");
    beyond_.push_back(what + ": the answer has no voxels there; write a mesh to keep all of the object");
  }

  void answer_by_mesh(Object& made) {
    for (const Object& object : objects_)
      if (!object.mesh.whole)
        throw std::runtime_error(
            object.id + ": is an octree: " + (operation_.voxel ? "write an .octree, or make" : "make") +
            " its mesh first by octotomy mesh");
    const voxel::Box box = voxel::bounds(universe_.lattice());
    verify::MeshExpressions expressions({});
    operation_.mesh(value(), {box.low_mm, box.high_mm, objects_, no_scan_, expressions, timings_, progress()},
                    made.mesh);
    made.findings.insert(made.findings.end(), made.mesh.findings.begin(), made.mesh.findings.end());
    // An empty result is valid: its volume is 0, and its file contains no triangle.
    if (made.mesh.whole->empty())
      made.findings.push_back("empty: nothing is left of " + made.definition + ", so " +
                              text_.out.filename().string() + " has no triangles");
  }

  /// Makes the voxels of an answer that the mesh kernel alone has computed.
  void voxelise_answer(Object& made) {
    const Stopwatch watch(timings_, "voxelise");
    const brep::Solid& solid = *made.mesh.whole;
    if (solid.empty()) {
      choose_universe();
      made.voxel.octree = voxel::Octree::empty(universe_);
      return;
    }
    const voxel::Box box{solid.size().low_mm, solid.size().high_mm};
    made.voxel.octree =
        convert::voxelise(universe_around(box, longest_side_mm(box)), solid.linked(), progress());
    made.findings.emplace_back(mesh_alone);
  }

  void certify_answer(Object& made) {
    const Stopwatch watch(timings_, "certify");
    made.mesh.within = made.mesh.whole;
    operation_.bound(value(), {universe_, objects_, no_scan_}, made);
    certify(made, operation_.name + " = " + made.definition, progress());
  }

  int status(const Object& made) const {
    if (!made.certificate || made.certificate->verdict != verify::Verdict::Fail) return done;
    warn("the kernels disagree (a FAIL verdict)");
    return disagreement;
  }

  int write_voxels(const Object& made) {
    const voxel::OctreeFile file{made.voxel.octree, text_.out.stem().string(),
                                 json_text(Json{{"made_by", std::string("octotomy ") + OCTOTOMY_VERSION},
                                                {"operation", made.definition}})};
    Json more = Json::object();
    if (made.certificate) more["certificate"] = to_json(*made.certificate);
    say(program_, octree_written(file, text_.out, program_.stop.get_token(), timings_, made.findings, more),
        timings_);
    return status(made);
  }

  int write_mesh(Object& made) {
    const brep::Solid& solid = *made.mesh.whole;
    const brep::Health health = brep::health(solid.triangles());
    const brep::Measures& measures = solid.measures();
    write_surface(solid, text_.out, timings_);
    if (auto finding = rounding_finding(text_.out, timings_)) made.findings.push_back(std::move(*finding));
    for (const std::string& finding : made.findings) warn_finding(finding);
    Json json = answer(timings_);
    json["path"] = text_.out.string();
    json.update(to_json(health));
    json.update(to_json(measures));
    json["area_estimator"] = "triangles";
    json["health"] = to_json(health);
    json.update(made.mesh.details);
    json.update(settled_details_);
    if (made.certificate) json["certificate"] = to_json(*made.certificate);
    json["findings"] = made.findings;
    std::vector<std::pair<std::string, std::string>> rows{
        {"written", text_.out.string()},
        {"volume", grouped(measures.volume_mm3, 3) + " mm\u00b3"},
        {"area", grouped(measures.area_mm2, 3) + " mm\u00b2"}};
    if (made.certificate) rows.emplace_back("verdict", verify::to_string(made.certificate->verdict));
    program_.say(json, lines(rows));
    return status(made);
  }

  const Program& program_;
  const Action& action_;
  const Operation& operation_;
  const OperationText& text_;
  const std::vector<ScanRecord> no_scans_;
  const Scans no_scan_ = [](const std::string& name) -> const LoadedScan& {
    throw std::invalid_argument("there is no scan called '" + name + "'");
  };
  Timings timings_;
  voxel::Universe universe_;
  bool has_octree_ = false, has_mesh_ = false;
  std::vector<std::string> mended_;  ///< repairs of meshes that are not solids
  std::vector<std::string> beyond_;  ///< meshes that the octree's universe cuts off
  std::vector<Object> inputs_;
  Objects objects_;
  std::shared_ptr<void> settled_;  ///< the value made by settle(); empty: the typed one
  nlohmann::ordered_json settled_details_ = nlohmann::ordered_json::object();
};

/// One run of a verb whose operation reads files and returns the answer itself. Returns the exit status.
int answer_from_files(const Program& program, const Action& action, const OperationText& text) {
  Timings timings;
  for (const auto& [field, words] : text.words)
    if (field.starts_with("window")) program.note_tissues(words);
  FileBench bench{timings, program.stop.get_token(), program.progress()};
  bench.scan_reader = [&](const fs::path& path, const voxel::SlicesFinal& slices_final) {
    return read_scan(program, path, text.scan, timings, slices_final);
  };
  bench.dicom_source = [&](const fs::path& path, const voxel::Scene& scene) {
    return is_dicom(scene) ? std::make_shared<const voxel::DicomSource>(
                                 voxel::dicom_source(path, read_options(program, text.scan)))
                           : nullptr;
  };
  return say(program, action.operation().on_files(action.value(), bench), timings);
}

void add_object_options(CLI::App& verb, const Operation& operation, OperationText& text) {
  const bool by_both = static_cast<bool>(operation.voxel);
  verb.add_option(
          "-o,--out", text.out,
          std::string("The answer: a .stl, .ply, .obj, .off, .vtp or .glb file by the mesh kernel, or ") +
              (by_both ? "an .octree by the voxel kernel" : "an .octree of the voxels inside that surface"))
      ->required();
  verb.add_option("--voxel", text.voxel_mm,
                  std::string("Edge of an octree's voxels, mm; default: a 128th of the ") +
                      (by_both ? "objects' extent" : "answer's extent"))
      ->check(above_zero());
  verb.add_flag("--mend", text.mend, "Repair meshes that are not solids first, as repair --solid does");
  verb.add_flag("--orient", text.orient,
                "Turn triangles that face the wrong way first, as repair --orient does");
  CLI::Option* certify = verb.add_flag("--certify", text.certify,
                                       "Compute the answer in both kernels and print the certificate");
  if (!by_both) certify->group("");  // hidden: it is refused with a reason
}

/// Whether a field of the operation names objects. On the command line these are files of meshes or octrees.
bool names_files(const Operation& operation, const std::vector<Field>& fields) {
  const std::shared_ptr<void> fresh = operation.fresh();
  return std::any_of(fields.begin(), fields.end(),
                     [&](const Field& field) { return names_objects(field, fresh.get()); });
}

void add_verb(Program& program, const Operation& operation) {
  const auto text = std::make_shared<OperationText>();
  std::string says = operation.says;
  says.pop_back();
  CLI::App& verb = program.verb(operation.name, says, operation.verb_example, [&program, &operation, text] {
    const Action action = read_action(operation, text->words);
    choose_mesh_options(*text->verb);
    if (operation.reads_scans) need_options_fit(*text->verb, objects_used(action));
    return operation.on_files ? answer_from_files(program, action, *text)
                              : OperationRun(program, action, *text).run();
  });
  text->verb = &verb;
  if (!program.is_asked(operation.name)) return;
  const std::vector<Field> fields = fields_of(operation);
  add_field_options(verb, operation, fields, text->words);
  if (!operation.on_files) add_object_options(verb, operation, *text);
  if (operation.reads_scans) add_scan_options(verb, text->scan);
  if (names_files(operation, fields)) add_mesh_options(verb);
}

}  // namespace

void add_operation_verbs(Program& program) {
  for (const Operation& operation : operations())
    if (!operation.verb_example.empty() && operation.makes != Makes::Scan) add_verb(program, operation);
}

}  // namespace octotomy::planner::cli
