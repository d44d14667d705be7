// SPDX-License-Identifier: AGPL-3.0-or-later
//
// 1 choose the planes; 2 follow each object's outlines on them; 3 describe the regions, their contours and the
// images that they refer to.
#include "voxel/archive/write_rtstruct.h"

#include <array>
#include <cmath>
#include <cstdio>
#include <set>
#include <stdexcept>

#include "voxel/archive/pixel_outlines.h"
#include "voxel/dicom/character_set.h"
#include "voxel/scan/dicom_derived.h"
#include "voxel/space/error.h"
#include "voxel/space/staged_files.h"
#include "voxel/tree/slice_bits.h"

namespace octotomy::voxel {
namespace {

namespace fs = std::filesystem;
using Items = std::vector<DicomAttributes>;
using Objects = std::span<const DicomSegment>;

constexpr const char* structure_set_storage = "1.2.840.10008.5.1.4.1.1.481.3";
/// The SOP class that references to a study state (PS3.6). The standard has retired it, but readers still
/// expect it.
constexpr const char* study_class = "1.2.840.10008.3.1.2.3.1";

/// Files state positions to a hundredth of a millimetre or better, so planes closer than this count as one.
constexpr double same_plane_mm() {
  return 0.01;
}

DicomAttributes implicit() {
  return DicomAttributes(DicomAttributes::Coding::ImplicitVr);
}

/// A plane on which contours are drawn: its position along the voxels' third axis, and the nearest plane of
/// voxels, whose outlines it shows.
struct ContourPlane {
  double z_voxel = 0.0;
  int z = 0;
  double slab_mm = 0.0;  ///< thickness of the slab that the contours represent
  std::vector<DicomSource::Image> images = {};
};

/// The distance in mm between neighbouring planes of voxels, perpendicular to the planes.
double plane_distance_mm(const Universe& universe) {
  const glm::dmat3 axes(universe.lps_from_voxel);
  return std::abs(glm::dot(axes[2], glm::normalize(glm::cross(axes[0], axes[1]))));
}

std::vector<ContourPlane> planes_of_voxels(const Universe& universe,
                                           const std::optional<DicomSource>& source) {
  std::vector<ContourPlane> planes;
  for (int z = 0; z < universe.side(); ++z) {
    planes.push_back({static_cast<double>(z), z, plane_distance_mm(universe)});
    if (source) planes.back().images = images_behind(*source, universe.lattice(), z);
  }
  return planes;
}

/// The planes of the source's images, ordered along the voxels' third axis. If every plane of voxels with an
/// object has its own image, these are the planes of the voxels.
std::vector<ContourPlane> planes_of_images(const Universe& universe, const DicomSource& source) {
  const glm::dmat3 axes(universe.lps_from_voxel);
  const glm::dvec3 normal = glm::normalize(glm::cross(axes[0], axes[1]));
  // Rounding a normal to single precision changes this cosine by less than the tolerance.
  if (std::abs(std::abs(glm::dot(normal, source.normal)) - 1.0) > 1e-6)
    throw InvalidInput(
        "planes of voxels are not parallel to the source's images: resample the "
        "object on the lattice of the scan, or draw on the planes of the voxels");
  const double first_mm = glm::dot(glm::dvec3(universe.lps_from_voxel[3]), source.normal);
  const double step_mm = glm::dot(axes[2], source.normal);
  std::vector<ContourPlane> planes;
  for (const DicomSource::Image& image : source.images) {
    const double z_voxel = (image.height_mm - first_mm) / step_mm;
    const double nearest = std::round(z_voxel);
    if (nearest < 0.0 || nearest >= universe.side()) continue;
    if (!planes.empty() && std::abs(planes.back().z_voxel - z_voxel) * std::abs(step_mm) <= same_plane_mm()) {
      if (planes.back().images.back().instance_uid != image.instance_uid)
        planes.back().images.push_back(image);
      continue;
    }
    planes.push_back({z_voxel, static_cast<int>(nearest), 0.0, {image}});
  }
  if (step_mm < 0.0) std::reverse(planes.begin(), planes.end());
  // A slab extends equally to both sides of its plane. Its thickness is the wider one of the gaps to the two
  // neighbouring planes, so that no gap remains between slabs.
  for (std::size_t i = 0; i < planes.size(); ++i) {
    double slab_mm = planes.size() > 1 ? 0.0 : plane_distance_mm(universe);
    if (i > 0) slab_mm = (planes[i].z_voxel - planes[i - 1].z_voxel) * std::abs(step_mm);
    if (i + 1 < planes.size())
      slab_mm = std::max(slab_mm, (planes[i + 1].z_voxel - planes[i].z_voxel) * std::abs(step_mm));
    planes[i].slab_mm = slab_mm;
  }
  return planes;
}

/// Coordinates to a ten thousandth of a millimetre. Contours lie half a voxel's edge from the voxels'
/// centres, so fine voxels need more decimals: with `is_fine`, a coordinate uses all digits of a decimal
/// string.
std::string coordinates(const glm::dvec3& p_mm, bool is_fine) {
  if (is_fine) return dicom_decimals(p_mm);
  std::string text;
  for (int axis = 0; axis < 3; ++axis) {
    char number[40];
    std::snprintf(number, sizeof number, "%.4f", p_mm[axis]);
    std::string digits = number;
    digits.resize(digits.find_last_not_of('0') + 1);
    if (digits.ends_with('.')) digits.pop_back();
    text += (axis == 0 ? "" : "\\") + (digits == "-0" ? "0" : digits);
  }
  return text;
}

Items references(const std::vector<DicomSource::Image>& images) {
  Items items;
  for (const DicomSource::Image& image : images) {
    items.push_back(implicit());
    items.back().put(0x00081150, "UI", image.class_uid);
    items.back().put(0x00081155, "UI", image.instance_uid);
  }
  return items;
}

class StructureSetWriter {
 public:
  StructureSetWriter(Objects objects, const RtstructOptions& options)
      : objects_(objects), options_(options), universe_(objects.front().object.universe()) {
    planes_ = options.source && options.planes == ContourPlanes::Images
                  ? planes_of_images(universe_, *options.source)
                  : planes_of_voxels(universe_, options.source);
    const glm::dvec3 edge_mm = universe_.lattice().spacing_mm();
    is_fine_ = std::min(edge_mm.x, edge_mm.y) < 0.02;
  }

