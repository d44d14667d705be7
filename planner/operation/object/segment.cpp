// SPDX-License-Identifier: AGPL-3.0-or-later
// Both kernels start from the scan: the voxel kernel from a window on its grey octree, the mesh kernel from
// the isosurface of its own samples. A selection that is only defined on voxels leaves the object without a
// mesh.
#include "planner/operation/object/segment.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <set>

#include "brep/mesh/triangles.h"
#include "convert/surface/fill_cavities.h"
#include "convert/surface/isosurface.h"
#include "planner/operation/file/contour_findings.h"
#include "planner/operation/file/label_table.h"
#include "planner/operation/file/region_file.h"
#include "planner/operation/object/part_choice.h"
#include "planner/operation/object/parts.h"
#include "planner/operation/object/provenance.h"
#include "planner/operation/object/segment_witness.h"
#include "planner/operation/table/json.h"
#include "planner/operation/table/number_format.h"
#include "planner/operation/table/operation.h"
#include "planner/operation/table/same_patient.h"
#include "verify/witness/witness.h"
#include "voxel/filter/components.h"
#include "voxel/filter/label_map.h"
#include "voxel/filter/morphology.h"
#include "voxel/filter/otsu.h"
#include "voxel/filter/region_grow.h"
#include "voxel/filter/tissue.h"
#include "voxel/solid/combine.h"
#include "voxel/solid/grey_owner.h"
#include "voxel/space/error.h"

namespace octotomy::planner {
namespace {

/// The text of a window: the tissue's name, if it is one, and the numbers.
std::string words_of(const SampleWindow& window) {
  const std::optional<voxel::Tissue> tissue = voxel::tissue(window.tissue);
  return tissue ? voxel::described(*tissue) : to_string(window);
}

voxel::Neighbours neighbours_of(const Segment& segment) {
  if (segment.neighbours == 18) return voxel::Neighbours::Edges;
  return segment.neighbours == 26 ? voxel::Neighbours::Corners : voxel::Neighbours::Faces;
}

BridgeDecisions bridges_of(const Segment& segment) {
  return {segment.keep_bridges_mm, segment.cut_bridges_mm, segment.bridge_mm, segment.agreed_mm};
}

bool chooses_parts(const Segment& segment) {
  return segment.largest || segment.components || segment.at_least_mm3;
}

std::vector<glm::ivec3> seed_voxels(const Segment& segment, const voxel::Universe& universe) {
  std::vector<glm::ivec3> seeds;
  for (const glm::dvec3& p_mm : segment.seeds_mm) {
    const glm::ivec3 voxel(glm::floor(universe.lattice().voxel(p_mm) + 0.5));
    if (glm::any(glm::lessThan(voxel, glm::ivec3(0))) ||
        glm::any(glm::greaterThanEqual(voxel, glm::ivec3(universe.side()))))
      throw std::runtime_error("seed " + plain(p_mm.x) + "," + plain(p_mm.y) + "," + plain(p_mm.z) +
                               " mm lies outside the scan");
    seeds.push_back(voxel);
  }
  return seeds;
}

/// The labels in a scan; none if its samples are not labels. A label can be selected by its number in any
/// scan.
std::vector<voxel::Label> labels_or_none(const voxel::Scene& scene) {
  try {
    return voxel::labels(scene);
  } catch (const voxel::InvalidInput&) {
    return {};
  }
}

/// The number of samples that are not whole numbers, as label_of() decides.
std::size_t samples_between_labels(const voxel::Scene& scene) {
  const auto* samples = std::get_if<voxel::FloatSamples>(&scene.samples);
  if (samples == nullptr) return 0;
  return static_cast<std::size_t>(std::count_if(samples->begin(), samples->end(), [](float sample) {
    return std::isfinite(sample) && !voxel::label_of(std::abs(static_cast<double>(sample)));
  }));
}

/// Selects the voxels of one object, step by step.
class Segmenter {
 public:
  Segmenter(const Segment& segment, const SegmentSource& source) : segment_(segment), source_(source) {}

