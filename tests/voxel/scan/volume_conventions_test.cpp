// SPDX-License-Identifier: AGPL-3.0-or-later
//
// A table of what volume files state about themselves: each row is a file made here byte by byte, the place
// of its first and its last sample in the patient, its range, and the audit's verdict on the statement. Who
// says so: nifti1.h and nibabel, the definition of NRRD, MetaIO.
#include <bit>
#include <cstring>
#include <functional>
#include <gtest/gtest.h>
#include <limits>
#include <nifti/nifti1.h>

#include "tests/file_bytes.h"
#include "tests/page_rows.h"
#include "tests/voxel/linear_scene.h"
#include "tests/voxel/scan/volume_bytes.h"
#include "tests/voxel/scratch_folder.h"
#include "voxel/scan/read_scene.h"
#include "voxel/space/printed.h"

namespace octotomy::voxel {
namespace {

using tests::meta;
using tests::meta_place;
using tests::nifti;
using tests::nrrd;
using tests::nrrd_in;
using tests::ramp;
using tests::write_bytes;

struct Row {
  std::string statement;
  const char* name;  ///< of the file
  std::string bytes;
  glm::dvec3 first_mm, last_mm;
  Range range;
  const char* check;
  Verdict verdict;
  const char* frame = "";
  const char* unit = "";
};

constexpr Range as_stored{0.0, 23.0};
const glm::dvec3 lps_first(10, 20, 30), lps_last(12, 26, 42), ras_first(-10, -20, 30), ras_last(-12, -26, 42);

std::string shorts(std::int16_t value, int count) {
  std::string bytes;
  for (int i = 0; i < count; ++i) bytes.append(reinterpret_cast<const char*>(&value), sizeof value);
  return bytes;
}

std::vector<Row> nifti_rows() {
  const float nan = std::numeric_limits<float>::quiet_NaN();
  const char* const name = "a.nii";
  std::vector<Row> table{
      {"sform and qform agree", name, nifti([](auto&) {}), ras_first, ras_last, as_stored, "orientation",
       Verdict::Pass},
      {"sform alone", name, nifti([](auto& h) {
         h.qform_code = 0;
         h.pixdim[1] = 7;
       }),
       ras_first, ras_last, as_stored, "orientation", Verdict::Pass},
      {"qform alone", name, nifti([](auto& h) {
         h.sform_code = 0;
         h.srow_x[0] = 7;
       }),
       ras_first, ras_last, as_stored, "orientation", Verdict::Pass},
      {"qform alone, qfac -1",
       name,
       nifti([](auto& h) {
         h.sform_code = 0;
         h.pixdim[0] = -1;
       }),
       ras_first,
       {-12, -26, 18},
       as_stored,
       "handedness",
       Verdict::Pass},
      {"qform alone, half a turn about z",
       name,
       nifti([](auto& h) {
         h.sform_code = 0;
         h.quatern_d = 1;
       }),
       ras_first,
       {-8, -14, 42},
       as_stored,
       "orientation",
       Verdict::Pass},
      {"sform and qform 180 degrees apart", name, nifti([](auto& h) { h.quatern_d = 1; }), ras_first,
       ras_last, as_stored, "forms", Verdict::Warn},
      {"neither form: Analyze's axes, centred",
       name,
       nifti([](auto& h) { h.sform_code = h.qform_code = 0; }),
       {-1, 3, -6},
       {1, -3, 6},
       as_stored,
       "orientation",
       Verdict::Warn},
      {"negative spacing under a qform", name, nifti([](auto& h) {
         h.sform_code = 0;
         h.pixdim[2] = -3;
       }),
       ras_first, ras_last, as_stored, "spacing", Verdict::Warn},
      {"sform alone, pixdim of another size", name, nifti([](auto& h) {
         h.qform_code = 0;
         h.pixdim[1] = 7;
       }),
       ras_first, ras_last, as_stored, "spacing", Verdict::Warn},
      {"sform that is no number, sound qform", name,
       nifti([](auto& h) { h.srow_x[0] = std::numeric_limits<float>::quiet_NaN(); }), ras_first, ras_last,
       as_stored, "forms", Verdict::Warn},
      {"xyzt_units mm", name, nifti([](auto&) {}), ras_first, ras_last, as_stored, "length_unit",
       Verdict::Pass},
      {"xyzt_units metres", name, nifti([](auto& h) { h.xyzt_units = NIFTI_UNITS_METER; }), 1e3 * ras_first,
       1e3 * ras_last, as_stored, "length_unit", Verdict::Pass},
      {"xyzt_units micrometres and seconds", name,
       nifti([](auto& h) { h.xyzt_units = NIFTI_UNITS_MICRON | NIFTI_UNITS_SEC; }), 1e-3 * ras_first,
       1e-3 * ras_last, as_stored, "length_unit", Verdict::Pass},
      {"xyzt_units unknown", name, nifti([](auto& h) { h.xyzt_units = 0; }), ras_first, ras_last, as_stored,
       "length_unit", Verdict::Warn},
      {"--unit um where mm are stated", name, nifti([](auto&) {}), 1e-3 * ras_first, 1e-3 * ras_last,
       as_stored, "length_unit", Verdict::Warn, "", "um"},
      {"--frame LPS where RAS is stated", name, nifti([](auto&) {}), lps_first, lps_last, as_stored,
       "orientation", Verdict::Warn, "LPS"},
      {"--frame RAS where RAS is stated", name, nifti([](auto&) {}), ras_first, ras_last, as_stored,
       "orientation", Verdict::Pass, "RAS"},
      {"slope 2, intercept -5",
       name,
       nifti([](auto& h) {
         h.scl_slope = 2;
         h.scl_inter = -5;
       }),
       ras_first,
       ras_last,
       {-5, 41},
       "rescale",
       Verdict::Pass},
      {"slope 0, intercept 0", name, nifti([](auto&) {}), ras_first, ras_last, as_stored, "rescale",
       Verdict::Pass},
      {"slope 0, intercept -1024", name, nifti([](auto& h) { h.scl_inter = -1024; }), ras_first, ras_last,
       as_stored, "rescale", Verdict::Warn},
      {"slope nan, intercept nan", name, nifti([&](auto& h) { h.scl_slope = h.scl_inter = nan; }), ras_first,
       ras_last, as_stored, "rescale", Verdict::Pass},
      {"intent code 1002, a label map", name, nifti([](auto& h) { h.intent_code = NIFTI_INTENT_LABEL; }),
       ras_first, ras_last, as_stored, "unit", Verdict::Pass},
      {"a mask whose intercept makes it air",
       name,
       nifti(
           [](auto& h) {
             h.scl_slope = 1;
             h.scl_inter = -1024;
           },
           std::string(20, '\0') + std::string(4, '\1')),
       ras_first,
       ras_last,
       {-1024, -1023},
       "unit",
       Verdict::Warn},
      {"a mask whose description says HU",
       name,
       nifti([](auto& h) { std::memcpy(h.descrip, "octotomy HU CT", 15); },
             std::string(20, '\0') + std::string(4, '\1')),
       ras_first,
       ras_last,
       {0, 1},
       "unit",
       Verdict::Warn},
      {"no offset of the samples", name, nifti([](auto& h) { h.vox_offset = 0; }), ras_first, ras_last,
       as_stored, "offset", Verdict::Warn},
      {"no unit of values, air at -1000",
       name,
       nifti(
           [](auto& h) {
             h.datatype = DT_INT16;
             h.bitpix = 16;
           },
           shorts(-1000, 16) + shorts(300, 8)),
       ras_first,
       ras_last,
       {-1000, 300},
       "air_level",
       Verdict::Warn},
      {"no unit of values, no air",
       name,
       nifti(
           [](auto& h) {
             h.datatype = DT_INT16;
             h.bitpix = 16;
           },
           shorts(100, 16) + shorts(300, 8)),
       ras_first,
       ras_last,
       {100, 300},
       "air_level",
       Verdict::Pass},
      {"one byte behind the samples", name, nifti([](auto&) {}, ramp() + "x"), ras_first, ras_last, as_stored,
       "samples", Verdict::Warn},
  };
  const auto slice = [](float third, short codes) {
    return nifti(
        [=](auto& h) {
          h.dim[0] = 2;
          h.dim[3] = 1;
          h.pixdim[3] = h.srow_z[2] = third;
          h.sform_code = codes;
        },
        ramp().substr(0, 6));
  };
  for (const short codes : {short{1}, short{0}}) {
    const std::string form = codes == 1 ? "sform" : "qform";
    table.push_back({"two axes, thickness 4 in the " + form,
                     name,
                     slice(4, codes),
                     ras_first,
                     {-12, -26, 30},
                     {0, 5},
                     "slice_spacing",
                     Verdict::Pass});
    table.push_back({"two axes, no thickness in the " + form,
                     name,
                     slice(0, codes),
                     ras_first,
                     {-12, -26, 30},
                     {0, 5},
                     "slice_spacing",
                     Verdict::Warn});
  }
  return table;
}

std::vector<Row> nrrd_rows() {
  const char* const name = "a.nrrd";
  std::vector<Row> table;
  struct Space {
    const char* words;
    glm::dvec3 first, last;
  };
  for (const auto& [words, first, last] :
       {Space{"right-anterior-superior", ras_first, ras_last}, Space{"RAS", ras_first, ras_last},
        Space{"RAST", ras_first, ras_last}, Space{"left-anterior-superior", {10, -20, 30}, {12, -26, 42}},
        Space{"LAS", {10, -20, 30}, {12, -26, 42}}, Space{"left-posterior-superior", lps_first, lps_last},
        Space{"LPS", lps_first, lps_last}, Space{"left-posterior-superior-time", lps_first, lps_last},
        Space{"inferior-right-posterior", {-20, 30, -10}, {-26, 42, -12}}}) {
    const bool has_time = std::string(words).ends_with("time") || std::string(words).size() == 4;
    const std::string place =
        has_time ? "space directions: (2,0,0,0) (0,3,0,0) (0,0,4,0)\nspace origin: (10,20,30,0)\n"
                 : "space directions: (2,0,0) (0,3,0) (0,0,4)\nspace origin: (10,20,30)\n";
    table.push_back({std::string("space ") + words, name, nrrd(std::string("space: ") + words + "\n" + place),
                     first, last, as_stored, "orientation", Verdict::Pass});
  }
  for (const char* words : {"scanner-xyz", "3D-right-handed", "3D-left-handed"})
    table.push_back({std::string("space ") + words, name, nrrd_in(std::string("space: ") + words + "\n"),
                     lps_first, lps_last, as_stored, "orientation", Verdict::Warn});
  table.push_back({"no space, directions", name, nrrd_in("space dimension: 3\n"), lps_first, lps_last,
                   as_stored, "orientation", Verdict::Warn});
  table.push_back({"no space, --frame LAS",
                   name,
                   nrrd_in("space dimension: 3\n"),
                   {10, -20, 30},
                   {12, -26, 42},
                   as_stored,
                   "orientation",
                   Verdict::Pass,
                   "LAS"});
  struct Unit {
    const char* word;
    double mm;
  };
  for (const auto& [word, mm] : {Unit{"mm", 1}, Unit{"microns", 1e-3}, Unit{"um", 1e-3}, Unit{"m", 1e3},
                                 Unit{"inch", 25.4}, Unit{"cm", 10}, Unit{"millimetres", 1}}) {
    std::string units = "space units:";
    for (int axis = 0; axis < 3; ++axis) units += std::string(" \"") + word + "\"";
    table.push_back({std::string("space units ") + word, name, nrrd_in("space: LPS\n" + units + "\n"),
                     mm * lps_first, mm * lps_last, as_stored, "length_unit", Verdict::Pass});
  }
  const std::string lps = "space: LPS\nspace directions: (2,0,0) (0,3,0) (0,0,4)\n",
                    origin = "space origin: (10,20,30)\n";
  const std::vector<Row> others{
      {"space units um mm m",
       name,
       nrrd_in("space: LPS\nspace units: \"um\" \"mm\" \"m\"\n"),
       {0.01, 20, 30000},
       {0.012, 26, 42000},
       as_stored,
       "length_unit",
       Verdict::Pass},
      {"no space units", name, nrrd_in("space: LPS\n"), lps_first, lps_last, as_stored, "length_unit",
       Verdict::Warn},
      {"space units pixel", name, nrrd_in("space: LPS\nspace units: \"pixel\" \"pixel\" \"pixel\"\n"),
       lps_first, lps_last, as_stored, "length_unit", Verdict::Warn},
      {"no space origin", name, nrrd(lps), {0, 0, 0}, {2, 6, 12}, as_stored, "origin", Verdict::Warn},
      {"sheared directions",
       name,
       nrrd("space: LPS\nspace directions: (2,0,0) (1,3,0) (0,0.5,4)\n" + origin),
       lps_first,
       {14, 27.5, 42},
       as_stored,
       "orientation",
       Verdict::Pass},
      {"a list axis of one value first", name,
       "NRRD0004\ntype: uchar\ndimension: 4\nsizes: 1 2 3 4\nkinds: list domain domain domain\n"
       "space: LPS\nspace directions: none (2,0,0) (0,3,0) (0,0,4)\n" +
           origin + "encoding: raw\n\n" + ramp(),
       lps_first, lps_last, as_stored, "orientation", Verdict::Pass},
      {"spacings and axis mins, node", name,
       nrrd("spacings: 2 3 4\naxis mins: 10 20 30\ncenters: node node node\n"), lps_first, lps_last,
       as_stored, "orientation", Verdict::Warn},
      {"spacings of which one has a minus sign",
       name,
       nrrd("spacings: -2 3 4\naxis mins: 10 20 30\ncenters: node node node\n"),
       lps_first,
       {8, 26, 42},
       as_stored,
       "spacing",
       Verdict::Warn},
      {"spacings and axis mins, cell",
       name,
       nrrd("spacings: 2 3 4\naxis mins: 10 20 30\ncenters: cell cell cell\n"),
       {11, 21.5, 32},
       {13, 27.5, 44},
       as_stored,
       "orientation",
       Verdict::Warn},
      {"axis mins without centers",
       name,
       nrrd("spacings: 2 3 4\naxis mins: 10 20 30\n"),
       {11, 21.5, 32},
       {13, 27.5, 44},
       as_stored,
       "origin",
       Verdict::Warn},
      {"axis mins and maxs, cell",
       name,
       nrrd("axis mins: 10 20 30\naxis maxs: 14 29 46\ncenters: cell cell cell\n"),
       {11, 21.5, 32},
       {13, 27.5, 44},
       as_stored,
       "orientation",
       Verdict::Warn},
      {"units of the older kind",
       name,
       nrrd("spacings: 2 3 4\nunits: \"cm\" \"cm\" \"cm\"\naxis mins: 10 20 30\ncenters: node node node\n"),
       {100, 200, 300},
       {120, 260, 420},
       as_stored,
       "length_unit",
       Verdict::Pass},
      {"old min and old max", name, nrrd(lps + origin + "old min: -1000\nold max: 2000\n"), lps_first,
       lps_last, as_stored, "old_range", Verdict::Warn},
      {"measurement frame", name, nrrd(lps + origin + "measurement frame: (1,0,0) (0,1,0) (0,0,1)\n"),
       lps_first, lps_last, as_stored, "measurement_frame", Verdict::Pass},
      {"sample units HU",
       name,
       nrrd(lps + origin + "type: short\nendian: big\nsample units: \"HU\"\n",
            std::string(46, '\x70') + std::string("\xfc\x18", 2)),
       lps_first,
       lps_last,
       {-1000, 0x7070},
       "unit",
       Verdict::Pass},
      {"no endian for bytes that need one",
       name,
       nrrd(lps + origin + "type: short\n", std::string(48, '\1')),
       lps_first,
       lps_last,
       {257, 257},
       "byte_order",
       Verdict::Warn},
      {"text", name,
       nrrd(lps + origin + "encoding: ascii\n",
            "0 1 2 3 4 5 6 7 8 9 10 11\n12 13 14 15 16 17 18 19 20 21 22 23\n"),
       lps_first, lps_last, as_stored, "rescale", Verdict::Pass},
      {"hex", name,
       nrrd(lps + origin + "encoding: hex\n", "000102030405060708090A0b0c0d0e0f\n1011121314151617\n"),
       lps_first, lps_last, as_stored, "rescale", Verdict::Pass},
      {"line skip and byte skip", name,
       nrrd(lps + origin + "line skip: 2\nbyte skip: 3\n", "one\ntwo\nxyz" + ramp()), lps_first, lps_last,
       as_stored, "rescale", Verdict::Pass},
      {"byte skip -1", name, nrrd(lps + origin + "byte skip: -1\n", "anything" + ramp()), lps_first, lps_last,
       as_stored, "rescale", Verdict::Pass}};
  table.insert(table.end(), others.begin(), others.end());
  return table;
}

std::vector<Row> meta_rows() {
  const char* const name = "a.mha";
  std::vector<Row> table{
      {"TransformMatrix and Offset", name, meta(meta_place), lps_first, lps_last, as_stored, "orientation",
       Verdict::Pass},
      {"TransformMatrix, an axis after the other",
       name,
       meta("TransformMatrix = 0 1 0 -1 0 0 0 0 1\nOffset = 10 20 30\nElementSpacing = 2 3 4\n"),
       lps_first,
       {4, 22, 42},
       as_stored,
       "orientation",
       Verdict::Pass},
      {"Position and Rotation", name,
       meta("Rotation = 1 0 0 0 1 0 0 0 1\nPosition = 10 20 30\nElementSpacing = 2 3 4\n"), lps_first,
       lps_last, as_stored, "orientation", Verdict::Pass},
      {"Origin and Orientation", name,
       meta("Orientation = 1 0 0 0 1 0 0 0 1\nOrigin = 10 20 30\nElementSpacing = 2 3 4\n"), lps_first,
       lps_last, as_stored, "orientation", Verdict::Pass},
      {"Offset and Position that disagree", name, meta(meta_place + "Position = 1 2 3\n"), lps_first,
       lps_last, as_stored, "geometry", Verdict::Warn},
      {"no TransformMatrix", name, meta("Offset = 10 20 30\nElementSpacing = 2 3 4\n"), lps_first, lps_last,
       as_stored, "orientation", Verdict::Warn},
      {"no Offset",
       name,
       meta("TransformMatrix = 1 0 0 0 1 0 0 0 1\nElementSpacing = 2 3 4\n"),
       {0, 0, 0},
       {2, 6, 12},
       as_stored,
       "origin",
       Verdict::Warn},
      {"ElementSize alone", name,
       meta("TransformMatrix = 1 0 0 0 1 0 0 0 1\nOffset = 10 20 30\nElementSize = 2 3 4\n"), lps_first,
       lps_last, as_stored, "spacing", Verdict::Warn},
      {"ElementSize beside ElementSpacing", name, meta(meta_place + "ElementSize = 1 1 1\n"), lps_first,
       lps_last, as_stored, "orientation", Verdict::Pass},
      {"AnatomicalOrientation RAI", name, meta(meta_place + "AnatomicalOrientation = RAI\n"), lps_first,
       lps_last, as_stored, "anatomical_orientation", Verdict::Pass},
      {"AnatomicalOrientation LPI against it", name, meta(meta_place + "AnatomicalOrientation = LPI\n"),
       lps_first, lps_last, as_stored, "anatomical_orientation", Verdict::Warn},
      {"ElementSpacing with a minus sign",
       name,
       meta("Offset = 10 20 30\nElementSpacing = 2 3 -4\n"),
       lps_first,
       {12, 26, 18},
       as_stored,
       "spacing",
       Verdict::Warn},
      {"no DistanceUnits", name, meta(meta_place), lps_first, lps_last, as_stored, "length_unit",
       Verdict::Warn},
      {"--unit cm", name, meta(meta_place), 10.0 * lps_first, 10.0 * lps_last, as_stored, "length_unit",
       Verdict::Pass, "", "cm"},
      {"slope 2 and offset -5",
       name,
       meta(meta_place + "ElementToIntensityFunctionSlope = 2\nElementToIntensityFunctionOffset = -5\n"),
       lps_first,
       lps_last,
       {-5, 41},
       "rescale",
       Verdict::Pass},
      {"slope 0", name, meta(meta_place + "ElementToIntensityFunctionSlope = 0\n"), lps_first, lps_last,
       as_stored, "rescale", Verdict::Warn},
      {"MSB",
       name,
       meta(meta_place + "ElementType = MET_SHORT\nBinaryDataByteOrderMSB = True\n",
            std::string(46, '\0') + std::string("\1\2", 2)),
       lps_first,
       lps_last,
       {0, 258},
       "rescale",
       Verdict::Pass},
      {"no byte order",
       name,
       meta(meta_place + "ElementType = MET_SHORT\n", std::string(46, '\0') + std::string("\1\2", 2)),
       lps_first,
       lps_last,
       {0, 513},
       "byte_order",
       Verdict::Warn},
      {"Modality MR", name, meta(meta_place + "Modality = MET_MOD_MR\n"), lps_first, lps_last, as_stored,
       "unit", Verdict::Pass},
      {"MET_LONG has 32 bits",
       name,
       meta(meta_place + "ElementType = MET_LONG\nBinaryDataByteOrderMSB = False\n",
            std::string(92, '\0') + std::string("\1\2\0\0", 4)),
       lps_first,
       lps_last,
       {0, 513},
       "rescale",
       Verdict::Pass},
      {"HeaderSize -1", name, meta(meta_place + "HeaderSize = -1\n", "anything" + ramp()), lps_first,
       lps_last, as_stored, "rescale", Verdict::Pass},
      {"BinaryData False", name,
       meta(meta_place + "BinaryData = False\n",
            "0 1 2 3 4 5 6 7 8 9 10 11 12 13 14 15 16 17 18 19 20 21 22 23"),
       lps_first, lps_last, as_stored, "rescale", Verdict::Pass},
      {"a colon behind each key", name,
       "NDims: 3\nDimSize: 2 3 4\nTransformMatrix: 1 0 0 0 1 0 0 0 1\nOffset: 10 20 30\n"
       "ElementSpacing: 2 3 4\nElementType: MET_UCHAR\nElementDataFile: LOCAL\n" +
           tests::ramp(),
       lps_first, lps_last, as_stored, "orientation", Verdict::Pass},
      {"a mask of a CT",
       name,
       meta(meta_place + "Modality = MET_MOD_CT\n", std::string(20, '\0') + std::string(4, '\1')),
       lps_first,
       lps_last,
       {0, 1},
       "unit",
       Verdict::Warn}};
  struct Unit {
    const char* word;
    double mm;
  };
  for (const auto& [word, mm] :
       {Unit{"mm", 1}, Unit{"um", 1e-3}, Unit{"m", 1e3}, Unit{"inch", 25.4}, Unit{"cm", 10}})
    table.push_back({std::string("DistanceUnits ") + word, name,
                     meta(meta_place + "DistanceUnits = " + word + "\n"), mm * lps_first, mm * lps_last,
                     as_stored, "length_unit", Verdict::Pass});
  return table;
}

const char* word_of(Verdict verdict) {
  return verdict == Verdict::Pass ? "PASS" : verdict == Verdict::Warn ? "WARN" : "FAIL";
}

void expect_near(const glm::dvec3& got, const glm::dvec3& right) {
  EXPECT_LE(glm::distance(got, right), 1e-6 * (1.0 + glm::length(right)))
      << got.x << " " << got.y << " " << got.z << ", right " << right.x << " " << right.y << " " << right.z;
}

/// Reads each row's file and compares it. The rows stand in the manual, too.
void expect_rows(const char* format, const std::vector<Row>& table) {
  const tests::ScratchFolder folder;
  std::vector<std::string> found;
  for (const Row& row : table) {
    SCOPED_TRACE(std::string(format) + ": " + row.statement);
    write_bytes(folder / row.name, row.bytes);
    ReadOptions options;
    if (*row.frame != '\0') options.frame = parse_frame(row.frame);
    if (*row.unit != '\0') options.unit = parse_unit(row.unit);
    try {
      const Scene scene = read_scene(folder / row.name, options);
      const Range values = range(scene);
      expect_near(scene.lattice.lps_mm({0, 0, 0}), row.first_mm);
      expect_near(scene.lattice.lps_mm(glm::dvec3(scene.lattice.dims - 1)), row.last_mm);
      EXPECT_EQ(values.low, row.range.low);
      EXPECT_EQ(values.high, row.range.high);
      const Finding* const line = tests::finding(scene, row.check);
      ASSERT_NE(line, nullptr) << "the audit has no line '" << row.check << "'";
      EXPECT_EQ(line->verdict, row.verdict) << line->detail;
      found.push_back(print("| %s | %s | %g %g %g | %g to %g | ", format, row.statement.c_str(),
                            row.first_mm.x, row.first_mm.y, row.first_mm.z, row.range.low, row.range.high) +
                      word_of(line->verdict) + " " + row.check + ": " + line->detail + " |");
    } catch (const std::exception& error) {
      ADD_FAILURE() << "refused: " << error.what();
    }
  }
  tests::expect_on_page(found, OCTOTOMY_SOURCE_DIR "/voxel/volume/statements.md", std::string(format) + " |");
}

TEST(VolumeConventions, HoldForWhatNiftiStates) {
  expect_rows("NIfTI", nifti_rows());
}

TEST(VolumeConventions, HoldForWhatNrrdStates) {
  expect_rows("NRRD", nrrd_rows());
}

TEST(VolumeConventions, HoldForWhatMetaImageStates) {
  expect_rows("MetaImage", meta_rows());
}

}  // namespace
}  // namespace octotomy::voxel
