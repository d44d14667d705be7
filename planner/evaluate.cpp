// SPDX-License-Identifier: AGPL-3.0-or-later
//
// Steps are evaluated in order, each in both kernels before the next:
//   1 Read every scan once; sample it into a grey octree, keep its samples for isosurfaces until the last
//     window that needs them.
//   2 Voxel kernel: windows on the grey octree, masks symbolic, expressions on octrees, motions composed.
//   3 Mesh kernel: isosurface of the scan's own samples, prisms of the masks, corefinement, moved vertices.
//   4 Certify: only here do the two answers meet.
// Invariant: nothing of step 3 is computed from an octree, nothing of step 2 from a mesh.
#include "planner/evaluate.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "brep/move.h"
#include "brep/prism.h"
#include "brep/triangles.h"
#include "convert/isosurface.h"
#include "planner/sha256.h"
#include "verify/expression_on_meshes.h"
#include "voxel/combine.h"
#include "voxel/read_image_stack.h"
#include "voxel/read_scene.h"

namespace octotomy::planner {
namespace {

/// A plane that an object was cut along and that ran along the universe's planes when it was: where it lies
/// now, and the axis of its normal then.
struct CutPlane {
  int axis = 0;
  glm::dvec3 normal{1, 0, 0};
  double offset_mm = 0.0;
  double voxels = 1.0;  ///< how much a piece of it may err, in what a cut's of that area may
};

/// What an object is made from, beside what a report shows of it.
struct Making {
  explicit Making(voxel::Expression expression) : symbol(std::move(expression)) {}

