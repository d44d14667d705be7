// SPDX-License-Identifier: AGPL-3.0-or-later
// Source of types and numberings of cells: The VTK User's Guide, "VTK file formats".
#include "brep/io/vtk_cells.h"

#include <algorithm>
#include <array>

#include "brep/mesh/error.h"

namespace octotomy::brep {
namespace {

using Face = std::vector<int>;  ///< corners of a cell, by their index in it

/// The middle node of an edge of a quadratic cell.
struct Middle {
  int a, b, node;
};

/// A type of cell: its faces seen from outside or, for a surface cell, its outline.
struct Kind {
  int type;
  std::size_t corners;  ///< least number of corners
  bool is_volume;
  std::vector<Face> faces;
  std::vector<Middle> middles = {};
};

const std::vector<Kind>& kinds() {
  const std::vector<Face> tetrahedron{{0, 1, 3}, {1, 2, 3}, {2, 0, 3}, {0, 2, 1}},
      hexahedron{{0, 4, 7, 3}, {1, 2, 6, 5}, {0, 1, 5, 4}, {3, 7, 6, 2}, {0, 3, 2, 1}, {4, 5, 6, 7}},
      voxel{{0, 4, 6, 2}, {1, 3, 7, 5}, {0, 1, 5, 4}, {2, 6, 7, 3}, {0, 2, 3, 1}, {4, 5, 7, 6}},
      wedge{{0, 1, 2}, {3, 5, 4}, {0, 3, 4, 1}, {1, 4, 5, 2}, {2, 5, 3, 0}},
      pyramid{{0, 3, 2, 1}, {0, 1, 4}, {1, 2, 4}, {2, 3, 4}, {3, 0, 4}};
  const std::vector<Middle> of_triangle{{0, 1, 3}, {1, 2, 4}, {2, 0, 5}},
      of_quad{{0, 1, 4}, {1, 2, 5}, {2, 3, 6}, {3, 0, 7}},
      of_tetrahedron{{0, 1, 4}, {1, 2, 5}, {2, 0, 6}, {0, 3, 7}, {1, 3, 8}, {2, 3, 9}},
      of_hexahedron{{0, 1, 8},  {1, 2, 9},  {2, 3, 10}, {3, 0, 11}, {4, 5, 12}, {5, 6, 13},
                    {6, 7, 14}, {7, 4, 15}, {0, 4, 16}, {1, 5, 17}, {2, 6, 18}, {3, 7, 19}},
      of_wedge{{0, 1, 6},  {1, 2, 7},  {2, 0, 8},  {3, 4, 9}, {4, 5, 10},
               {5, 3, 11}, {0, 3, 12}, {1, 4, 13}, {2, 5, 14}},
      of_pyramid{{0, 1, 5}, {1, 2, 6}, {2, 3, 7}, {3, 0, 8}, {0, 4, 9}, {1, 4, 10}, {2, 4, 11}, {3, 4, 12}};
  static const std::vector<Kind> known{{5, 3, false, {{0, 1, 2}}},
                                       {8, 4, false, {{0, 1, 3, 2}}},
                                       {9, 4, false, {{0, 1, 2, 3}}},
                                       {22, 6, false, {{0, 1, 2}}, of_triangle},
                                       {34, 7, false, {{0, 1, 2}}, of_triangle},
                                       {23, 8, false, {{0, 1, 2, 3}}, of_quad},
                                       {28, 9, false, {{0, 1, 2, 3}}, of_quad},
                                       {10, 4, true, tetrahedron},
                                       {11, 8, true, voxel},
                                       {12, 8, true, hexahedron},
                                       {13, 6, true, wedge},
                                       {14, 5, true, pyramid},
                                       {24, 10, true, tetrahedron, of_tetrahedron},
                                       {25, 20, true, hexahedron, of_hexahedron},
                                       {29, 27, true, hexahedron, of_hexahedron},
                                       {26, 15, true, wedge, of_wedge},
                                       {27, 13, true, pyramid, of_pyramid}};
  return known;
}

constexpr int polygon = 7, strip = 6;

bool is_line_or_point(long long type) {
  constexpr std::array<long long, 8> passed{{0, 1, 2, 3, 4, 21, 35, 68}};
  return std::find(passed.begin(), passed.end(), type) != passed.end();
}

const Kind* kind_of(long long type) {
  const auto found =
      std::find_if(kinds().begin(), kinds().end(), [&](const Kind& k) { return k.type == type; });
  return found == kinds().end() ? nullptr : &*found;
}

/// A face's points in order, including the middle nodes of a quadratic cell's edges.
std::vector<long long> outline(const std::vector<long long>& cell, const Kind& kind, const Face& face) {
  std::vector<long long> points;
  for (std::size_t i = 0; i < face.size(); ++i) {
    const int a = face[i], b = face[(i + 1) % face.size()];
    points.push_back(cell[static_cast<std::size_t>(a)]);
    for (const Middle& middle : kind.middles)
      if ((middle.a == a && middle.b == b) || (middle.a == b && middle.b == a))
        points.push_back(cell[static_cast<std::size_t>(middle.node)]);
  }
  return points;
}

/// Six times the volume that a cell's faces enclose; negative where they face inward.
double volume(const std::vector<glm::dvec3>& points, const std::vector<long long>& cell, const Kind& kind) {
  const auto at = [&](int i) { return points[static_cast<std::size_t>(cell[static_cast<std::size_t>(i)])]; };
  const glm::dvec3 origin = at(0);
  double sum = 0.0;
  for (const Face& face : kind.faces)
    for (std::size_t i = 2; i < face.size(); ++i)
      sum += glm::dot(at(face[0]) - origin, glm::cross(at(face[i - 1]) - origin, at(face[i]) - origin));
  return sum;
}

/// Faces of volume cells, found by their corners in ascending order.
struct CellFace {
  std::array<long long, 4> key{-1, -1, -1, -1};
  std::size_t cell = 0;
  std::size_t face = 0;
  bool operator<(const CellFace& other) const {
    return std::tie(key, cell, face) < std::tie(other.key, other.cell, other.face);
  }
};

CellFace keyed(const std::vector<long long>& cell, const Kind& kind, std::size_t cell_number,
               std::size_t face) {
  CellFace made;
  std::size_t count = 0;
  for (const int corner : kind.faces[face]) made.key[count++] = cell[static_cast<std::size_t>(corner)];
  std::sort(made.key.begin(), made.key.end());
  made.cell = cell_number;
  made.face = face;
  return made;
}

void need_points(const std::vector<long long>& cell, std::size_t number, std::size_t least,
                 std::size_t points) {
  const std::string name = "cell " + std::to_string(number);
  if (cell.size() < least) throw Error(ErrorCode::Input, name + " has too few corners for its type");
  for (const long long corner : cell)
    if (corner < 0 || corner >= static_cast<long long>(points))
      throw Error(ErrorCode::Input,
                  name + " refers to point " + std::to_string(corner) + " of " + std::to_string(points));
}

/// The faces that belong to exactly one cell, in the order of the cells.
std::vector<CellFace> outer_faces(std::vector<CellFace> faces) {
  std::sort(faces.begin(), faces.end());
  std::vector<CellFace> outer;
  for (std::size_t i = 0; i < faces.size();) {
    std::size_t end = i + 1;
    while (end < faces.size() && faces[end].key == faces[i].key) ++end;
    if (end == i + 1) outer.push_back(faces[i]);
    i = end;
  }
  std::sort(outer.begin(), outer.end(), [](const CellFace& a, const CellFace& b) {
    return std::tie(a.cell, a.face) < std::tie(b.cell, b.face);
  });
  return outer;
}

void add_surface_cell(const std::vector<long long>& cell, long long type, PolygonSplitter& polygons) {
  if (type == strip) return polygons.add_strip(cell);
  if (type == polygon) return polygons.add(cell);
  const Kind& kind = *kind_of(type);
  polygons.add(outline(cell, kind, kind.faces.front()));
}

}  // namespace

void add_grid_surface(const CellCorners& cells, const std::vector<long long>& types, MeshContent& made) {
  if (types.size() != cells.size())
    throw Error(ErrorCode::Input,
                std::to_string(cells.size()) + " cells have " + std::to_string(types.size()) + " types");
  const auto& points = made.triangles.points_mm;
  std::vector<CellFace> faces;
  std::size_t volumes = 0, surfaces = 0;
  for (std::size_t i = 0; i < cells.size(); ++i) {
    const Kind* kind = kind_of(types[i]);
    if (kind == nullptr && types[i] != polygon && types[i] != strip) {
      if (is_line_or_point(types[i])) continue;
      throw Error(ErrorCode::Input, "cell " + std::to_string(i) + " has type " + std::to_string(types[i]) +
                                        ", which is not read: export the surface as polydata");
    }
    need_points(cells[i], i, kind == nullptr ? 3 : kind->corners, points.size());
    if (kind == nullptr || !kind->is_volume) {
      ++surfaces;
      continue;
    }
    ++volumes;
    for (std::size_t face = 0; face < kind->faces.size(); ++face)
      faces.push_back(keyed(cells[i], *kind, i, face));
  }
  PolygonSplitter polygons(made.triangles, made.polygons);
  if (volumes == 0) {
    for (std::size_t i = 0; i < cells.size(); ++i)
      if (!is_line_or_point(types[i])) add_surface_cell(cells[i], types[i], polygons);
    return;
  }
  for (const CellFace& outer : outer_faces(std::move(faces))) {
    const Kind& kind = *kind_of(types[outer.cell]);
    std::vector<long long> corners = outline(cells[outer.cell], kind, kind.faces[outer.face]);
    if (volume(points, cells[outer.cell], kind) < 0.0) std::reverse(corners.begin(), corners.end());
    polygons.add(corners);
  }
  made.says.tell("file",
                 "the surface around " + std::to_string(volumes) + " volume cells" +
                     (surfaces > 0 ? "; " + std::to_string(surfaces) + " surface cells are left out" : ""));
}

}  // namespace octotomy::brep
