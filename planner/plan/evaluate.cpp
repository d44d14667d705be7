// SPDX-License-Identifier: AGPL-3.0-or-later
//
// Steps are evaluated in order, each in both kernels before the next:
// 1 Read every scan once, sample it into a grey octree, and store its samples until the last step that uses
//   them.
// 2 Voxel kernel: the operation's answer from other voxel answers.
// 3 Mesh kernel: the operation's answer from other mesh answers and the scan's own samples.
// 4 Certify: only here are the two answers compared. Without a cache, certificates run in parallel with later
//   steps.
// Invariant: the benches of 2 and 3 give access to one kernel each.
#include "planner/plan/evaluate.h"

#include <algorithm>
#include <cmath>
#include <deque>
#include <memory>
#include <nlohmann/json.hpp>
#include <set>

#include "brep/boolean/boolean.h"
#include "brep/mesh/error.h"
#include "brep/shape/prism.h"
#include "convert/voxel/voxelise.h"
#include "planner/operation/object/certify.h"
#include "planner/operation/object/import.h"
#include "planner/operation/object/provenance.h"
#include "planner/operation/object/tile.h"
#include "planner/operation/table/fault.h"
#include "planner/operation/table/number_format.h"
#include "planner/operation/table/same_patient.h"
#include "planner/plan/background_tasks.h"
#include "planner/plan/caveats.h"
#include "planner/plan/dependence.h"
#include "planner/plan/makers.h"
#include "planner/plan/room.h"
#include "planner/plan/sha256.h"
#include "planner/plan/step_errors.h"
#include "verify/certificate/places.h"
#include "verify/witness/reshaped_witness.h"
#include "verify/witness/scan_blend_witness.h"
#include "verify/witness/witness.h"
#include "voxel/measure/distance_map.h"
#include "voxel/scan/read_image_stack.h"
#include "voxel/scan/read_scene.h"
#include "voxel/space/regular_file.h"

namespace octotomy::planner {
namespace {

brep::Prism prism_of(const voxel::Box& box) {
  const glm::dvec3 a = box.low_mm, b = box.high_mm;
  return {{0, 1, 0}, {0, 0, 1}, {1, 0, 0}, {{{a.x, a.z}, {b.x, a.z}, {b.x, b.z}, {a.x, b.z}}}, a.y, b.y};
}

/// The value of samples outside of a scan: the scan's lowest value, which is air.
std::int16_t background_of(const voxel::Scene& scene) {
  return static_cast<std::int16_t>(std::clamp(std::floor(voxel::range(scene).low), -32768.0, -1024.0));
}

ScanRecord record_of(const std::string& name, const std::filesystem::path& path, const voxel::Scene& scene) {
  ScanRecord record;
  record.name = name;
  record.path = path;
  record.lattice = scene.lattice;
  record.meaning = scene.meaning;
  record.modality = scene.modality;
  record.unit = voxel::unit(scene);
  record.range = voxel::range(scene);
  record.audit = scene.audit;
  record.holes = scene.holes;
  record.identity = scene.identity;
  return record;
}

/// One evaluation in progress.
class Evaluator {
 public:
  Evaluator(const Plan& plan, const EvaluateOptions& options, std::optional<voxel::Box> room)
      : plan_(plan), options_(options), room_(std::move(room)) {
    if (plan.lps_from_head) result_.objects.lps_from_head = *plan.lps_from_head;
    std::vector<std::string> wanted = options.wanted;
    if (wanted.empty())
      for (const Step& step : plan.steps) wanted.push_back(step.id);
    wanted_ = needed_for(plan, wanted);
    with_mesh_ = options.meshes ? wanted_ : needing_meshes(plan, wanted_);
  }

