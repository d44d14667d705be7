// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <deque>
#include <glm/glm.hpp>
#include <limits>
#include <map>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "brep/mesh/solid.h"
#include "planner/operation/table/field.h"
#include "verify/certificate/certificate.h"
#include "verify/witness/reading.h"
#include "voxel/measure/measure.h"
#include "voxel/solid/expression.h"
#include "voxel/space/scene.h"
#include "voxel/tree/grey_octree.h"
#include "voxel/tree/octree.h"

namespace octotomy::planner {

/// The voxel kernel's answer for an operation.
struct VoxelSide {
  explicit VoxelSide(const voxel::Universe& universe) : octree(voxel::Octree::empty(universe)) {}

  voxel::Octree octree;
  /// The object as an expression of windows on samples. A motion then interpolates the samples only once.
  std::optional<voxel::Expression> symbol;
  voxel::Measures measures;
  std::string lineage;
  std::vector<std::string> makers;  ///< the code that computed it and its inputs (verify::Answer)
  std::vector<std::string> findings;
};

/// The mesh kernel's answer for the same operation.
struct MeshSide {
  std::optional<brep::Solid> whole;   ///< the whole solid, also beyond the universe; none if the kernel has
                                      ///< no answer
  std::optional<brep::Solid> within;  ///< the part of `whole` within the universe
  std::string lineage;
  std::vector<std::string> makers;  ///< as in VoxelSide
  double shift_mm = 0.0;            ///< the largest distance by which Booleans moved operands
  std::vector<std::string> findings;
  nlohmann::ordered_json details = nlohmann::ordered_json::object();  ///< further results of the operation
  /// If the object is a selection of another object's parts: that object's name, and the parts that were left
  /// out.
  std::optional<std::pair<std::string, brep::Solid>> parts_of = {};
};

/// A plane along which an object was cut. At the time of the cut it was parallel to a side of the universe.
struct CutPlane {
  int axis = 0;                ///< axis of the universe along which its normal was at that time
  glm::dvec3 normal{1, 0, 0};  ///< its current normal
  double offset_mm = 0.0;      ///< normal . p for points p of the plane
  double voxels = 1.0;         ///< error of a cut along it, relative to that of a cut through voxels
};

/// A window on samples that shows an object's surface. Except at cuts, the surface lies at the lower bound of
/// one of these windows.
struct Shown {
  voxel::GreyOctree grey;
  double threshold = 0.0;
  std::string scan;                                  ///< name of the scan of `grey`
  glm::dmat4 moved_from_still{1.0};                  ///< motion by all steps since the surface was made, LPS
                                                     ///< to LPS
  std::shared_ptr<const voxel::Scene> samples = {};  ///< samples of the scan; null: only `grey` shows the
                                                     ///< surface
  double high = std::numeric_limits<double>::infinity();  ///< the window's upper bound
};

/// The terms of the bound of a certificate.
struct BoundTerms {
  std::vector<CutPlane> planes;
  glm::dvec3 spacing_mm{0.0};  ///< spacing of the coarsest scan from which the object derives; zero if there
                               ///< is none
  std::optional<voxel::Box> scan_box_mm;  ///< box of the scan from which the object derives; none after a
                                          ///< motion
  bool voxels_are_samples = false;
  double shift_mm = 0.0;       ///< the largest distance by which Booleans moved operands, from all earlier
                               ///< steps (brep::Booleans)
  std::vector<Shown> windows;  ///< windows of all objects from which it was made; their bounds determine its
                               ///< surface
  /// Names of earlier objects whose surface was replaced by an offset, by smoothing or by decimation. The
  /// uncertainty of their surfaces also applies to this object.
  std::vector<std::string> reshaped;
  /// The mean distance by which two correct answers may differ, because each kernel computes distances
  /// separately (verify::BoundInputs).
  double measured_apart_mm = 0.0;
};

/// The wall of a mask that cut an object, and the motion of the object by all steps since the cut, LPS to
/// LPS.
struct CutWall {
  std::string mask;
  brep::Solid wall;
  glm::dmat4 moved_from_still{1.0};
};

/// A reason why an object's certificate cannot be PASS even if the kernels agree.
struct Caveat {
  voxel::Verdict verdict = voxel::Verdict::Warn;
  std::string reason;
  bool is_inherited = false;  ///< whether the caveat comes from an object from which it was made
  bool is_of_place = false;   ///< whether it depends on the object's position, so that a moved object does
                              ///< not inherit it
  /// An upper bound of the missing tissue in mm3. None: unknown, or the caveat has another subject.
  std::optional<double> missing_mm3 = {};
};

/// The object that an operation made, in both kernels.
struct Object {
  Object(std::string name, std::string operation, const voxel::Universe& universe)
      : id(std::move(name)), kind(std::move(operation)), voxel(universe) {}