  /// Down to windows on samples, so that a motion moves those: an octree that moves by a part of a voxel
  /// would go by a whole one or none.
  voxel::Expression symbol;
  /// The mesh kernel's answer as it is, wherever it reaches; the object's mesh is what of it is in the
  /// universe.
  verify::SharedMesh solid;
  std::vector<CutPlane> planes;
  glm::dvec3 spacing_mm{0.0};  ///< of the coarsest scan it comes from; zero where it comes from none
  std::string voxel_lineage, mesh_lineage;
  std::optional<voxel::Box> scan_box_mm;  ///< of the scan that it comes from, where it has not moved
  bool voxels_are_samples = false;
};

struct LoadedScan {
  voxel::Scene scene;
  voxel::GreyOctree grey;
};

/// How far a vertex that lies on a plane may be from it after rigid motions of coordinates as large as
/// `reach_mm`: a few roundings of a dot product of three terms.
double on_plane_mm(double reach_mm) {
  return 64.0 * std::numeric_limits<double>::epsilon() * reach_mm;
}

/// Area of the mesh's triangles that lie on the planes, by the planes' axes, each by how much it may err.
glm::dvec3 area_on_planes(const brep::Mesh& mesh, const std::vector<CutPlane>& planes) {
  glm::dvec3 area_mm2(0.0);
  if (planes.empty()) return area_mm2;
  for (const auto face : mesh.faces()) {
    glm::dvec3 corner[3];
    int count = 0;
    for (const auto vertex : face.vertices()) {
      const auto& p = mesh.point(vertex);
      corner[count++] = glm::dvec3(p[0], p[1], p[2]);
    }
    const double reach_mm = glm::length(corner[0]) + glm::length(corner[1]) + glm::length(corner[2]);
    for (const CutPlane& plane : planes) {
      const auto off = [&](const glm::dvec3& p) {
        return std::abs(glm::dot(plane.normal, p) - plane.offset_mm);
      };
      if (std::max({off(corner[0]), off(corner[1]), off(corner[2])}) > on_plane_mm(reach_mm)) continue;
      area_mm2[plane.axis] +=
          plane.voxels * 0.5 * glm::length(glm::cross(corner[1] - corner[0], corner[2] - corner[0]));
      break;
    }
  }
  return area_mm2;
}

/// The planes through a region's edges that are normal to a universe axis: those whose normal is so but for
/// the rounding of a view's unit vectors.
std::vector<CutPlane> planes_of(const voxel::RegionMask& mask) {
  constexpr double rounding = 8.0 * std::numeric_limits<double>::epsilon();
  std::vector<CutPlane> planes;
  for (const voxel::Region& region : mask.regions)
    for (const auto& polygon : region.polygons_mm)
      for (std::size_t i = 0; i < polygon.size(); ++i) {
        const glm::dvec2 &a = polygon[i], &b = polygon[(i + 1) % polygon.size()];
        if (a == b) continue;
        const glm::dvec2 across = glm::normalize(glm::dvec2(a.y - b.y, b.x - a.x));
        const glm::dvec3 normal = across.x * region.view.right + across.y * region.view.up;
        for (int axis = 0; axis < 3; ++axis)
          if (std::abs(normal[axis]) >= 1.0 - rounding) planes.push_back({axis, normal, glm::dot(across, a)});
      }
  return planes;
}

/// Where a solid ends with its scan, mesh and voxels end up to half a sample apart, not half a voxel.
std::vector<CutPlane> ends_of(const voxel::Box& scan, const glm::dvec3& sample_mm,
                              const glm::dvec3& voxel_mm) {
  std::vector<CutPlane> planes;
  for (int axis = 0; axis < 3; ++axis)
    for (const double at_mm : {scan.low_mm[axis], scan.high_mm[axis]}) {
      glm::dvec3 normal(0.0);
      normal[axis] = 1.0;
      planes.push_back({axis, normal, at_mm, sample_mm[axis] / voxel_mm[axis]});
    }
  return planes;
}

std::vector<CutPlane> moved_planes(std::vector<CutPlane> planes, const glm::dmat4& moved_from_still) {
  for (CutPlane& plane : planes) {
    const glm::dvec3 point = glm::dvec3(moved_from_still * glm::dvec4(plane.normal * plane.offset_mm, 1.0));
    plane.normal = glm::dmat3(moved_from_still) * plane.normal;
    plane.offset_mm = glm::dot(plane.normal, point);
  }
  return planes;
}

/// A region's prism, from before the nearest to behind the farthest corner of the box by more than its size,
/// so that no end of a prism comes into the universe, nor does one of a moved prism.
brep::Prism prism_of(const voxel::Region& region, const voxel::Box& box) {
  const double size_mm = glm::length(box.high_mm - box.low_mm);
  const double middle_mm = glm::dot(region.view.look, (box.low_mm + box.high_mm) * 0.5);
  return {region.view.look,          region.view.up,           region.view.right, region.polygons_mm,
          middle_mm - 1.6 * size_mm, middle_mm + 1.6 * size_mm};
}

brep::Prism prism_of(const voxel::Box& box) {
  const glm::dvec3 a = box.low_mm, b = box.high_mm;
  return {{0, 1, 0}, {0, 0, 1}, {1, 0, 0}, {{{a.x, a.z}, {b.x, a.z}, {b.x, b.z}, {a.x, b.z}}}, a.y, b.y};
}

std::string number(double value) {
  std::string text = std::to_string(value);
  text.erase(text.find_last_not_of('0') + 1);
  if (text.back() == '.') text.pop_back();
  return text;
}

std::string place(const voxel::Box& box) {
  const auto axis = [&](char name, int i) {
    return std::string(1, name) + " " + number(box.low_mm[i]) + ".." + number(box.high_mm[i]);
  };
  return axis('x', 0) + ", " + axis('y', 1) + ", " + axis('z', 2) + " mm";
}

[[noreturn]] void refuse_missing(const std::string& name, const std::filesystem::path& path) {
  throw std::runtime_error("scan '" + name + "': " + path.string() +
                           ": no such file or folder; correct the plan or use --scan " + name + "=PATH");
}

/// Whether every voxel's centre within the scan is one of its samples, to rounding.
bool on_samples(const voxel::Lattice& scan, const voxel::Lattice& universe) {
  const glm::dvec3 first = scan.voxel(universe.lps_mm(glm::dvec3(0.0)));
  for (int axis = 0; axis < 3; ++axis) {
    glm::dvec3 step(0.0);
    step[axis] = 1.0;
    const glm::dvec3 next = scan.voxel(universe.lps_mm(step)) - first;
    // A dot product of three terms, in voxels of the largest universe.
    constexpr double rounding = 4096.0 * 64.0 * std::numeric_limits<double>::epsilon();
    if (glm::distance(next, step) > rounding / 4096.0) return false;
    if (std::abs(first[axis] - std::round(first[axis])) > rounding) return false;
  }
  return true;
}

/// One evaluation in progress.
class Evaluator {
 public:
  Evaluator(const Plan& plan, const EvaluateOptions& options) : plan_(plan), options_(options) {}

