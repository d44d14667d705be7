// SPDX-License-Identifier: AGPL-3.0-or-later
#include "verify/suite/representation_study.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdio>
#include <memory>
#include <numbers>
#include <optional>

#include "verify/phantom/head_phantom.h"
#include "verify/phantom/solid_phantom.h"
#include "voxel/codes/bi_tree.h"
#include "voxel/codes/grey_runs.h"
#include "voxel/codes/masked_octree.h"
#include "voxel/codes/reduced_octree.h"
#include "voxel/measure/grey_level_counts.h"
#include "voxel/solid/combine.h"
#include "voxel/solid/digitise.h"
#include "voxel/space/view.h"
#include "voxel/view/render.h"
#include "voxel/view/visits.h"

namespace octotomy::verify {
namespace {

using voxel::Direction;
using voxel::Octree;

constexpr int depth = 8;
constexpr voxel::Window16 bone{20, 63};  // the upper 44 of 64 levels
/// The thesis divides the visits at each level by the pixels of the finest picture. The study does the same.
constexpr double pixels = 256.0 * 256.0;

std::string with_decimals(double value, int decimals) {
  char text[32];
  std::snprintf(text, sizeof text, "%.*f", decimals, value);
  return text;
}

std::string joined(const std::vector<std::string>& columns) {
  std::string text;
  for (const std::string& column : columns) text += (text.empty() ? "" : " ") + column;
  return text;
}

std::uint64_t sum(const voxel::LevelCount& level) {
  return level.partial + level.full + level.empty;
}
std::uint64_t sum(const std::vector<voxel::LevelCount>& levels) {
  std::uint64_t nodes = 0;
  for (const voxel::LevelCount& level : levels) nodes += sum(level);
  return nodes;
}

/// The head phantom, coded as the thesis codes its skull: 4096 densities in 64 levels, one density a voxel.
voxel::GreyOctree grey_head() {
  voxel::Scene scene = head_phantom();
  for (std::int16_t& sample : std::get<voxel::Int16Samples>(scene.samples))
    sample = static_cast<std::int16_t>(std::clamp((sample + 1024) / 64, 0, 63));
  scene.meaning = voxel::Meaning::Raw;
  voxel::Universe universe{depth, scene.lattice.lps_from_voxel};
  return grey_octree_of(universe, scene, 0);
}

/// Counts the tree nodes that are visited while an object is drawn from the front.
voxel::Visits drawn(const voxel::DrawnObject& object, voxel::Algorithm algorithm) {
  voxel::RenderOptions options;
  options.view = voxel::parse_view("anterior");
  options.size_px = {64, 64};
  options.algorithm = algorithm;
  options.count = true;
  options.antialias = false;
  options.occlusion = false;
  return *render({object}, options).visits;
}

/// The visible faces: the observer is in front, and the patient's front is y-.
constexpr voxel::FaceSet front = voxel::face_bit(Direction::MinusY);

// --------------------------------------------------------------------------------- what holds for any object

std::vector<ThesisEntry> face_codes() {
  std::vector<ThesisEntry> entries;
  const char* codes[] = {"F E F E F E", "E F F E F E", "F E E F F E", "E F E F F E",
                         "F E F E E F", "E F F E E F", "F E E F E F", "E F E F E F"};
  for (int octant = 0; octant < 8; ++octant)
    entries.push_back({"table 4.1", "faces seen from octant " + std::to_string(octant), codes[octant],
                       voxel::face_text(voxel::view_code(octant)),
                       "in the order x- x+ y- y+ z- z+ of equation 3.2; the table's heading has x+ first"});
  const char* masks[] = {"172105", "174212", "630423", "631054", "747400", "740360"};
  const char* names[] = {"E", "W", "N", "S", "U", "D"};
  for (int i = 0; i < voxel::direction_count; ++i) {
    char octal[16];
    std::snprintf(octal, sizeof octal, "%o", voxel::neighbour_mask(static_cast<Direction>(i)));
    entries.push_back({"table 5.2", std::string("neighbours that shade face ") + names[i], masks[i], octal});
  }
  return entries;
}

/// The face code of the node in figure 3.6. Beside the node, Full voxels cover z- and z+ and, behind a
/// Partial node, y+.
std::vector<ThesisEntry> figure_3_6() {
  voxel::Universe universe;
  universe.depth = 3;
  const auto box = [](const glm::dvec3& low, const glm::dvec3& high) {
    return voxel::Expression(voxel::Box{low - 0.5, high + 0.5});
  };
  const Octree object = combine(universe, box({2, 2, 2}, {3, 3, 3}) | box({2, 4, 2}, {3, 4, 3}) |
                                              box({2, 2, 4}, {3, 3, 4}) | box({2, 2, 0}, {3, 3, 1}));
  const voxel::MaskedOctree masked = masked_octree(object);
  // The index in `nodes` of octal code 07 at level 2: the last child of the root's first child.
  std::size_t node = 2;
  for (int k = 0; k < 7; ++k) node += masked.nodes[node].size;
  const voxel::FaceSet code = masked.nodes[node].covered;
  return {{"figure 3.6", "neighbour code", "E E E F F F", voxel::face_text(code)},
          {"section 4.4.3.1", "result code of figure 3.6 seen from octant 5", "E F F E E E",
           voxel::face_text(static_cast<voxel::FaceSet>(~code & voxel::view_code(5)))}};
}

/// Counts the accesses needed to find the neighbour along x of each voxel in a row but the last.
std::vector<ThesisEntry> theorem_3_1() {
  double from_pivot = 0.0, down_and_up = 0.0;
  const int side = 1 << depth;
  for (int i = 0; i + 1 < side; ++i) {
    const int levels = std::bit_width(static_cast<unsigned>(i ^ (i + 1)));  // from a voxel up to the pivot
    from_pivot += levels;
    down_and_up += 2.0 * levels;
  }
  const auto below = [&](double accesses, double bound) {
    const double mean = accesses / (side - 1);
    return mean < bound && mean > 0.95 * bound ? "below " + with_decimals(bound, 0) : with_decimals(mean, 3);
  };
  return {
      {"theorem 3.1", "accesses by walking up from the pivot, level 8", "below 2", below(from_pivot, 2.0)},
      {"theorem 3.1", "accesses by walking down and up, level 8", "below 4", below(down_and_up, 4.0)}};
}

/// The names in order of falling cost, joined by ">".
std::string order(std::vector<std::pair<double, std::string>> costs) {
  std::stable_sort(costs.begin(), costs.end(),
                   [](const auto& a, const auto& b) { return a.first > b.first; });
  std::string text;
  for (const auto& [cost, name] : costs) text += (text.empty() ? "" : " > ") + name;
  return text;
}

// ----------------------------------------------------------------------------------------------- the tables

std::string statuses(const voxel::LevelCount& level, bool is_top) {
  return joined({is_top ? "-" : std::to_string(level.partial), std::to_string(level.full),
                 std::to_string(level.empty)});
}

void tables_3_1_and_3_2(const voxel::GreyOctree& grey, const Octree& skull, RepresentationStudy& study) {
  static constexpr std::array<const char*, depth> binary{
      "8 0 0",       "31 0 33",          "157 0 91",          "731 0 525",
      "3561 3 2284", "15678 1644 11166", "47485 30694 47245", "- 184692 195188"};
  static constexpr std::array<const char*, depth> greys{
      "8 0 0",         "44 0 20",         "236 0 116",          "1366 0 522",
      "8739 175 2014", "58942 2883 8087", "349348 86143 36045", "- 2627833 166951"};
  const auto of_skull = level_counts(skull);
  const auto of_grey = level_counts(grey);
  for (std::size_t i = 0; i < depth; ++i) {
    const std::string item = "level " + std::to_string(i + 1) + ", Partial Full Empty";
    study.beside.push_back({"table 3.1, skull", item, binary[i], statuses(of_skull[i], i + 1 == depth)});
    study.beside.push_back({"table 3.2, 64 levels", item, greys[i], statuses(of_grey[i], i + 1 == depth)});
  }
}

/// Stands for a row that the available text of the thesis leaves out.
constexpr const char* left_out = "not in the text at hand";

constexpr std::array<const char*, depth> visits_to_skull{
    "157.25 0.00 -",     "102.48 0.00 16.67", "30.26 0.00 17.308", "1.09 0.00 4.055",
    "3.524 0.000 1.946", "1.045 0.108 0.904", "0.364 0.083 0.387", "- 0.077 0.209"};
constexpr std::array<const char*, depth> not_printed{left_out, left_out, left_out, left_out,
                                                     left_out, left_out, left_out, left_out};

void table_a_1(const char* object, const std::array<const char*, depth>& printed, const voxel::Visits& visits,
               RepresentationStudy& study) {
  for (std::size_t i = 0; i < depth; ++i) {
    const auto share = [&](std::uint64_t all, std::uint64_t nodes) {
      return nodes == 0 ? std::string("-")
                        : with_decimals(static_cast<double>(all) / static_cast<double>(nodes), 3);
    };
    const voxel::LevelCount &made = visits.all.octree[i], &nodes = visits.existing[i];
    study.beside.push_back({std::string("table A.1, ") + object,
                            "level " + std::to_string(i + 1) + ", visits to Partial Full Empty", printed[i],
                            joined({share(made.partial, nodes.partial), share(made.full, nodes.full),
                                    share(made.empty, nodes.empty)})});
  }
}

/// The spheres, digitised by the share of each voxel that they fill, as table 3.1 has them.
void spheres_of_3_1_and_a_1(RepresentationStudy& study) {
  const voxel::PartialOctree sphere = digitise_partial(solid_phantom("sphere"));
  const voxel::PartialOctree chequered = digitise_partial(solid_phantom("chequered_sphere"));
  const auto of_chequered = level_counts(chequered);
  for (std::size_t i = 0; i < depth; ++i)
    study.beside.push_back({"table 3.1, chequered sphere",
                            "level " + std::to_string(i + 1) + ", Partial Full Empty", left_out,
                            statuses(of_chequered[i], i + 1 == depth)});
  for (const auto& [name, shares] : {std::pair("sphere", &sphere), {"chequered sphere", &chequered}}) {
    voxel::DrawnObject object{name, shares->touching};
    object.inside = shares->inside;
    table_a_1(name, not_printed, drawn(object, voxel::Algorithm::NodeTrace), study);
  }
}

/// The columns are: back to front unmasked, back to front masked, front to back, node tracing with direct
/// visits, node tracing with all visits.
void table_a_2(const Octree& skull, RepresentationStudy& study) {
  struct Row {
    const char *visits, *unvisited, *per_pixel;
  };
  static constexpr std::array<Row, 6> printed{
      {{"1.00 1.00 0.94 0.90 1.27", "0.00 0.00 0.06 0.06 0.06", "0.00489 0.00488 0.00461 0.00441 0.00621"},
       {"1.00 0.98 0.79 0.70 1.07", "0.00 0.02 0.21 0.37 0.29", "0.02399 0.02350 0.01888 0.01676 0.02564"},
       {"1.00 0.95 0.58 0.50 0.80", "0.00 0.05 0.42 0.56 0.50", "0.11285 0.10772 0.06495 0.05618 0.09011"},
       {"1.00 0.88 0.39 0.32 0.54", "0.00 0.12 0.61 0.72 0.67", "0.54553 0.47791 0.21139 0.17708 0.29367"},
       {"1.00 0.81 0.26 0.22 0.36", "0.00 0.19 0.74 0.81 0.78", "2.44733 1.87321 0.62960 0.53852 0.88955"},
       {"1.00 0.75 0.21 0.19 0.29", "0.00 0.25 0.79 0.84 0.82", "8.17665 6.11504 1.81234 1.52448 2.39753"}}};
  for (int level = 3; level <= depth; ++level) {
    // The printed total of level 3 is that of the whole tree cut off at this level (table 3.1). So a node
    // that contains a Full voxel becomes Full.
    const Octree object = reduced(skull, depth - level, {voxel::Reduction::Of::Children, 0.0});
    const voxel::DrawnObject head{"skull", object};
    const voxel::MaskedDrawing masked = draw_back_to_front(masked_octree(object), front);
    const voxel::Visits unmasked = drawn(head, voxel::Algorithm::BackToFront);
    const voxel::Visits front_to_back = drawn(head, voxel::Algorithm::FrontToBack);
    const voxel::Visits traced = drawn(head, voxel::Algorithm::NodeTrace);
    const auto nodes = static_cast<double>(sum(traced.existing));
    const std::array<double, 5> visits{
        static_cast<double>(sum(unmasked.direct.octree)), static_cast<double>(sum(masked.visits)),
        static_cast<double>(sum(front_to_back.direct.octree)), static_cast<double>(sum(traced.direct.octree)),
        static_cast<double>(sum(traced.all.octree))};
    const std::array<double, 5> at_pixels{
        static_cast<double>(unmasked.direct.quadtree), static_cast<double>(sum(masked.visits)),
        static_cast<double>(front_to_back.direct.quadtree), static_cast<double>(traced.direct.quadtree),
        static_cast<double>(traced.all.quadtree)};
    std::vector<std::string> per_node, per_pixel;
    for (std::size_t i = 0; i < 5; ++i) {
      per_node.push_back(with_decimals(visits[i] / nodes, 2));
      per_pixel.push_back(with_decimals(at_pixels[i] / pixels, 5));
    }
    const auto& row = printed[static_cast<std::size_t>(level - 3)];
    const std::string item = "level " + std::to_string(level) + ", ";
    study.beside.push_back({"table A.2", item + "visits per node: BTFU BTFM FTB trace direct, all",
                            row.visits, joined(per_node)});
    study.beside.push_back({"table A.2", item + "share unvisited: BTFU BTFM FTB trace direct, all",
                            row.unvisited,
                            joined({with_decimals(unmasked.unvisited_fraction().value_or(0.0), 2),
                                    with_decimals(1.0 - visits[1] / nodes, 2),
                                    with_decimals(front_to_back.unvisited_fraction().value_or(0.0), 2),
                                    with_decimals(traced.directly_unvisited_fraction().value_or(0.0), 2),
                                    with_decimals(traced.unvisited_fraction().value_or(0.0), 2)})});
    study.beside.push_back({"table A.2", item + "visits per pixel: BTFU BTFM FTB trace direct, all",
                            row.per_pixel, joined(per_pixel)});
    if (level < 5) continue;  // masks hide almost nothing at these levels
    study.entries.push_back(
        {"table A.2", item + "algorithms by visits per node", "BTFU > BTFM > FTB > trace",
         order({{visits[0], "BTFU"}, {visits[1], "BTFM"}, {visits[2], "FTB"}, {visits[3], "trace"}})});
    if (level == depth) table_a_1("skull", visits_to_skull, traced, study);
  }
}

void tables_4_2_and_a_3(const voxel::GreyOctree& grey, const Octree& skull, RepresentationStudy& study) {
  voxel::DrawnObject head{"skull", skull};
  head.grey = grey;
  head.threshold = bone.low;
  head.counted_in_grey = true;
  const voxel::Visits in_ranges = drawn(head, voxel::Algorithm::NodeTrace);
  const auto axes = axis_view(grey.universe(), voxel::parse_view("anterior"));
  const voxel::Visits plain = visits_without_ranges(grey, bone, *axes);
  const voxel::Visits in_depths = visits_with_depths(grey, bone, *axes);
  const auto row = [&](const voxel::Visits& visits) {
    return joined(
        {with_decimals(
             static_cast<double>(sum(visits.all.octree)) / static_cast<double>(sum(visits.existing)), 2),
         with_decimals(visits.unvisited_fraction().value_or(0.0), 2),
         with_decimals(static_cast<double>(visits.all.quadtree) / pixels, 2)});
  };
  const char* columns = ": visits per node, share unvisited, visits per pixel";
  study.beside.push_back(
      {"table A.3", std::string("node trace, no min-max") + columns, "0.67 0.65 0.61", row(plain)});
  study.beside.push_back(
      {"table A.3", std::string("node trace, min-max") + columns, "0.08 0.94 0.58", row(in_ranges)});
  study.beside.push_back({"table A.3", std::string("node trace, min-max, depth interpolated") + columns,
                          "0.09 0.94 0.58", row(in_depths)});
  study.entries.push_back({"table A.3", "grey trees by visits per node",
                           "no min-max > interpolated > min-max",
                           order({{static_cast<double>(sum(plain.all.octree)), "no min-max"},
                                  {static_cast<double>(sum(in_depths.all.octree)), "interpolated"},
                                  {static_cast<double>(sum(in_ranges.all.octree)), "min-max"}})});

  const voxel::MaskedOctree masked = masked_octree(skull);
  const double by_mask = static_cast<double>(sum(draw_back_to_front(masked, voxel::view_code(0)).visits));
  const double unmasked = static_cast<double>(sum(level_counts(skull)));
  const double all_grey = static_cast<double>(sum(level_counts(grey)));
  const double pyramid = static_cast<double>(sum(drawn(head, voxel::Algorithm::BackToFront).direct.octree));
  const std::array<std::pair<double, const char*>, 4> rows{{{by_mask, "binary masked"},
                                                            {unmasked, "binary unmasked"},
                                                            {all_grey, "grey"},
                                                            {pyramid, "pyramid grey"}}};
  static constexpr std::array<const char*, 4> seconds{"78 s", "257 s", "585 s", "440 s"};
  for (std::size_t i = 0; i < rows.size(); ++i)
    study.beside.push_back({"table 4.2", std::string("back to front, ") + rows[i].second, seconds[i],
                            with_decimals(rows[i].first, 0) + " visits"});
  study.entries.push_back(
      {"table 4.2", "back to front by cost", "grey > binary unmasked > binary masked",
       order({{by_mask, "binary masked"}, {unmasked, "binary unmasked"}, {all_grey, "grey"}})});
}

/// Walks through two masked trees at once, as for making or drawing their intersection (7.2, 7.3.1), and
/// counts visits.
class PairWalk {
 public:
  /// `seen`: the faces towards an observer, for drawing; none: for making.
  PairWalk(const voxel::MaskedOctree& a, const voxel::MaskedOctree& b, std::optional<voxel::FaceSet> seen)
      : a_(a), b_(b), seen_(seen) {
    visit(place(a, 0), place(b, 0));
  }
  /// The number of visits to pairs of nodes of levels 1..n.
  std::uint64_t visits() const { return visits_; }

