// SPDX-License-Identifier: AGPL-3.0-or-later
#include "tests/fuzz/file_kinds.h"

#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <regex>
#include <utility>

#include "tests/brep/io/zip_bytes.h"
#include "tests/file_bytes.h"
#include "tests/fuzz/mutation.h"
#include "tests/fuzz/sound_bytes.h"
#include "tests/voxel/scan/dicom_frames.h"
#include "tests/voxel/scan/picture_bytes.h"
#include "tests/voxel/scan/structure_set.h"

namespace octotomy::tests {
namespace {

namespace fs = std::filesystem;
using Command = std::vector<std::string>;

constexpr const char* marks =
    R"({"landmarks": [{"name": "nasion", "point_mm": [0, 0, 0]}, {"name": "ans", "point_mm": [9, 0, 1.5]},)"
    R"( {"name": "menton", "point_mm": [0, -7e0, 0], "weight": 2.0}]})";
constexpr const char* region =
    R"({"polygons_mm": [[[-40, -60], [40, -60], [40, -25.5], [-4e1, -25]], [[0, 0], [9, 0], [0, 9]]]})";
constexpr const char* drawing =
    R"(<svg xmlns="http://www.w3.org/2000/svg" width="80mm" height="60mm" viewBox="0 0 80 60">)"
    R"~(<g transform="translate(2,3)"><path d="M 1 1 L 40,1 C 45,5 45,20 40,30 Z"/></g>)~"
    R"(<rect x="5" y="35" width="30" height="10"/></svg>)";
constexpr const char* curves =
    R"({"markups": [{"type": "ClosedCurve", "coordinateSystem": "RAS", "coordinateUnits": "mm",)"
    R"( "controlPoints": [{"label": "a", "position": [-40, 0, -60]}, {"label": "b", "position": [40, 0, -60],)"
    R"( "positionStatus": "defined"}, {"label": "c", "position": [0, 5.5, 2e1]}]}]})";
constexpr const char* points =
    R"({"markups": [{"type": "Fiducial", "coordinateSystem": "LPS", "controlPoints": [)"
    R"({"label": "nasion", "position": [0, 0, 0]}, {"label": "ans", "position": [9, 0, 1]},)"
    R"( {"label": "menton", "position": [0, -7.5, 0], "positionStatus": "defined"}]}]})";
constexpr const char* edits =
    R"({"edits": [{"slice": 3, "contour": 0, "do": "remove"}, {"slice": 4, "do": "add",)"
    R"( "points_mm": [[-12.5, 4e1], [9, 40], [0, 55]]}]})";
constexpr const char* transfer =
    R"({"octotomy_transfer": 1, "surface_per_mm": 60, "points": [{"sample": -500, "colour": "#cc7a29",)"
    R"( "per_mm": 0.0}, {"sample": 100.5, "colour": "#ffffff", "per_mm": 1e-1}]})";
constexpr const char* plan =
    R"({"octotomy_plan": 1, "name": "small", "scans": {"ct": {"path": "head.nrrd"}},)"
    R"( "universe": {"voxel_mm": 12}, "steps": [{"id": "s", "do": "window", "scan": "ct", "low": 300},)"
    R"( {"id": "m", "do": "move", "object": "s", "translate_mm": [0, -6, 2]},)"
    R"( {"id": "u", "do": "combine", "expression": "s | m"}, {"id": "n", "do": "measure", "object": "u"}]})";
constexpr const char* definitions =
    R"({"cephalometry": "mine", "says": "Two.", "landmarks": [{"name": "nasion", "says": "a"},)"
    R"( {"name": "ans", "says": "b"}, {"name": "menton", "says": "c"},)"
    R"( {"name": "middle", "says": "d", "mean_of": ["ans", "menton"]}], "measures": [{"name": "A", "says": "e",)"
    R"( "kind": "angle", "points": ["ans", "nasion", "menton"], "norm": 82, "deviation": 3.5, "source": "f"},)"
    R"( {"name": "B", "says": "g", "kind": "angle", "points": ["middle", "nasion", "menton"]},)"
    R"( {"name": "C", "says": "h", "kind": "difference", "of": ["A", "B"]}]})";

constexpr const char* chin =
    R"({"landmarks": [{"name": "foramen_left", "point_mm": [23, -65, -62]},)"
    R"( {"name": "foramen_right", "point_mm": [-23, -65, -62]}, {"name": "border_left", "point_mm": [30, -50, -75]},)"
    R"( {"name": "border_right", "point_mm": [-30, -50, -75]}, {"name": "pogonion", "point_mm": [0, -85, -70]},)"
    R"( {"name": "menton", "point_mm": [0, -80, -80]}]})";

/// The JPEG 2000 picture within a DICOM file: from its first marker to its last.
std::string codestream(const std::string& dicom) {
  const std::size_t begin = dicom.find("\xff\x4f\xff\x51");
  return dicom.substr(begin, dicom.rfind("\xff\xd9") + 2 - begin);
}

/// 20 x 20 x 20 numbers of 16 bits.
std::string ramp_bytes() {
  std::string ramp;
  for (std::uint32_t i = 0; i < 20 * 20 * 20; ++i) ramp += DicomBytes::number(i % 1000, 2);
  return ramp;
}

std::string ramp_text() {
  std::string text;
  for (int i = 0; i < 20 * 20 * 20; ++i) text += std::to_string(i % 1000) + (i % 20 == 19 ? "\n" : " ");
  return text;
}

/// A NRRD with statements that others leave out.
std::string nrrd_text() {
  return "NRRD0005\n# text\ntype: double\ndimension: 4\nspace: right-anterior-superior\nsizes: 1 20 20 20\n"
         "space directions: none (1,0,0) (0,1,0) (0.1,0,1.5)\nspace origin: (-10,-9.5,3e1)\n"
         "space units: \"mm\" \"mm\" \"mm\"\nkinds: list domain domain domain\nold min: -1\nencoding: ascii\n"
         "sample units: \"HU\"\nkey:=value\n\n" +
         ramp_text();
}

std::string nrrd_list() {
  return "NRRD0004\ntype: short\ndimension: 3\nsizes: 20 20 40\nspacings: 1 1 0.5\naxis mins: 0 0 -5\n"
         "centers: node cell node\nunits: \"cm\" \"cm\" \"cm\"\nendian: little\nencoding: raw\nbyte skip: 0\n"
         "data file: part%d.raw 5 7 2\n";
}

std::string meta_text() {
  return "ObjectType = Image\nNDims = 3\nBinaryData = False\nTransformMatrix = 0 1 0 -1 0 0 0 0 1\n"
         "Offset = 10 20.5 -3e1\nCenterOfRotation = 0 0 0\nAnatomicalOrientation = ARI\nElementSpacing = 1 1 "
         "2\n"
         "DistanceUnits = mm\nModality = MET_MOD_CT\nDimSize = 20 20 20\nElementToIntensityFunctionSlope = "
         "2\n"
         "ElementToIntensityFunctionOffset = -1024\nElementType = MET_SHORT\nElementDataFile = LOCAL\n" +
         ramp_text();
}

/// The two files of a NIfTI pair out of one file.
std::string nifti_pair_header(const std::string& whole) {
  std::string header = whole.substr(0, 348) + std::string(4, '\0');
  header.replace(108, 4, std::string(4, '\0'));  // the offset of the samples, in the other file
  header.replace(344, 4, std::string("ni1\0", 4));
  return header;
}
std::string nifti_samples(const std::string& whole) {
  float offset = 0.0f;
  std::memcpy(&offset, whole.data() + 108, sizeof offset);
  return whole.substr(static_cast<std::size_t>(offset));
}

/// The tools that make the sound files, and the folder that contains these.
class SoundFiles {
 public:
  SoundFiles(fs::path folder, const std::function<void(const Command&)>& make)
      : folder_(std::move(folder)), make_(make) {}