  Evaluation run() {
    check_masks();
    read_scans();
    std::size_t done = 0;
    for (const Step& step : plan_.steps) {
      report(verb(step) + " " + step.id,
             static_cast<double>(done++) / static_cast<double>(plan_.steps.size()));
      try {
        std::visit([&](const auto& action) { evaluate_step(step.id, action); }, step.action);
      } catch (const Stopped&) {
        throw;
      } catch (const std::runtime_error& error) {
        throw std::runtime_error("step '" + step.id + "': " + error.what());
      } catch (const std::invalid_argument& error) {
        throw std::runtime_error("step '" + step.id + "': " + error.what());
      }
    }
    report("evaluated", 1.0);
    return std::move(result_);
  }

 private:
  void report(const std::string& doing, double fraction) const {
    if (options_.stop.stop_requested()) throw Stopped("stopped before '" + doing + "': nothing was written");
    if (options_.progress) options_.progress(doing, fraction);
  }

  /// Polygons that no solid can be swept from are refused before a scan is read.
  void check_masks() const {
    for (const Step& step : plan_.steps)
      if (const auto* mask = std::get_if<MaskStep>(&step.action))
        for (const voxel::Region& region : mask_of(*mask).regions) try {
            brep::mesh_of(prism_of(region, {glm::dvec3(0.0), glm::dvec3(1.0)}));
          } catch (const std::invalid_argument& error) {
            throw std::runtime_error("step '" + step.id + "': " + error.what());
          }
  }

  /// The scans that windows use, the first window's first: it fixes the universe.
  std::vector<std::string> scans_in_use() {
    std::vector<std::string> names;
    for (const Step& step : plan_.steps)
      if (const auto* window = std::get_if<WindowStep>(&step.action))
        if (windows_left_[window->scan]++ == 0) names.push_back(window->scan);
    if (names.empty()) names.push_back(plan_.scans.begin()->first);
    return names;
  }

  void read_scans() {
    for (const std::string& name : scans_in_use()) {
      report("read " + name, 0.0);
      const ScanSource& source = plan_.scans.at(name);
      const std::filesystem::path path = scan_path(plan_, source);
      ScanRecord record;
      voxel::Scene scene;
      {
        const Stopwatch watch(result_.timings, "read");
        if (!std::filesystem::exists(path) && voxel::image_files(path).empty()) refuse_missing(name, path);
        record.sha256 = sha256_of_path(path);
        if (source.sha256 && *source.sha256 != record.sha256)
          throw std::runtime_error("scan '" + name + "': " + path.string() + " has SHA-256 " + record.sha256 +
                                   ", the plan wants " + *source.sha256 + ": it is another scan");
        voxel::ReadOptions read = source.read;
        read.stop = options_.stop;
        scene = voxel::read_scene(path, read);
        voxel::check(scene);
      }
      record.name = name;
      record.path = source.path;
      record.lattice = scene.lattice;
      record.meaning = scene.meaning;
      record.modality = scene.modality;
      record.unit = voxel::unit(scene);
      record.range = voxel::range(scene);
      record.audit = scene.audit;
      if (result_.scans.empty()) {
        result_.universe = universe_of(scene.lattice, plan_.voxel_mm);
        box_ = voxel::bounds(result_.universe.lattice());
        world_ = shared(brep::mesh_of(prism_of(box_)));
        meshes_ = std::make_unique<verify::MeshExpressions>(world_);
      }
      result_.scans.push_back(std::move(record));
      const Stopwatch watch(result_.timings, "octree");
      voxel::GreyOctree grey = voxel::grey_octree_of(result_.universe, scene, background_of(scene));
      loaded_.emplace(name, LoadedScan{std::move(scene), std::move(grey)});
    }
  }

  /// Beyond the scan is what the scan has least of: air.
  static std::int16_t background_of(const voxel::Scene& scene) {
    const double low = std::floor(std::min(voxel::range(scene).low, -1024.0));
    return static_cast<std::int16_t>(std::max(low, -32768.0));
  }

  voxel::Octree combined(const voxel::Expression& expression) {
    const Stopwatch watch(result_.timings, "boolean_voxel");
    return voxel::combine(result_.universe, expression);
  }