  Evaluation run() {
    read_scans();
    if (options_.cache != nullptr)
      keys_ = step_keys(plan_, common_key(), [this](const std::string& scan) { return scan_keys_.at(scan); });
    std::size_t done = 0;
    const std::size_t works = plan_.steps.size() * (certifies_beside() ? 2 : 1);
    const auto tell = [&](const std::string& doing) {
      report(doing, static_cast<double>(done++) / static_cast<double>(works));
    };
    for (const Step& step : plan_.steps) {
      tell(verb(step) + " " + step.id);
      const Makes makes = step.action.operation().makes;
      if ((makes != Makes::Object && makes != Makes::Scan) || !wanted_.contains(step.id)) continue;
      name_step_in_errors(step.id, [&] {
        background_.without_tasks([&] {
          if (!take_cached(step)) makes == Makes::Scan ? make_scan(step) : make(step);
        });
        // Started outside of without_tasks(), because a parallel loop within it could run the new task.
        if (begun_ < uncertified_.size() && !prepares_files())
          background_.begin(uncertified_[begun_++].certify);
      });
      for (const std::string& scan : scans_used(step.action))
        if (--uses_left_[scan] == 0 && !options_.keep_scans) loaded_.erase(scan);
    }
    for (std::size_t i = 0; i < uncertified_.size(); ++i) {
      Uncertified& made = uncertified_[i];
      tell("certifying " + made.object.id);
      name_step_in_errors(made.object.id,
                          [&] { prepares_files() ? made.certify(options_.stop) : background_.wait(i); });
      result_.objects.change(made.index).certificate = std::move(made.object.certificate);
      for (const auto& [stage, ms] : made.timings) result_.timings[stage] += ms;
    }
    for (auto& [name, scan] : loaded_)
      if (uses_left_[name] > 0 || options_.keep_scans)
        result_.loaded.emplace(name, std::make_shared<const LoadedScan>(std::move(scan)));
    report("evaluated", 1.0);
    return std::move(result_);
  }

 private:
  void report(const std::string& doing, double fraction) {
    told_ = fraction;
    if (options_.stop.stop_requested()) throw Stopped("stopped before '" + doing + "': nothing was written");
    if (options_.progress) options_.progress(doing, fraction);
  }

  /// The names of the plan's scans to read: those that wanted steps use, or all with `keep_scans`. The scan
  /// of the plan's first step, which determines the universe, is always included.
  std::vector<std::string> scans_in_use() {
    std::vector<std::string> names;
    std::string first;  // the first scan that any step uses, wanted or not
    for (const Step& step : plan_.steps)
      for (const std::string& scan : scans_used(step.action)) {
        if (first.empty() && plan_.scans.contains(scan)) first = scan;
        if (!wanted_.contains(step.id)) continue;
        if (uses_left_[scan]++ == 0 && plan_.scans.contains(scan)) names.push_back(scan);
      }
    if (plan_.scans.empty()) return names;
    if (first.empty()) first = plan_.scans.begin()->first;
    if (std::find(names.begin(), names.end(), first) == names.end()) names.insert(names.begin(), first);
    if (options_.keep_scans)
      for (const auto& [name, source] : plan_.scans)
        if (std::find(names.begin(), names.end(), name) == names.end()) names.push_back(name);
    return names;
  }

  voxel::Scene read(const std::string& name, const ScanSource& source, std::string& sha256) {
    const Stopwatch watch(result_.timings, "read");
    const std::filesystem::path path = scan_path(plan_, source);
    if (!std::filesystem::exists(path) && voxel::image_files(path).empty())
      throw std::runtime_error("scan '" + name + "': " + path.string() +
                               ": no such file or folder; correct the plan or use --scan " + name + "=PATH");
    if (!std::filesystem::is_directory(path)) voxel::need_regular_file(path);
    sha256 = sum_of(path);
    if (source.sha256 && *source.sha256 != sha256)
      throw std::runtime_error("scan '" + name + "': " + path.string() + " has SHA-256 " + sha256 +
                               ", the plan states " + *source.sha256 + ": it is another scan");
    voxel::ReadOptions options = source.read;
    options.progress.stop = options_.stop;
    voxel::Scene scene =
        options_.read_scene ? options_.read_scene(path, options) : voxel::read_scene(path, options);
    voxel::check(scene);
    return scene;
  }

  void read_scans() {
    if (plan_.scans.empty()) set_universe(universe_of(boxes_of_steps(), plan_.voxel_mm));
    for (const std::string& name : scans_in_use()) {
      report("read " + name, 0.0);
      const ScanSource& source = plan_.scans.at(name);
      std::string sha256;
      if (take_cached_scan(name, source) || take_loaded_scan(name)) continue;
      voxel::Scene scene = read(name, source, sha256);
      if (result_.scans.empty()) set_universe(universe_of(scene, plan_.voxel_mm));
      result_.scans.push_back(record_of(name, source.path, scene));
      result_.scans.back().sha256 = std::move(sha256);
      load(name, std::move(scene));
      if (options_.cache != nullptr)
        options_.cache->keep(scan_keys_[name] = scan_key(name, source),
                             {loaded_.at(name), result_.scans.back()});
    }
    check_identities();
  }

