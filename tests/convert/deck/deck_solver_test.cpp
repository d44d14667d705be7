// SPDX-License-Identifier: AGPL-3.0-or-later
//
// Decks in the programs that they are made for: CalculiX solves them, gmsh and meshio read them.
#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <fstream>
#include <functional>
#include <gtest/gtest.h>

#include "convert/deck/calculix_result.h"
#include "convert/deck/deck.h"
#include "convert/deck/second_order.h"
#include "convert/tet/octree_tetrahedra.h"
#include "convert/tet/separate_regions.h"
#include "convert/tet/tetrahedralise.h"
#include "tests/convert/surfaces.h"
#include "tests/file_bytes.h"
#include "tests/run_command.h"
#include "tests/voxel/scratch_folder.h"
#include "voxel/solid/combine.h"

namespace octotomy::convert {
namespace {

namespace fs = std::filesystem;

using tests::has_program;
using tests::ScratchFolder;

/// The status of a command that runs in a folder; its output goes to a file there.
int run_in(const ScratchFolder& folder, const std::string& command) {
  return std::system(("cd '" + folder.path().string() + "' && " + command + " > log 2>&1").c_str());
}

std::string log_of(const ScratchFolder& folder) {
  return tests::bytes_of(folder / "log");
}

/// Elements of graded sizes.
Tetrahedra graded_block() {
  voxel::Universe universe;
  universe.depth = 4;
  return tetrahedra_of(voxel::combine(universe, voxel::Box{{0.5, 1.5, 0.5}, {12.5, 12.5, 11.5}}));
}

std::vector<glm::dvec3> displacements_at(const Tetrahedra& t, const std::vector<std::uint32_t>& nodes,
                                         const std::function<glm::dvec3(const glm::dvec3&)>& field) {
  std::vector<glm::dvec3> displacements;
  for (const std::uint32_t node : nodes) displacements.push_back(field(t.nodes_mm[node]));
  return displacements;
}

/// A deck of two regions, two materials, a set, two surfaces and a field.
struct Rich {
  Tetrahedra t = graded_block();
  DeckOptions options;
  Rich() {
    for (const auto& tet : t.tets) t.region_of_tet.push_back(t.nodes_mm[tet[3]].x > 6.0 ? 1 : 0);
    options.title = "rich -- <deck>";
    options.materials = {{"HARD", 17000.0, 0.3}, {"SOFT", 300.0, 0.45}};
    options.material_of_tet = t.region_of_tet;
    options.node_sets = {{"LOW", {}}, {"HIGH", {}}};
    for (const std::uint32_t node : t.boundary_nodes) {
      if (t.nodes_mm[node].z < 0.6) options.node_sets[0].nodes.push_back(node);
      if (t.nodes_mm[node].z > 11.4) options.node_sets[1].nodes.push_back(node);
    }
    options.prescribed = {
        {"LOW", {}}, {"HIGH", std::vector<glm::dvec3>(options.node_sets[1].nodes.size(), {0.0, 0.0, 0.01})}};
    DeckSurface all{"ALL", surface_faces(t)};
    DeckSurface top{"TOP", {}};
    for (const ElementFace& face : all.faces) {
      const auto corners = corners_of(t, face);
      if (std::all_of(corners.begin(), corners.end(),
                      [&](std::uint32_t c) { return t.nodes_mm[c].z > 11.4; }))
        top.faces.push_back(face);
    }
    options.surfaces = {all, top};
    options.fields = {{"HU", std::vector<double>(t.tets.size(), 400.0)}};
  }
};

TEST(DeckSolver, ALinearDisplacementOfTheSurfaceIsLinearWithinToABillionthOfAMillimetre) {
  if (!has_program("ccx")) GTEST_SKIP() << "CalculiX (ccx) is not installed";
  const ScratchFolder folder;
  const Tetrahedra t = graded_block();
  const auto field = [](const glm::dvec3& p) {
    return 1e-6 * glm::dvec3(2.0 * p.x - p.y + 0.5 * p.z, p.x + 3.0 * p.y, -p.y + 1.5 * p.z);
  };
  DeckOptions options;
  options.node_sets = {{"SKIN", t.boundary_nodes}};
  options.prescribed = {{"SKIN", displacements_at(t, t.boundary_nodes, field)}};
  write_deck(t, folder / "patch.inp", options);
  ASSERT_EQ(run_in(folder, "ccx patch"), 0) << log_of(folder);
  const auto solved = read_displacements(folder / "patch.frd", t.nodes_mm.size());
  std::size_t within = 0;
  for (std::size_t i = 0; i < solved.size(); ++i) {
    ASSERT_TRUE(solved[i].has_value()) << "node " << i;
    EXPECT_LT(glm::distance(*solved[i], field(t.nodes_mm[i])), 1e-9) << "node " << i;
    within +=
        !std::binary_search(t.boundary_nodes.begin(), t.boundary_nodes.end(), static_cast<std::uint32_t>(i));
  }
  EXPECT_GT(within, 100U);
}

/// A deck solved, by node.
std::vector<glm::dvec3> solved_by_ccx(const ScratchFolder& folder, const Tetrahedra& t,
                                      const DeckOptions& options) {
  write_deck(t, folder / "job.inp", options);
  EXPECT_EQ(run_in(folder, "ccx job"), 0) << log_of(folder);
  std::vector<glm::dvec3> displacements;
  for (const auto& each : read_displacements(folder / "job.frd", t.nodes_mm.size()))
    displacements.push_back(each.value());
  return displacements;
}

/// The largest distance of nodes from a field, if the nodes of the surface are moved by that field.
double worst_within(const ScratchFolder& folder, const Tetrahedra& t,
                    const std::function<glm::dvec3(const glm::dvec3&)>& field) {
  DeckOptions options;
  options.node_sets = {{"SKIN", t.boundary_nodes}};
  options.prescribed = {{"SKIN", displacements_at(t, t.boundary_nodes, field)}};
  const std::vector<glm::dvec3> solved = solved_by_ccx(folder, t, options);
  double worst = 0.0;
  for (std::size_t i = 0; i < solved.size(); ++i)
    worst = std::max(worst, glm::distance(solved[i], field(t.nodes_mm[i])));
  return worst;
}

TEST(DeckSolver, AQuadraticDisplacementIsQuadraticWithinByTenNodesAndNotByFour) {
  if (!has_program("ccx")) GTEST_SKIP() << "CalculiX (ccx) is not installed";
  const ScratchFolder folder;
  const Tetrahedra linear = graded_block();
  // A field without divergence and with a Laplacian of zero, which is in equilibrium for any stiffness.
  const auto field = [](const glm::dvec3& p) {
    return 1e-6 * glm::dvec3(p.y * p.y - p.z * p.z + p.y * p.z, p.z * p.z - p.x * p.x,
                             p.x * p.x - p.y * p.y + 2.0 * p.x * p.y);
  };
  EXPECT_LT(worst_within(folder, second_order(linear, {}).tetrahedra, field), 1e-9);
  EXPECT_GT(worst_within(folder, linear, field), 1e-7);
}

/// A wall between two balls, pushed out from within by 0.1 and held on the outside: u = a r + b / r^2 for any
/// stiffness.
struct ThickSphere {
  static constexpr double inner = 10.0, outer = 20.0, pushed = 0.1;
  Tetrahedra t;
  DeckOptions options;