  void evaluate_step(const std::string& id, const WindowStep& step) {
    const LoadedScan& scan = loaded_.at(step.scan);
    const std::string unit = voxel::unit(scan.scene) == "1" ? "" : " " + voxel::unit(scan.scene);
    Object object = fresh(
        id, "window",
        step.scan + " from " + number(step.low) + (step.high ? " to " + number(*step.high) : "") + unit);
    {
      const Stopwatch watch(result_.timings, "octree");
      object.octree = voxel::combine(result_.universe, voxel::Expression(window_of(step)));
    }
    if (object.octree.is_empty()) {
      const voxel::Range range = voxel::range(scan.scene);
      throw std::runtime_error("no voxel of scan '" + step.scan +
                               "' is in the window; its samples are from " + number(range.low) + " to " +
                               number(range.high) + unit + ": choose within them");
    }
    // Depth is interpolated where samples pass the lower bound; an upper bound inside the object breaks that.
    if (!step.high) {
      object.grey = scan.grey;
      object.threshold = step.low;
      object.scan = step.scan;
    }
    Making making{within_universe(voxel::Expression(window_of(step)))};
    making.spacing_mm = scan.scene.lattice.spacing_mm();
    making.scan_box_mm = voxel::bounds(scan.scene.lattice);
    making.voxels_are_samples = on_samples(scan.scene.lattice, result_.universe.lattice());
    making.voxel_lineage = "window on a grey octree of the scan";
    making.mesh_lineage = "isosurface of the scan's own samples";
    {
      const Stopwatch watch(result_.timings, "isosurface");
      const double high = step.high.value_or(std::numeric_limits<double>::infinity());
      making.solid = shared(brep::mesh_of(convert::isosurface(scan.scene, step.low, high)));
    }
    keep(std::move(object), std::move(making));
    if (--windows_left_[step.scan] == 0) loaded_.erase(step.scan);
  }

  void evaluate_step(const std::string& id, const MaskStep& step) {
    const voxel::RegionMask mask = mask_of(step);
    std::string views;
    for (const RegionText& region : step.regions)
      views += (views.empty() ? "regions in " : ", ") + region.view;
    Object object = fresh(id, "mask", views);
    object.octree = combined(voxel::Expression(mask));
    if (object.octree.is_empty())
      throw std::runtime_error(
          "the mask holds no voxel: its regions miss each other or the universe, which spans " + place(box_) +
          "; draw them within it");
    Making making{voxel::Expression(mask)};
    making.planes = planes_of(mask);
    making.voxel_lineage = "regions projected at voxel centres";
    making.mesh_lineage = "prisms of the regions";
    mesh_work(object, making, {}, [&] {
      brep::Mesh solid = brep::mesh_of(prism_of(mask.regions.front(), box_));
      for (std::size_t i = 1; i < mask.regions.size(); ++i)
        solid = brep::boolean(solid, brep::Operation::Intersection,
                              brep::mesh_of(prism_of(mask.regions[i], box_)))
                    .mesh;
      return shared(std::move(solid));
    });
    if (making.solid) object.cuts = {{id, making.solid}};
    keep(std::move(object), std::move(making));
  }

  void evaluate_step(const std::string& id, const CombineStep& step) {
    Object object = fresh(id, "combine", step.expression);
    voxel::Names operands, symbols;
    operands.object = [&](std::string_view name) {
      // A mask decides voxels by their centre just as its octree does, and needs no walk over a tree.
      const Object& operand = result_.object(std::string(name));
      return operand.kind == "mask" ? makings_.at(operand.id).symbol : voxel::Expression(operand.octree);
    };
    symbols.object = [&](std::string_view name) { return makings_.at(std::string(name)).symbol; };
    object.octree = combined(voxel::parse_expression(step.expression, operands));
    Making making{within_universe(voxel::parse_expression(step.expression, symbols))};
    making.voxel_lineage = "Boolean of octrees";
    making.mesh_lineage = "corefinement of meshes";
    const auto names = voxel::names_in(step.expression);
    inherit_samples(object, names);
    for (const std::string& name : names) {
      const std::vector<Cut>& cuts = result_.object(name).cuts;
      object.cuts.insert(object.cuts.end(), cuts.begin(), cuts.end());
      const Making& from = makings_.at(name);
      making.planes.insert(making.planes.end(), from.planes.begin(), from.planes.end());
      making.spacing_mm = glm::max(making.spacing_mm, from.spacing_mm);
      if (from.scan_box_mm) making.scan_box_mm = from.scan_box_mm;
    }
    mesh_work(object, making, names, [&] {
      auto solid = meshes_->evaluate(
          step.expression, [&](std::string_view name) { return makings_.at(std::string(name)).solid; });
      object.findings = meshes_->findings();
      return solid;
    });
    keep(std::move(object), std::move(making));
  }