  std::string at(const std::string& name) const { return (folder_ / name).string(); }
  std::string bytes(const std::string& name) const { return bytes_of(folder_ / name); }
  void make(const Command& arguments) const { make_(arguments); }
  void write(const std::string& name, const std::string& bytes) const {
    std::ofstream(folder_ / name, std::ios::binary) << bytes;
  }

  void make_all() const {
    make({"phantom", "head", "--voxel", "12", "-o", at("head.nrrd")});
    for (const char* name : {"head.nii", "head.mha", "head.mhd", "head.nhdr"})
      make({"convert", at("head.nrrd"), "-o", at(name)});
    make({"convert", at("head.nrrd"), "-o", at("dicom"), "--dicom"});
    make({"octree", at("head.nrrd"), "--window", "300:", "-o", at("binary.octree")});
    make({"octree", at("head.nrrd"), "--grey", "-o", at("grey.octree")});
    for (const char* name : {"labels.nrrd", "labels.nii"})
      make({"segment", at("head.nrrd"), "--window", "bone", "--window", "soft_tissue", "-o", at(name)});
    make({"segment", at("dicom"), "--window", "bone", "--window", "soft_tissue", "-o", at("seg.dcm")});
    write("box.stl", stl_text());
    write("marks.json", marks);
    write("region.json", region);
    write("chin.json", chin);
    write("small.plan.json", plan);
    make({"contours", at("head.nrrd"), "--window", "300:", "-o", at("bone.json")});
    make({"phantom", "sphere", "--voxel", "10", "--voxels", "8", "--radius", "1.6", "-o", at("ball.octree")});
    for (const char* name : {"ball.stl", "ball.ply", "ball.obj", "ball.off", "ball.vtp", "ball.glb"})
      make({"mesh", at("ball.octree"), "-o", at(name)});
    const auto picture = [&](const char* view, const char* name) {
      make(
          {"render", at("head.nrrd"), "--shading", "mip", "--view", view, "--size", "48x48", "-o", at(name)});
    };
    picture("anterior", "front.png");
    for (const char* name : {"left.png", "left.jpg", "left.webp"}) picture("left", name);
    make({"run", at("small.plan.json"), "--certify", "never", "-o", at("result")});
    write("signed.plan.json", plan);
    make({"plan", "sign", at("signed.plan.json"), "--by", "A. Reader"});
    write("told.plan.json", plan);
    make({"plan", "history", at("told.plan.json"), "--name", "first"});
    write("told.plan.json", std::regex_replace(plan, std::regex("300"), "400"));
    make({"plan", "history", at("told.plan.json"), "--branch", "harder"});
    write("told.plan.json", std::regex_replace(plan, std::regex("300"), "500"));
    make({"plan", "history", at("told.plan.json")});
  }