  /// Compares the patients of the scans and adds differences to their audits. A label map is compared with
  /// every scan and refused if it differs from all. Another scan is compared only with the first one and
  /// never refused, because plans may use scans of donors and later scans.
  void check_identities() {
    for (ScanRecord& laid : result_.scans) {
      std::erase_if(laid.audit, [](const voxel::Finding& finding) { return finding.check == "identity"; });
      const bool is_label = laid.meaning == voxel::Meaning::Label;
      std::optional<voxel::Finding> best;
      for (const ScanRecord& scan : result_.scans) {
        if (&scan == &laid || (is_label ? scan.meaning == voxel::Meaning::Label : &scan != &result_.scans[0]))
          continue;
        voxel::Finding found = identity_finding({"scan '" + scan.name + "'", scan.identity},
                                                {"scan '" + laid.name + "'", laid.identity});
        if (!best || found.verdict < best->verdict) best = std::move(found);
      }
      if (!best || best->verdict == voxel::Verdict::Pass) continue;
      if (is_label && best->verdict == voxel::Verdict::Fail && !plan_.scans.at(laid.name).other_identity)
        throw std::runtime_error(best->detail +
                                 "; if this is intended, \"other_identity\": true beside the path of '" +
                                 laid.name + "' continues and reports it as a FAIL");
      if (!is_label && best->verdict != voxel::Verdict::Fail) continue;
      if (!is_label) {
        best->verdict = voxel::Verdict::Warn;
        best->detail += "; a step must move objects of one to the other before they are combined";
      }
      laid.audit.push_back(std::move(*best));
    }
  }

  /// The boxes of all imported meshes and tiled contours of the plan, even of steps that are not wanted, so
  /// that the universe does not depend on the wanted steps.
  std::vector<voxel::Box> boxes_of_steps() {
    const Stopwatch watch(result_.timings, "read");
    std::vector<voxel::Box> boxes;
    for (const Step& step : plan_.steps)
      if (is_import(step.action) || is_tile(step.action))
        name_step_in_errors(step.id, [&] {
          boxes.push_back(is_tile(step.action) ? tile_box(step.action, plan_.folder)
                                               : import_box(step.action, plan_.folder));
        });
    return boxes;
  }

  void set_universe(const voxel::Universe& universe) {
    least_universe_ = universe;
    result_.universe = room_ ? with_room(universe, *room_).value_or(universe) : universe;
    box_ = voxel::bounds(result_.universe.lattice());
    world_ = brep::solid_of(prism_of(box_));
    expressions_ = std::make_unique<verify::MeshExpressions>(world_);
  }

  std::string sum_of(const std::filesystem::path& path) const {
    if (options_.cache == nullptr) return sha256_of_path(path);
    const std::string state = state_of_path(path);
    if (const auto known = options_.cache->sum(state)) return *known;
    std::string sum = sha256_of_path(path);
    options_.cache->keep_sum(state, sum);
    return sum;
  }

  /// The key of a scan of the plan. It covers the scan's files, the options for reading them, and the
  /// universe.
  std::string scan_key(const std::string& name, const ScanSource& source) const {
    nlohmann::ordered_json says{{"name", name},
                                {"sum", sum_of(scan_path(plan_, source))},
                                {"path", source.path.string()},
                                {"series", source.read.series},
                                {"voxel_mm", plan_.voxel_mm.value_or(0.0)}};
    if (room_)
      for (const glm::dvec3& p_mm : {room_->low_mm, room_->high_mm})
        says["room_mm"].push_back({p_mm.x, p_mm.y, p_mm.z});
    if (source.read.join) says["join"] = true;
    for (const voxel::SliceRange& range : source.read.slices)
      says["slices"].push_back({range.first, range.last});
    if (source.read.frame) says["frame"] = source.read.frame->name;
    if (source.read.unit) says["unit"] = source.read.unit->name;
    if (source.read.spacing_mm)
      for (int axis = 0; axis < 3; ++axis) says["spacing_mm"].push_back((*source.read.spacing_mm)[axis]);
    if (const auto& raw = source.read.raw)
      says["raw"] = {raw->dims.x,     raw->dims.y, raw->dims.z, static_cast<int>(raw->type),
                     raw->big_endian, raw->offset};
    for (const auto& [first, key] : scan_keys_)
      if (first == result_.scans.front().name && first != name) says["first"] = key;
    return sha256_of(says.dump());
  }