  void evaluate_step(const std::string& id, const MoveStep& step) {
    const glm::dmat4 motion = voxel::moved_from_still(motion_of(step));
    std::string definition = step.object + " moved by (" + number(step.translate_mm.x) + ", " +
                             number(step.translate_mm.y) + ", " + number(step.translate_mm.z) + ") mm";
    if (step.rotate) definition += ", turned by " + number(step.rotate->degrees) + "\u00b0";
    Object object = fresh(id, "move", definition);
    const Making& still = makings_.at(step.object);
    Making making(moved(still.symbol, motion));
    object.octree = combined(making.symbol);
    inherit_samples(object, {step.object});
    object.moved_from_still = motion * object.moved_from_still;
    object.moved = Object::Moved{step.object, motion};
    object.cuts = result_.object(step.object).cuts;
    for (Cut& cut : object.cuts) cut.moved_from_still = motion * cut.moved_from_still;
    making.planes = still.planes;
    if (still.scan_box_mm) {
      const auto ends =
          ends_of(*still.scan_box_mm, still.spacing_mm, result_.universe.lattice().spacing_mm());
      making.planes.insert(making.planes.end(), ends.begin(), ends.end());
    }
    making.planes = moved_planes(std::move(making.planes), motion);
    making.spacing_mm = still.spacing_mm;
    making.voxel_lineage = "what the object is made of under a rigid motion, windows on interpolated samples";
    making.mesh_lineage = "vertices of a mesh under a rigid motion";
    mesh_work(object, making, {step.object}, [&] { return shared(brep::moved(*still.solid, motion)); });
    keep(std::move(object), std::move(making));
  }

  void evaluate_step(const std::string& id, const MeasureStep& step) {
    Measured measured{id, 0, std::nullopt, step.points_mm};
    if (step.points_mm.empty()) measured.object = index_.at(step.object);
    if (step.to) measured.to = index_.at(*step.to);
    result_.measured.push_back(std::move(measured));
  }

  void evaluate_step(const std::string&, const ExportStep&) {}

  voxel::Window window_of(const WindowStep& step) const {
    voxel::Window window{loaded_.at(step.scan).grey, step.low};
    if (step.high) window.high = *step.high;
    return window;
  }

  /// What of a symbol is in the universe: an object ends there, also when it moves on.
  voxel::Expression within_universe(const voxel::Expression& symbol) const {
    return symbol & voxel::Expression(box_);
  }

  /// A piece cut from one window shows that window's samples; a merger of several, or of pieces moved apart,
  /// does not lie where one scan says.
  void inherit_samples(Object& object, const std::vector<std::string>& names) const {
    const Object* source = nullptr;
    for (const std::string& name : names) {
      const Object& operand = result_.object(name);
      if (operand.kind == "mask") continue;
      const bool same =
          source == nullptr || (operand.threshold == source->threshold && operand.scan == source->scan &&
                                operand.moved_from_still == source->moved_from_still);
      if (!operand.grey || !same) return;
      source = &operand;
    }
    if (source == nullptr) return;
    object.grey = source->grey;
    object.threshold = source->threshold;
    object.scan = source->scan;
    object.moved_from_still = source->moved_from_still;
  }

  static verify::SharedMesh shared(brep::Mesh mesh) {
    return std::make_shared<const brep::Mesh>(std::move(mesh));
  }

  Object fresh(const std::string& id, const std::string& kind, const std::string& definition) const {
    Object object(voxel::Octree::empty(result_.universe));
    object.id = id;
    object.kind = kind;
    object.definition = definition;
    return object;
  }

  /// Runs the mesh kernel's part of a step; where it cannot answer, says so and leaves no solid.
  template <typename Work>
  void mesh_work(Object& object, Making& making, const std::vector<std::string>& names, const Work& work) {
    for (const std::string& name : names)
      if (!makings_.at(name).solid) {
        object.findings.push_back("no mesh, as '" + name + "' has none");
        return;
      }
    const Stopwatch watch(result_.timings, "boolean_mesh");
    try {
      making.solid = work();
    } catch (const std::runtime_error& error) {
      object.findings.push_back(std::string("the mesh kernel has no answer: ") + error.what());
    }
  }

