// SPDX-License-Identifier: AGPL-3.0-or-later
// Scales and shears an object: a motion that is not rigid, so that volumes, lengths and angles change. Stated in
// one of three ways:
//   factors along the head's directions, then a shear, about one point;
//   a matrix;
//   a linear transform of 3D Slicer or ITK, from its file.
// The voxel kernel reads its windows and masks at each voxel's origin under the map; the mesh kernel maps points.
#include <cmath>

#include "brep/mesh/move.h"
#include "planner/operation/file/itk_transform.h"
#include "planner/operation/object/provenance.h"
#include "planner/operation/table/deformation.h"
#include "planner/operation/table/field_file.h"
#include "planner/operation/table/number_format.h"
#include "planner/operation/table/operation.h"
#include "voxel/solid/expression.h"

namespace octotomy::planner {
namespace {

/// The allowed factors of lengths. With a smaller factor, a sample covers less than a voxel of any plan. With
/// a larger one, the rounding of a voxel exceeds the thickness of bone.
constexpr double least_factor = 0.01, greatest_factor = 100.0;

struct Affine {
  struct Shear {
    double by = 0.0;
    glm::dvec3 along{1, 0, 0}, normal{0, 0, 1};
  };
  ObjectName object;
  std::optional<glm::dvec3> scale;
  std::optional<Shear> shear;
  std::optional<Mark> about_mm;
  std::optional<glm::dmat4> matrix;
  std::filesystem::path file;
};

/// The linear part of the map: first the scale, then the shear.
glm::dmat3 linear_of(const Affine& affine, const glm::dmat3& lps_from_head) {
  glm::dmat3 map(1.0);
  if (affine.scale) {
    glm::dmat3 factors(1.0);
    for (int axis = 0; axis < 3; ++axis) factors[axis][axis] = (*affine.scale)[axis];
    map = lps_from_head * factors * glm::transpose(lps_from_head);
  }
  if (affine.shear)
    map = (glm::dmat3(1.0) + affine.shear->by * glm::outerProduct(glm::normalize(affine.shear->along),
                                                                  glm::normalize(affine.shear->normal))) *
          map;
  return map;
}

/// The reason why a map is refused; none if it is an affine map that scales or shears.
std::optional<std::string> why_refused(const glm::dmat4& map) {
  if (glm::transpose(map)[3] != glm::dvec4(0, 0, 0, 1))
    return "is not affine: its last row must be [0, 0, 0, 1]";
  for (int column = 0; column < 4; ++column)
    for (int row = 0; row < 3; ++row)
      if (!std::isfinite(map[column][row])) return "has a number that is not finite";
  const Deformation found = deformation_of(glm::dmat3(map));
  if (!(found.least_length >= least_factor && found.greatest_length <= greatest_factor))
    return "changes lengths by factors from " + plain(found.least_length) + " to " +
           plain(found.greatest_length) + ", and " + plain(least_factor) + " to " + plain(greatest_factor) +
           " are allowed" +
           (found.least_length < least_factor ? ", because the object would become flat" : "");
  if (found.volume_factor < 0.0) return "mirrors the object: use 'mirror' first, then scale the result";
  if (is_rigid(map)) return "is a rigid motion, which neither scales nor shears: use 'move' instead";
  return std::nullopt;
}

/// The map in a transform's file. Throws std::runtime_error that names the path if why_refused() refuses the
/// map.
TransformFile map_in(const std::filesystem::path& path) {
  TransformFile read = read_itk_transform(path);
  if (const auto why = why_refused(read.moved_from_still))
    throw std::runtime_error(path.string() + ": the transform " + *why);
  return read;
}

glm::dmat4 motion_of(const Affine& affine, const Objects& objects, const std::filesystem::path& folder) {
  if (affine.matrix) return *affine.matrix;
  if (!affine.file.empty()) return map_in(folder / affine.file).moved_from_still;
  const glm::dmat3 map = linear_of(affine, objects.lps_from_head);
  const glm::dvec3 at_mm = mark_mm(*affine.about_mm, objects);
  glm::dmat4 motion(map);
  motion[3] = glm::dvec4(at_mm - map * at_mm, 1.0);
  return motion;
}

void check_shear(const Affine::Shear& shear, const FieldLocation& place) {
  const double off = std::abs(glm::dot(glm::normalize(shear.along), glm::normalize(shear.normal)));
  constexpr double right_angle = 1e-6;  // users copy directions with six decimals
  if (off > right_angle)
    place.refuse("'along' and 'normal' must be at right angles, but differ from that by " +
                 three_figures(glm::degrees(std::asin(std::min(1.0, off)))) + "\u00b0");
}

void check(const Affine& affine, const FieldLocation& place) {
  const bool by_parts = affine.scale || affine.shear;
  const int ways = int{by_parts} + int{affine.matrix.has_value()} + int{!affine.file.empty()};
  if (ways == 0) place.refuse("changes nothing: add 'scale', 'shear' or both, or 'matrix', or 'file'");
  if (ways > 1)
    place.refuse("states its map twice: keep only 'matrix', only 'file', or only 'scale' and 'shear'");
  if (by_parts && !affine.about_mm) place.refuse("'about_mm' is missing: add the point that does not move");
  if (!by_parts && affine.about_mm)
    place.at("about_mm").refuse("is the fixed point of 'scale' and 'shear': add one of them");
  if (affine.matrix) {
    if (const auto why = why_refused(*affine.matrix)) place.at("matrix").refuse(*why);
    return;
  }
  if (by_parts) {
    if (affine.shear) check_shear(*affine.shear, place.at("shear"));
    // This check does not need the head's position, because it does not change the factors.
    if (const auto why = why_refused(glm::dmat4(linear_of(affine, glm::dmat3(1.0)))))
      place.at(affine.scale ? "scale" : "shear").refuse(*why);
    return;
  }
  check_field_file(place.at("file"), affine.file, map_in);
}

std::string definition(const Affine& affine, const Objects&) {
  const std::string& name = affine.object.name;
  if (affine.matrix) return name + " under an affine matrix";
  if (!affine.file.empty()) return name + " under " + affine.file.filename().string();
  std::string text = name;
  if (affine.scale)
    text += " scaled by (" + plain(affine.scale->x) + ", " + plain(affine.scale->y) + ", " +
            plain(affine.scale->z) + ")";
  if (affine.shear) text += std::string(affine.scale ? "," : "") + " sheared by " + plain(affine.shear->by);
  return text;
}

void voxels(const Affine& affine, const VoxelBench& bench, VoxelSide& made) {
  const glm::dmat4 motion = motion_of(affine, bench.objects, bench.folder);
  const Object& still = bench.objects.at(affine.object.name);
  if (is_voxelised(still)) return voxelise(brep::deformed(*still.mesh.whole, motion), bench.universe, made);
  made.symbol = carried(*bench.object(affine.object.name).symbol, motion);
  made.octree = bench.combined(*made.symbol);
  made.lineage = "the object's own definition under an affine map, windows on interpolated samples";
}

void triangles(const Affine& affine, const MeshBench& bench, MeshSide& made) {
  const glm::dmat4 motion = motion_of(affine, bench.objects, bench.folder);
  const Stopwatch watch(bench.timings, "boolean_mesh");
  made.whole = brep::deformed(bench.object(affine.object.name), motion);
  made.lineage = "vertices of a mesh under an affine map";
}

void bound(const Affine& affine, const BoundBench& bench, Object& made) {
  const glm::dmat4 motion = motion_of(affine, bench.objects, bench.folder);
  carry(affine.object.name, motion, bench, made);
  const Deformation found = deformation_of(glm::dmat3(motion));
  made.findings.push_back(in_words(found));
  made.moved->details = {{"is_rigid", false},
                         {"volume_factor", found.volume_factor},
                         {"length_factors", {found.least_length, found.greatest_length}},
                         {"area_factors", {found.least_area, found.greatest_area}},
                         {"most_angle_deg", found.most_angle_deg}};
  if (affine.file.empty()) return;
  const TransformFile read = map_in(bench.folder / affine.file);
  made.findings.insert(made.findings.end(), read.findings.begin(), read.findings.end());
  made.shared_values.push_back("the map in " + affine.file.filename().string());
}

}  // namespace

Operation affine_operation() {
  using Shear = Affine::Shear;
  return Describe<Affine>(
             "affine",
             "Scales and shears an object. This is not a rigid motion: volumes, lengths and angles change.",
             Makes::Object)
      .takes(field("object", &Affine::object, "The object.").required().positional("solid"))
      .takes(field("scale", &Affine::scale,
                   "Factors of the scale, which is done first, along the head's directions: across, front to "
                   "back, upwards.")
                 .for_example("[1.1, 1, 1]"))
      .takes(
          record("shear", &Affine::shear, "A shear, done after the scale.",
                 {field("by", &Shear::by,
                        "Movement in mm for each mm of distance from the plane through 'about_mm'.")
                      .required(),
                  field("along", &Shear::along, "The direction of the movement, LPS.").direction(),
                  field("normal", &Shear::normal, "The normal of the plane, LPS, at right angles to 'along'.")
                      .direction()})
              .for_example(R"({"by": 0.2, "along": [1, 0, 0], "normal": [0, 0, 1]})"))
      .takes(field("about_mm", &Affine::about_mm,
                   "The point that 'scale' and 'shear' do not move: [x, y, z] or a landmark."))
      .takes(field("matrix", &Affine::matrix,
                   "The whole map, instead of 'scale' and 'shear': four rows of four numbers, LPS.")
                 .for_example("[[1.1, 0, 0, 0], [0, 1, 0, 0], [0, 0, 1, 0], [0, 0, 0, 1]]"))
      .takes(field("file", &Affine::file,
                   "A file of the whole map, instead of 'scale' and 'shear': a linear transform of 3D Slicer "
                   "or ITK, .tfm or .h5.")
                 .a_file())
      .example(R"({"id": "wider", "do": "affine", "object": "maxilla", "scale": [1.1, 1, 1],
        "about_mm": [0, -40, -30]})")
      .on_files("octotomy affine maxilla.stl --scale=1.1,1,1 --about=0,-40,-30 -o wider.stl")
      .motion()
      .of_head()
      .check(check)
      .object(definition, voxels, triangles, bound);
}

}  // namespace octotomy::planner