  DicomAttributes made() {
    digest_.add(&universe_.lps_from_voxel, sizeof universe_.lps_from_voxel);
    digest_.add(options_.label);
    digest_.add(options_.series_description);
    if (options_.source) digest_.add(options_.source->series_uid);
    bool in_utf8 = !is_ascii(options_.label) || !is_ascii(options_.series_description);
    Items names, contours, observations;
    for (std::size_t i = 0; i < objects_.size(); ++i) {
      digest_.add(objects_[i].label);
      in_utf8 = in_utf8 || !is_ascii(objects_[i].label);
      contours.push_back(contours_of(i));
    }
    DicomAttributes file = implicit();
    DicomOptions study{.series_description = options_.series_description, .source = options_.source};
    if (study.source) study.patient_name.clear();
    put_study(file, study, digest_, in_utf8);
    const std::string frame_uid = file.value(0x00200052);
    for (std::size_t i = 0; i < objects_.size(); ++i) {
      names.push_back(name_of(i, frame_uid));
      observations.push_back(observation_of(i));
    }
    put_set(file);
    file.put_sequence(0x30060010, {frame_of_reference(frame_uid, file.value(0x0020000d))});
    file.put_sequence(0x30060020, names);
    file.put_sequence(0x30060039, contours);
    file.put_sequence(0x30060080, observations);
    return file;
  }

  std::vector<ContouredObject> drawn() && { return std::move(drawn_); }

 private:
  static std::string number(std::size_t i) { return std::to_string(i + 1); }

