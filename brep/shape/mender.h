// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <cstdint>
#include <optional>
#include <stop_token>
#include <string>
#include <vector>

#include "brep/mesh/disjoint_sets.h"
#include "brep/mesh/mesh.h"
#include "brep/mesh/solid.h"
#include "brep/shape/repair.h"
#include "brep/shape/shell_orientation.h"

namespace octotomy::brep {

/// The steps of repair(): each changes the surface and lists its changes by the numbers of triangles in the input.
/// Steps that need a connected mesh report if the triangles do not form one.
class Mender {
 public:
  explicit Mender(const Triangles& surface);

  /// Merges points within the distance, also in chains; 0 merges equal ones.
  void weld(double distance_mm);
  /// Removes triangles that repeat a point.
  void remove_repeats();
  /// Removes triangles without area, or replaces them by cutting along another diagonal.
  void flip_flat();
  void remove_duplicates();
  /// Orients triangles; returns whether any was reversed.
  bool orient(Nested nested = Nested::Alternating);
  /// Removes triangles with a point that is not finite.
  void remove_not_finite();
  /// Splits fans so that mesh_of() accepts the surface.
  void split();
  /// Replaces the shells by their union; returns false if Booleans compute none.
  bool unite(const std::stop_token& stop);
  /// Replaces the surface by one around the region that it encloses.
  void enclose(const RepairOptions& options);
  /// Replaces the surface by a solid that was made with cells of that size.
  void replace(const Solid& solid, double cell_mm, const std::string& what);
  void fill_holes(const std::optional<double>& longest_mm);
  /// Removes triangles without neighbours and closed shells that enclose almost no volume, such as two
  /// coincident sheets.
  void remove_films();
  void remove_intersections();

  const Triangles& surface() const { return repair_.surface; }
  /// The cell size of the lattice, if the surface was reconstructed.
  const std::optional<double>& cell_mm() const { return repair_.enclosed_cell_mm; }
  /// Whether any side of a triangle is not shared by exactly one other triangle.
  bool is_open() const;
  double extent_mm() const;
  /// Ends the repair. Points that belong to no triangle are left out.
  Repair result();

 private:
  std::string name(std::size_t f) const;
  glm::dvec3 centre(std::size_t f) const;
  void change(const char* step, std::string what, const glm::dvec3& at);
  void left(const char* step, std::string what, const glm::dvec3& at);
  Shells wound_alike(const Neighbours& neighbours);
  /// Compares only points in neighbouring cells of a lattice whose cells are as wide as the distance.
  static void join_near(const std::vector<glm::dvec3>& points, double distance_mm, DisjointSets& sets);
  template <typename Keep>
  void keep_if(const Keep& keep);
  template <typename Run>
  void with_mesh(const char* step, const Run& run);
  /// Replaces the surface and lists the triangles that are no longer in it.
  void replace(Triangles other, const char* step, const std::string& how);
  void drop_unused_points();

  Repair repair_;
  std::vector<std::uint32_t> origin_;  ///< of each triangle, its number in the input
};

}  // namespace octotomy::brep