  Segmented run() {
    base();
    refine();
    if (made_.octree.is_empty())
      throw std::runtime_error(source_.name + ": '" + name() + "' holds no voxel" + advice());
    return std::move(made_);
  }

  /// The selection before the steps that refine it.
  const voxel::Octree& base() {
    begin();
    if (!segment_.regions.empty())
      become(voxel::combine(source_.universe, voxel::Expression(made_.octree) & regions()),
             {{"do", "regions"}, {"path", segment_.regions.string()}});
    if (!segment_.tolerance) made_.base = made_.octree;
    return made_.octree;
  }

 private:
  voxel::SliceMask regions() {
    DrawnSlices drawn = read_slices(source_.folder / segment_.regions, SlicesOptions{segment_.structure});
    if (drawn.identity)
      made_.findings = need_same_patient({source_.name, source_.scene.identity},
                                         {segment_.regions.generic_string(), *drawn.identity},
                                         segment_.other_identity, "'other_identity'");
    made_.findings.insert(made_.findings.end(), drawn.findings.begin(), drawn.findings.end());
    if (auto beyond = beyond_scan(drawn.mask, source_.scene.lattice, segment_.regions.string()))
      made_.findings.push_back(std::move(*beyond));
    if (drawn.identity)
      if (auto lacking =
              slices_without_contours(drawn.mask, source_.scene.lattice, segment_.regions.string()))
        made_.findings.push_back(std::move(*lacking));
    return std::move(drawn.mask);
  }

  /// Advice for the error that an object has no voxels.
  std::string advice() const {
    if (made_.steps.size() > 1)
      return " after its " + std::to_string(made_.steps.size()) + " steps: leave some out";
    if (source_.scene.meaning != voxel::Meaning::Label && !segment_.label)
      return ": choose another window; --otsu 3 suggests bounds";
    for (const voxel::Finding& finding : source_.scene.audit)
      if (finding.check == "fractions") return ": " + finding.detail;
    return ": choose another label";
  }

  std::string name() const {
    if (segment_.named) return *segment_.named;
    if (segment_.label) return "label " + std::to_string(*segment_.label);
    if (segment_.clusters) return "class " + std::to_string(segment_.otsu_class.value_or(*segment_.clusters));
    return segment_.window ? words_of(*segment_.window) : "grown";
  }

  void become(voxel::Octree octree, Json step) {
    made_.octree = std::move(octree);
    step["voxels"] = made_.octree.voxel_count();
    made_.steps.push_back(std::move(step));
  }

  void begin() {
    if (segment_.label) {
      for (const voxel::Label& label : labels_or_none(source_.scene))
        if (label.number == *segment_.label) made_.findings = findings_of_labels({label});
      if (const std::size_t between = samples_between_labels(source_.scene); between > 0)
        made_.findings.push_back(std::to_string(between) + (between == 1 ? " sample lies" : " samples lie") +
                                 " between labels and belong to none, for example because the label map was "
                                 "resampled by interpolation: resample it by the nearest sample");
      return become(voxel::octree_of_label(source_.universe, source_.scene, *segment_.label),
                    {{"do", "label"}, {"label", *segment_.label}});
    }
    if (segment_.clusters) {
      const int which = segment_.otsu_class.value_or(*segment_.clusters);
      const voxel::Scene map = voxel::class_map(source_.scene, segment_.classes, {source_.stop, {}});
      return become(voxel::octree_of_label(source_.universe, map, which),
                    {{"do", "cluster"}, {"clusters", *segment_.clusters}, {"class", which}});
    }
    if (segment_.tolerance) {
      voxel::GrowOptions options;
      options.seeds = seed_voxels(segment_, source_.universe);
      options.tolerance = *segment_.tolerance;
      options.neighbours = neighbours_of(segment_);
      options.stop = source_.stop;
      if (segment_.running_mean)
        return become(voxel::grow_by_running_mean(source_.grey(), options),
                      {{"do", "grow"}, {"tolerance", *segment_.tolerance}, {"running_mean", true}});
      return become(voxel::grow_region(source_.grey(), options),
                    {{"do", "grow"}, {"tolerance", *segment_.tolerance}});
    }
    const SampleWindow& window = *segment_.window;
    // Samples outside of the scan are in no window.
    const voxel::Octree within = voxel::combine(source_.universe, voxel::bounds(source_.scene.lattice));
    become(
        voxel::combine(source_.universe,
                       voxel::Expression(window_on(source_.grey(), window)) & voxel::Expression(within)),
        {{"do", "window"}, {"low", window.low}, {"high", window.high ? Json(*window.high) : Json(nullptr)}});
  }