 private:
  fs::path folder_;
  const std::function<void(const Command&)>& make_;
};

class Kinds {
 public:
  explicit Kinds(const SoundFiles& sound) : sound_(sound) {}

  std::vector<FileKind> all() {
    add_scans();
    add_pictures();
    add_dicom();
    add_labels();
    add_octrees();
    add_meshes();
    add_drawings();
    add_documents();
    return std::move(all_);
  }

 private:
  std::string at(const std::string& name) const { return sound_.at(name); }

  FileKind& add(const std::string& name, const std::string& file, std::string sound,
                Command command = {"info", "MUTANT"}) {
    all_.push_back({name, file, std::move(sound), {}, {}, false, false, std::move(command), {}});
    return all_.back();
  }

  /// A scan, with the options that every verb needs to read it, and a window of samples that occur in it.
  FileKind& scan(const std::string& name, const std::string& file, std::string sound,
                 const Command& options = {}, const std::string& window = "300:") {
    FileKind& kind = add(name, file, std::move(sound));
    kind.verbs = {{"octree", "MUTANT", "--window", window, "-o", "OUT.octree"},
                  {"octree", "MUTANT", "--grey", "-o", "OUT.octree"},
                  {"render", "MUTANT", "--window", window, "--size", "16x16", "-o", "OUT.png"},
                  {"slice", "MUTANT", "--size", "16x16", "-o", "OUT.png"},
                  {"mesh", "MUTANT", "--window", window, "-o", "OUT.stl"},
                  {"measure", "MUTANT", "--window", window},
                  {"contours", "MUTANT", "--window", window, "-o", "OUT.json"},
                  {"segment", "MUTANT", "--window", window, "--largest", "-o", "OUT.octree"},
                  {"segment", "MUTANT", "--otsu", "2", "-o", "OUT.nrrd"},
                  {"prepare", "MUTANT", "--step", "median=1", "-o", "OUT.nrrd"},
                  {"prepare", "MUTANT", "--step", "average_down=2", "-o", "OUT.nrrd"},
                  {"convert", "MUTANT", "-o", "OUT.nii.gz"},
                  {"convert", "MUTANT", "-o", "OUT_dicom", "--dicom"}};
    kind.slow_verbs = {{"look", "MUTANT", "-o", "OUT_look"},
                       {"find_landmarks", "MUTANT", "-o", "OUT.json"},
                       {"outcome", at("small.plan.json"), "MUTANT"}};
    kind.command.insert(kind.command.end(), options.begin(), options.end());
    for (auto* verbs : {&kind.verbs, &kind.slow_verbs})
      for (Command& verb : *verbs) verb.insert(verb.end(), options.begin(), options.end());
    return kind;
  }

