// SPDX-License-Identifier: AGPL-3.0-or-later
#include "verify/suite/thesis_tables.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <map>
#include <set>

#include "brep/align/register_landmarks.h"
#include "verify/phantom/solid_phantom.h"
#include "voxel/codes/binary_array.h"
#include "voxel/codes/cuberille_faces.h"
#include "voxel/codes/linear_octree.h"
#include "voxel/codes/marginal_index.h"
#include "voxel/codes/octal_code.h"
#include "voxel/codes/run_length.h"
#include "voxel/codes/segment_index.h"
#include "voxel/solid/combine.h"
#include "voxel/solid/digitise.h"
#include "voxel/space/view.h"
#include "voxel/tree/treecode.h"
#include "voxel/view/object_normals.h"
#include "voxel/view/render.h"

namespace octotomy::verify {
namespace {

using voxel::Expression;
using voxel::Octree;

std::vector<ThesisEntry> figure_3_1() {
  SolidPhantomOptions options;
  options.voxels = 4;
  const Octree object = digitise(solid_phantom("figure_3_1", options), voxel::Digitisation::Centre);
  return {{"section 3.1.2.2", "face lists of figure 3.1",
           "x+ (1,2,0), (1,3,0), (3,1,1), (2,2,1), (1,3,1), (1,2,2), (0,3,2), (1,2,3)\n"
           "x- (0,2,0), (0,3,0), (3,1,1), (0,2,1), (0,3,1), (1,2,2), (0,3,2), (1,2,3)\n"
           "y+ (0,3,0), (1,3,0), (3,1,1), (2,2,1), (0,3,1), (1,3,1), (1,2,2), (0,3,2), (1,2,3)\n"
           "y- (0,2,0), (1,2,0), (3,1,1), (0,2,1), (1,2,1), (2,2,1), (1,2,2), (0,3,2), (1,2,3)\n"
           "z+ (3,1,1), (0,2,1), (2,2,1), (1,3,1), (0,3,2), (1,2,3)\n"
           "z- (0,2,0), (1,2,0), (0,3,0), (1,3,0), (3,1,1), (2,2,1)\n",
           text(voxel::cuberille_faces(object)),
           "lists x fastest; the x- list is printed with (3,0,1), which is no voxel of the object: (3,1,1) "
           "is meant"},
          {"section 3.2.1", "array of figure 3.1",
           "Slice 0 :\n0 0 0 0\n0 0 0 0\n1 1 0 0\n1 1 0 0\nSlice 1 :\n0 0 0 0\n0 0 0 1\n1 1 1 0\n1 1 0 0\n"
           "Slice 2 :\n0 0 0 0\n0 0 0 0\n0 1 0 0\n1 0 0 0\nSlice 3 :\n0 0 0 0\n0 0 0 0\n0 1 0 0\n0 0 0 0\n",
           text(voxel::binary_array(object))},
          {"figure 3.4", "marginal index of figure 3.1",
           "0 Null Null 1100 1100\n1 Null 0001 1110 1100\n2 Null Null 0100 1000\n3 Null Null 0100 Null\n",
           text(voxel::marginal_index(object))},
          {"section 3.2.3", "runs of ones of figure 3.1", "8:9 12:13 23:26 28:29 41:41 44:44 57:57",
           text(voxel::run_length(object))},
          {"section 3.2.4", "segment index of figure 3.1",
           "0 Null Null 0:1 0:1\n1 Null 3:3 0:2 0:1\n2 Null Null 1:1 0:0\n3 Null Null 1:1 Null\n",
           text(voxel::segment_index(object))},
          {"section 3.4", "treecode of figure 3.1", "P(EP(EEEEEEEF)FP(EEEEFEEE)EEP(EFFEEFEE)E)",
           voxel::treecode(object)},
          {"section 3.4", "linear octree of figure 3.1", "17, 2, 34, 61, 62, 65",
           text(voxel::linear_octree(object))}};
}

/// The sphere of radius 64 in the middle of 256^3 voxels. A boundary voxel counts as Full.
std::vector<ThesisEntry> table_3_1() {
  static constexpr std::array<std::array<std::uint64_t, 3>, 8> printed{{{8, 0, 0},
                                                                        {8, 0, 56},
                                                                        {56, 8, 0},
                                                                        {272, 72, 104},
                                                                        {1160, 480, 536},
                                                                        {4760, 2240, 2280},
                                                                        {19232, 9360, 9488},
                                                                        {0, 115784, 38072}}};
  const auto counted = voxel::level_counts(digitise_partial(solid_phantom("sphere")));
  std::vector<ThesisEntry> entries;
  for (std::size_t i = 0; i < printed.size(); ++i) {
    const voxel::LevelCount ours = i < counted.size() ? counted[i] : voxel::LevelCount{};
    const std::array<std::uint64_t, 3> values{ours.partial, ours.full, ours.empty};
    static constexpr std::array<const char*, 3> names{"Partial", "Full", "Empty"};
    for (std::size_t k = 0; k < 3; ++k)
      entries.push_back({"table 3.1, sphere", "level " + std::to_string(i + 1) + ", " + names[k],
                         std::to_string(printed[i][k]), std::to_string(values[k]),
                         i == 7 && k == 0 ? "printed as a dash: single voxels are never Partial" : ""});
  }
  return entries;
}

/// The octal code of node 734 in a world of 16 voxels a side, and the nodes above it. The origin is in the
/// world's middle, as in the thesis.
std::vector<ThesisEntry> figure_4_6() {
  const voxel::OctalCode node(3, 0734);
  struct Row {
    int level;
    const char *code, *centre, *origin, *edge;
  };
  static constexpr std::array<Row, 3> rows{{{1, "7", "(4,4,4)", "(0,0,0)", "8"},
                                            {2, "73", "(6,6,2)", "(4,4,0)", "4"},
                                            {3, "734", "(5,5,3)", "(4,4,2)", "2"}}};
  const auto place = [](const glm::ivec3& p) {
    return "(" + std::to_string(p.x) + "," + std::to_string(p.y) + "," + std::to_string(p.z) + ")";
  };
  std::vector<ThesisEntry> entries;
  for (const Row& row : rows) {
    const voxel::OctalCode code = node.ancestor(row.level);
    const int edge = 16 >> row.level;
    const glm::ivec3 origin = voxel::origin_voxel(code, 4) - 8;
    const std::string level = "level " + std::to_string(row.level);
    entries.push_back({"figure 4.6", "octal code, " + level, row.code, to_string(code)});
    entries.push_back({"figure 4.6", "origin, " + level, row.origin, place(origin)});
    entries.push_back({"figure 4.6", "centre, " + level, row.centre, place(origin + edge / 2)});
    entries.push_back({"figure 4.6", "edge, " + level, row.edge, std::to_string(edge)});
  }
  return entries;
}

/// The pairs of an octree's children that project onto one child of the quadtree. The front child of a pair
/// comes first, in the order of the node tracer. The quadtree's children may be in any order, so pairs are
/// sorted by their front child.
std::vector<ThesisEntry> table_4_3() {
  struct Column {
    const char *view, *printed, *note;
  };
  static constexpr std::array<Column, 6> columns{
      {{"left", "1-0 3-2 5-4 7-6", ""},
       {"right", "0-1 2-3 4-5 6-7", ""},
       {"posterior", "2-0 3-1 6-4 7-5",
        "the second pair is printed as 0 2, although 2 is in front in the others"},
       {"anterior", "0-2 1-3 4-6 5-7", ""},
       {"superior", "4-0 5-1 6-2 7-3", ""},
       {"inferior", "0-4 1-5 2-6 3-7", ""}}};
  voxel::Universe universe;
  universe.depth = 4;
  universe.lps_from_voxel[3] = glm::dvec4(-7.5, -7.5, -7.5, 1.0);  // the world's middle is the origin
  const auto child = [&](int number) {
    const glm::dvec3 at =
        4.0 * glm::dvec3(2 * (number & 1) - 1, 2 * (number >> 1 & 1) - 1, 2 * (number >> 2) - 1);
    return voxel::combine(universe, voxel::Box{at - 4.0, at + 4.0});
  };
  std::vector<ThesisEntry> entries;
  for (const Column& column : columns) {
    voxel::RenderOptions options;
    options.view = voxel::parse_view(column.view);
    options.size_px = {2, 2};
    options.width_mm = 16.0;
    options.centre_mm = glm::dvec2(0.0);
    options.algorithm = voxel::Algorithm::NodeTrace;
    options.antialias = false;
    // Returns the pixel that an object covers: the number of a child of the quadtree.
    const auto covered = [&](const Octree& object) {
      const voxel::Picture picture = voxel::render({{"child", object}}, options);
      const auto lit =
          std::find_if(picture.object.begin(), picture.object.end(), [](int one) { return one >= 0; });
      return lit - picture.object.begin();
    };
    std::string ours;
    for (int front = 0; front < 8; ++front)
      for (int back = 0; back < 8; ++back) {
        if (front == back || covered(child(front)) != covered(child(back))) continue;
        const voxel::Picture both = voxel::render({{"front", child(front)}, {"back", child(back)}}, options);
        if (std::count(both.object.begin(), both.object.end(), 1) > 0) continue;
        ours += (ours.empty() ? "" : " ") + std::to_string(front) + "-" + std::to_string(back);
      }
    entries.push_back({"table 4.3", std::string("front and back children seen from ") + column.view,
                       column.printed, ours, column.note});
  }
  return entries;
}

/// The motion of marked points (8.3), by how far its definitions are missed, in mm or degrees: first for
/// three points whose ends are marked with errors, then for two points with their common normal in place of a
/// third.
std::vector<ThesisEntry> equations_of_8_3() {
  using glm::dvec3;
  const auto moved_by = [](const std::array<dvec3, 3>& from, const std::array<dvec3, 3>& to) {
    std::vector<brep::Landmark> moving, fixed;
    for (std::size_t i = 0; i < 3; ++i) {
      moving.push_back({"a" + std::to_string(i + 1), from[i]});
      fixed.push_back({"a" + std::to_string(i + 1), to[i]});
    }
    return brep::register_landmarks(moving, fixed, brep::MotionModel::three_points).fixed_from_moving;
  };
  const auto carried = [](const glm::dmat4& motion, const dvec3& p) {
    return dvec3(motion * glm::dvec4(p, 1.0));
  };
  const auto angle = [](const dvec3& a, const dvec3& b) {
    return glm::degrees(std::atan2(glm::length(glm::cross(a, b)), glm::dot(a, b)));
  };
  const auto off = [](double value) {
    return std::abs(value) < 1e-6 ? std::string("0") : std::to_string(value);
  };
  std::vector<ThesisEntry> entries;
  const auto hold = [&](const char* item, const std::array<dvec3, 3>& from, const std::array<dvec3, 3>& to) {
    const glm::dmat4 motion = moved_by(from, to);
    const std::array<dvec3, 3> at{carried(motion, from[0]), carried(motion, from[1]),
                                  carried(motion, from[2])};
    const std::string name = std::string(item) + ": ";
    entries.push_back(
        {"section 8.3", name + "the first point from its end", "0", off(glm::distance(at[0], to[0]))});
    entries.push_back(
        {"section 8.3", name + "a2 - a1 from its direction", "0", off(angle(at[1] - at[0], to[1] - to[0]))});
    entries.push_back(
        {"section 8.3", name + "(a2 - a1) ^ (a3 - a1) from its direction", "0",
         off(angle(glm::cross(at[1] - at[0], at[2] - at[0]), glm::cross(to[1] - to[0], to[2] - to[0])))});
    return motion;
  };
  // The ends are marked a few millimetres off a rigid motion, so that the motion depends on the definitions.
  const std::array<dvec3, 3> from{dvec3(1.0, -62.0, -30.0), dvec3(31.0, -8.0, -41.0),
                                  dvec3(-29.0, -11.0, -37.0)};
  const std::array<dvec3, 3> to{dvec3(2.0, -69.0, -26.0), dvec3(30.0, -14.0, -45.0),
                                dvec3(-31.0, -15.0, -33.0)};
  hold("equations 8.6 to 8.9", from, to);
  const dvec3 normal = glm::cross(from[1] - from[0], to[1] - to[0]);
  const glm::dmat4 two =
      hold("equations 8.10 to 8.12", {from[0], from[1], from[0] + normal}, {to[0], to[1], to[0] + normal});
  entries.push_back({"section 8.3", "equations 8.10 to 8.12: two points turn about their common normal", "0",
                     off(angle(glm::dmat3(two) * normal, normal))});
  return entries;
}

/// The shading case for each of the 16 states of four neighbours. The cases stand for the slopes 1, 1/2, 0,
/// -1/2 and -1.
std::vector<ThesisEntry> table_5_1() {
  struct Row {
    const char* state;  // neighbours DE, D, UE, U, each F or E; x: either
    int multiplicity, number;
  };
  static constexpr std::array<Row, 9> rows{{{"EEFx", 2, 1},
                                            {"EFFx", 2, 2},
                                            {"EEEF", 1, 2},
                                            {"FxFx", 4, 3},
                                            {"EFEF", 1, 3},
                                            {"EEEE", 1, 3},
                                            {"FxEF", 2, 4},
                                            {"EFEE", 1, 4},
                                            {"FxEE", 2, 5}}};
  voxel::Universe universe;
  universe.depth = 3;
  const auto at = [&](const glm::ivec3& v) {
    const glm::dvec3 p(v);
    return voxel::combine(universe, voxel::Box{p - 0.25, p + 0.25});
  };
  const std::array<Octree, 4> neighbours{at({4, 3, 2}), at({3, 3, 2}), at({4, 3, 4}), at({3, 3, 4})};
  std::vector<ThesisEntry> entries;
  for (const Row& row : rows) {
    std::set<int> cases;
    int multiplicity = 0;
    for (unsigned state = 0; state < 16; ++state) {
      bool meant = true;
      // The object consists of the voxel, its neighbours on the surface to the south and north, and the Full
      // ones of the four neighbours.
      Expression object = Expression(at({3, 3, 3})) | at({3, 2, 3}) | at({3, 4, 3});
      for (std::size_t i = 0; i < 4; ++i) {
        const bool full = (state >> i) & 1;
        meant = meant && (row.state[i] == 'x' || (row.state[i] == 'F') == full);
        if (full) object = object | neighbours[i];
      }
      if (!meant) continue;
      ++multiplicity;
      const glm::dvec3 normal = voxel::context_normal(voxel::combine(universe, object), {3, 3, 3}, 0, 1);
      cases.insert(3 + static_cast<int>(2.0 * normal.z / normal.x));
    }
    std::string ours = std::to_string(multiplicity) + " of case";
    for (const int number : cases) ours += " " + std::to_string(number);
    entries.push_back({"table 5.1", std::string("neighbours DE D UE U = ") + row.state,
                       std::to_string(row.multiplicity) + " of case " + std::to_string(row.number), ours});
  }
  return entries;
}

/// The possible statuses of a Boolean of two trees, found with pairs of trees that are complementary,
/// disjoint, equal or crossing.
std::vector<ThesisEntry> table_7_1() {
  voxel::Universe universe;
  universe.depth = 5;
  const Octree empty = Octree::empty(universe), full = Octree::full(universe);
  const Octree half = voxel::combine(universe, voxel::Box{glm::dvec3(-1.0), {15.5, 40.0, 40.0}});
  const Octree other_half = voxel::combine(universe, ~Expression(half));
  const Octree ball = voxel::combine(universe, voxel::Sphere{glm::dvec3(16.0), 9.0});
  const std::map<char, std::vector<Octree>> trees{
      {'F', {full}}, {'E', {empty}}, {'P', {half, other_half, ball}}};
  const auto status = [&](const Octree& octree) {
    return octree.is_empty() ? 'E' : octree == full ? 'F' : 'P';
  };
  struct Column {
    const char* name;
    Expression (*of)(const Expression&, const Expression&);
    std::array<const char*, 9> printed;  // rows of tree B: F, E, P; columns of tree A: F, E, P
  };
  const std::array<Column, 3> columns{{{"A n B",
                                        [](const Expression& a, const Expression& b) { return a & b; },
                                        {"F", "E", "P", "E", "E", "E", "P", "E", "P/E"}},
                                       {"A - B",
                                        [](const Expression& a, const Expression& b) { return a - b; },
                                        {"E", "E", "E", "F", "E", "P", "P", "E", "P/E"}},
                                       {"A u B",
                                        [](const Expression& a, const Expression& b) { return a | b; },
                                        {"F", "F", "F", "F", "E", "P", "F", "P", "P/F"}}}};
  std::vector<ThesisEntry> entries;
  for (const Column& column : columns)
    for (std::size_t row = 0; row < 9; ++row) {
      const char a = "FEP"[row % 3], b = "FEP"[row / 3];
      std::set<char> found;
      for (const Octree& left : trees.at(a))
        for (const Octree& right : trees.at(b))
          found.insert(status(voxel::combine(universe, column.of(left, right))));
      std::string ours;
      for (const char one : std::string("PFE"))
        if (found.contains(one)) ours += (ours.empty() ? "" : "/") + std::string(1, one);
      entries.push_back({"table 7.1", std::string(column.name) + " for A = " + a + ", B = " + b,
                         column.printed[row], ours});
    }
  return entries;
}

}  // namespace

std::vector<ThesisEntry> thesis_tables() {
  std::vector<ThesisEntry> all;
  for (const auto& part :
       {figure_3_1(), table_3_1(), figure_4_6(), table_4_3(), table_5_1(), table_7_1(), equations_of_8_3()})
    all.insert(all.end(), part.begin(), part.end());
  return all;
}

const std::vector<ThesisGap>& thesis_gaps() {
  static const std::vector<ThesisGap> gaps{
      {"tables 4.2 and 7.2 to 7.6, seconds",
       "the thesis measured seconds on a Norsk Data ND540 and a Sun 3/60 "
       "of 1989, which are not recomputed; visits, nodes and voxels are"}};
  return gaps;
}

}  // namespace octotomy::verify