  void go_on() const {
    if (source_.stop.stop_requested()) throw voxel::Stopped("stopped before '" + name() + "' was made");
  }

  void refine() {
    const voxel::Neighbours neighbours = neighbours_of(segment_);
    const double voxel_mm3 = source_.universe.lattice().voxel_mm3();
    go_on();
    if (segment_.open_mm)
      become(voxel::open(made_.octree, *segment_.open_mm),
             {{"do", "open"}, {"radius_mm", *segment_.open_mm}});
    go_on();
    if (!segment_.seeds_mm.empty() && !segment_.tolerance)
      become(voxel::components_at(made_.octree, seed_voxels(segment_, source_.universe), neighbours),
             {{"do", "components_at_seeds"}});
    go_on();
    const BridgeDecisions bridges = bridges_of(segment_);
    if (!bridges.cut_mm.empty())
      become(cut_bridges(made_.octree, bridges), {{"do", "cut_bridges"}, {"count", bridges.cut_mm.size()}});
    const voxel::Octree whole = made_.octree;
    go_on();
    if (segment_.largest || segment_.components) {
      const auto wanted = static_cast<std::size_t>(segment_.components.value_or(1));
      const std::size_t of = voxel::component_count(made_.octree, neighbours);
      become(largest_parts(made_.octree, wanted, neighbours), {{"do", "largest_components"}, {"of", of}});
    }
    go_on();
    if (segment_.at_least_mm3)
      become(voxel::components_of_at_least(
                 made_.octree, static_cast<std::uint64_t>(std::ceil(*segment_.at_least_mm3 / voxel_mm3)),
                 neighbours),
             {{"do", "components_at_least"}, {"volume_mm3", *segment_.at_least_mm3}});
    if (bridges.keeps())
      become(with_kept_parts(made_.octree, whole, bridges, neighbours),
             {{"do", "keep_bridges"}, {"count", bridges.keep_mm.size()}});
    go_on();
    if (segment_.close_mm)
      become(voxel::close(made_.octree, *segment_.close_mm),
             {{"do", "close"}, {"radius_mm", *segment_.close_mm}});
    go_on();
    if (segment_.fill) become(voxel::fill_cavities(made_.octree), {{"do", "fill"}});
  }