  void add_scans() {
    scan("nifti", "head.nii", sound_.bytes("head.nii"));
    scan("nifti_gz", "head.nii.gz", sound_.bytes("head.nii")).finish = packed;
    scan("nifti_bomb", "head.nii.gz", sound_.bytes("head.nii")).finish =
        [bomb = gzip_bomb()](const std::string& bytes) { return packed(bytes) + bomb; };
    scan("nifti2", "head.nii", nifti2());
    // The two files of a pair, one of which is damaged.
    const std::string pair = nifti_pair_header(sound_.bytes("head.nii"));
    sound_.write("pair.img", nifti_samples(sound_.bytes("head.nii")));
    scan("nifti_pair", "pair.hdr", pair).beside = {at("pair.img")};
    scan("nrrd", "head.nrrd", sound_.bytes("head.nrrd"));
    scan("nrrd_header", "head.nhdr", sound_.bytes("head.nhdr")).beside = {at("head.raw.gz")};
    scan("nrrd_text", "text.nrrd", nrrd_text());
    scan("nrrd_list", "list.nhdr", nrrd_list()).beside = {at("part5.raw"), at("part7.raw")};
    sound_.write("part5.raw", ramp_bytes());
    sound_.write("part7.raw", ramp_bytes());
    scan("metaimage_text", "text.mha", meta_text());
    scan("metaimage", "head.mha", sound_.bytes("head.mha"));
    scan("metaimage_header", "head.mhd", sound_.bytes("head.mhd")).beside = {at("head.zraw")};
    scan("raw", "head.raw", ramp_bytes(), {"--raw", "20x20x20", "int16", "--spacing", "1,1,1"});
  }

  /// A scan of two slices in a folder, of which one is the mutant.
  FileKind& stack(const std::string& name, const std::string& extension, std::string sound,
                  const std::string& window = "100:") {
    const std::string other = name + "_1." + extension;
    sound_.write(other, sound);
    FileKind& kind = scan(name, name + "_2." + extension, std::move(sound), {"--spacing", "1,1,1"}, window);
    kind.beside = {at(other)};
    kind.is_folder = true;
    return kind;
  }