  explicit ThickSphere(double max_volume_mm3) {
    const brep::Triangles shell = tests::together(tests::ball({0, 0, 0}, outer, 4),
                                                  tests::inside_out(tests::ball({0, 0, 0}, inner, 4)));
    TetOptions fine;
    fine.max_volume_mm3 = max_volume_mm3;
    t = tetrahedralise(brep::mesh_of(shell), fine);
    options.node_sets = {{"INNER", {}}, {"OUTER", {}}};
    for (const std::uint32_t node : t.boundary_nodes)
      options.node_sets[glm::length(t.nodes_mm[node]) < 15.0 ? 0 : 1].nodes.push_back(node);
    options.prescribed = {
        {"INNER", displacements_at(t, options.node_sets[0].nodes,
                                   [](const glm::dvec3& p) { return pushed * glm::normalize(p); })},
        {"OUTER", {}}};
  }
};

struct WallErrors {
  double mean = 0.0, worst = 0.0;
};
/// The radial displacements in the wall's middle, relative to the closed form.
WallErrors errors_of(const std::vector<glm::dvec3>& nodes_mm, const std::vector<glm::dvec3>& solved) {
  constexpr double inner = ThickSphere::inner, outer = ThickSphere::outer;
  const double b = ThickSphere::pushed / (1.0 / (inner * inner) - inner / (outer * outer * outer));
  const double a = -b / (outer * outer * outer);
  WallErrors errors;
  std::size_t middle = 0;
  for (std::size_t i = 0; i < solved.size(); ++i) {
    const double r = glm::length(nodes_mm[i]);
    if (r < 12.0 || r > 15.0) continue;
    const double error = glm::dot(solved[i], nodes_mm[i]) / r / (a * r + b / (r * r)) - 1.0;
    errors.worst = std::max(errors.worst, std::abs(error));
    errors.mean += error;
    ++middle;
  }
  EXPECT_GT(middle, 50U);
  errors.mean = std::abs(errors.mean / static_cast<double>(middle));
  return errors;
}

TEST(DeckSolver, AThickSpheresWallMovesAsTheClosedFormSaysAndCloserByTenNodesOfTheSameElements) {
  if (!has_program("ccx")) GTEST_SKIP() << "CalculiX (ccx) is not installed";
  const ScratchFolder folder;
  // The mesher is called with 85 % of this volume, so elements take up to 8 mm3: their four nodes are far from
  // exact.
  const ThickSphere wall(8.0 / 0.85);
  const WallErrors by_four = errors_of(wall.t.nodes_mm, solved_by_ccx(folder, wall.t, wall.options));
  EXPECT_LT(by_four.mean, 0.025);
  EXPECT_LT(by_four.worst, 0.12);
  const SecondOrder finer = second_order(wall.t, wall.options);
  const WallErrors by_ten =
      errors_of(finer.tetrahedra.nodes_mm, solved_by_ccx(folder, finer.tetrahedra, finer.options));
  // The remaining mean error comes from the flat triangles, whose middles are prescribed off the balls.
  EXPECT_LT(by_ten.mean, by_four.mean);
  EXPECT_LT(by_ten.worst, 0.25 * by_four.worst);
  RecordProperty("by_four", std::to_string(by_four.mean) + " " + std::to_string(by_four.worst));
  RecordProperty("by_ten", std::to_string(by_ten.mean) + " " + std::to_string(by_ten.worst));
}

TEST(DeckSolver, ASolvedDeckOfTenNodesIsReadAsEightLinearPartsEach) {
  if (!has_program("ccx")) GTEST_SKIP() << "CalculiX (ccx) is not installed";
  const ScratchFolder folder;
  const Rich rich;
  DeckOptions options = rich.options;
  options.second_order = true;
  write_deck(rich.t, folder / "rich.inp", options);
  ASSERT_EQ(run_in(folder, "ccx rich"), 0) << log_of(folder);
  const SolvedDeck solved = read_solved_deck(folder / "rich.frd");
  EXPECT_EQ(solved.tetrahedra.tets.size(), 8 * rich.t.tets.size());
  EXPECT_GT(quality(solved.tetrahedra).min_volume_mm3, 0.0);
  EXPECT_NEAR(quality(solved.tetrahedra).volume_mm3, 12.0 * 11.0 * 11.0, 1e-3);
  for (std::size_t i = 0; i < solved.displacement_mm.size(); ++i) {
    if (solved.tetrahedra.nodes_mm[i].z > 11.4) {
      EXPECT_EQ(solved.displacement_mm[i], glm::dvec3(0.0, 0.0, 0.01));
    }
  }
}

/// Two blocks of 6 x 6 x 6 mm, one on top of the other, that touch or share their nodes; the lower one is
/// held below, the upper one moved above.
struct TwoBlocks {
  Tetrahedra t;
  DeckOptions options;