 private:
  /// A node, or a part of a Full or Empty node.
  struct Place {
    voxel::Status status;
    voxel::FaceSet covered;
    std::size_t node;  ///< of a Partial node
  };
  static Place place(const voxel::MaskedOctree& tree, std::size_t node) {
    return {tree.nodes[node].status, tree.nodes[node].covered, node};
  }

  static std::array<Place, 8> children(const voxel::MaskedOctree& tree, const Place& outer) {
    std::array<Place, 8> inner;
    std::size_t node = outer.node + 1;
    for (unsigned i = 0; i < 8; ++i) {
      if (outer.status == voxel::Status::Partial) {
        inner[i] = place(tree, node);
        node += tree.nodes[node].size;
        continue;
      }
      // The faces between parts of a Full node are covered by the node's own voxels.
      inner[i] = {outer.status,
                  static_cast<voxel::FaceSet>(outer.covered | voxel::view_code(7 - static_cast<int>(i))),
                  outer.node};
    }
    return inner;
  }

  void visit(const Place& a, const Place& b) {
    if (a.status == voxel::Status::Empty || b.status == voxel::Status::Empty) return;
    if (a.status == voxel::Status::Full && b.status == voxel::Status::Full) return;
    if (seen_ && (*seen_ & ~(a.covered & b.covered)) == 0) return;
    const std::array<Place, 8> of_a = children(a_, a), of_b = children(b_, b);
    for (std::size_t i = 0; i < 8; ++i) {
      ++visits_;
      visit(of_a[i], of_b[i]);
    }
  }