  void add_pictures() {
    stack("png_stack", "png", sound_.bytes("left.png"));
    stack("png_sealed", "png", sound_.bytes("left.png")).finish = resealed_png;
    stack("jpeg_stack", "jpg", sound_.bytes("left.jpg"));
    stack("webp_stack", "webp", sound_.bytes("left.webp"));
    stack("tiff_stack", "tif", tiff(), "300:");
    stack("tiff_tiles_stack", "tif", tiff_of_tiles(16, 16));
    stack("bmp_stack", "bmp", bmp());
    stack("pgm_stack", "pgm", pgm());
    stack("pgm_deep_stack", "pgm", pgm(4095));
    stack("exr_stack", "exr", exr());
  }

  void add_dicom() {
    const std::string slice = "dicom/slice_0010.dcm";
    scan("dicom", "slice.dcm", sound_.bytes(slice));
    FileKind& series = scan("dicom_series", "slice_0010.dcm", sound_.bytes(slice));
    series.beside = {at("dicom/slice_0009.dcm"), at("dicom/slice_0011.dcm"), at("dicom/slice_0012.dcm")};
    series.is_folder = true;
    DicomFrames frames;
    scan("dicom_frames", "frames.dcm", DicomBytes::file("1.2.840.10008.1.2.1", frames.attributes()));
    frames.open = true;
    scan("dicom_open_frames", "frames.dcm", DicomBytes::file("1.2.840.10008.1.2.1", frames.attributes()));
    for (const auto& [name, command] :
         {std::pair{"dicom_jpeg_2000", "gdcmconv --j2k"}, std::pair{"dicom_jpeg_ls", "gdcmconv --jpegls"},
          std::pair{"dicom_jpeg", "gdcmconv --jpeg"}, std::pair{"dicom_rle", "gdcmconv --rle"},
          std::pair{"dicom_deflated", "dcmconv +td"}, std::pair{"dicom_big_endian", "dcmconv +tb"}}) {
      const std::string to = std::string(name) + ".dcm";
      if (std::system((std::string(command) + " " + at(slice) + " " + at(to) + " >/dev/null 2>&1").c_str()) ==
          0)
        scan(name, "slice.dcm", sound_.bytes(to));
      else
        std::printf("%-18s left out: '%s' is not installed\n", name, command);
    }
    if (fs::exists(at("dicom_jpeg_2000.dcm"))) {
      std::string picture = codestream(sound_.bytes("dicom_jpeg_2000.dcm"));
      // The samples' bits less one, without a sign. Each sample gains 2^14 when it is decoded.
      picture[42] = 14;
      stack("jpeg_2000_stack", "jp2", picture, "16484:");
      stack("jp2_stack", "jp2", jp2(picture), "16484:");
    }
    add("structure_set", "rs.dcm",
        structure_set({{1, "Mandible", {rectangle({-30, -20}, {30, 40}, -12), rectangle({0, 0}, {9, 9}, 0)}},
                       {3, "Isocentre", {{{1, 2, 3}}}, "POINT"}}),
        {"mask", "--slices", "MUTANT", "--structure", "Mandible", "--like", at("head.nrrd"), "-o",
         "OUT.octree"});
  }