  bool take_cached_scan(const std::string& name, const ScanSource& source) {
    if (options_.cache == nullptr || !std::filesystem::exists(scan_path(plan_, source))) return false;
    const std::string key = scan_key(name, source);
    const auto known = options_.cache->scan(key);
    if (known == nullptr || (source.sha256 && *source.sha256 != known->record.sha256)) return false;
    scan_keys_[name] = key;
    take_scan(name, known->loaded, known->record);
    return true;
  }

  bool take_loaded_scan(const std::string& name) {
    if (options_.scans_of == nullptr) return false;
    const auto known = options_.scans_of->loaded.find(name);
    if (known == options_.scans_of->loaded.end()) return false;
    for (const ScanRecord& record : options_.scans_of->scans)
      if (record.name == name) take_scan(name, *known->second, record);
    return true;
  }

  void take_scan(const std::string& name, const LoadedScan& scan, const ScanRecord& record) {
    if (result_.scans.empty()) set_universe(universe_of(scan.scene(), plan_.voxel_mm));
    result_.scans.push_back(record);
    loaded_.insert_or_assign(name, scan);
    if (!(scan.grey.universe() == result_.universe)) load(name, scan.scene());
  }

  /// A text that covers the common inputs of all answers: the universe, by its size and place or by the first
  /// scan, and whether objects are certified.
  std::string common_key() const {
    const glm::dvec3& low = box_.low_mm;
    const std::string place =
        plan_.scans.empty()
            ? nlohmann::json{low.x, low.y, low.z, box_.high_mm.x, result_.universe.depth}.dump()
            : scan_keys_.at(result_.scans.front().name);
    return place + (options_.certify ? " certified" : "");
  }

  /// The cache's key of a step's object. It differs between answers with and without the mesh kernel.
  std::string key_of(const Step& step) const {
    return keys_.at(step.id) + (with_mesh_.contains(step.id) ? "" : " voxels");
  }

  bool take_cached(const Step& step) {
    if (options_.cache == nullptr) return false;
    if (step.action.operation().makes == Makes::Object) {
      const auto known = options_.cache->object(key_of(step));
      if (known == nullptr) return false;
      if (grows()) need_room(result_.objects, *known, least_universe_, room_);
      result_.objects.add(*known);
      return true;
    }
    const auto known = options_.cache->scan(keys_.at(step.id));
    if (known == nullptr) return false;
    result_.scans.push_back(known->record);
    loaded_.insert_or_assign(step.id, known->loaded);
    return true;
  }

  void load(const std::string& name, voxel::Scene scene) {
    const Stopwatch watch(result_.timings, "octree");
    voxel::GreyOctree grey = voxel::grey_octree_of(
        result_.universe, scene, background_of(scene),
        {options_.stop, [&](double share) {
           report("octree of " + name + ", " + std::to_string(std::lround(100.0 * share)) + " %", told_);
         }});
    const auto shared = std::make_shared<const voxel::Scene>(std::move(scene));
    loaded_.insert_or_assign(name, LoadedScan{shared, grey.with_scan(shared)});
  }

  /// Makes a scan by a step. The universe remains that of the first scan that was read.
  void make_scan(const Step& step) {
    const Operation& operation = step.action.operation();
    MadeScan made;
    {
      const Stopwatch watch(result_.timings, operation.name);
      made = operation.scan(step.action.value(), {[this](const std::string& name) -> const voxel::Scene& {
                                                    return loaded_.at(name).scene();
                                                  },
                                                  result_.timings,
                                                  {options_.stop, {}},
                                                  plan_.folder,
                                                  &scan_,
                                                  &result_.objects});
    }
    ScanRecord record = record_of(step.id, {}, made.scene);
    record.made_by = operation.name + " of " + scans_used(step.action).front();
    record.details = std::move(made.details);
    for (const std::string& finding : made.findings)
      record.audit.push_back({operation.name, voxel::Verdict::Warn, finding});
    keep_unmeasured(step.action, result_.scans, record);
    result_.scans.push_back(std::move(record));
    if (!uses_left_.contains(step.id) && !options_.keep_scans) return;
    load(step.id, std::move(made.scene));
    if (options_.cache != nullptr)
      options_.cache->keep(keys_.at(step.id), {loaded_.at(step.id), result_.scans.back()});
  }