  const voxel::MaskedOctree &a_, &b_;
  std::optional<voxel::FaceSet> seen_;
  std::uint64_t visits_ = 0;
};

/// The skull cut by a box, in place of the thesis's volume of interest.
void table_7_5(const Octree& skull, RepresentationStudy& study) {
  const voxel::Universe& universe = skull.universe();
  const voxel::FaceSet seen = voxel::view_code(0);
  const Octree cut = combine(universe, voxel::Box{{-200.0, -100.0, -70.0}, {200.0, -20.0, 40.0}});
  const voxel::MaskedOctree a = masked_octree(skull), b = masked_octree(cut),
                            both = masked_octree(combine(universe, voxel::Expression(skull) & cut));
  const auto drawn = [&](const voxel::MaskedOctree& tree, bool is_masked) {
    return sum(draw_back_to_front(tree, seen, is_masked).visits);
  };
  const auto row = [&](const char* name, const char* printed, const std::vector<std::string>& ours) {
    study.beside.push_back({"table 7.5",
                            std::string(name) +
                                ": create, display, link, display linked, display the expression; " +
                                "printed: seconds; ours: visits, for link nodes",
                            printed, joined(ours)});
  };
  const auto count = [](std::uint64_t n) { return std::to_string(n); };
  row("A", "- 38 543 - -", {"-", count(drawn(a, false)), count(a.nodes.size()), "-", "-"});
  row("B", "- 68 698 - -", {"-", count(drawn(b, false)), count(b.nodes.size()), "-", "-"});
  const std::uint64_t made = PairWalk(a, b, std::nullopt).visits(), shown = PairWalk(a, b, seen).visits();
  row("intersection", "58 52 308 50 52",
      {count(made), count(drawn(both, false)), count(both.nodes.size()), count(drawn(both, true)),
       count(shown)});
  study.entries.push_back({"table 7.5", "the intersection by cost", "create > display the expression",
                           order({{static_cast<double>(made), "create"},
                                  {static_cast<double>(shown), "display the expression"}})});
}

// ---------------------------------------------------------------------------------------------- chapter 5

/// The slopes that a filter of whole depths can represent: their number, the steepest slope, and the largest
/// angle between neighbouring slopes.
void figure_5_8(RepresentationStudy& study) {
  struct Curve {
    const char* name;
    double width, highest, step;  // width in pixels; largest depth and step of depths in voxels
  };
  static constexpr std::array<Curve, 4> curves{
      {{"a: filter of 3 x 3 pixels, depths to 10 voxels", 3, 10, 1},
       {"b: filter of 3 x 3 pixels, depths to 255 voxels", 3, 255, 1},
       {"c: filter of 255 x 255 pixels, depths to 10 voxels", 255, 10, 1},
       {"d: filter of 3 x 3 pixels, depths to 5 voxels in 64ths", 3, 5, 1.0 / 64.0}}};
  std::vector<std::pair<double, std::string>> widest;
  for (const Curve& curve : curves) {
    double before_deg = 0.0, gap_deg = 0.0;
    int count = 1;
    for (double d = curve.step; d <= curve.highest; d += curve.step, ++count) {
      const double at_deg = std::atan(d / curve.width) * 180.0 / std::numbers::pi;
      gap_deg = std::max(gap_deg, at_deg - before_deg);
      before_deg = at_deg;
    }
    widest.emplace_back(gap_deg, std::string(1, curve.name[0]));
    study.beside.push_back({"figure 5.8", std::string("curve ") + curve.name, "drawn as a curve",
                            std::to_string(count) + " slopes to " + with_decimals(before_deg, 1) +
                                " degrees, at most " + with_decimals(gap_deg, 2) + " apart"});
  }
  study.entries.push_back({"figure 5.8", "a small filter of whole depths samples worse than one of 64ths",
                           "a > d", order({{widest[0].first, "a"}, {widest[3].first, "d"}})});
}

/// The mean depth errors of two depth images of the sphere of table 3.1, whose true depth is known.
void figures_5_9_and_5_10(RepresentationStudy& study) {
  const SolidPhantom sphere = solid_phantom("sphere");
  const voxel::PartialOctree shares = digitise_partial(sphere);
  voxel::DrawnObject object{"sphere", at_least_half(shares)};
  const auto errors = [&](const voxel::Shading shading) {
    voxel::RenderOptions options;
    options.view = voxel::parse_view("anterior");
    options.size_px = {256, 256};
    options.width_mm = 256.0;
    options.centre_mm = glm::dvec2(0.0);
    options.shading = shading;
    options.algorithm = voxel::Algorithm::NodeTrace;
    options.antialias = false;
    const voxel::Picture picture = render({object}, options);
    double total = 0.0;
    int count = 0;
    for (int y = 0; y < 256; ++y)
      for (int x = 0; x < 256; ++x) {
        const auto p = picture.point_mm({x, y});
        // Steeper parts belong to the silhouette, where a voxel's depth does not measure the surface's.
        if (!p || std::hypot(p->x, p->z) > 32.0) continue;
        total += std::abs(p->y + std::sqrt(64.0 * 64.0 - p->x * p->x - p->z * p->z));
        ++count;
      }
    return total / count;
  };
  const double stepped = errors(voxel::Shading::Gradient);
  object.grey = share_samples(shares);
  object.threshold = voxel::half_share;
  const double interpolated = errors(voxel::Shading::PartialVolume);
  study.beside.push_back({"figure 5.9", "depth of the sphere in voxels, mean error", "drawn as a relief",
                          with_decimals(stepped, 3)});
  study.beside.push_back({"figure 5.10", "interpolated depth of the sphere, mean error", "drawn as a relief",
                          with_decimals(interpolated, 3)});
  study.entries.push_back({"figure 5.10", "mean errors of both depth images", "whole voxels > interpolated",
                           order({{stepped, "whole voxels"}, {interpolated, "interpolated"}})});
}

}  // namespace

RepresentationStudy representation_study() {
  RepresentationStudy study;
  SolidPhantomOptions four;
  four.voxels = 4;
  const Octree figure = digitise(solid_phantom("figure_3_1", four), voxel::Digitisation::Centre);
  study.entries.push_back({"section 3.2.3", "runs of zeros and ones of figure 3.1",
                           "(0:8), (1:2), (0:2), (1:2), (0:9), (1:4), (0:1), (1:2), (0:11), (1:1), (0:2), "
                           "(1:1), (0:12), (1:1), (0:6)",
                           text(voxel::grey_runs(figure)),
                           "the run after (0:11) is printed as (0:1); the list of one-runs has it as ones"});
  for (const auto& part : {face_codes(), figure_3_6(), theorem_3_1()})
    study.entries.insert(study.entries.end(), part.begin(), part.end());
  const std::string bi_nodes = text(voxel::bi_tree(figure));
  study.beside.push_back(
      {"section 3.3", "bi-tree of figure 3.1: nodes; the octree's", "not drawn",
       std::to_string(bi_nodes.size()) + "; " + std::to_string(1 + sum(level_counts(figure)))});

  const voxel::GreyOctree grey = grey_head();
  const Octree skull = combine(grey.universe(), voxel::Window{grey, bone.low, bone.high});
  tables_3_1_and_3_2(grey, skull, study);
  spheres_of_3_1_and_a_1(study);
  table_a_2(skull, study);
  tables_4_2_and_a_3(grey, skull, study);
  table_7_5(skull, study);
  figure_5_8(study);
  figures_5_9_and_5_10(study);
  return study;
}

}  // namespace octotomy::verify