  std::string id;
  std::string kind;              ///< the operation's name
  std::string definition;        ///< in words: "skull & cut"
  bool is_tool = false;          ///< it only helps to make other objects, like a mask
  bool is_interpolated = false;  ///< whether a part of it comes from samples between images
  bool is_surely_empty = false;  ///< its definition is empty for all operands, for example a - a
  VoxelSide voxel;
  MeshSide mesh;
  BoundTerms bound;
  verify::Witness witness;  ///< describes `mesh.whole`; empty if there is no independent witness
  std::optional<verify::Certificate> certificate;  ///< none for tools, and if certify() cannot judge the
                                                   ///< object
  std::vector<std::string> findings;
  /// The finding that the scan's border cuts off the object, beyond which neither kernel has data. A moved
  /// object keeps the finding.
  std::optional<std::string> border_finding;
  std::vector<Caveat> caveats;
  /// Inputs that were computed only once and that both kernels use, such as values from a step or filtered
  /// samples. An error in them cannot appear as a disagreement.
  std::vector<std::string> shared_values;
  bool ends_with_universe = false;  ///< if it moves, its mesh stays cut at the universe's border
  std::optional<Shown> shown;
  /// The last motion of a moved object.
  struct Moved {
    std::string object;      ///< name of the object before the motion
    glm::dmat4 motion{1.0};  ///< LPS to LPS; affine, because a step may scale or shear (is_rigid())
    /// Facts about the motion for the report, such as residuals of points.
    nlohmann::ordered_json details = nlohmann::ordered_json::object();
  };
  std::optional<Moved> moved;
  /// Set if the object is an image of another object: moved, mirrored, scaled or sheared, by one step or
  /// several.
  struct Image {
    std::string object;                 ///< the original object, which is not an image
    glm::dmat4 image_from_object{1.0};  ///< affine
    /// Whether both objects lie wholly within the universe, so that their volumes differ exactly by the
    /// determinant.
    bool is_whole = false;
  };
  std::optional<Image> image;
  std::vector<CutWall> walls;  ///< one wall for each mask with a mesh that cut this object
};

/// The objects that steps have made so far, in their order. References stay valid when objects are added.
class Objects {
 public:
  /// The object of this name. Throws std::invalid_argument if there is none.
  const Object& at(const std::string& name) const;
  const Object& add(Object object);

  auto begin() const { return objects_.begin(); }
  auto end() const { return objects_.end(); }
  auto rbegin() const { return objects_.rbegin(); }
  auto rend() const { return objects_.rend(); }
  std::size_t size() const { return objects_.size(); }
  const Object& operator[](std::size_t index) const { return objects_[index]; }
  const Object& front() const { return objects_.front(); }
  const Object& back() const { return objects_.back(); }
  /// A changeable object, for adding its certificate and for tests.
  Object& change(std::size_t index) { return objects_[index]; }

  /// The head's orientation: the columns are the head's directions left, back and up as unit vectors in LPS.
  glm::dmat3 lps_from_head{1.0};

 private:
  std::deque<Object> objects_;
  std::map<std::string, std::size_t> index_;
};

/// The original object of an image; the object itself if it is not an image.
const Object& still_of(const Objects& objects, const Object& object);
/// The combined motion of all steps that moved an object since it was made, LPS to LPS.
glm::dmat4 moved_since_made(const Objects& objects, const std::string& object);
/// The position of a mark, LPS mm. A landmark that is attached to an object moves with that object.
glm::dvec3 mark_mm(const Mark& mark, const Objects& objects);

}  // namespace octotomy::planner