  /// Computes both kernels' answers to a step, and the bound within which they must agree.
  Object answer(const Step& step, const void* value, Object object) {
    const Operation& operation = step.action.operation();
    if (operation.voxel)
      operation.voxel(value,
                      {result_.universe,
                       result_.objects,
                       scan_,
                       result_.timings,
                       {options_.stop, {}},
                       plan_.folder,
                       result_.scans},
                      object.voxel);
    object.findings.insert(object.findings.end(), object.voxel.findings.begin(), object.voxel.findings.end());
    if (with_mesh_.contains(step.id)) make_mesh(step, value, object);
    if (!operation.voxel) voxelise(object);
    operation.bound(value, {result_.universe, result_.objects, scan_, plan_.folder}, object);
    if (!is_judged(operation, object)) object.findings.emplace_back(mesh_alone);
    object.bound.shift_mm += object.mesh.shift_mm;
    take_within(object);
    return object;
  }

  /// Computes the answer of a step. If the step chooses connected parts, both kernels must choose the same
  /// ones. Whether a neck thinner than a few voxels exists depends on the kernel, so a part that only one
  /// kernel connects by such a neck stays in both answers, with a finding. There is no finding if the plan
  /// states that the part stays.
  Object agreed_answer(const Step& step, const void* value, const Object& begun) {
    constexpr int most_rounds = 4;
    Object made = answer(step, value, begun);
    std::vector<verify::OpenPart> kept, open;
    std::vector<glm::dvec3> also_mm;
    for (int round = 0; made.mesh.within; ++round) {
      const Stopwatch watch(result_.timings, "bridges");
      open = verify::open_parts(made.voxel.octree, *made.mesh.within, made.witness);
      if (open.empty() || round == most_rounds) break;
      for (const verify::OpenPart& part : open)
        also_mm.insert(also_mm.end(), part.part_mm.begin(), part.part_mm.end());
      const std::shared_ptr<void> more = step.action.operation().with_parts(value, also_mm);
      if (!more) break;
      const verify::PartChoice& own = made.witness.choices().back();
      std::copy_if(open.begin(), open.end(), std::back_inserter(kept), [&](const verify::OpenPart& part) {
        return !own.necks || !own.necks->keeps(part.part_mm, part.bridge.at_mm);
      });
      made = answer(step, more.get(), begun);
    }
    add_kept_parts(std::move(kept), open, made);
    return made;
  }

  /// Makes the object of a step in both kernels, and certifies it or adds it to the objects to certify.
  void make(const Step& step) {
    const Operation& operation = step.action.operation();
    Object object(step.id, operation.name, result_.universe);
    std::shared_ptr<void> settled;
    nlohmann::ordered_json told = nlohmann::ordered_json::object();
    if (operation.settle)
      settled = operation.settle(step.action.value(), {result_.objects,
                                                       scan_,
                                                       result_.timings,
                                                       {options_.stop, {}},
                                                       plan_.folder,
                                                       told,
                                                       object.findings,
                                                       [this](const std::string& name) -> const Action* {
                                                         for (const Step& made_by : plan_.steps)
                                                           if (made_by.id == name) return &made_by.action;
                                                         return nullptr;
                                                       }});
    const void* value = settled ? settled.get() : step.action.value();
    object.is_tool = operation.is_tool;
    object.definition = operation.definition(value, result_.objects);
    object = operation.with_parts ? agreed_answer(step, value, object) : answer(step, value, object);
    object.mesh.details.update(told);
    object.voxel.measures = voxel::measure(object.voxel.octree);
    const MadeOf made_of{step.action, result_.objects, scan_, result_.scans};
    add_caveats(made_of, object);
    if (grows()) need_room(result_.objects, object, least_universe_, room_);
    add_border_finding(step, object);
    add_makers(made_of, !told.empty(), object);
    if (options_.prepares_files) prepare_files_of(object);
    if (has_certificate(object) && options_.certify && options_.meshes && !object.is_tool &&
        is_judged(operation, object)) {
      if (certifies_beside()) {
        Uncertified& made = uncertified_.emplace_back(Uncertified{object, result_.objects.size(), {}, {}});
        made.certify = [&made](const std::stop_token& stop) {
          certify_made(made.object, made.timings, stop);
        };
      } else {
        certify_made(object, result_.timings, options_.stop);
      }
    }
    if (object.ends_with_universe) {
      object.mesh.whole = object.mesh.within;
      object.witness = verify::cut_by_box(object.witness, box_);
    }
    if (options_.cache != nullptr && !options_.only_look_up) options_.cache->keep(key_of(step), object);
    result_.objects.add(std::move(object));
  }