  void add_labels() {
    const Command surfaces{"surfaces", "MUTANT", "-o", "OUT.vtp"},
        one{"segment", "MUTANT", "--label", "1", "-o", "OUT.octree"};
    for (const auto& [name, file] :
         {std::pair{"labels", "labels.nrrd"}, std::pair{"labels_nifti", "labels.nii"},
          std::pair{"dicom_seg", "seg.dcm"}})
      add(name, file, sound_.bytes(file)).verbs = {surfaces, one};
    all_[all_.size() - 2].verbs.push_back({"convert", "MUTANT", "--source", at("dicom"), "-o", "OUT.dcm"});
    const auto table = [&](const std::string& name, const std::string& file, const std::string& text) {
      add(name, file, text,
          {"segment", at("labels.nrrd"), "--named", "bone", "--names", "MUTANT", "-o", "OUT.octree"});
    };
    table("label_table", "names.json", R"({"bone": 1, "soft tissue": 2})");
    table("label_table_csv", "names.csv", "label,name\n1,bone\n2,\"soft, tissue\"\n");
    table("label_table_txt", "names.txt", "# ITK-SNAP\n1 255 0 0 1 1 1 \"bone\"\n2 0 255 0 1 1 1 \"soft\"\n");
  }

  void add_octrees() {
    const Command render{"render", "MUTANT", "--size", "16x16", "-o", "OUT.png"},
        slice{"slice", "MUTANT", "--size", "16x16", "-o", "OUT.png"};
    FileKind& binary = add("octree", "binary.octree", sound_.bytes("binary.octree"));
    binary.finish = resealed_octree;
    binary.verbs = {
        render,
        slice,
        {"eval", "a", "--let", "a=MUTANT", "-o", "OUT.octree"},
        {"eval", "~(a - move(a, m))", "--let", "a=MUTANT", "--motion", "m=3,0,12", "-o", "OUT.octree"},
        {"mesh", "MUTANT", "-o", "OUT.stl"},
        {"mesh", "MUTANT", "--surface", "cuberille", "-o", "OUT.stl"},
        {"measure", "MUTANT"},
        {"octree", "MUTANT", "--as", "linear", "-o", "OUT.txt"},
        {"convert", "MUTANT", "--source", at("dicom"), "-o", "OUT.dcm"},
        {"tet", "MUTANT", "-o", "OUT.inp"},
        {"parts", "MUTANT", "--largest", "1", "-o", "OUT.octree"},
        {"fill", "MUTANT", "-o", "OUT.octree"},
        {"mask", "--edit", "MUTANT", "--region", "anterior:" + at("region.json"), "-o", "OUT.octree"},
        {"voxelise", at("box.stl"), "--like", "MUTANT", "-o", "OUT.octree"}};
    FileKind& grey = add("octree_grey", "grey.octree", sound_.bytes("grey.octree"));
    grey.finish = resealed_octree;
    grey.verbs = {render,
                  slice,
                  {"measure", "MUTANT", "--window", "300:"},
                  {"mesh", "MUTANT", "--window", "300:", "-o", "OUT.stl"},
                  {"octree", "MUTANT", "--window", "300:", "-o", "OUT.octree"}};
    for (const char* form : {"treecode", "linear", "explicit", "runs", "segments", "marginal", "faces",
                             "array", "packed", "bits"}) {
      const std::string file = std::string(form) + ".txt";
      sound_.make({"octree", at("binary.octree"), "--as", form, "-o", at(file)});
      add(std::string("form_") + form, file, sound_.bytes(file),
          {"octree", "MUTANT", "--from", form, "--depth", "5", "-o", "OUT.octree"});
    }
  }