  TwoBlocks(bool contact, double moved_mm) {
    voxel::Universe universe;
    universe.depth = 4;
    t = tetrahedra_of({voxel::combine(universe, voxel::Box{{-0.5, -0.5, -0.5}, {5.5, 5.5, 5.5}}),
                       voxel::combine(universe, voxel::Box{{-0.5, -0.5, 5.5}, {5.5, 5.5, 11.5}})},
                      BoundaryCells::Voxels);
    const Interface between = interfaces(t).front();
    if (contact) {
      options.surfaces = {{"LOWER", between.faces}, {"UPPER", between.opposite}};
      options.contacts = {{"PAIR", "LOWER", "UPPER"}};
      t = separate_regions(t);
    }
    options.node_sets = {{"HELD", {}}, {"MOVED", {}}};
    for (const std::uint32_t node : t.boundary_nodes) {
      if (t.nodes_mm[node].z < -0.4) options.node_sets[0].nodes.push_back(node);
      if (t.nodes_mm[node].z > 11.4) options.node_sets[1].nodes.push_back(node);
    }
    options.prescribed = {
        {"HELD", {}},
        {"MOVED", std::vector<glm::dvec3>(options.node_sets[1].nodes.size(), {0.0, 0.0, moved_mm})}};
  }

  /// Mean displacement along z of the lower block's nodes between the two.
  double between_mm(const ScratchFolder& folder) const {
    const std::vector<glm::dvec3> solved = solved_by_ccx(folder, t, options);
    std::vector<bool> is_lower(t.nodes_mm.size(), false);
    for (std::size_t i = 0; i < t.tets.size(); ++i)
      if (t.region_of_tet[i] == 0)
        for (const std::uint32_t v : t.tets[i]) is_lower[v] = true;
    double sum = 0.0;
    std::size_t count = 0;
    for (std::size_t i = 0; i < solved.size(); ++i)
      if (is_lower[i] && std::abs(t.nodes_mm[i].z - 5.5) < 1e-9) {
        sum += solved[i].z;
        ++count;
      }
    EXPECT_EQ(count, 49u);
    return sum / static_cast<double>(count);
  }
};

TEST(DeckSolver, ContactPressesAsSharedNodesDoAndLetsGoWhereTheyPull) {
  if (!has_program("ccx")) GTEST_SKIP() << "CalculiX (ccx) is not installed";
  const ScratchFolder folder;
  // By symmetry, the plane between two equal blocks moves half as far.
  EXPECT_NEAR(TwoBlocks(false, -0.06).between_mm(folder), -0.03, 1e-4);
  EXPECT_NEAR(TwoBlocks(true, -0.06).between_mm(folder), -0.03, 1e-3);
  EXPECT_NEAR(TwoBlocks(false, 0.06).between_mm(folder), 0.03, 1e-4);
  EXPECT_NEAR(TwoBlocks(true, 0.06).between_mm(folder), 0.0, 1e-3);
}

TEST(DeckSolver, AFebioDeckHasItsContactPairs) {
  if (!has_program("/usr/bin/python3")) GTEST_SKIP() << "python3 is not installed";
  const ScratchFolder folder;
  const TwoBlocks blocks(true, -0.06);
  write_deck(blocks.t, folder / "blocks.feb", blocks.options);
  std::ofstream(folder / "look.py")
      << "import xml.etree.ElementTree as E\n"
         "root = E.parse('blocks.feb').getroot()\n"
         "surfaces = {s.attrib['name'] for s in root.find('Mesh').findall('Surface')}\n"
         "pairs = {p.attrib['name']: (p.find('primary').text, p.find('secondary').text)\n"
         "         for p in root.find('Mesh').findall('SurfacePair')}\n"
         "assert pairs == {'PAIR': ('LOWER', 'UPPER')} and surfaces == {'LOWER', 'UPPER'}, pairs\n"
         "contacts = root.find('Contact').findall('contact')\n"
         "assert [c.attrib['surface_pair'] for c in contacts] == ['PAIR']\n"
         "assert float(contacts[0].find('penalty').text) == 170000\n";
  EXPECT_EQ(run_in(folder, "/usr/bin/python3 look.py"), 0) << log_of(folder);
}

TEST(DeckSolver, AResultOfAnotherDeckOrOfNoneIsRefused) {
  const ScratchFolder folder;
  std::ofstream(folder / "a.frd")
      << "    1C\n -4  DISP        4    1\n -1         9 1.00000E-01 0.00000E+00-2.00000E-01\n -3\n";
  EXPECT_EQ(read_displacements(folder / "a.frd", 9)[8], glm::dvec3(0.1, 0.0, -0.2));
  EXPECT_EQ(read_displacements(folder / "a.frd", 9)[3], std::nullopt);
  EXPECT_THROW(read_displacements(folder / "a.frd", 8), std::runtime_error);
  std::ofstream(folder / "b.frd") << "    1C\n -4  STRESS      4    1\n -3\n";
  EXPECT_THROW(read_displacements(folder / "b.frd", 9), std::runtime_error);
}

TEST(Deck, FacesOfTheSurfaceFaceOutward) {
  const Rich rich;
  glm::dvec3 sum(0.0);
  double six = 0.0;
  for (const ElementFace& face : rich.options.surfaces[0].faces) {
    const auto [a, b, c] = corners_of(rich.t, face);
    const auto& p = rich.t.nodes_mm;
    sum += glm::cross(p[b] - p[a], p[c] - p[a]);
    six += glm::dot(p[a], glm::cross(p[b], p[c]));
  }
  EXPECT_LT(glm::length(sum), 1e-9);
  EXPECT_NEAR(six / 6.0, 12.0 * 11.0 * 11.0, 1e-6);
  for (const ElementFace& face : rich.options.surfaces[1].faces) {
    const auto [a, b, c] = corners_of(rich.t, face);
    const auto& p = rich.t.nodes_mm;
    EXPECT_GT(glm::cross(p[b] - p[a], p[c] - p[a]).z, 0.0);
  }
}

TEST(DeckSolver, CalculixTakesRegionsMaterialsSurfacesAndAStep) {
  if (!has_program("ccx")) GTEST_SKIP() << "CalculiX (ccx) is not installed";
  const ScratchFolder folder;
  const Rich rich;
  write_deck(rich.t, folder / "rich.inp", rich.options);
  ASSERT_EQ(run_in(folder, "ccx rich"), 0) << log_of(folder);
  const auto solved = read_displacements(folder / "rich.frd", rich.t.nodes_mm.size());
  for (const std::uint32_t node : rich.options.node_sets[1].nodes)
    EXPECT_EQ(solved[node], glm::dvec3(0.0, 0.0, 0.01));
  for (const std::uint32_t node : rich.options.node_sets[0].nodes) EXPECT_EQ(solved[node], glm::dvec3(0.0));
}

TEST(DeckSolver, GmshFindsNothingWrongWithEitherVersion) {
  if (!has_program("gmsh")) GTEST_SKIP() << "gmsh is not installed";
  const ScratchFolder folder;
  Rich rich;
  rich.options.surfaces.pop_back();  // its faces would stand there twice
  for (const auto& [old, second] : {std::pair{false, false}, {true, false}, {false, true}, {true, true}}) {
    rich.options.msh_2_2 = old;
    rich.options.second_order = second;
    write_deck(rich.t, folder / "rich.msh", rich.options);
    ASSERT_EQ(run_in(folder, "gmsh -check rich.msh"), 0) << log_of(folder);
    EXPECT_EQ(log_of(folder).find("Error"), std::string::npos) << log_of(folder);
    EXPECT_EQ(log_of(folder).find("Warning"), std::string::npos) << log_of(folder);
  }
}

TEST(DeckSolver, MeshioReadsTheSameNodesElementsRegionsAndSets) {
  if (std::system("/usr/bin/python3 -c 'import meshio' > /dev/null 2>&1") != 0)
    GTEST_SKIP() << "python3-meshio is not installed";
  const ScratchFolder folder;
  const Rich rich;
  write_deck(rich.t, folder / "rich.inp", rich.options);
  write_deck(rich.t, folder / "rich.vtu", rich.options);
  write_deck(rich.t, folder / "rich.msh", rich.options);
  write_deck(rich.t, folder / "rich.node", rich.options);
  const std::string tets = std::to_string(rich.t.tets.size());
  const std::string nodes = std::to_string(rich.t.nodes_mm.size());
  std::ofstream(folder / "look.py")
      << "import meshio, numpy\n"
         "for name in ('rich.inp', 'rich.vtu', 'rich.msh', 'rich.ele'):\n"
         "    mesh = meshio.read(name)\n"
         "    cells = numpy.vstack([c.data for c in mesh.cells if c.type == 'tetra'])\n"
         "    p = mesh.points[cells]\n"
         "    six = numpy.einsum('ij,ij->i', numpy.cross(p[:,1]-p[:,0], p[:,2]-p[:,0]), p[:,3]-p[:,0])\n"
         "    assert six.min() > 0, name\n"
         "    assert abs(six.sum() / 6 - 12 * 11 * 11) < 1e-6, name\n"
         "    assert len(cells) == "
      << tets << " and len(mesh.points) == " << nodes
      << ", name\n"
         "mesh = meshio.read('rich.vtu')\n"
         "assert sorted(set(mesh.cell_data['region'][0])) == [0, 1]\n"
         "assert set(mesh.cell_data['HU'][0]) == {400.0}\n"
         "assert mesh.point_data['HIGH'].sum() == "
      << rich.options.node_sets[1].nodes.size()
      << "\n"
         "mesh = meshio.read('rich.inp')\n"
         "assert len(mesh.point_sets['HIGH']) == "
      << rich.options.node_sets[1].nodes.size() << "\n";
  EXPECT_EQ(run_in(folder, "/usr/bin/python3 look.py"), 0) << log_of(folder);
}

TEST(DeckSolver, MeshioFindsNodesInTheMiddleOfTheSidesThatItsOrderSays) {
  if (std::system("/usr/bin/python3 -c 'import meshio' > /dev/null 2>&1") != 0)
    GTEST_SKIP() << "python3-meshio is not installed";
  const ScratchFolder folder;
  Rich rich;
  rich.options.second_order = true;
  rich.options.surfaces.pop_back();
  for (const char* name : {"rich.inp", "rich.vtu", "rich.msh", "rich.feb"})
    write_deck(rich.t, folder / name, rich.options);
  std::ofstream(folder / "look.py")
      << "import meshio, numpy\n"
         "import xml.etree.ElementTree as E\n"
         "sides = ((0, 1), (1, 2), (2, 0), (0, 3), (1, 3), (2, 3))\n"
         "def check(points, cells, name):\n"
         "    assert len(cells) == "
      << rich.t.tets.size()
      << ", name\n"
         "    for k, (a, b) in enumerate(sides):\n"
         "        mean = (points[cells[:, a]] + points[cells[:, b]]) / 2\n"
         "        assert abs(points[cells[:, 4 + k]] - mean).max() < 1e-9, (name, k)\n"
         "    assert len(set(cells.ravel())) == len(points), name\n"
         "for name in ('rich.inp', 'rich.vtu', 'rich.msh'):\n"
         "    mesh = meshio.read(name)\n"
         "    check(mesh.points, numpy.vstack([c.data for c in mesh.cells if c.type == 'tetra10']), name)\n"
         "    for c in mesh.cells:\n"
         "        if c.type == 'triangle6':\n"
         "            for k in range(3):\n"
         "                mean = (mesh.points[c.data[:, k]] + mesh.points[c.data[:, (k + 1) % 3]]) / 2\n"
         "                assert abs(mesh.points[c.data[:, 3 + k]] - mean).max() < 1e-9, (name, k)\n"
         "root = E.parse('rich.feb').getroot().find('Mesh')\n"
         "points = numpy.array([[float(x) for x in n.text.split(',')] for n in root.find('Nodes')])\n"
         "rows = [e for block in root.findall('Elements') for e in block]\n"
         "assert {b.attrib['type'] for b in root.findall('Elements')} == {'tet10'}\n"
         "cells = numpy.array([[int(x) - 1 for x in e.text.split(',')] for e in rows])\n"
         "check(points, cells, 'rich.feb')\n"
         "faces = numpy.array([[int(x) - 1 for x in e.text.split(',')] for e in root.find('Surface')])\n"
         "for k in range(3):\n"
         "    mean = (points[faces[:, k]] + points[faces[:, (k + 1) % 3]]) / 2\n"
         "    assert abs(points[faces[:, 3 + k]] - mean).max() < 1e-9, k\n";
  EXPECT_EQ(run_in(folder, "/usr/bin/python3 look.py"), 0) << log_of(folder);
}

TEST(DeckSolver, AFebioDeckIsWholeXmlWithItsSetsAndMaps) {
  if (!has_program("/usr/bin/python3")) GTEST_SKIP() << "python3 is not installed";
  const ScratchFolder folder;
  const Rich rich;
  write_deck(rich.t, folder / "rich.feb", rich.options);
  std::ofstream(folder / "look.py")
      << "import xml.etree.ElementTree as E\n"
         "root = E.parse('rich.feb').getroot()\n"
         "assert root.attrib['version'] == '4.0'\n"
         "mesh = root.find('Mesh')\n"
         "assert len(mesh.find('Nodes')) == "
      << rich.t.nodes_mm.size()
      << "\n"
         "blocks = {e.attrib['name']: len(e) for e in mesh.findall('Elements')}\n"
         "assert sum(blocks.values()) == "
      << rich.t.tets.size()
      << " and len(blocks) == 2, blocks\n"
         "domains = {d.attrib['name']: d.attrib['mat'] for d in root.find('MeshDomains')}\n"
         "assert domains == {'REGION1_HARD': 'HARD', 'REGION2_SOFT': 'SOFT'}, domains\n"
         "sets = {s.attrib['name']: len(s.text.split(',')) for s in mesh.findall('NodeSet')}\n"
         "assert sets['HIGH'] == "
      << rich.options.node_sets[1].nodes.size()
      << "\n"
         "assert len(mesh.findall('Surface')) == 2\n"
         "maps = [d for d in root.find('MeshData')]\n"
         "assert len(maps) == 3 and all(len(m) == sets['HIGH'] for m in maps)\n"
         "assert {n.text for n in maps[2]} == {'0.01'}\n"
         "assert len(root.find('Boundary')) == 4\n";
  EXPECT_EQ(run_in(folder, "/usr/bin/python3 look.py"), 0) << log_of(folder);
}

TEST(Deck, SetsMaterialsAndDisplacementsThatDoNotFitAreRefused) {
  const ScratchFolder folder;
  const auto refused = [&](const std::function<void(Rich&)>& spoil) {
    Rich rich;
    spoil(rich);
    EXPECT_THROW(write_deck(rich.t, folder / "a.inp", rich.options), std::invalid_argument);
  };
  refused([](Rich& r) { r.options.node_sets[0].nodes.push_back(1U << 30); });
  refused([](Rich& r) { r.options.prescribed[1].displacement_mm.pop_back(); });
  refused([](Rich& r) { r.options.prescribed[0].node_set = "NONE"; });
  refused([](Rich& r) { r.options.material_of_tet[5] = 2; });
  refused([](Rich& r) { r.options.surfaces[0].faces[0].opposite = 4; });
  refused([](Rich& r) { r.options.fields[0].values.pop_back(); });
  refused([](Rich& r) { r.t.region_of_tet.pop_back(); });
  refused([](Rich& r) { r.options.contacts = {{"PAIR", "ALL", "NONE"}}; });
  refused([](Rich& r) { r.options.materials[1].youngs_modulus_mpa = 0.0; });
}

}  // namespace
}  // namespace octotomy::convert