  /// Whether the universe may grow for an object. It stays as it is for a piece that is being dragged, which
  /// is made again for each picture; a finding states what is cut off.
  bool grows() const { return options_.meshes || !options_.only_look_up; }

  /// For an evaluation by voxels alone, adds a finding if an object ends at the universe's border: there is
  /// no mesh that extends beyond it. Adds none if an operand ends there too, for example because the scan
  /// does.
  void add_border_finding(const Step& step, Object& object) const {
    if (options_.meshes || object.is_tool || !object.ends_with_universe || object.kind == "combine") return;
    const auto touches = [](const Object& each) {
      if (each.voxel.octree.is_empty()) return false;
      const voxel::VoxelRange range = voxel::range_of(each.voxel.octree);
      return glm::any(glm::equal(range.low, glm::ivec3(0))) ||
             glm::any(glm::equal(range.high, glm::ivec3(each.voxel.octree.universe().side() - 1)));
    };
    if (!touches(object)) return;
    for (const std::string& used : objects_used(step.action))
      if (touches(result_.objects.at(used))) return;
    object.findings.push_back("the object reaches the border of the universe (" + plain(box_) +
                              ") and is cut off there, because this answer was computed by the voxel kernel "
                              "alone: certify the object, which enlarges the universe if there is room");
  }

  /// Whether files are prepared. That takes longest, so certificates wait for it, and run in parallel with
  /// it.
  bool prepares_files() const {
    return options_.prepares_files &&
           std::any_of(plan_.steps.begin(), plan_.steps.end(),
                       [](const Step& step) { return step.action.operation().prepare_file != nullptr; });
  }

  /// Whether certificates are computed in the background. With a cache they are not, because an object is
  /// stored together with its certificate.
  bool certifies_beside() const { return options_.cache == nullptr; }

  static void certify_made(Object& object, Timings& timings, const std::stop_token& stop) {
    // Certificates run in parallel, so the sum of their times is larger than the elapsed time.
    const Stopwatch watch(timings, "certify");
    certify(object, object.id + " = " + object.definition, {stop, {}});
  }

  /// Starts to prepare the files that need this object and whose other objects are already made.
  void prepare_files_of(const Object& object) {
    const auto is_made = [&](const std::string& id) {
      return id == object.id || std::any_of(result_.objects.begin(), result_.objects.end(),
                                            [&](const Object& made) { return made.id == id; });
    };
    std::vector<Action> actions;
    std::vector<std::string> steps;
    for (const Step& step : plan_.steps) {
      if (!step.action.operation().prepare_file) continue;
      const std::vector<std::string> used = objects_used(step.action);
      if (std::find(used.begin(), used.end(), object.id) == used.end() ||
          !std::all_of(used.begin(), used.end(), is_made))
        continue;
      actions.push_back(step.action);
      steps.push_back(step.id);
    }
    if (actions.empty()) return;
    Objects objects = result_.objects;
    objects.add(object);
    const auto begun = std::make_shared<FilePreparation>(std::move(actions), result_.universe,
                                                         std::move(objects), options_.stop);
    for (const std::string& step : steps) result_.file_preparations[step] = begun;
  }

  /// Whether the certificate can compare the mesh with something independent of it: with voxels of the voxel
  /// kernel, or with a witness.
  static bool is_judged(const Operation& operation, const Object& object) {
    return operation.voxel || verify::is_reshaped(object.witness) || verify::is_scan_blend(object.witness);
  }