  void put_set(DicomAttributes& file) const {
    file.put(0x00080016, "UI", structure_set_storage);
    file.put(0x00080018, "UI", digest_.uid("structure set"));
    file.put(0x00080060, "CS", "RTSTRUCT");
    file.put(0x00081070, "PN", "");
    file.put(0x00081090, "LO", "octotomy");
    file.put(0x00181020, "LO", OCTOTOMY_VERSION);
    file.put(0x00200013, "IS", "1");
    // DICOM's short string (VR SH) has at most 16 characters. The attribute for the name stores the whole
    // label.
    constexpr std::size_t most_of_short = 16;
    file.put(0x30060002, "SH",
             is_ascii(options_.label) ? options_.label.substr(0, most_of_short) : "OCTOTOMY");
    file.put(0x30060004, "LO", options_.label);
    file.put(0x30060008, "DA", "20000101");
    file.put(0x30060009, "TM", "000000");
  }

  DicomAttributes frame_of_reference(const std::string& frame_uid, const std::string& study_uid) const {
    DicomAttributes frame = implicit();
    frame.put(0x00200052, "UI", frame_uid);
    if (!options_.source) return frame;
    std::vector<DicomSource::Image> images;
    std::set<std::string> known;
    for (const DicomSource::Image& image : options_.source->images)
      if (known.insert(image.instance_uid).second) images.push_back(image);
    DicomAttributes series = implicit(), study = implicit();
    series.put(0x0020000e, "UI", options_.source->series_uid);
    series.put_sequence(0x30060016, references(images));
    study.put(0x00081150, "UI", study_class);
    study.put(0x00081155, "UI", study_uid);
    study.put_sequence(0x30060014, {series});
    frame.put_sequence(0x30060012, {study});
    return frame;
  }

  DicomAttributes name_of(std::size_t i, const std::string& frame_uid) const {
    DicomAttributes region = implicit();
    region.put(0x30060022, "IS", number(i));
    region.put(0x30060024, "UI", frame_uid);
    region.put(0x30060026, "LO", objects_[i].label);
    region.put(0x30060036, "CS", "SEMIAUTOMATIC");
    return region;
  }

  DicomAttributes observation_of(std::size_t i) const {
    DicomAttributes observation = implicit();
    observation.put(0x30060082, "IS", number(i));
    observation.put(0x30060084, "IS", number(i));
    observation.put(0x300600a4, "CS", "");
    observation.put(0x300600a6, "PN", "");
    return observation;
  }

  struct Outlined {
    const ContourPlane* plane;
    std::vector<PixelOutline> outlines;
  };

  /// Draws the object's outlines on the planes, and counts the planes of voxels that have no outline.
  std::vector<Outlined> outlined(std::size_t i, ContouredObject& drawn) {
    const Octree& object = objects_[i].object;
    const double step_mm = plane_distance_mm(universe_);
    std::vector<Outlined> made;
    std::vector<bool> is_held(static_cast<std::size_t>(universe_.side()));
    std::vector<std::vector<const ContourPlane*>> shown(is_held.size());
    for (const ContourPlane& plane : planes_) shown[static_cast<std::size_t>(plane.z)].push_back(&plane);
    SliceBits slice;
    for (int z = 0; z < universe_.side(); ++z) {
      options_.progress.at((static_cast<double>(i) + static_cast<double>(z) / universe_.side()) /
                           static_cast<double>(objects_.size()));
      read_slice(object, z, slice);
      const std::vector<PixelOutline> outlines = pixel_outlines(slice);
      if (outlines.empty()) continue;
      digest_.add(&z, sizeof z);
      digest_.add(slice.words.data(), slice.words.size() * sizeof slice.words[0]);
      is_held[static_cast<std::size_t>(z)] = true;
      if (shown[static_cast<std::size_t>(z)].empty()) ++drawn.planes_left_out;
      for (const ContourPlane* plane : shown[static_cast<std::size_t>(z)]) {
        digest_.add(&plane->z_voxel, sizeof plane->z_voxel);
        drawn.farthest_mm = std::max(drawn.farthest_mm, std::abs(plane->z_voxel - z) * step_mm);
        made.push_back({plane, outlines});
      }
    }
    if (std::find(is_held.begin(), is_held.end(), true) == is_held.end())
      throw InvalidInput("the object '" + objects_[i].label +
                         "' is empty: choose an object with at least one voxel");
    if (made.empty())
      throw Error(ErrorCode::Geometry, "the object '" + objects_[i].label +
                                           "' lies on none of the source's images: was it made of another "
                                           "scan?");
    return made;
  }

