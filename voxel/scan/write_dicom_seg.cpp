// SPDX-License-Identifier: AGPL-3.0-or-later
//
// 1 Find each segment's planes that hold a voxel, and the rectangle around the voxels of all planes.
// 2 Describe each plane as a frame, and pack its pixels: one bit each; for fractions one byte; for label maps
//   the object's number.
// 3 Describe the segments, the dimensions (segment and position) and the origin.
#include "voxel/scan/write_dicom_seg.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <set>
#include <stdexcept>

#include "voxel/dicom/character_set.h"
#include "voxel/scan/dicom_derived.h"
#include "voxel/space/error.h"
#include "voxel/space/staged_files.h"
#include "voxel/tree/slice_bits.h"

namespace octotomy::voxel {

namespace {

namespace fs = std::filesystem;
using Items = std::vector<DicomAttributes>;

constexpr const char* segmentation_storage = "1.2.840.10008.5.1.4.1.1.66.4";
constexpr const char* label_map_storage = "1.2.840.10008.5.1.4.1.1.66.7";
/// The fraction stored for a wholly filled pixel.
constexpr std::uint16_t most_fraction = 255;

using Segments = std::span<const DicomSegment>;

/// A plane with at least one voxel of a segment.
struct Plane {
  std::size_t segment;  ///< from 0
  int z;
};

/// The planes with at least one voxel, segment by segment, and the smallest rectangle around all voxels.
struct Extent {
  std::vector<Plane> planes;
  glm::ivec2 low{0};
  glm::ivec2 high{-1};  ///< inclusive
  glm::ivec2 size_px() const { return high - low + 1; }
};

/// Collects the planes, and adds each plane's words to the digest.
void add_planes(Segments segments, std::size_t segment, const Progress& progress, Extent& extent,
                DicomDigest& digest) {
  const Octree& object = segments[segment].object;
  const int side = object.universe().side();
  const std::size_t before = extent.planes.size();
  SliceBits slice;
  for (int z = 0; z < side; ++z) {
    progress.at(0.5 * (static_cast<double>(segment) + static_cast<double>(z) / side) /
                static_cast<double>(segments.size()));
    read_slice(object, z, slice);
    bool held = false;
    for (int y = 0; y < side; ++y)
      for (int word = 0; word < slice.words_per_row; ++word) {
        const std::uint64_t bits = slice.row(y)[word];
        if (bits == 0) continue;
        held = true;
        extent.low = glm::min(extent.low, glm::ivec2(64 * word + std::countr_zero(bits), y));
        extent.high = glm::max(extent.high, glm::ivec2(64 * word + 63 - std::countl_zero(bits), y));
      }
    if (!held) continue;
    extent.planes.push_back({segment, z});
    digest.add(&z, sizeof z);
    digest.add(slice.words.data(), slice.words.size() * sizeof slice.words[0]);
  }
  if (extent.planes.size() == before)
    throw InvalidInput("the object is empty: choose an object with at least one voxel");
}

/// Adds the planes of a segment's fractions.
void add_planes(const Lattice& lattice, const DicomFractions& segment, std::size_t number, Extent& extent,
                DicomDigest& digest) {
  const std::size_t before = extent.planes.size();
  const std::uint8_t* fraction = segment.fractions.data();
  for (int z = 0; z < lattice.dims.z; ++z) {
    bool is_held = false;
    const std::uint8_t* const plane = fraction;
    for (int y = 0; y < lattice.dims.y; ++y)
      for (int x = 0; x < lattice.dims.x; ++x, ++fraction) {
        if (*fraction == 0) continue;
        is_held = true;
        extent.low = glm::min(extent.low, glm::ivec2(x, y));
        extent.high = glm::max(extent.high, glm::ivec2(x, y));
      }
    if (!is_held) continue;
    extent.planes.push_back({number, z});
    digest.add(&z, sizeof z);
    digest.add(plane, static_cast<std::size_t>(fraction - plane));
  }
  if (extent.planes.size() == before)
    throw InvalidInput("the fractions of '" + segment.label +
                       "' are all zero: choose an object that fills a part of a voxel");
}

/// The number of bytes in the pixels of all frames. Throws Error (Geometry) if it exceeds DICOM's limit.
std::size_t pixel_bytes(const Extent& extent, unsigned bits) {
  const auto area =
      static_cast<std::uint64_t>(extent.size_px().x) * static_cast<std::uint64_t>(extent.size_px().y);
  const std::uint64_t bytes = (area * extent.planes.size() * bits + 7) / 8;
  if (bytes > 0xfffffffe)
    throw Error(ErrorCode::Geometry,
                "the segmentation's " + std::to_string(extent.planes.size()) +
                    " frames take more than DICOM's 4 GB: choose larger voxels or a part of the object");
  return static_cast<std::size_t>(bytes);
}

/// The pixels of all frames, one bit each, without gaps between rows or frames; the first pixel in the lowest
/// bit (PS3.5, 8.1.1).
std::string packed_pixels(Segments segments, const Extent& extent, const Progress& progress) {
  std::string pixels(pixel_bytes(extent, 1), '\0');
  SliceBits slice;
  std::size_t bit = 0;
  for (std::size_t i = 0; i < extent.planes.size(); ++i) {
    progress.at(0.5 + 0.5 * static_cast<double>(i) / static_cast<double>(extent.planes.size()));
    read_slice(segments[extent.planes[i].segment].object, extent.planes[i].z, slice);
    for (int y = extent.low.y; y <= extent.high.y; ++y)
      for (int x = extent.low.x; x <= extent.high.x; ++x, ++bit)
        if ((slice.row(y)[x / 64] >> (x % 64)) & 1)
          pixels[bit / 8] = static_cast<char>(pixels[bit / 8] | (1 << (bit % 8)));
  }
  return pixels;
}

/// Leaves one plane at each height, because all objects of a label map share one frame there.
void share_planes(Extent& extent) {
  std::vector<Plane>& planes = extent.planes;
  std::sort(planes.begin(), planes.end(), [](const Plane& a, const Plane& b) { return a.z < b.z; });
  planes.erase(
      std::unique(planes.begin(), planes.end(), [](const Plane& a, const Plane& b) { return a.z == b.z; }),
      planes.end());
}

/// The pixels of all frames: each is the number of the object that contains it, 0 for none, in one byte, or
/// in two if there are more than 255 objects.
template <typename Number>
std::string label_pixels(Segments segments, const Extent& extent, const Progress& progress) {
  std::string pixels(pixel_bytes(extent, 8 * sizeof(Number)), '\0');
  auto* const numbers = reinterpret_cast<Number*>(pixels.data());
  const glm::ivec2 size = extent.size_px();
  SliceBits slice;
  for (std::size_t i = 0; i < extent.planes.size(); ++i) {
    progress.at(0.5 + 0.5 * static_cast<double>(i) / static_cast<double>(extent.planes.size()));
    Number* const frame = numbers + i * static_cast<std::size_t>(size.x) * size.y;
    for (std::size_t k = 0; k < segments.size(); ++k) {
      read_slice(segments[k].object, extent.planes[i].z, slice);
      for (int y = extent.low.y; y <= extent.high.y; ++y)
        for (int x = extent.low.x; x <= extent.high.x; ++x) {
          if (((slice.row(y)[x / 64] >> (x % 64)) & 1) == 0) continue;
          Number& number = frame[static_cast<std::size_t>(y - extent.low.y) * size.x + (x - extent.low.x)];
          if (number != 0)
            throw Error(ErrorCode::Geometry,
                        "'" + segments[number - 1U].label + "' and '" + segments[k].label +
                            "' share voxels, and a label map has one object at each: write a "
                            "binary segmentation");
          number = static_cast<Number>(k + 1);
        }
    }
  }
  return pixels;
}

/// The pixels of all frames as fractions, one byte each.
std::string fraction_pixels(const Lattice& lattice, std::span<const DicomFractions> segments,
                            const Extent& extent) {
  std::string pixels;
  pixels.reserve(pixel_bytes(extent, 8));
  const auto columns = static_cast<std::size_t>(lattice.dims.x),
             rows = static_cast<std::size_t>(lattice.dims.y);
  for (const auto& [segment, z] : extent.planes)
    for (int y = extent.low.y; y <= extent.high.y; ++y) {
      const std::uint8_t* const row =
          segments[segment].fractions.data() +
          columns * (rows * static_cast<std::size_t>(z) + static_cast<std::size_t>(y));
      pixels.append(row + extent.low.x, row + extent.high.x + 1);
    }
  return pixels;
}

/// The content of the file, apart from the source.
struct Content {
  Lattice lattice;
  std::vector<std::string> labels = {};  ///< of the segments
  DicomDigest digest = {};
  Extent extent = {};
  std::string pixels = {};
  enum class Kind { Binary, Fractional, LabelMap } kind = Kind::Binary;