  void add_meshes() {
    const auto mesh = [&](const std::string& name, const std::string& file, std::string sound) -> FileKind& {
      FileKind& kind = add(name, file, std::move(sound));
      kind.verbs = {
          {"measure", "MUTANT"},
          {"measure", "MUTANT", "--section", "1,1,1", "0,0,1"},
          {"measure", "MUTANT", "--curvature"},
          {"voxelise", "MUTANT", "--voxel", "6", "-o", "OUT.octree"},
          {"boolean", "MUTANT", "union", at("box.stl"), "-o", "OUT.stl"},
          {"repair", "MUTANT", "--orient", "--flat", "--duplicates", "--weld", "0.001", "-o", "OUT.stl"},
          {"repair", "MUTANT", "--solid", "--cell", "8", "-o", "OUT.ply"},
          {"smooth", "MUTANT", "--rounds", "1", "--max-volume-share", "0.9", "-o", "OUT.ply"},
          {"decimate", "MUTANT", "--faces", "100", "-o", "OUT.obj"},
          {"saw", "MUTANT", "--line", "-60,-120,-20", "60,-120,-20", "--direction", "0,1,0", "-o", "OUT.stl"},
          {"brush", "MUTANT", "--points", "-20,-90,-28", "0,-95,-28", "-o", "OUT.stl"},
          {"parts", "MUTANT", "--largest", "1", "-o", "OUT.off"},
          {"separate", "MUTANT", "-o", "OUT.stl"},
          {"compare", "MUTANT", at("box.stl"), "--spacing", "10"},
          {"slice", at("head.nrrd"), "--octree", "MUTANT", "--size", "16x16", "-o", "OUT.png"},
          {"mirror", "MUTANT", "-o", "OUT.stl"},
          {"mirror", "MUTANT", "--plane", "1,2,3", "1,1,0", "--exactly", "-o", "OUT.ply"},
          {"shell", "MUTANT", "--thickness", "8", "--voxel", "2", "-o", "OUT.octree"},
          {"shadow", "MUTANT", "--direction", "0.2,1,0.1", "--voxel", "2", "-o", "OUT.octree"},
          {"fill", "MUTANT", "--certify", "-o", "OUT.stl"},
          {"saw", "MUTANT", "--line", "-60,-120,-20", "60,-120,-20", "--direction", "0,1,0", "--certify",
           "-o", "OUT.stl"}};
      kind.slow_verbs = {{"boolean", at("box.stl"), "intersection", "MUTANT", "--mend", "-o", "OUT.stl"},
                         {"offset", "MUTANT", "--by", "20", "--mend", "-o", "OUT.stl"},
                         {"tet", "MUTANT", "--mend", "-o", "OUT.vtu"}};
      return kind;
    };
    for (const char* kind : {"stl", "ply", "obj", "off", "vtp", "glb"})
      mesh(kind, std::string("ball.") + kind, sound_.bytes(std::string("ball.") + kind));
    mesh("vtk", "box.vtk", vtk());
    mesh("vtk_binary", "box.vtk", vtk_binary());
    mesh("vtp_text", "box.vtp", vtp_text());
    mesh("stl_text", "box.stl", stl_text());
    mesh("ply_text", "box.ply", ply_text());
    mesh("vtk_grid", "box.vtk", vtk_grid());
    mesh("vtu_text", "box.vtu", vtu_text());
    mesh("obj_polygons", "box.obj", obj_polygons());
    const auto archive = [](const std::string& xml) { return zipped({{"3D/3dmodel.model", xml}}, true); };
    mesh("3mf", "box.3mf", archive(model_3mf()));
    mesh("3mf_model", "box.3mf", model_3mf()).finish = archive;
    add("frd", "face.frd", frd(), {"warp", at("box.stl"), "--result", "MUTANT", "-o", "OUT.stl"});
  }