  /// Makes the voxels of an answer that only the mesh kernel has computed. Throws std::runtime_error if it
  /// has no mesh.
  void voxelise(Object& object) {
    if (!object.mesh.whole)
      throw std::runtime_error(object.findings.empty() ? "there is no mesh to make voxels of"
                                                       : object.findings.front());
    const Stopwatch watch(result_.timings, "voxelise");
    planner::voxelise(*object.mesh.whole, result_.universe, object.voxel);
    object.witness = verify::witness_of_surface(*object.mesh.whole);
  }

  /// Computes the mesh kernel's answer. Adds a finding if it has none.
  void make_mesh(const Step& step, const void* value, Object& object) {
    const Operation& operation = step.action.operation();
    if (!operation.mesh) return object.findings.push_back("no mesh: the mesh kernel does not do this");
    for (const std::string& name : objects_used(step.action))
      if (!result_.object(name).mesh.whole)
        return object.findings.push_back("no mesh, as '" + name + "' has none");
    try {
      operation.mesh(value,
                     {box_.low_mm,
                      box_.high_mm,
                      result_.objects,
                      scan_,
                      *expressions_,
                      result_.timings,
                      {options_.stop, {}},
                      plan_.folder},
                     object.mesh);
      object.findings.insert(object.findings.end(), object.mesh.findings.begin(), object.mesh.findings.end());
    } catch (const std::runtime_error& error) {
      if (fault_of(error) == Fault::Cancelled) throw;
      object.findings.push_back(std::string("the mesh kernel has no answer: ") + error.what());
    }
  }

  /// Cuts the mesh at the border of the universe, where the voxels end. Adds a finding if a part lies
  /// outside; masks are exempt, because they normally extend beyond it.
  void take_within(Object& object) {
    object.mesh.within = object.mesh.whole;
    if (!object.mesh.whole || object.mesh.whole->empty()) return;
    const brep::Size& size = object.mesh.whole->size();
    const bool inside = glm::all(glm::greaterThanEqual(size.low_mm, box_.low_mm)) &&
                        glm::all(glm::lessThanEqual(size.high_mm, box_.high_mm));
    if (inside) return;
    const Stopwatch watch(result_.timings, "boolean_mesh");
    try {
      brep::BooleanResult cut =
          brep::boolean(*object.mesh.whole, brep::Operation::Intersection, world_, options_.stop);
      object.mesh.within = std::move(cut.solid);
      object.bound.shift_mm += cut.shift_mm;
    } catch (const std::runtime_error& error) {
      if (fault_of(error) == Fault::Cancelled) throw;
      object.mesh.within.reset();
      object.findings.push_back(std::string("the mesh kernel cannot cut it at the universe's border: ") +
                                error.what());
    }
    add_part_outside(box_, object);
  }

  const Plan& plan_;
  const EvaluateOptions& options_;
  const std::optional<voxel::Box> room_;
  voxel::Universe least_universe_;  ///< before it was enlarged
  Evaluation result_;
  double told_ = 0.0;  ///< fraction of the progress that was reported last
  std::map<std::string, LoadedScan> loaded_;
  std::map<std::string, std::size_t> uses_left_;
  std::set<std::string> wanted_, with_mesh_;      ///< steps
  std::map<std::string, std::string> scan_keys_;  ///< keys of the plan's scans; only with a cache
  std::map<std::string, std::string> keys_;       ///< keys of the steps; only with a cache
  const Scans scan_ = [this](const std::string& name) -> const LoadedScan& { return loaded_.at(name); };
  voxel::Box box_;  ///< box of the universe
  brep::Solid world_;
  std::unique_ptr<verify::MeshExpressions> expressions_;
  /// An object that is not certified yet, its index among the objects, and the time that certifying it has
  /// taken.
  struct Uncertified {
    Object object;
    std::size_t index = 0;
    Timings timings;
    std::function<void(const std::stop_token&)> certify;
  };
  std::deque<Uncertified> uncertified_;  ///< numbered like the background tasks
  std::size_t begun_ = 0;                ///< number of objects whose task has been started
  /// Runs the certificates. Must be the last member, so that the tasks end before the objects that they use
  /// are destroyed.
  BackgroundTasks background_{options_.stop};
};

}  // namespace

Evaluation evaluate(const Plan& plan, const EvaluateOptions& options) {
  for (std::optional<voxel::Box> room;;) {
    try {
      return Evaluator(plan, options, room).run();
    } catch (const NeedsRoom& needs) {
      room = needs.box_mm;
    }
  }
}

}  // namespace octotomy::planner