  /// The object's mesh: what of its solid is in the universe, as its voxels are. Masks reach beyond by their
  /// nature; a moved piece that does has lost voxels, which is worth saying.
  void take_mesh(Object& object, const Making& making) {
    object.mesh = making.solid;
    if (!object.mesh || object.mesh->n_faces() == 0) return;
    const brep::Measures measures = brep::measure(*object.mesh);
    const bool inside = glm::all(glm::greaterThanEqual(measures.low_mm, box_.low_mm)) &&
                        glm::all(glm::lessThanEqual(measures.high_mm, box_.high_mm));
    if (inside) return;
    const Stopwatch watch(result_.timings, "boolean_mesh");
    try {
      object.mesh = shared(brep::boolean(*making.solid, brep::Operation::Intersection, *world_).mesh);
    } catch (const std::runtime_error& error) {
      object.mesh = nullptr;
      object.findings.push_back(std::string("the mesh kernel cannot cut it at the universe's border: ") +
                                error.what());
    }
    if (making.spacing_mm != glm::dvec3(0.0))
      object.findings.push_back(
          "a part lies outside of the universe (" + place(box_) +
          ") and is left out of every number and picture: move less, or use a scan with more room");
  }

  void certify(Object& object, const Making& making) {
    const Stopwatch watch(result_.timings, "certify");
    verify::BoundInputs inputs;
    inputs.operation = object.id + " = " + object.definition;
    inputs.voxel_lineage = making.voxel_lineage;
    inputs.mesh_lineage = making.mesh_lineage;
    inputs.scan_spacing_mm = making.spacing_mm;
    inputs.flat_cut_mm2 = area_on_planes(*object.mesh, making.planes);
    inputs.scan_box_mm = making.scan_box_mm;
    inputs.voxels_are_samples = making.voxels_are_samples;
    object.certificate = verify::certify_bounded(object.octree, *object.mesh, inputs);
  }

  void keep(Object object, Making making) {
    take_mesh(object, making);
    object.voxel_measures = voxel::measure(object.octree);
    if (object.mesh) object.mesh_measures = brep::measure(*object.mesh);
    if (object.mesh && options_.certify && object.kind != "mask") certify(object, making);
    // An expression ends with the universe, in both kernels alike, also when it moves on.
    if (object.kind == "combine") making.solid = object.mesh;
    index_[object.id] = result_.objects.size();
    makings_.emplace(object.id, std::move(making));
    result_.objects.push_back(std::move(object));
  }

  const Plan& plan_;
  const EvaluateOptions& options_;
  Evaluation result_;
  std::map<std::string, LoadedScan> loaded_;
  std::map<std::string, Making> makings_;
  std::map<std::string, std::size_t> index_;
  std::map<std::string, std::size_t> windows_left_;
  voxel::Box box_;  ///< of the universe
  verify::SharedMesh world_;
  std::unique_ptr<verify::MeshExpressions> meshes_;
};

}  // namespace

const Object& Evaluation::object(const std::string& id) const {
  for (const Object& object : objects)
    if (object.id == id) return object;
  throw std::invalid_argument("no object is called '" + id + "'");
}

voxel::Universe universe_of(const voxel::Lattice& scan, std::optional<double> voxel_mm) {
  const voxel::Box box = voxel::bounds(scan);
  const glm::dvec3 spacing_mm = scan.spacing_mm();
  const glm::dvec3 extent_mm = box.high_mm - box.low_mm;
  constexpr double most_a_side = 512.0;
  const double finest_mm = std::min({spacing_mm.x, spacing_mm.y, spacing_mm.z});
  const double longest_mm = std::max({extent_mm.x, extent_mm.y, extent_mm.z});
  const double edge_mm = voxel_mm.value_or(std::max(finest_mm, longest_mm / most_a_side));
  voxel::Universe universe = voxel::universe_around(box, edge_mm);
  // A universe around an odd number of samples lies half a voxel off them, and resampling would blur what
  // need not be touched: put a voxel's centre on the first sample, where the box stays inside.
  const glm::dvec3 first = universe.lattice().voxel(scan.lps_mm(glm::dvec3(0.0)));
  const double spare_voxels = 0.5 * universe.side();
  for (int axis = 0; axis < 3; ++axis) {
    const double shift = first[axis] - std::floor(first[axis] + 0.5);
    if (0.5 * extent_mm[axis] / edge_mm + std::abs(shift) <= spare_voxels)
      universe.lps_from_voxel[3][axis] += shift * edge_mm;
  }
  return universe;
}

Evaluation evaluate(const Plan& plan, const EvaluateOptions& options) {
  return Evaluator(plan, options).run();
}

}  // namespace octotomy::planner
