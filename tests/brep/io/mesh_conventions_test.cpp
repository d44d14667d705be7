// SPDX-License-Identifier: AGPL-3.0-or-later
//
// What mesh files state about themselves, one file a statement, with the right place: the box from (10, 30,
// -5) to (20, 50, 25), LPS mm, as each file has it in its own frame and unit. The table is printed.
#include <cstring>
#include <fstream>
#include <functional>
#include <gtest/gtest.h>
#include <sstream>

#include "brep/io/read_mesh.h"
#include "brep/io/write_mesh.h"
#include "brep/mesh/health.h"
#include "brep/mesh/measure.h"
#include "tests/brep/io/zip_bytes.h"
#include "tests/brep/shapes.h"
#include "tests/page_rows.h"
#include "tests/voxel/scratch_folder.h"

namespace octotomy::brep {
namespace {

using tests::little;

Triangles lps_box() {
  return shapes::box({10, 30, -5}, {20, 50, 25});
}

/// The box as a file in another frame and unit stores it: the inverse of reading.
Triangles in_file(const std::string& frame, double unit_mm) {
  Triangles t = lps_box();
  const glm::dmat3 lps = lps_from(frame);
  for (glm::dvec3& p : t.points_mm) p = glm::transpose(lps) * p / unit_mm;
  if (glm::determinant(lps) < 0.0)
    for (auto& face : t.faces) std::swap(face[1], face[2]);
  return t;
}

std::string number(double value) {
  std::ostringstream text;
  text.precision(9);
  text << value;
  return text.str();
}
std::string point(const glm::dvec3& p) {
  return number(p.x) + " " + number(p.y) + " " + number(p.z);
}
std::string single(double value) {
  const auto number = static_cast<float>(value);
  std::uint32_t bits = 0;
  std::memcpy(&bits, &number, 4);
  return little(bits, 4);
}

std::string stl(const Triangles& t, std::string header) {
  header.resize(80, ' ');
  std::string bytes = header + little(t.faces.size(), 4);
  for (const auto& face : t.faces) {
    bytes += std::string(12, '\0');
    for (const std::uint32_t v : face)
      for (int axis = 0; axis < 3; ++axis) bytes += single(t.points_mm[v][axis]);
    bytes += std::string(2, '\0');
  }
  return bytes;
}
std::string stl_text(const Triangles& t, const std::string& name) {
  std::string text = "solid " + name + "\n";
  for (const auto& face : t.faces) {
    text += "facet normal 0 0 0\nouter loop\n";
    for (const std::uint32_t v : face) text += "vertex " + point(t.points_mm[v]) + "\n";
    text += "endloop\nendfacet\n";
  }
  return text + "endsolid " + name + "\n";
}
std::string faces_of(const Triangles& t, const std::string& before, std::uint32_t first) {
  std::string text;
  for (const auto& f : t.faces)
    text += before + std::to_string(f[0] + first) + " " + std::to_string(f[1] + first) + " " +
            std::to_string(f[2] + first) + "\n";
  return text;
}
std::string points_of(const Triangles& t, const std::string& before = "") {
  std::string text;
  for (const glm::dvec3& p : t.points_mm) text += before + point(p) + "\n";
  return text;
}
std::string ply(const Triangles& t, const std::string& comment) {
  return "ply\nformat ascii 1.0\n" + (comment.empty() ? "" : "comment " + comment + "\n") +
         "element vertex 8\nproperty float x\nproperty float y\nproperty float z\nelement face 12\n"
         "property list uchar int vertex_indices\nend_header\n" +
         points_of(t) + faces_of(t, "3 ", 0);
}
std::string obj(const Triangles& t, const std::string& comment) {
  return (comment.empty() ? "" : "# " + comment + "\n") + points_of(t, "v ") + faces_of(t, "f ", 1);
}
std::string off(const Triangles& t, const std::string& comment) {
  return "OFF\n" + (comment.empty() ? "" : "# " + comment + "\n") + "8 12 0\n" + points_of(t) +
         faces_of(t, "3 ", 0);
}
std::string vtk(const Triangles& t, const std::string& title, const std::string& field = "") {
  return "# vtk DataFile Version 4.2\n" + title + "\nASCII\nDATASET POLYDATA\n" +
         (field.empty() ? "" : "FIELD FieldData 1\nSPACE 1 1 string\n" + field + "\n\n") +
         "POINTS 8 float\n" + points_of(t) + "POLYGONS 12 48\n" + faces_of(t, "3 ", 0);
}
std::string vtp(const Triangles& t, const std::string& comment, const std::string& field = "") {
  std::string letters, offsets;
  for (const char c : field) letters += std::to_string(static_cast<int>(c)) + " ";
  for (int i = 1; i <= 12; ++i) offsets += std::to_string(3 * i) + " ";
  return "<?xml version=\"1.0\"?>" + (comment.empty() ? "" : "<!-- " + comment + " -->") +
         "<VTKFile type=\"PolyData\"><PolyData>" +
         (field.empty() ? ""
                        : "<FieldData><Array type=\"String\" Name=\"SPACE\" NumberOfTuples=\"1\" "
                          "format=\"ascii\">" +
                              letters + "0</Array></FieldData>") +
         "<Piece NumberOfPoints=\"8\" NumberOfPolys=\"12\"><Points><DataArray type=\"Float64\" "
         "NumberOfComponents=\"3\" format=\"ascii\">" +
         points_of(t) +
         "</DataArray></Points><Polys><DataArray type=\"Int32\" Name=\"connectivity\" format=\"ascii\">" +
         faces_of(t, "", 0) + "</DataArray><DataArray type=\"Int32\" Name=\"offsets\" format=\"ascii\">" +
         offsets + "</DataArray></Polys></Piece></PolyData></VTKFile>";
}
std::string glb(const Triangles& t, const std::string& node) {
  std::string data, json;
  for (const glm::dvec3& p : t.points_mm)
    for (int axis = 0; axis < 3; ++axis) data += single(p[axis]);
  for (const auto& face : t.faces)
    for (const std::uint32_t v : face) data += little(v, 2);
  json = R"({"asset":{"version":"2.0","generator":"hand"},"scene":0,"scenes":[{"nodes":[0]}],"nodes":[)" +
         node +
         R"(],"meshes":[{"primitives":[{"attributes":{"POSITION":0},"indices":1}]}],)"
         R"("accessors":[{"bufferView":0,"componentType":5126,"count":8,"type":"VEC3"},)"
         R"({"bufferView":1,"componentType":5123,"count":36,"type":"SCALAR"}],)"
         R"("bufferViews":[{"buffer":0,"byteLength":96},{"buffer":0,"byteOffset":96,"byteLength":72}],)"
         R"("buffers":[{"byteLength":168}]})";
  while (json.size() % 4 != 0) json += ' ';
  const std::string chunks =
      little(json.size(), 4) + "JSON" + json + little(data.size(), 4) + std::string("BIN\0", 4) + data;
  return "glTF" + little(2, 4) + little(12 + chunks.size(), 4) + chunks;
}
std::string model(const Triangles& t, const std::string& attributes,
                  const std::string& build = "<item objectid=\"1\"/>", const std::string& more = "") {
  std::string xml =
      "<?xml version=\"1.0\" encoding=\"UTF-8\"?><model xmlns=\"http://schemas.microsoft.com/"
      "3dmanufacturing/core/2015/02\" " +
      attributes +
      "><metadata name=\"Application\">hand</metadata><resources><object id=\"1\" "
      "type=\"model\"><mesh><vertices>";
  for (const glm::dvec3& p : t.points_mm)
    xml += "<vertex x=\"" + number(p.x) + "\" y=\"" + number(p.y) + "\" z=\"" + number(p.z) + "\"/>";
  xml += "</vertices><triangles>";
  for (const auto& f : t.faces)
    xml += "<triangle v1=\"" + std::to_string(f[0]) + "\" v2=\"" + std::to_string(f[1]) + "\" v3=\"" +
           std::to_string(f[2]) + "\"/>";
  return xml + "</triangles></mesh></object>" + more + "</resources><build>" + build + "</build></model>";
}
std::string threemf(const std::string& xml, bool deflate = true) {
  return tests::zipped(
      {{"_rels/.rels",
        "<Relationships xmlns=\"http://schemas.openxmlformats.org/package/2006/relationships\"><Relationship "
        "Target=\"/3D/box.model\" Id=\"r\" "
        "Type=\"http://schemas.microsoft.com/3dmanufacturing/2013/01/3dmodel\"/></Relationships>"},
       {"3D/box.model", xml}},
      deflate);
}

struct Row {
  std::string states, file, bytes;
  MeshVerdict frame = MeshVerdict::Pass, unit = MeshVerdict::Warn;
  MeshReadOptions options = {};
};

std::vector<Row> rows() {
  constexpr auto pass = MeshVerdict::Pass, warn = MeshVerdict::Warn;
  const Triangles lps = in_file("LPS", 1), ras = in_file("RAS", 1), las = in_file("LAS", 1);
  return {
      {"STL header, SPACE=RAS", "a.stl", stl(ras, "3D Slicer output. SPACE=RAS")},
      {"STL header, SPACE=LPS", "a.stl", stl(lps, "3D Slicer output. SPACE=LPS")},
      {"STL header, nothing", "a.stl", stl(lps, "made by hand"), warn},
      {"STL solid line, SPACE=RAS", "a.stl", stl_text(ras, "3D Slicer output. SPACE=RAS")},
      {"STL header, UNITS=inch", "a.stl", stl(in_file("LPS", 25.4), "UNITS=inch"), warn, pass},
      {"STL header, nothing; --frame RAS --unit m",
       "a.stl",
       stl(in_file("RAS", 1000), "x"),
       pass,
       pass,
       {"RAS", "m"}},
      {"STL header, SPACE=LPS against --frame RAS", "a.stl", stl(ras, "SPACE=LPS"), warn, warn, {"RAS", {}}},
      {"STL header, SPACE=LAS, left-handed", "a.stl", stl(las, "SPACE=LAS")},
      {"STL header, space: right-anterior-superior", "a.stl", stl(ras, "space: right-anterior-superior")},
      {"PLY comment, SPACE=RAS", "a.ply", ply(ras, "SPACE=RAS")},
      {"PLY comment, units millimetres", "a.ply", ply(lps, "units millimetres"), warn, pass},
      {"PLY comment, unit: cm", "a.ply", ply(in_file("LPS", 10), "unit: cm"), warn, pass},
      {"OBJ comment, SPACE=RAS", "a.obj", obj(ras, "3D Slicer output. SPACE=RAS")},
      {"OBJ comment, File units = meters", "a.obj", obj(in_file("LPS", 1000), "File units = meters"), warn,
       pass},
      {"OBJ comment, File units = inches", "a.obj", obj(in_file("LPS", 25.4), "File units = inches"), warn,
       pass},
      {"OBJ comment, Units are in mm", "a.obj", obj(lps, "Units are in mm"), warn, pass},
      {"PLY comment, unit of length in cm", "a.ply", ply(in_file("LPS", 10), "unit of length in cm"), warn,
       pass},
      {"PLY comment, units: dm", "a.ply", ply(in_file("LPS", 100), "units: dm"), warn, pass},
      {"PLY comment, unit: m^3", "a.ply", ply(lps, "unit: m^3"), warn, warn},
      {"PLY comment, coordinate system is RAS", "a.ply", ply(ras, "the coordinate system is RAS")},
      {"OFF comment, SPACE=RAS UNITS=um", "a.off", off(in_file("RAS", 1e-3), "SPACE=RAS UNITS=um"), pass,
       pass},
      {"OFF, our own comment", "a.off", off(lps, "octotomy, LPS millimetres"), pass, pass},
      {"VTK title, SPACE=RAS", "a.vtk", vtk(ras, "3D Slicer output. SPACE=RAS")},
      {"VTK field SPACE, RAS", "a.vtk", vtk(ras, "vtk output", "RAS")},
      {"VTP field SPACE, RAS", "a.vtp", vtp(ras, "", "RAS")},
      {"VTP comment, SPACE=RAS", "a.vtp", vtp(ras, "SPACE=RAS")},
      {"VTP, nothing", "a.vtp", vtp(lps, ""), warn},
      {"GLB, metres, y up", "a.glb", glb(in_file("LSA", 1000), R"({"mesh":0})"), pass, pass},
      {"GLB, a node moves and scales", "a.glb",
       glb(in_file("LSA", 1), R"({"mesh":0,"scale":[0.001,0.001,0.001]})"), pass, pass},
      {"GLB against --unit mm", "a.glb", glb(in_file("LSA", 1), R"({"mesh":0})"), pass, warn, {{}, "mm"}},
      {"GLB against --frame LPS",
       "a.glb",
       glb(in_file("LPS", 1000), R"({"mesh":0})"),
       warn,
       pass,
       {"LPS", {}}},
      {"GLB, a mirrored node below a turned one", "a.glb",
       // Turned by 180 degrees about x, then z negated in the child.
       glb(
           [] {
             Triangles t = in_file("LSA", 1000);
             for (glm::dvec3& p : t.points_mm) p = {p.x, -p.y, p.z};
             for (auto& face : t.faces) std::swap(face[1], face[2]);
             return t;
           }(),
           R"({"children":[1],"rotation":[1,0,0,0]},{"mesh":0,"scale":[1,1,-1]})"),
       pass, pass},
      {"3MF, no unit: millimetres", "a.3mf", threemf(model(lps, "")), warn, pass},
      {"3MF, unit micron, stored", "a.3mf", threemf(model(in_file("LPS", 1e-3), "unit=\"micron\""), false),
       warn, pass},
      {"3MF, unit inch", "a.3mf", threemf(model(in_file("LPS", 25.4), "unit=\"inch\"")), warn, pass},
      {"3MF, unit foot", "a.3mf", threemf(model(in_file("LPS", 304.8), "unit=\"foot\"")), warn, pass},
      {"3MF, unit meter", "a.3mf", threemf(model(in_file("LPS", 1000), "unit=\"meter\"")), warn, pass},
      {"3MF, unit centimeter; --frame RAS",
       "a.3mf",
       threemf(model(in_file("RAS", 10), "unit=\"centimeter\"")),
       pass,
       pass,
       {"RAS", {}}},
      {"3MF, moved by a component and an item", "a.3mf",
       threemf(model(
           [] {
             Triangles t = in_file("LPS", 1);
             for (glm::dvec3& p : t.points_mm) p = {-p.y, p.x, p.z - 7};
             return t;
           }(),
           "", "<item objectid=\"2\" transform=\"0 -1 0 1 0 0 0 0 1 0 0 3\"/>",
           "<object id=\"2\"><components><component objectid=\"1\" transform=\"1 0 0 0 1 0 0 0 1 0 0 "
           "4\"/></components></object>")),
       warn, pass},
  };
}

MeshFile read_row(const Row& row) {
  static const tests::ScratchFolder folder;
  std::ofstream(folder / row.file, std::ios::binary) << row.bytes;
  return read_mesh(folder / row.file, row.options);
}

const MeshFinding& finding(const MeshFile& file, const std::string& check) {
  for (const MeshFinding& each : file.audit)
    if (each.check == check) return each;
  throw std::runtime_error("no line about " + check);
}

TEST(MeshConventions, EveryStatementOfAFilePutsTheBoxInItsPlace) {
  std::vector<std::string> found;
  for (const Row& row : rows()) {
    SCOPED_TRACE(row.states);
    const MeshFile file = read_row(row);
    const Extent extent = file.extent();
    // Single precision of half a metre, and nine digits.
    EXPECT_LT(glm::distance(extent.low_mm, glm::dvec3(10, 30, -5)), 1e-4)
        << extent.low_mm.x << " " << extent.low_mm.y;
    EXPECT_LT(glm::distance(extent.high_mm, glm::dvec3(20, 50, 25)), 1e-4)
        << extent.high_mm.x << " " << extent.high_mm.y;
    EXPECT_NEAR(size_of(file.triangles).volume_mm3, 6000.0, 0.1);
    EXPECT_TRUE(health(file.triangles).solid());
    EXPECT_EQ(finding(file, "frame").verdict, row.frame) << finding(file, "frame").detail;
    EXPECT_EQ(finding(file, "unit").verdict, row.unit) << finding(file, "unit").detail;
    found.push_back("| " + row.states + " | " + to_string(row.frame) + ": " + finding(file, "frame").detail +
                    " | " + to_string(row.unit) + ": " + finding(file, "unit").detail + " |");
  }
  tests::expect_on_page(found, OCTOTOMY_SOURCE_DIR "/brep/io/statements.md", "");
}

std::string refusal(const Row& row) {
  try {
    read_row(row);
  } catch (const std::runtime_error& error) {
    return error.what();
  }
  return "";
}

TEST(MeshConventions, AContradictionIsRefusedUntilOneIsChosen) {
  Row row{"", "a.vtk", vtk(in_file("RAS", 1), "SPACE=LPS", "RAS")};
  EXPECT_NE(refusal(row).find("--frame"), std::string::npos) << refusal(row);
  row.options.frame = "RAS";
  EXPECT_EQ(read_row(row).extent().low_mm.x, 10.0);
  EXPECT_EQ(finding(read_row(row), "frame").verdict, MeshVerdict::Warn);
  Row units{"", "a.obj", obj(in_file("LPS", 1), "units = mm, UNITS=inch")};
  EXPECT_NE(refusal(units).find("--unit"), std::string::npos) << refusal(units);
}

TEST(MeshConventions, WhatIsNoFrameOrUnitIsNoStatement) {
  const MeshFile file =
      read_row({"", "a.ply", ply(in_file("LPS", 1), "SPACE=scanner UNITS=furlong 3D space unit cube")});
  EXPECT_EQ(file.extent().low_mm.x, 10.0);
  for (const char* check : {"frame", "unit"}) EXPECT_EQ(finding(file, check).verdict, MeshVerdict::Warn);
  int told = 0;
  for (const MeshFinding& each : file.audit)
    if (each.verdict == MeshVerdict::Warn && (each.detail.find("scanner") != std::string::npos ||
                                              each.detail.find("furlong") != std::string::npos))
      ++told;
  EXPECT_EQ(told, 2);
  for (const char* frame : {"", "LP", "LLS", "LPSS", "left-right-up"})
    EXPECT_FALSE(frame_named(frame)) << frame;
  for (const char* unit : {"", "km", "mmm", "pixel"}) EXPECT_FALSE(length_unit(unit)) << unit;
  Row wrong{"", "a.ply", ply(in_file("LPS", 1), "")};
  wrong.options.frame = "up";
  EXPECT_NE(refusal(wrong).find("'up' is not a frame"), std::string::npos);
  wrong.options = {{}, "ell"};
  EXPECT_NE(refusal(wrong).find("'ell' is not a unit"), std::string::npos);
}

/// The millimetres of a length of 1 in a file with that comment; 0 if it is refused.
double mm_by(const std::string& comment) {
  try {
    const Extent extent = read_row({"", "a.ply", ply(in_file("LPS", 1), comment)}).extent();
    return (extent.high_mm.x - extent.low_mm.x) / 10.0;
  } catch (const std::runtime_error&) {
    return 0.0;
  }
}
MeshVerdict unit_verdict(const std::string& comment) {
  return finding(read_row({"", "a.ply", ply(in_file("LPS", 1), comment)}), "unit").verdict;
}

TEST(MeshConventions, ASentenceStatesItsUnitAndNoPrepositionDoes) {
  for (const char* words :
       {"Units are in mm", "Units: in mm", "units in mm", "Skull surface, units are in millimeters",
        "unit in mm", "All units in millimeters", "coordinates in units of mm", "units (mm)", "units [mm]",
        "units: in (mm)", "Units: Millimeters (mm)", "units: mm (scaled from m)", "1 unit = 1 mm",
        "units=\"mm\"", "<unit>mm</unit>", "unit: mm, velocity unit: m/s"}) {
    EXPECT_NEAR(mm_by(words), 1.0, 1e-9) << words;
    EXPECT_EQ(unit_verdict(words), MeshVerdict::Pass) << words;
  }
  const std::vector<std::pair<const char*, double>> others{
      {"Units are in inches", 25.4},  {"Units: in", 25.4},
      {"UNITS=in SPACE=LPS", 25.4},   {"unit: inch (was mm)", 25.4},
      {"Units: in, z up", 25.4},      {"Unit is the meter", 1000.0},
      {"units, m", 1000.0},           {"unit m", 1000.0},
      {"numpy-stl units m", 1000.0},  {"XYZ unit: m, RGB", 1000.0},
      {"Units in metres", 1000.0},    {"units of length in cm", 10.0},
      {"scale: 1 unit = 1 cm", 10.0}, {"length_unit: cm", 10.0},
      {"units: dm", 100.0},           {"units: nm", 1e-6},
      {"units: mil", 0.0254},         {"Mesh units: cm  Angle units: deg", 10.0}};
  for (const auto& [words, mm] : others) {
    EXPECT_NEAR(mm_by(words) / mm, 1.0, 1e-9) << words;
    EXPECT_EQ(unit_verdict(words), MeshVerdict::Pass) << words;
  }
}

TEST(MeshConventions, AUnitOfSomethingElseOrANameIsNoUnitOfLength) {
  for (const char* words : {"unit m/s",
                            "unit: m^3",
                            "volume unit: m^3",
                            "Dental Unit M, Dr. X",
                            "velocity unit: m",
                            "unit m s-1",
                            "units: m squared",
                            "Units m/pixel 0.5",
                            "time unit: m",
                            "unit of volume: m^3",
                            "unit in the machine",
                            "made by unit in Berlin",
                            "unit M2 of the hospital",
                            "units are not m",
                            "units mm to m",
                            "10 units = 1 cm",
                            "0.1 units = 1 cm",
                            "units per meter: 1000",
                            "units unknown, probably cm",
                            "Units are in",
                            "volume_unit: cm"}) {
    EXPECT_NEAR(mm_by(words), 1.0, 1e-9) << words;
    EXPECT_EQ(unit_verdict(words), MeshVerdict::Warn) << words;
  }
  // What names a unit all the same is reported with its words.
  for (const char* words : {"units mm to m", "units unknown, probably cm", "10 units = 1 cm",
                            "units: furlong", "Units: 1 = 1m", "unit: m^3"}) {
    const MeshFile file = read_row({"", "a.ply", ply(in_file("LPS", 1), words)});
    std::size_t told = 0;
    for (const MeshFinding& each : file.audit) told += each.check == "unit";
    EXPECT_EQ(told, 2u) << words;
    EXPECT_NE(finding(file, "unit").detail.find("no unit could be taken"), std::string::npos) << words;
  }
  const MeshFile silent = read_row({"", "a.ply", ply(in_file("LPS", 1), "unit normals in world space")});
  EXPECT_EQ(finding(silent, "unit").detail, "the file names no unit: mm is assumed");
}

TEST(MeshConventions, AFrameIsAStatementAndNoWordOfThreeLetters) {
  const auto frame_of = [](const std::string& comment) {
    const MeshFinding made = finding(read_row({"", "a.ply", ply(in_file("LPS", 1), comment)}), "frame");
    return to_string(made.verdict) + " " + made.detail;
  };
  for (const char* words : {"SPACE=RAS", "space: ras", "space RAS", "coordinate system is RAS",
                            "coordinate system (RAS)", "SPACE=RAS but written otherwise"})
    EXPECT_EQ(frame_of(words).find("PASS"), 0u) << words << ": " << frame_of(words);
  for (const char* words : {"space lip to chin", "the space air takes", "SPACE AIR", "color_SPACE=RAS",
                            "3D space, RAS unknown", "unit normals in world space"})
    EXPECT_EQ(frame_of(words).find("WARN"), 0u) << words << ": " << frame_of(words);
  for (const char* words : {"space: LPS to RAS converted", "coordinate system converted from RAS to LPS",
                            "coordinate system: RAS -> LPS", "space: lip"})
    EXPECT_EQ(frame_of(words).find("WARN no frame could be taken"), 0u) << words << ": " << frame_of(words);
}

TEST(MeshConventions, WhatWeWriteStatesItsFrameAndComesBackToItsPlace) {
  const tests::ScratchFolder folder;
  for (const char* name : {"a.stl", "a.ply", "a.obj", "a.off", "a.vtp", "a.glb"}) {
    SCOPED_TRACE(name);
    write_mesh(lps_box(), folder / name);
    const MeshFile file = read_mesh(folder / name);
    EXPECT_EQ(file.extent().low_mm, glm::dvec3(10, 30, -5));
    EXPECT_EQ(file.extent().high_mm, glm::dvec3(20, 50, 25));
    EXPECT_EQ(size_of(file.triangles).volume_mm3, 6000.0);
    for (const MeshFinding& each : file.audit)
      EXPECT_EQ(each.verdict, MeshVerdict::Pass) << each.check << each.detail;
  }
}

TEST(MeshConventions, TheAuditNamesTheProgramTheSizeAndThePolygons) {
  const MeshFile file = read_row({"", "a.stl", stl(in_file("RAS", 1), "3D Slicer output. SPACE=RAS")});
  EXPECT_EQ(finding(file, "writer").detail, "3D Slicer output. SPACE=RAS");
  EXPECT_EQ(finding(file, "size").detail, "10 x 20 x 30 mm");
  EXPECT_EQ(finding(file, "polygons").detail, "12 triangles");
  const MeshFile unbuilt = read_row({"", "a.3mf", threemf(model(in_file("LPS", 1), "", ""))});
  EXPECT_EQ(finding(unbuilt, "file").detail,
            "its build places no object: all objects are read untransformed");
  EXPECT_EQ(finding(unbuilt, "file").verdict, MeshVerdict::Warn);
  const MeshFile metres = read_row({"", "a.stl", stl(in_file("LPS", 1000), "")});
  EXPECT_EQ(finding(metres, "size").verdict, MeshVerdict::Warn);
}

TEST(MeshConventions, BesideAScanAnImplausibleSizeOrPlaceIsNamedWithWhatWouldBeRight) {
  const Extent head{{-90, -120, -100}, {90, 120, 130}};
  const auto beside = [&](const Extent& mesh) { return findings_beside(mesh, head, "the scan"); };
  EXPECT_TRUE(beside({{10, 30, -5}, {20, 50, 25}}).empty());
  const auto metres = beside({{-0.08, -0.1, -0.1}, {0.09, 0.1, 0.1}});
  ASSERT_EQ(metres.size(), 1u);
  EXPECT_EQ(metres[0].check, "scale");
  EXPECT_NE(metres[0].detail.find("--unit m"), std::string::npos) << metres[0].detail;
  EXPECT_NE(metres[0].detail.find("smaller than the scan"), std::string::npos) << metres[0].detail;
  const auto microns = beside({{-80000, -1e5, -1e5}, {9e4, 1e5, 1e5}});
  ASSERT_EQ(microns.size(), 1u);
  EXPECT_NE(microns[0].detail.find("--unit um"), std::string::npos) << microns[0].detail;
  const auto turned =
      findings_beside({{-40, -80, 0}, {-20, -60, 9}}, {{0, 0, 0}, {90, 120, 100}}, "the scan");
  ASSERT_EQ(turned.size(), 1u);
  EXPECT_EQ(turned[0].check, "place");
  EXPECT_NE(turned[0].detail.find("--frame RAS"), std::string::npos) << turned[0].detail;
}

TEST(MeshConventions, DamagedGlbAnd3mfFilesAreRefusedWithTheirReason) {
  const std::string whole = glb(in_file("LSA", 1000), R"({"mesh":0})");
  EXPECT_NE(refusal({"", "a.glb", whole.substr(0, whole.size() - 4)}).find("cut short"), std::string::npos);
  EXPECT_NE(refusal({"", "a.glb", glb(in_file("LSA", 1), R"({"children":[1],"mesh":0},{"children":[0]})")})
                .find("two parents"),
            std::string::npos);
  EXPECT_NE(refusal({"", "a.glb",
                     glb(in_file("LSA", 1), R"({"mesh":0,"matrix":[1,0,0,0.5,0,1,0,0,0,0,1,0,0,0,0,1]})")})
                .find("0 0 0 1"),
            std::string::npos);
  std::string far = whole;
  far.replace(far.find("\"count\":36"), 10, "\"count\":99");
  EXPECT_NE(refusal({"", "a.glb", far}).find("beyond its view"), std::string::npos);
  std::string packed = threemf(model(in_file("LPS", 1), ""));
  EXPECT_NE(refusal({"", "a.3mf", packed.substr(0, packed.size() - 30)}).find("archive"), std::string::npos);
  packed[packed.find("3D/box.model") + 40] ^= 1;
  EXPECT_NE(refusal({"", "a.3mf", packed}).find("damaged"), std::string::npos);
  EXPECT_NE(refusal({"", "a.3mf", threemf("<!DOCTYPE a [<!ENTITY b \"c\">]><model/>")}).find("document type"),
            std::string::npos);
  EXPECT_NE(refusal({"", "a.3mf",
                     threemf(model(
                         in_file("LPS", 1), "", "<item objectid=\"2\"/>",
                         "<object id=\"2\"><components><component objectid=\"2\"/></components></object>"))})
                .find("nested"),
            std::string::npos);
  EXPECT_NE(refusal({"", "a.3mf", threemf(model(in_file("LPS", 1), "requiredextensions=\"b\""))})
                .find("extension 'b'"),
            std::string::npos);
}

}  // namespace
}  // namespace octotomy::brep
