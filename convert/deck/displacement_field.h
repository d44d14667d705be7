// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <glm/glm.hpp>
#include <optional>
#include <vector>

#include "brep/mesh/distance.h"
#include "convert/tet/tetrahedra.h"
#include "voxel/space/progress.h"
#include "voxel/space/scene.h"

namespace octotomy::convert {

/// An element that displacements turn inside out.
struct TurnedOver {
  glm::dvec3 centre_mm{0.0};  ///< its middle before the displacements, LPS
  double volume_ratio = 0.0;  ///< its signed volume after the displacements, divided by that before; at most
                              ///< 0
};

/// The shortest distance over which a displacement of this length may fade without folding space: the
/// steepest slope of the fading function, 135/64, times the length. Millimetres.
double least_fade_mm(double largest_displacement_mm);

/// The displacements of tetrahedra's nodes as a field over space: linear within each element; outside all
/// elements, the displacement of the nearest point of their surface, searched from 1e-6 mm beside the place in a fixed
/// direction, so that rounding does not choose among equally near points. So the field is continuous across the
/// surface, and parts that the elements surround (bone, mouth, airway) move with them. Beyond the elements'
/// box along the patient's axes the displacement fades to zero, because the surrounding tissue holds the
/// parts that the deck leaves out. The fading function is Wendland's (1-r)^4 (4r+1) with r = distance to the
/// box / fade_mm. It has compact support; Fornefett, Rohr and Stiehl, Image and Vision Computing 19 (2001),
/// use it for local deformations of heads.
class DisplacementField {
 public:
  /// Throws std::invalid_argument if there are no elements, if displacements and nodes differ in number, or
  /// `fade_mm` is not above least_fade_mm() of the largest displacement.
  DisplacementField(Tetrahedra tetrahedra, std::vector<glm::dvec3> displacement_mm, double fade_mm);

  /// The displacement of each point, both in LPS millimetres. Parallel. Cost a point: some elements inside,
  /// log n outside.
  std::vector<glm::dvec3> at(const std::vector<glm::dvec3>& points_mm) const;

  /// The field that moves displaced points back. The inverse is exact within the elements if none is
  /// inverted, and beyond their box if the displacement is uniform along their surface.
  DisplacementField inverse() const;
  /// The elements that the displacements invert (negative volume), in the elements' order.
  std::vector<TurnedOver> turned_over() const;

 private:
  struct Bins {
    glm::dvec3 low_mm{0.0};
    double side_mm = 1.0;
    glm::ivec3 dims{1};
    std::vector<std::uint32_t> first;  ///< index of each bin's first element in `tets`, then the end
    std::vector<std::uint32_t> tets;

    glm::ivec3 bin(const glm::dvec3& p_mm) const;
    std::size_t number(const glm::ivec3& bin) const;
  };
  struct Box {
    glm::dvec3 low_mm{0.0}, high_mm{0.0};
  };
  DisplacementField(Tetrahedra tetrahedra, std::vector<glm::dvec3> displacement_mm, double fade_mm, Box box,
                    bool is_inverse);
  static Box box_of(const Tetrahedra& tetrahedra);
  static Bins bins_of(const Tetrahedra& tetrahedra);
  std::optional<glm::dvec3> within(const glm::dvec3& p_mm) const;
  double fading(const glm::dvec3& p_mm) const;
  glm::dvec3 faded(const glm::dvec3& p_mm, const glm::dvec3& displacement_mm) const;

  Tetrahedra tetrahedra_;
  std::vector<glm::dvec3> displacement_mm_;
  Bins bins_;
  brep::Triangles surface_;
  brep::SurfaceTree surface_tree_;
  double fade_mm_;
  Box box_;  ///< box of the nodes before any displacement
  bool is_inverse_;
};

/// A surface whose points are displaced.
brep::Mesh warped(const brep::Mesh& mesh, const DisplacementField& field);

/// The scan of a displaced body: each voxel gets the trilinear sample at the position from which it moved.
/// Precondition: no element is inverted. int16 samples are rounded to the nearest integer. Throws
/// voxel::Stopped.
voxel::Scene warped(const voxel::Scene& scan, const DisplacementField& field,
                    const voxel::Progress& progress = {});

}  // namespace octotomy::convert