  const Segment& segment_;
  const SegmentSource& source_;
  Segmented made_{voxel::Octree::empty(source_.universe)};
};

void check(const Segment& segment, const FieldLocation& place) {
  const int ways = (segment.window ? 1 : 0) + (segment.otsu ? 1 : 0) + (segment.clusters ? 1 : 0) +
                   (segment.tolerance ? 1 : 0) + (segment.label ? 1 : 0) + (segment.named ? 1 : 0);
  if (ways != 1 && place.scope != nullptr)
    place.refuse(
        "needs exactly one of 'window', 'otsu', 'clusters', 'label', 'named', or 'tolerance' together with "
        "'seeds_mm'");
  if (!segment.names.empty() && !segment.named)
    place.at("names").refuse("applies only to 'named': add 'named', or leave it out");
  if (segment.regions.empty() && !segment.structure.empty())
    place.at("structure").refuse("applies only to a structure set: add the set as 'regions'");
  if (segment.regions.empty() && segment.other_identity)
    place.at("other_identity").refuse("applies only to a structure set: add the set as 'regions'");
  if (segment.tolerance && segment.seeds_mm.empty())
    place.at("tolerance").refuse("needs seeds from which the object grows: add 'seeds_mm'");
  const std::optional<int>& classes = segment.otsu ? segment.otsu : segment.clusters;
  if (segment.otsu_class && (!classes || *segment.otsu_class > *classes))
    place.at("class").refuse(classes ? "must be from 1, the darkest, to " + std::to_string(*classes) +
                                           ", one of the classes of 'otsu' or 'clusters'"
                                     : "applies only to 'otsu' or 'clusters': add one of these");
  if (bridges_of(segment).any() && !chooses_parts(segment))
    place.refuse(
        "has 'keep_bridges_mm' or 'cut_bridges_mm', which apply only to a choice of parts: add 'largest', "
        "'components' or 'at_least_mm3'");
  check(bridges_of(segment), place);
  if (segment.neighbours != 6 && segment.neighbours != 18 && segment.neighbours != 26)
    place.at("neighbours").refuse("must be 6 (faces), 18 (edges) or 26 (corners)");
}

Segment settle(const Segment& segment, const SettleBench& bench) {
  Segment settled = segment;
  if (segment.named) {
    const voxel::Scene& scene = bench.scan(segment.scan.name).scene();
    settled.label = label_of_name(segment, scene.source, scene, bench.folder, bench.findings);
    bench.details["label"] = *settled.label;
  }
  if (segment.clusters) {
    Clusters found = clusters_of(bench.scan(segment.scan.name).scene(), *segment.clusters, bench.progress);
    settled.classes = std::move(found.classes);
    bench.details["centres"] = found.suggestion["centres"];
  }
  if (!segment.otsu) return settled;
  OtsuWindow found = otsu_window(bench.scan(segment.scan.name).scene(), *segment.otsu,
                                 segment.otsu_class.value_or(*segment.otsu));
  settled.window = found.window;
  bench.details["thresholds"] = found.suggestion["thresholds"];
  return settled;
}

std::string definition(const Segment& segment, const Objects&) {
  std::string text = segment.scan.name;
  if (segment.window) text += " in " + words_of(*segment.window);
  if (segment.named)
    text += ", '" + *segment.named + "'";
  else if (segment.label)
    text += ", label " + std::to_string(*segment.label);
  if (segment.clusters)
    text += ", class " + std::to_string(segment.otsu_class.value_or(*segment.clusters)) + " of " +
            std::to_string(*segment.clusters) + " by density and gradient";
  if (segment.tolerance) text += " grown within " + plain(*segment.tolerance);
  if (segment.running_mean) text += " of its running mean";
  if (!segment.regions.empty()) text += ", within " + segment.regions.filename().string();
  if (segment.open_mm) text += ", opened by " + plain(*segment.open_mm) + " mm";
  if (!segment.seeds_mm.empty() && !segment.tolerance) text += ", parts at seeds";
  if (segment.largest || segment.components)
    text += ", the " + std::to_string(segment.components.value_or(1)) + " largest";
  if (segment.at_least_mm3) text += ", parts of at least " + plain(*segment.at_least_mm3) + " mm\u00b3";
  if (segment.close_mm) text += ", closed by " + plain(*segment.close_mm) + " mm";
  return segment.fill ? text + ", filled" : text;
}

/// The reason why the object has no mesh; null if the mesh kernel can make one.
const char* why_voxels_alone(const Segment& segment) {
  if (segment.label || segment.named)
    return "a label map has no samples between which an isosurface could run";
  if (segment.clusters) return "classes by density and gradient exist for voxels only";
  if (segment.tolerance) return "growing from seeds selects voxels only";
  if (!segment.regions.empty()) return "regions on slices select voxels only";
  if (segment.open_mm || segment.close_mm) return "opening and closing exist for voxels only";
  if (!segment.seeds_mm.empty()) return "seeds select parts of voxels only";
  return segment.neighbours != 6 ? "connection by edges and corners exists for voxels only" : nullptr;
}

std::optional<Segment> with_parts(const Segment& segment, const std::vector<glm::dvec3>& also_mm) {
  if (!chooses_parts(segment) || why_voxels_alone(segment) != nullptr) return std::nullopt;
  Segment more = segment;
  more.agreed_mm.insert(more.agreed_mm.end(), also_mm.begin(), also_mm.end());
  return more;
}

void voxels(const Segment& segment, const VoxelBench& bench, VoxelSide& made) {
  const LoadedScan& scan = bench.loaded(segment.scan.name);
  const Stopwatch watch(bench.timings, "segment");
  const auto grey = [&]() -> const voxel::GreyOctree& { return scan.grey; };
  Segmented chosen = segmented(segment, {"scan '" + segment.scan.name + "'", scan.scene(), bench.universe,
                                         grey, bench.folder, bench.progress.stop});
  made.octree = std::move(chosen.octree);
  made.findings.insert(made.findings.end(), chosen.findings.begin(), chosen.findings.end());
  made.lineage = "voxels of a window on a grey octree of the scan";
  if (why_voxels_alone(segment) != nullptr) {
    made.symbol = voxel::with_samples(voxel::Expression(made.octree), voxel::all_samples(scan.grey));
    made.lineage = "voxels chosen in the scan";
    return;
  }
  // The window stays in the expression, because it places the surface within a voxel, and a motion
  // interpolates its samples.
  made.symbol = bench.within_universe(window_on(scan.grey, *segment.window)) &
                voxel::Expression(voxel::bounds(scan.scene().lattice));
  made.symbol = cut_bridges(*made.symbol, bridges_of(segment));
  if (!chooses_parts(segment) && !segment.fill) return;
  const voxel::Octree window = bench.combined(*made.symbol);
  const voxel::Octree kept = bench.combined(voxel::Expression(made.octree) & voxel::Expression(window));
  if (chooses_parts(segment)) made.symbol = symbol_of_parts(*made.symbol, window, kept);
  if (segment.fill) made.symbol = symbol_of_filled(*made.symbol, kept, made.octree);
}

/// The mesh of the window with cut bridges, before parts are selected. Adds to `shift_mm` as cut_bridges().
brep::Solid window_mesh(const Segment& segment, const voxel::Scene& scene, const std::stop_token& stop,
                        double& shift_mm) {
  const brep::Solid whole = brep::trusted_solid(
      brep::mesh_of(convert::isosurface(scene, segment.window->low, segment.window->high_or_infinity())),
      brep::Proof::Construction);
  return cut_bridges(whole, bridges_of(segment), stop, shift_mm);
}
brep::Solid filled(const brep::Solid& solid) {
  return convert::fill_cavities(solid, std::numeric_limits<double>::infinity()).solid;
}

void triangles(const Segment& segment, const MeshBench& bench, MeshSide& made) {
  if (const char* why = why_voxels_alone(segment)) throw std::runtime_error(why);
  const voxel::Scene& scene = bench.samples(segment.scan.name);
  need_hounsfield(*segment.window, scene);
  {
    const Stopwatch watch(bench.timings, "isosurface");
    made.whole = window_mesh(segment, scene, bench.progress.stop, made.shift_mm);
  }
  const Stopwatch watch(bench.timings, "components");
  if (chooses_parts(segment)) {
    std::optional<int> largest;
    if (segment.largest || segment.components) largest = segment.components.value_or(1);
    made.whole =
        brep::trusted_solid(kept_parts(*made.whole, largest, segment.at_least_mm3, bridges_of(segment)).mesh,
                            bridges_of(segment).cut_mm.empty() ? brep::Proof::Construction
                                                               : brep::proof_of_part(made.whole->proof()));
  }
  if (segment.fill) made.whole = filled(*made.whole);
  made.lineage = "isosurface of the scan's own samples";
}

/// Makes the kernels' selections of parts agree, by settle_choice().
void settle_parts(const Segment& segment, const LoadedScan& scan, const voxel::Universe& universe,
                  Object& made) {
  const auto voxels = [&] {
    const voxel::Octree window =
        voxel::combine(universe, cut_bridges(voxel::Expression(window_on(scan.grey, *segment.window)) &
                                                 voxel::Expression(voxel::bounds(scan.scene().lattice)),
                                             bridges_of(segment)));
    return segment.fill ? voxel::fill_cavities(window) : window;
  };
  const auto mesh = [&] {
    double shift_mm = 0.0;
    const brep::Solid whole = window_mesh(segment, scan.scene(), {}, shift_mm);
    return segment.fill ? filled(whole) : whole;
  };
  settle_choice({voxels, mesh, segment.fill ? verify::witness_of_filled(made.witness) : made.witness,
                 static_cast<std::size_t>(segment.components.value_or(1))},
                universe, segment.largest || segment.components ? std::nullopt : segment.at_least_mm3, made);
}

void bound(const Segment& segment, const BoundBench& bench, Object& made) {
  const LoadedScan& scan = bench.scan(segment.scan.name);
  const voxel::Lattice& lattice = scan.scene().lattice;
  made.bound.spacing_mm = lattice.spacing_mm();
  made.bound.scan_box_mm = voxel::bounds(lattice);
  const bool voxels_are_samples = on_samples(lattice, bench.universe.lattice());
  made.bound.voxels_are_samples =
      voxels_are_samples && !(segment.window && on_both_sides(scan.scene(), segment.window->low,
                                                              segment.window->high_or_infinity()));
  made.witness = witness_of_samples(segment, scan, voxels_are_samples);
  // Pictures interpolate the depth where samples cross the lower bound, which would be wrong inside an object
  // with an upper bound.
  if (!segment.window || why_voxels_alone(segment) != nullptr) return;
  made.bound.windows = {{.grey = scan.grey,
                         .threshold = segment.window->low,
                         .scan = segment.scan.name,
                         .samples = scan.shared,
                         .high = segment.window->high_or_infinity()}};
  if (!segment.window->high) made.shown = made.bound.windows.front();
  made.witness = verify::witness_of_window(
      scan.shared, segment.window->low, segment.window->high_or_infinity(), bench.universe, scan.grey.step());
  const BridgeDecisions bridges = bridges_of(segment);
  made.witness = cut_bridges(std::move(made.witness), bridges);
  if (chooses_parts(segment) && made.mesh.whole) settle_parts(segment, scan, bench.universe, made);
  if (chooses_parts(segment))
    made.witness = made.mesh.whole
                       ? verify::witness_of_parts(made.witness,
                                                  {made.voxel.octree, *made.mesh.whole, bridges.decided_mm(),
                                                   bridges.keep_mm, made.bound.spacing_mm})
                       : verify::witness_of_parts(made.witness);
  if (segment.fill) made.witness = verify::witness_of_filled(made.witness);
}

}  // namespace

Segmented segmented(const Segment& segment, const SegmentSource& source) {
  if (segment.window) need_hounsfield(*segment.window, source.scene);
  return Segmenter(segment, source).run();
}

voxel::Octree on_own_samples(const Segment& segment, const SegmentSource& source, const Segmented& made) {
  const voxel::Lattice& lattice = source.scene.lattice;
  if (made.base)
    return voxel::chosen_samples(lattice, Segmenter(segment, source).base(), *made.base, made.octree);
  // A grown object has no `base`: only its voxels determine where it ends.
  return voxel::chosen_samples(lattice, voxel::Octree::empty(source.universe),
                               voxel::Octree::empty(made.octree.universe()), made.octree);
}

OtsuWindow otsu_window(const voxel::Scene& scene, int classes, int number) {
  const voxel::Histogram histogram = voxel::histogram(scene);
  const std::vector<double> thresholds = voxel::otsu_thresholds(histogram, classes);
  const auto which = static_cast<std::size_t>(number) - 1;
  OtsuWindow otsu;
  otsu.window.low = which == 0 ? std::numeric_limits<std::int16_t>::min() : std::ceil(thresholds[which - 1]);
  if (which < thresholds.size()) otsu.window.high = std::ceil(thresholds[which]) - 1.0;
  otsu.suggestion = {
      {"method", "Otsu 1979, " + std::to_string(classes) + " classes"},
      {"thresholds", thresholds},
      {"histogram", {{"low", histogram.low}, {"bin", histogram.width()}, {"counts", histogram.counts}}}};
  return otsu;
}

Clusters clusters_of(const voxel::Scene& scene, int classes, const voxel::Progress& progress) {
  Clusters made{voxel::feature_classes(scene, classes, progress), {}};
  Json centres = Json::array();
  for (const voxel::FeatureCentre& centre : made.classes.centres)
    centres.push_back(
        {{"density", centre.density}, {"gradient_per_mm", centre.gradient}, {"share", centre.share}});
  made.suggestion = {{"method", "k-means, " + std::to_string(classes) + " classes by density and gradient"},
                     {"centres", std::move(centres)}};
  return made;
}

int label_of_name(const Segment& segment, const std::filesystem::path& label_map, const voxel::Scene& scene,
                  const std::filesystem::path& folder, std::vector<std::string>& findings) {
  if (!segment.names.empty()) {
    const LabelTable given = read_label_table(folder / segment.names);
    findings.insert(findings.end(), given.passed_over.begin(), given.passed_over.end());
    return given.label(*segment.named);
  }
  std::set<int> occurring;
  for (const voxel::Label& label : labels_or_none(scene)) occurring.insert(label.number);
  const LabelTable table = label_table_of(label_map, occurring);
  findings.insert(findings.end(), table.passed_over.begin(), table.passed_over.end());
  return table.label(*segment.named);
}

Operation segment_operation() {
  return Describe<Segment>("segment", "Makes an object from a scan, and can choose its parts.", Makes::Object)
      .takes(
          field("scan", &Segment::scan, "The scan; with a label, a label map.").required().positional("scan"))
      .takes(field("window", &Segment::window,
                   "The samples of the object: LOW:HIGH or LOW: in the scan's unit, or a tissue.")
                 .for_example("\"bone\"")
                 .in_plans_only())
      .takes(field("otsu", &Segment::otsu,
                   "Divides the samples into this number of classes of least variance. The object is one of "
                   "them, see 'class'.")
                 .from(2)
                 .to(8))
      .takes(field("clusters", &Segment::clusters,
                   "Divides the samples into this number of clusters by density and gradient. The object is "
                   "one of them. Edges between tissues form separate clusters, so three tissues need five.")
                 .from(2)
                 .to(8))
      .takes(field("class", &Segment::otsu_class, "The class, from 1, the darkest. Default: the brightest.")
                 .from(1)
                 .to(8))
      .takes(field("tolerance", &Segment::tolerance,
                   "The object grows from the seeds through neighbouring samples within the range of the "
                   "seeds' samples, widened by this tolerance.")
                 .from(0)
                 .to(65535))
      .takes(field("running_mean", &Segment::running_mean,
                   "The tolerance is measured from the mean of the region, which is computed anew in rounds.")
                 .read_if<Segment>([](const Segment& segment) { return segment.tolerance.has_value(); },
                                   "applies only to growing: add 'tolerance' and 'seeds_mm'"))
      .takes(field("label", &Segment::label, "The object with this number in a label map.")
                 .from(1)
                 .to(voxel::most_label))
      .takes(field("named", &Segment::named,
                   "The object with this name in a label map with names: a segmentation of DICOM or 3D "
                   "Slicer, or a label map with a table beside it."))
      .takes(field("names", &Segment::names,
                   "A table of names to use instead of the label map's own: .json, .csv, .tsv, ITK-SNAP's "
                   ".txt, 3D Slicer's .ctbl.")
                 .a_file())
      .takes(field("regions", &Segment::regions,
                   "Keeps the voxels within regions on slices, from a JSON file or a DICOM structure set.")
                 .a_file())
      .takes(field("structure", &Segment::structure,
                   "For a structure set: the name or ROI number of the structure to use."))
      .takes(field("other_identity", &Segment::other_identity,
                   "Accepts a structure set that states another patient, study or frame of reference than "
                   "the scan; a finding then begins with FAIL."))
      .takes(field("open_mm", &Segment::open_mm,
                   "Removes parts of the object that a ball of this radius inside the object does not reach.")
                 .greater_than(0.0))
      .takes(field("seeds_mm", &Segment::seeds_mm, "Keeps the parts that contain these points, LPS.")
                 .repeated()
                 .called("seed"))
      .takes(field("largest", &Segment::largest, "Keeps the largest part."))
      .takes(field("components", &Segment::components, "Keeps this number of the largest parts.")
                 .from(1)
                 .to(1000000))
      .takes(field("at_least_mm3", &Segment::at_least_mm3, "Keeps the parts of at least this volume.")
                 .greater_than(0.0))
      .takes(field("keep_bridges_mm", &Segment::keep_bridges_mm,
                   "Keeps the parts beyond thin necks at these points, LPS, which certificates list.")
                 .in_plans_only())
      .takes(field("cut_bridges_mm", &Segment::cut_bridges_mm,
                   "Cuts thin necks at these points, LPS: removes everything in a cube around each point.")
                 .in_plans_only())
      .takes(field("bridge_mm", &Segment::bridge_mm,
                   "Edge of the cube around the point of a kept or cut neck, mm.")
                 .greater_than(0.0)
                 .in_plans_only())
      .takes(field("close_mm", &Segment::close_mm,
                   "Closes gaps through which a ball of this radius does not pass.")
                 .greater_than(0.0))
      .takes(field("fill", &Segment::fill, "Fills cavities."))
      .takes(field("neighbours", &Segment::neighbours,
                   "Whether parts are connected by faces (6), edges (18) or corners (26).")
                 .read_if<Segment>(
                     [](const Segment& segment) {
                       return chooses_parts(segment) || segment.tolerance || !segment.seeds_mm.empty();
                     },
                     "applies only where parts are chosen: add 'largest', 'components', 'at_least_mm3' or "
                     "'seeds_mm'"))
      .verb_takes(field("windows", &Segment::windows,
                        "LOW:HIGH or LOW: in sample units, or a tissue: " + names_of_tissues() +
                            "; again for more objects.")
                      .repeated()
                      .called("window"))
      .verb_takes(field("out", &Segment::out,
                        "The output: an .octree file for one object; or a label map (.nrrd, .nii.gz, .mha) "
                        "or a DICOM segmentation (.dcm) on the scan's lattice."))
      .verb_takes(field("objects", &Segment::objects,
                        "An .octree file that becomes a further object of the label map; may be repeated.")
                      .repeated()
                      .called("object")
                      .a_file())
      .verb_takes(field("contours", &Segment::contours,
                        "A .json file to which the contours of the first window's lower bound are written, "
                        "for every slice."))
      .verb_takes(field("voxel_mm", &Segment::voxel_mm,
                        "Edge of an octree's voxels, which also determine the parts. Default: the scan's "
                        "finest spacing, with at most 512 voxels a side.")
                      .greater_than(0.0))
      .verb_takes(
          field("identity", &Segment::identity,
                "The patient and study of a DICOM segmentation: keep uses the scan's; remove applies the "
                "Basic Application Level Confidentiality Profile of PS3.15, and also removes names from "
                "files; new states a patient without a name in a new study.")
              .one_of({"keep", "remove", "new"})
              .read_if<Segment>([](const Segment& segment) { return segment.out.extension() == ".dcm"; },
                                "applies only to a DICOM segmentation: leave it out, or write a .dcm"))
      .reads_scans()
      .on_files(
          "octotomy segment head.nrrd -o skull.octree --window bone --largest\n"
          "  octotomy segment head.nrrd -o tissues.nii.gz --window bone --window soft_tissue --window fat\n"
          "  octotomy segment dicom_folder -o tissues.dcm --window bone --window soft_tissue\n"
          "  octotomy segment head.nrrd --otsu 3 --json\n"
          "  octotomy segment head.nrrd --clusters 4 --class 3 -o tissue.octree\n"
          "  octotomy segment mr.nrrd --seed 10,-20,5 --tolerance 30 --running-mean -o brain.octree\n"
          "  octotomy segment tissues.nii.gz -o fat.octree --label 3\n"
          "  octotomy segment organs.nii.gz -o mandible.octree --named mandible --names organs.json\n"
          "  octotomy segment head.nrrd --window bone --contours skull.json",
          segment_file)
      .example(R"({"id": "skull", "do": "segment", "scan": "ct", "window": "bone", "largest": true})")
      .check(check)
      .settle(settle)
      .with_parts(with_parts)
      .object(definition, voxels, triangles, bound);
}

}  // namespace octotomy::planner