  /// Adds the kinds of files that contain drawings or marks.
  void add_drawings() {
    const auto mask = [&](const std::string& name, const std::string& file, std::string sound,
                          Command command) {
      command.insert(command.begin(), "mask");
      command.insert(command.end(), {"--like", at("head.nrrd"), "-o", "OUT.octree"});
      add(name, file, std::move(sound), std::move(command));
    };
    mask("region", "region.json", region, {"--region", "anterior:MUTANT"});
    mask("region_svg", "region.svg", drawing, {"--region", "anterior:MUTANT"});
    mask("region_curves", "region.mrk.json", curves, {"--region", "anterior:MUTANT"});
    mask("region_picture", "front.png", sound_.bytes("front.png"),
         {"--region-pixels", "MUTANT:10,10 40,10 40,40"});
    mask("slices", "slices.json", sound_.bytes("bone.json"), {"--slices", "MUTANT"});
    add("contours", "slices.json", sound_.bytes("bone.json"),
        {"contours", "MUTANT", "--by", "1", "-o", "OUT.json"});
    add("edits", "edits.json", edits, {"contours", at("bone.json"), "--edits", "MUTANT", "-o", "OUT.json"});
    const Command registration{"register", at("box.stl"),    at("box.stl"),     "--landmarks",
                               "MUTANT",   at("marks.json"), "--landmarks-only"};
    add("landmarks", "marks.json", marks, registration);
    add("landmarks_markups", "marks.mrk.json", points, registration);
    add("curve", "curve.json", R"({"points_mm": [[-30, 10, 5], [-15.5, -25, 5], [1.5e1, -25, 5]]})",
        {"slice", at("head.nrrd"), "--curve", "MUTANT", "--pixel", "4", "-o", "OUT.png"});
    add("transfer", "transfer.json", transfer,
        {"render", at("head.nrrd"), "--shading", "composite", "--transfer", "MUTANT", "--size", "16x16", "-o",
         "OUT.png"});
  }

  void add_documents() {
    const std::string whole = at("small.plan.json");
    FileKind& plans = add("plan", "small.plan.json", plan, {"verify", "MUTANT"});
    plans.beside = {at("head.nrrd")};
    plans.verbs = {{"plan", "diff", "MUTANT", whole},
                   {"plan", "merge", whole, "MUTANT", whole, "-o", "OUT.plan.json"},
                   {"preview", "MUTANT", "u", "-o", "OUT.png"},
                   {"run", "MUTANT", "--certify", "never", "-o", "OUT_result"}};
    add("signatures", "signed.plan.json", sound_.bytes("signed.plan.json"), {"plan", "sign", "MUTANT"})
        .beside = {at("head.nrrd")};
    FileKind& history = add("history", "told.plan.json.history", sound_.bytes("told.plan.json.history"));
    history.beside = {at("told.plan.json")};
    history.is_folder = history.is_changed = true;
    history.command = {"plan", "history", "MUTANT/told.plan.json"};
    for (const Command& more :
         {Command{"--undo"}, {"--go-to", "first"}, {"--branch", "softer"}, {"--name", "last"}}) {
      history.verbs.push_back(history.command);
      history.verbs.back().insert(history.verbs.back().end(), more.begin(), more.end());
    }
    add("question", "question.json",
        R"({"name": "both", "operands": ["box.stl", "box.stl"], "operation": "union", "result": "box.stl"})",
        {"verify", "MUTANT"})
        .beside = {at("box.stl")};
    add("procedure", "mine.procedure.json",
        bytes_of(OCTOTOMY_SOURCE_DIR "/planner/procedure/template/genioplasty.procedure.json"),
        {"procedure", "MUTANT", "--scan", at("head.nrrd"), "--landmarks", at("chin.json"), "--set",
         "forward_mm=5", "--voxel", "12", "-o", "OUT.plan.json"});
    add("definitions", "mine.json", definitions,
        {"cephalometry", at("marks.json"), "--definitions", "MUTANT"});
    add("result", "result.json", sound_.bytes("result/result.json"), {"table", "MUTANT", "-o", "OUT.csv"});
    add("subjects", "scans.csv", "participant_id,scan\nsub-1,head.nrrd\nsub-2,\"head.nrrd\"\n",
        {"cohort", "MUTANT", "OUT_cohort", "participant", "--plan", whole, "--dry-run"})
        .beside = {at("head.nrrd")};
  }

  const SoundFiles& sound_;
  std::vector<FileKind> all_;
};

}  // namespace

std::vector<FileKind> file_kinds(const fs::path& folder, const std::function<void(const Command&)>& make) {
  const SoundFiles sound(folder, make);
  sound.make_all();
  return Kinds(sound).all();
}

}  // namespace octotomy::tests