  bool is_label_map() const { return kind == Kind::LabelMap; }
  /// Bits of a pixel.
  std::uint16_t bits() const {
    if (kind == Kind::Binary) return 1;
    return is_label_map() && labels.size() > 255 ? 16 : 8;
  }
};

/// One item with one or more attributes, as most sequences of a segmentation have.
template <typename Fill>
Items item(Fill fill) {
  Items items(1);
  fill(items.front());
  return items;
}

void put_segments(DicomAttributes& file, const Content& content, const std::string& label) {
  // The object's anatomy is unknown. SNOMED's "Tissue" applies to every object.
  const Items tissue{dicom_code("85756007", "SCT", "Tissue")};
  file.put(0x00620001, "CS",
           content.is_label_map()                      ? "LABELMAP"
           : content.kind == Content::Kind::Fractional ? "FRACTIONAL"
                                                       : "BINARY");
  if (content.is_label_map()) file.put(0x00620013, "CS", "NO");  // segments do not overlap
  if (content.kind == Content::Kind::Fractional) {
    file.put_short(0x0062000e, most_fraction);
    file.put(0x00620010, "CS", "OCCUPANCY");
  }
  Items items;
  for (const std::string& each : content.labels) {
    DicomAttributes& segment = items.emplace_back();
    segment.put_sequence(0x00620003, tissue);
    segment.put_short(0x00620004, static_cast<std::uint16_t>(items.size()));
    segment.put(0x00620005, "LO", each);
    segment.put(0x00620008, "CS", "SEMIAUTOMATIC");
    segment.put(0x00620009, "LO", "Octotomy");
    segment.put_sequence(0x0062000f, tissue);
  }
  file.put_sequence(0x00620002, items);
  file.put(0x00700080, "CS", "OCTOTOMY");
  file.put(0x00700081, "LO", label);
  file.put(0x00700084, "PN", "Octotomy^Planner");
}

void put_dimensions(DicomAttributes& file, const std::string& uid, bool is_label_map) {
  const auto dimension = [&](DicomTag attribute, DicomTag group, const char* label) {
    DicomAttributes index;
    index.put(0x00209164, "UI", uid);
    index.put_tag(0x00209165, attribute);
    index.put_tag(0x00209167, group);
    index.put(0x00209421, "LO", label);
    return index;
  };
  file.put_sequence(0x00209221,
                    item([&](DicomAttributes& organization) { organization.put(0x00209164, "UI", uid); }));
  const DicomAttributes position = dimension(0x00200032, 0x00209113, "Position");
  if (is_label_map)
    file.put_sequence(0x00209222, {position});
  else
    file.put_sequence(0x00209222, {dimension(0x0062000b, 0x0062000a, "Segment"), position});
}

void put_shared_groups(DicomAttributes& file, const glm::dmat3& axes, const glm::dvec3& edge_mm) {
  DicomAttributes shared;
  shared.put_sequence(0x00209116, item([&](DicomAttributes& orientation) {
                        orientation.put(0x00200037, "DS",
                                        dicom_decimals(axes[0]) + "\\" + dicom_decimals(axes[1]));
                      }));
  shared.put_sequence(0x00289110, item([&](DicomAttributes& measures) {
                        measures.put(0x00180050, "DS", dicom_decimal(edge_mm.z));
                        measures.put(0x00180088, "DS", dicom_decimal(edge_mm.z));
                        measures.put(0x00280030, "DS",
                                     dicom_decimal(edge_mm.y) + "\\" + dicom_decimal(edge_mm.x));
                      }));
  file.put_sequence(0x52009229, {shared});
}

/// The functional groups of one frame. `segment` (none for a label map) and the frame's place among the
/// planes with frames are counted from 1.
DicomAttributes frame_groups(std::optional<std::uint16_t> segment, std::uint32_t place,
                             const glm::dvec3& first_mm, const std::vector<DicomSource::Image>& images) {
  DicomAttributes frame;
  if (!images.empty())
    frame.put_sequence(0x00089124, item([&](DicomAttributes& derivation) {
                         derivation.put(0x00082111, "ST", "Segmented from the source");
                         put_source_images(derivation, images);
                         derivation.put_sequence(0x00089215, {dicom_code("113076", "DCM", "Segmentation")});
                       }));
  frame.put_sequence(0x00209111, item([&](DicomAttributes& content) {
                       content.put(0x00209056, "SH", "1");
                       content.put_longs(0x00209057, {place});
                       if (segment)
                         content.put_longs(0x00209157, {*segment, place});
                       else
                         content.put_longs(0x00209157, {place});
                     }));
  frame.put_sequence(0x00209113, item([&](DicomAttributes& position) {
                       position.put(0x00200032, "DS", dicom_decimals(first_mm));
                     }));
  if (segment)
    frame.put_sequence(
        0x0062000a, item([&](DicomAttributes& identified) { identified.put_short(0x0062000b, *segment); }));
  return frame;
}

/// The items of all frames, and the images to which at least one frame refers.
void put_frames(DicomAttributes& file, const Content& content, const std::optional<DicomSource>& source) {
  const Lattice& lattice = content.lattice;
  const Extent& extent = content.extent;
  Items frames;
  std::vector<DicomSource::Image> referenced;
  std::set<std::string> known;
  std::set<int> places;
  for (const Plane& plane : extent.planes) places.insert(plane.z);
  for (const auto& [segment, z] : extent.planes) {
    std::vector<DicomSource::Image> images;
    if (source) images = images_behind(*source, lattice, z);
    for (const DicomSource::Image& image : images)
      if (known.insert(image.instance_uid).second) referenced.push_back(image);
    const auto place = std::distance(places.begin(), places.find(z)) + 1;
    std::optional<std::uint16_t> number;
    if (!content.is_label_map()) number = static_cast<std::uint16_t>(segment + 1);
    frames.push_back(frame_groups(number, static_cast<std::uint32_t>(place),
                                  lattice.lps_mm(glm::dvec3(extent.low, z)), images));
  }
  file.put_sequence(0x52009230, frames);
  file.put(0x00280008, "IS", std::to_string(frames.size()));
  if (source) put_referenced_series(file, source->series_uid, referenced);
}

void put_image(DicomAttributes& file, const Content& content) {
  const glm::ivec2 size_px = content.extent.size_px();
  const std::uint16_t bits = content.bits();
  file.put(0x00080008, "CS", "DERIVED\\PRIMARY");
  file.put(0x00080016, "UI", content.is_label_map() ? label_map_storage : segmentation_storage);
  file.put(0x00080023, "DA", "20000101");
  file.put(0x00080033, "TM", "000000");
  file.put(0x00080060, "CS", "SEG");
  file.put(0x00081090, "LO", "octotomy");
  file.put(0x00181000, "LO", "0");
  file.put(0x00181020, "LO", OCTOTOMY_VERSION);
  file.put(0x00200013, "IS", "1");
  file.put_short(0x00280002, 1);
  file.put(0x00280004, "CS", "MONOCHROME2");
  file.put_short(0x00280010, static_cast<std::uint16_t>(size_px.y));
  file.put_short(0x00280011, static_cast<std::uint16_t>(size_px.x));
  file.put_short(0x00280100, bits);
  file.put_short(0x00280101, bits);
  file.put_short(0x00280102, static_cast<std::uint16_t>(bits - 1));
  file.put_short(0x00280103, 0);
  if (content.is_label_map()) file.put_short(0x00280120, 0);  // value of pixels without an object
  file.put(0x00282110, "CS", "00");
}

/// The lattice's axes as unit vectors. Throws std::invalid_argument unless they are perpendicular.
glm::dmat3 perpendicular_axes(const Lattice& lattice) {
  const glm::dvec3 edge_mm = lattice.spacing_mm();
  glm::dmat3 axes(lattice.lps_from_voxel);
  for (int i = 0; i < 3; ++i) axes[i] /= edge_mm[i];
  // Rounding to single precision changes the cosine of a right angle by less than this. Decimal strings have
  // at least 13 digits and add almost no error.
  for (int i = 0; i < 3; ++i)
    if (std::abs(glm::dot(axes[i], axes[(i + 1) % 3])) > 1e-6)
      throw InvalidInput(
          "a segmentation's rows, columns and planes must be perpendicular: resample the object");
  return axes;
}

DicomAttributes segmentation(Content content, const DicomSegOptions& options) {
  const glm::dmat3 axes = perpendicular_axes(content.lattice);
  bool in_utf8 = !is_ascii(options.label) || !is_ascii(options.series_description);
  for (const std::string& label : content.labels) in_utf8 = in_utf8 || !is_ascii(label);
  DicomAttributes file;
  DicomOptions study{.series_description = options.series_description, .source = options.source};
  if (study.source) study.patient_name.clear();
  put_study(file, study, content.digest, in_utf8);
  put_image(file, content);
  file.put(0x00080018, "UI", content.digest.uid("segmentation"));
  put_segments(file, content, options.label);
  put_dimensions(file, content.digest.uid("dimensions"), content.is_label_map());
  put_shared_groups(file, axes, content.lattice.spacing_mm());
  put_frames(file, content, options.source);
  file.put(0x7fe00010, content.bits() == 16 ? "OW" : "OB", std::move(content.pixels));
  return file;
}

/// Content without segments. The digest already covers the data that all segments share.
Content content_on(const Lattice& lattice, const DicomSegOptions& options) {
  perpendicular_axes(lattice);
  Content content{lattice};
  content.digest.add(&lattice.lps_from_voxel, sizeof lattice.lps_from_voxel);
  content.digest.add(options.label);
  content.digest.add(options.series_description);
  if (options.source) content.digest.add(options.source->series_uid);
  content.extent.low = glm::max(lattice.dims.x, lattice.dims.y) * glm::ivec2(1);
  return content;
}

Content content_of(Segments segments, const DicomSegOptions& options) {
  Content content = content_on(segments.front().object.universe().lattice(), options);
  for (std::size_t i = 0; i < segments.size(); ++i) {
    if (i > 0 || segments[i].label != options.label) content.digest.add(segments[i].label);
    add_planes(segments, i, options.progress, content.extent, content.digest);
    content.labels.push_back(segments[i].label);
  }
  if (options.kind == DicomSegKind::Binary) {
    content.pixels = packed_pixels(segments, content.extent, options.progress);
    return content;
  }
  content.kind = Content::Kind::LabelMap;
  content.digest.add("label map");
  share_planes(content.extent);
  content.pixels = content.bits() == 16
                       ? label_pixels<std::uint16_t>(segments, content.extent, options.progress)
                       : label_pixels<std::uint8_t>(segments, content.extent, options.progress);
  return content;
}

Content content_of(const Lattice& lattice, std::span<const DicomFractions> segments,
                   const DicomSegOptions& options) {
  Content content = content_on(lattice, options);
  content.kind = Content::Kind::Fractional;
  content.digest.add("fractions");
  for (const DicomFractions& each : segments) {
    options.progress.at(0.0);
    content.digest.add(each.label);
    add_planes(lattice, each, content.labels.size(), content.extent, content.digest);
    content.labels.push_back(each.label);
  }
  content.pixels = fraction_pixels(lattice, segments, content.extent);
  return content;
}

void check_texts(const DicomSegOptions& options, std::size_t segment_count) {
  if (segment_count == 0 || segment_count > 65535)
    throw InvalidInput("a segmentation has 1 to 65535 segments, not " + std::to_string(segment_count));
  check_dicom_text(options.label, "label");
  check_dicom_text(options.series_description, "series_description");
  if (options.label.empty() || options.series_description.empty())
    throw InvalidInput("a segmentation's label and series_description must not be empty");
}

void check_segment_label(const std::string& label) {
  check_dicom_text(label, "label");
  if (label.empty()) throw InvalidInput("a segment's label must not be empty");
}

void write_staged(const DicomAttributes& file, const fs::path& path) {
  StagedFiles staging(path.parent_path());
  write_dicom_file(staging.folder() / path.filename(), path, file);
  staging.commit();
}

}  // namespace

void write_dicom_seg(const Octree& object, const fs::path& path, const DicomSegOptions& options) {
  const DicomSegment segment{options.label, object};
  write_dicom_seg({&segment, 1}, path, options);
}

void write_dicom_seg(Segments segments, const fs::path& path, const DicomSegOptions& options) {
  check_texts(options, segments.size());
  for (const DicomSegment& each : segments) {
    check_segment_label(each.label);
    if (each.object.universe() != segments.front().object.universe())
      throw InvalidInput("the segments of a file must lie in one universe");
  }
  write_staged(segmentation(content_of(segments, options), options), path);
}

void write_dicom_fractions(const Lattice& lattice, std::span<const DicomFractions> segments,
                           const fs::path& path, const DicomSegOptions& options) {
  check_texts(options, segments.size());
  for (const DicomFractions& each : segments) {
    check_segment_label(each.label);
    if (each.fractions.size() != lattice.sample_count())
      throw std::invalid_argument("the segment '" + each.label + "' has " +
                                  std::to_string(each.fractions.size()) + " fractions for " +
                                  std::to_string(lattice.sample_count()) + " samples");
  }
  write_staged(segmentation(content_of(lattice, segments, options), options), path);
}

}  // namespace octotomy::voxel