  DicomAttributes contours_of(std::size_t i) {
    ContouredObject drawn{objects_[i].label};
    const std::vector<Outlined> planes = outlined(i, drawn);
    for (const Outlined& plane : planes)
      for (const PixelOutline& outline : plane.outlines) drawn.holes += doubled_area(outline) < 0;
    const char* const kind = drawn.holes > 0 ? "CLOSEDPLANAR_XOR" : "CLOSED_PLANAR";
    Items contours;
    for (const auto& [plane, outlines] : planes) {
      const Items images = references(plane->images);
      for (const PixelOutline& outline : outlines) {
        std::string points;
        for (const glm::ivec2& corner : outline)
          points +=
              (points.empty() ? "" : "\\") +
              coordinates(universe_.lattice().lps_mm(glm::dvec3(glm::dvec2(corner) - 0.5, plane->z_voxel)),
                          is_fine_);
        DicomAttributes& contour = contours.emplace_back(implicit());
        if (!images.empty()) contour.put_sequence(0x30060016, images);
        contour.put(0x30060042, "CS", kind);
        contour.put(0x30060044, "DS", dicom_decimal(plane->slab_mm));
        contour.put(0x30060046, "IS", std::to_string(outline.size()));
        contour.put(0x30060050, "DS", points);
        drawn.points += outline.size();
      }
      drawn.contours += outlines.size();
    }
    drawn.planes = planes.size();
    drawn_.push_back(drawn);
    // Colours that are distinguishable on black, also by most colour-blind viewers (Okabe and Ito 2008).
    constexpr std::array<const char*, 7> colours{"230\\159\\0",  "86\\180\\233",  "0\\158\\115",
                                                 "240\\228\\66", "204\\121\\167", "213\\94\\0",
                                                 "0\\114\\178"};
    DicomAttributes region = implicit();
    region.put(0x3006002a, "IS", colours[i % colours.size()]);
    region.put_sequence(0x30060040, contours);
    region.put(0x30060084, "IS", number(i));
    return region;
  }

  Objects objects_;
  const RtstructOptions& options_;
  Universe universe_;
  std::vector<ContourPlane> planes_;
  bool is_fine_ = false;
  DicomDigest digest_;
  std::vector<ContouredObject> drawn_;
};

}  // namespace

std::vector<ContouredObject> write_rtstruct(Objects objects, const fs::path& path,
                                            const RtstructOptions& options) {
  if (objects.empty()) throw std::invalid_argument("a structure set needs at least one object");
  check_dicom_text(options.label, "label");
  check_dicom_text(options.series_description, "series_description");
  if (options.label.empty() || options.series_description.empty())
    throw InvalidInput("a structure set's label and series_description must not be empty");
  for (const DicomSegment& each : objects) {
    check_dicom_text(each.label, "label");
    if (each.label.empty()) throw InvalidInput("an object's label must not be empty");
    if (each.object.universe() != objects.front().object.universe())
      throw InvalidInput("the objects of a file must lie in one universe");
  }
  StructureSetWriter writer(objects, options);
  const DicomAttributes file = writer.made();
  StagedFiles staging(path.parent_path());
  write_dicom_file(staging.folder() / path.filename(), path, file);
  staging.commit();
  return std::move(writer).drawn();
}

}  // namespace octotomy::voxel
