// SPDX-License-Identifier: AGPL-3.0-or-later
//
// Damaged files for every reader: `octotomy info`, or the verb that reads that kind, runs on each as a
// process of its own, with limits on time and address space. A mutant is read (status 0) or refused (status
// 2, one line on standard error, nothing on standard output); anything else - a crash, a hang, memory that
// the file could not hold - is a fault, is kept, and is the exit status.
#include <CLI/CLI.hpp>
#include <atomic>
#include <bit>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <fcntl.h>
#include <filesystem>
#include <fstream>
#include <functional>
#include <mutex>
#include <sys/resource.h>
#include <sys/wait.h>
#include <thread>
#include <unistd.h>

#include "tests/file_bytes.h"
#include "tests/fuzz/mutation.h"
#include "tests/voxel/scan/dicom_frames.h"
#include "tests/voxel/scratch_folder.h"

namespace {

namespace fs = std::filesystem;
using namespace octotomy::tests;

void write_bytes(const fs::path& path, const std::string& bytes) {
  std::ofstream(path, std::ios::binary) << bytes;
}

/// A kind of file: one that is sound, and what its mutants go through before they are written.
struct Reader {
  std::string name;
  std::string file;                    ///< the mutant's name, with the extension that chooses the reader
  std::string sound;                   ///< bytes to mutate
  std::vector<std::string> arguments;  ///< of info, after the file
  /// Of half of the mutants: packs or seals, so that damage gets past checksums.
  std::function<std::string(std::string)> finish;
  std::vector<fs::path> beside;  ///< files that lie in the mutant's folder; info is then given the folder
  /// The verb that reads it, where that is not info: MUTANT stands for the mutant, OUT for a file to write.
  std::vector<std::string> command;
};

struct Options {
  fs::path program = fs::path(OCTOTOMY_BINARY_DIR) / "octotomy";
  std::uint64_t count = 2000;
  std::uint64_t first_seed = 0;
  std::vector<std::string> readers;
  fs::path keep;
  double seconds = 20.0;
  std::size_t address_space_mib = 1536;
  std::size_t resident_mib = 384;
  unsigned workers = std::max(1u, std::thread::hardware_concurrency());
};

/// How a process ended.
struct Outcome {
  int status = -1;  ///< exit status, or minus the signal
  bool timed_out = false;
  std::size_t resident_mib = 0;
  std::string out, errors;
};

void limit(int resource, rlim_t most) {
  const rlimit both{most, most};
  setrlimit(resource, &both);
}

Outcome run(const Options& options, const std::vector<std::string>& arguments, const fs::path& folder) {
  const fs::path out = folder / "stdout.txt", errors = folder / "stderr.txt";
  std::vector<char*> words;
  words.reserve(arguments.size() + 1);
  for (const std::string& argument : arguments) words.push_back(const_cast<char*>(argument.c_str()));
  words.push_back(nullptr);
  const std::string program = options.program.string();
  const pid_t process = fork();
  if (process == 0) {  // only what is safe after a fork of a process with threads
    const int out_file = open(out.c_str(), O_CREAT | O_TRUNC | O_WRONLY, 0600);
    const int error_file = open(errors.c_str(), O_CREAT | O_TRUNC | O_WRONLY, 0600);
    dup2(out_file, STDOUT_FILENO);
    dup2(error_file, STDERR_FILENO);
    limit(RLIMIT_CORE, 0);
    limit(RLIMIT_CPU, static_cast<rlim_t>(options.seconds) + 1);
#ifndef OCTOTOMY_SANITIZED
    limit(RLIMIT_AS, rlim_t{options.address_space_mib} << 20);
#endif
    execv(program.c_str(), words.data());
    _exit(127);
  }
  if (process < 0) throw std::runtime_error("no process can be started");
  Outcome outcome;
  const auto begin = std::chrono::steady_clock::now();
  int status = 0;
  rusage usage{};
  while (wait4(process, &status, WNOHANG, &usage) == 0) {
    const std::chrono::duration<double> passed = std::chrono::steady_clock::now() - begin;
    if (passed.count() > options.seconds && !outcome.timed_out) {
      outcome.timed_out = true;
      kill(process, SIGKILL);
    }
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }
  outcome.status = WIFEXITED(status) ? WEXITSTATUS(status) : -WTERMSIG(status);
  outcome.resident_mib = static_cast<std::size_t>(usage.ru_maxrss) >> 10;
  outcome.out = bytes_of(out);
  outcome.errors = bytes_of(errors);
  return outcome;
}

/// Why an outcome is a fault; empty where it is none.
std::string fault_of(const Outcome& outcome, const Options& options) {
  if (outcome.timed_out) return "did not end within " + std::to_string(options.seconds) + " s";
  if (outcome.status < 0) return "ended by signal " + std::to_string(-outcome.status);
  // A plan's kernels may disagree about a damaged plan.
  if (outcome.status != 0 && outcome.status != 2 && outcome.status != 1)
    return "status " + std::to_string(outcome.status);
#ifndef OCTOTOMY_SANITIZED
  if (outcome.resident_mib > options.resident_mib)
    return "took " + std::to_string(outcome.resident_mib) + " MiB of memory";
#endif
  if (outcome.status != 2) return outcome.out.starts_with("{") ? "" : "read, but no JSON was said";
  const auto lines = std::count(outcome.errors.begin(), outcome.errors.end(), '\n');
  if (lines != 1 || !outcome.errors.starts_with("octotomy: "))
    return "refused with " + std::to_string(lines) + " lines instead of one: " + outcome.errors;
  return outcome.out.empty() ? "" : "refused, but said something on standard output";
}

/// Makes the sound files with the program itself, in `folder`.
class Kinds {
 public:
  Kinds(const Options& options, fs::path folder) : options_(options), folder_(std::move(folder)) {
    make({"phantom", "head", "--voxel", "12", "-o", at("head.nrrd")});
    for (const char* name : {"head.nii", "head2.nii", "head.mha", "head.mhd", "head.nhdr"})
      if (std::string(name) != "head2.nii") make({"convert", at("head.nrrd"), "-o", at(name)});
    make({"convert", at("head.nrrd"), "-o", at("dicom"), "--dicom"});
    make({"octree", at("head.nrrd"), "--window", "300:", "-o", at("binary.octree")});
    make({"octree", at("head.nrrd"), "--grey", "-o", at("grey.octree")});
    write_bytes(folder_ / "box.stl", stl_text());
    write_bytes(
        folder_ / "marks.json",
        R"({"landmarks": [{"name": "a", "point_mm": [0, 0, 0]}, {"name": "b", "point_mm": [9, 0, 1]},)"
        R"( {"name": "c", "point_mm": [0, -7, 0]}]})");
    make({"contours", at("head.nrrd"), "--window", "300:", "-o", at("bone.json")});
    for (const char* name : {"head.stl", "head.ply", "head.obj", "head.off", "head.vtp"})
      make({"mesh", at("head.nrrd"), "--window", "300:", "-o", at(name)});
    for (const char* view : {"anterior", "left"})
      make({"render", at("head.nrrd"), "--shading", "mip", "--view", view, "--size", "48x48", "-o",
            at(std::string("slice_") + view + ".png")});
  }

  std::vector<Reader> readers() const {
    const fs::path slice = folder_ / "dicom/slice_0010.dcm";
    const std::vector<std::string> spacing{"--spacing", "1,1,1"};
    std::vector<Reader> all;
    const auto add = [&](const std::string& name, const std::string& file, std::string sound) -> Reader& {
      all.push_back({name, file, std::move(sound), {}, {}, {}, {}});
      return all.back();
    };
    add("dicom", "slice.dcm", bytes_of(slice));
    add("dicom_series", "slice_0010.dcm", bytes_of(slice)).beside = {
        folder_ / "dicom/slice_0009.dcm", folder_ / "dicom/slice_0011.dcm", folder_ / "dicom/slice_0012.dcm"};
    DicomFrames frames;
    add("dicom_frames", "frames.dcm", DicomBytes::file("1.2.840.10008.1.2.1", frames.attributes()));
    frames.open = true;
    add("dicom_open_frames", "frames.dcm", DicomBytes::file("1.2.840.10008.1.2.1", frames.attributes()));
    for (const auto& [name, command] :
         {std::pair{"dicom_jpeg_2000", "gdcmconv --j2k"}, std::pair{"dicom_jpeg_ls", "gdcmconv --jpegls"},
          std::pair{"dicom_jpeg", "gdcmconv --jpeg"}, std::pair{"dicom_rle", "gdcmconv --rle"},
          std::pair{"dicom_deflated", "dcmconv +td"}, std::pair{"dicom_big_endian", "dcmconv +tb"}}) {
      const std::string to = at(std::string(name) + ".dcm");
      if (std::system(
              (std::string(command) + " " + slice.string() + " " + to + " >/dev/null 2>&1").c_str()) == 0)
        add(name, "slice.dcm", bytes_of(to));
      else
        std::printf("%-18s left out: '%s' is not installed\n", name, command);
    }
    add("nifti", "head.nii", bytes_of(at("head.nii")));
    add("nifti_gz", "head.nii.gz", bytes_of(at("head.nii"))).finish = packed;
    add("nifti2", "head.nii", nifti2());
    add("nrrd", "head.nrrd", bytes_of(at("head.nrrd")));
    add("nrrd_header", "head.nhdr", bytes_of(at("head.nhdr"))).beside = {folder_ / "head.raw.gz"};
    add("metaimage", "head.mha", bytes_of(at("head.mha")));
    add("metaimage_header", "head.mhd", bytes_of(at("head.mhd"))).beside = {folder_ / "head.zraw"};
    add("png_stack", "slice_2.png", bytes_of(at("slice_left.png"))).beside = {folder_ / "slice_anterior.png"};
    all.back().arguments = spacing;
    add("tiff_stack", "slice.tif", tiff()).arguments = spacing;
    add("octree", "binary.octree", bytes_of(at("binary.octree"))).finish = resealed_octree;
    add("octree_grey", "grey.octree", bytes_of(at("grey.octree"))).finish = resealed_octree;
    add("raw", "head.raw", std::string(20 * 20 * 20 * 2, '\1')).arguments = {"--raw", "20x20x20", "int16",
                                                                             "--spacing", "1,1,1"};
    for (const char* kind : {"stl", "ply", "obj", "off"})
      add(kind, std::string("head.") + kind, bytes_of(at(std::string("head.") + kind)));
    add("vtk", "head.vtk", vtk());
    add("vtk_binary", "head.vtk", vtk_binary());
    add("vtp", "head.vtp", bytes_of(at("head.vtp")));
    add("vtp_text", "head.vtp", vtp_text());
    add("stl_text", "head.stl", stl_text());
    const auto read_by = [&](const std::string& name, const std::string& file, std::string sound,
                             std::vector<std::string> command) {
      add(name, file, std::move(sound)).command = std::move(command);
    };
    read_by("landmarks", "marks.json",
            R"({"landmarks": [{"name": "a", "point_mm": [0, 0, 0]}, {"name": "b", "point_mm": [9, 0, 1.5]},)"
            R"( {"name": "c", "point_mm": [0, -7e0, 0], "weight": 2.0}]})",
            {"register", at("box.stl"), at("box.stl"), "--landmarks", "MUTANT", at("marks.json"),
             "--landmarks-only", "--json"});
    read_by(
        "region", "region.json",
        R"({"polygons_mm": [[[-40, -60], [40, -60], [40, -25.5], [-4e1, -25]], [[0, 0], [9, 0], [0, 9]]]})",
        {"mask", "--region", "anterior:MUTANT", "--like", at("head.nrrd"), "-o", "OUT.octree", "--json"});
    read_by("slices", "slices.json", bytes_of(at("bone.json")),
            {"mask", "--slices", "MUTANT", "--like", at("head.nrrd"), "-o", "OUT.octree", "--json"});
    read_by("contours", "slices.json", bytes_of(at("bone.json")),
            {"contours", "MUTANT", "--by", "1", "-o", "OUT.json", "--json"});
    read_by("edits", "edits.json",
            R"({"edits": [{"slice": 3, "contour": 0, "do": "remove"}, {"slice": 4, "do": "add",)"
            R"( "points_mm": [[-12.5, 4e1], [9, 40], [0, 55]]}]})",
            {"contours", at("bone.json"), "--edits", "MUTANT", "-o", "OUT.json", "--json"});
    read_by(
        "transfer", "transfer.json",
        R"({"octotomy_transfer": 1, "surface_per_mm": 60, "points": [{"sample": -500, "colour": "#cc7a29",)"
        R"( "per_mm": 0.0}, {"sample": 100.5, "colour": "#ffffff", "per_mm": 1e-1}]})",
        {"render", at("head.nrrd"), "--shading", "composite", "--transfer", "MUTANT", "--size", "16x16", "-o",
         "OUT.png", "--json"});
    read_by(
        "plan", "small.plan.json",
        R"({"octotomy_plan": 1, "name": "small", "scans": {"ct": {"path": "head.nrrd"}},)"
        R"( "universe": {"voxel_mm": 12}, "steps": [{"id": "s", "do": "window", "scan": "ct", "low": 300},)"
        R"( {"id": "m", "do": "move", "object": "s", "translate_mm": [0, -6, 2]},)"
        R"( {"id": "u", "do": "combine", "expression": "s | m"}, {"id": "n", "do": "measure", "object": "u"}]})",
        {"verify", "MUTANT", "--json"});
    all.back().beside = {folder_ / "head.nrrd"};
    read_by("frd", "face.frd", frd(),
            {"warp", at("box.stl"), "--result", "MUTANT", "-o", "OUT.stl", "--json"});
    return all;
  }

 private:
  std::string at(const std::string& name) const { return (folder_ / name).string(); }

  void make(std::vector<std::string> arguments) const {
    arguments.insert(arguments.begin(), options_.program.string());
    Options unlimited = options_;
    unlimited.seconds = 120.0;
    unlimited.address_space_mib = std::size_t{1} << 14;
    const Outcome outcome = run(unlimited, arguments, folder_);
    if (outcome.status != 0)
      throw std::runtime_error("'" + arguments[1] + "' made no sound file: " + outcome.errors);
  }

  /// Numbers of a header, little-endian.
  template <typename Number>
  static void put(std::string& bytes, std::size_t at, Number number) {
    std::copy_n(reinterpret_cast<const char*>(&number), sizeof number,
                bytes.begin() + static_cast<std::ptrdiff_t>(at));
  }

  /// 6 x 5 x 4 samples of int16.
  static std::string nifti2() {
    std::string bytes(544 + 6 * 5 * 4 * 2, '\0');
    put(bytes, 0, std::int32_t{540});
    bytes.replace(4, 8, std::string("n+2\0\r\n\x1a\n", 8));
    put(bytes, 12, std::int16_t{4});
    put(bytes, 14, std::int16_t{16});
    for (std::size_t axis = 0; axis < 8; ++axis)
      put(bytes, 16 + 8 * axis, std::array<std::int64_t, 8>{3, 6, 5, 4, 1, 1, 1, 1}[axis]);
    for (std::size_t axis = 0; axis < 4; ++axis) put(bytes, 104 + 8 * axis, 1.0);
    put(bytes, 168, std::int64_t{544});
    put(bytes, 176, 1.0);
    put(bytes, 344, std::int32_t{1});
    return bytes;
  }

  /// One grey page of 16 x 12 pixels, uncompressed.
  static std::string tiff() {
    std::string bytes = std::string("II*\0", 4) + DicomBytes::number(8, 4);
    const std::array<std::array<std::uint32_t, 3>, 9> entries{{{256, 3, 16},
                                                               {257, 3, 12},
                                                               {258, 3, 16},
                                                               {259, 3, 1},
                                                               {262, 3, 1},
                                                               {273, 4, 8 + 2 + 9 * 12 + 4},
                                                               {277, 3, 1},
                                                               {278, 3, 12},
                                                               {279, 4, 16 * 12 * 2}}};
    bytes += DicomBytes::number(static_cast<std::uint32_t>(entries.size()), 2);
    for (const auto& [tag, type, value] : entries)
      bytes += DicomBytes::number(tag, 2) + DicomBytes::number(type, 2) + DicomBytes::number(1, 4) +
               DicomBytes::number(value, 4);
    bytes += DicomBytes::number(0, 4);
    for (std::uint32_t i = 0; i < 16 * 12; ++i) bytes += DicomBytes::number(1000 + 37 * i % 5000, 2);
    return bytes;
  }

  static std::string vtk() {
    return "# vtk DataFile Version 3.0\ntetrahedron\nASCII\nDATASET POLYDATA\nPOINTS 4 float\n"
           "0 0 0  10 0 0  0 10 0  0 0 10\nPOLYGONS 4 16\n3 0 2 1\n3 0 1 3\n3 1 2 3\n3 0 3 2\n";
  }

  static std::string vtk_binary() {
    std::string bytes = "# vtk DataFile Version 3.0\ntetrahedron\nBINARY\nDATASET POLYDATA\nPOINTS 4 float\n";
    const auto put_big = [&](std::uint32_t word) {
      for (int shift = 24; shift >= 0; shift -= 8) bytes += static_cast<char>(word >> shift & 0xff);
    };
    for (const float coordinate : {0, 0, 0, 10, 0, 0, 0, 10, 0, 0, 0, 10})
      put_big(std::bit_cast<std::uint32_t>(coordinate));
    bytes += "\nPOLYGONS 4 16\n";
    for (const std::uint32_t word : {3, 0, 2, 1, 3, 0, 1, 3, 3, 1, 2, 3, 3, 0, 3, 2}) put_big(word);
    return bytes + "\n";
  }

  static std::string vtp_text() {
    return "<?xml version=\"1.0\"?>\n<VTKFile type=\"PolyData\" version=\"0.1\" "
           "byte_order=\"LittleEndian\">\n"
           "<PolyData><Piece NumberOfPoints=\"4\" NumberOfPolys=\"4\">\n"
           "<Points><DataArray type=\"Float32\" NumberOfComponents=\"3\" format=\"ascii\">"
           "0 0 0 10 0 0 0 10 0 0 0 10</DataArray></Points>\n<Polys>"
           "<DataArray type=\"Int32\" Name=\"connectivity\" format=\"ascii\">0 2 1 0 1 3 1 2 3 0 3 "
           "2</DataArray>"
           "<DataArray type=\"Int32\" Name=\"offsets\" format=\"ascii\">3 6 9 12</DataArray>"
           "</Polys></Piece></PolyData></VTKFile>\n";
  }

  /// A tetrahedron.
  static std::string stl_text() {
    std::string text = "solid tetrahedron\n";
    for (const char* facet :
         {"0 0 0:0 10 0:10 0 0", "0 0 0:10 0 0:0 0 10", "10 0 0:0 10 0:0 0 10", "0 0 0:0 0 10:0 10 0"}) {
      std::string vertices = facet;
      for (std::size_t at = 0; (at = vertices.find(':')) != std::string::npos;)
        vertices.replace(at, 1, "\n vertex ");
      text += "facet normal 0 0 0\n outer loop\n vertex " + vertices + "\n endloop\nendfacet\n";
    }
    return text + "endsolid tetrahedron\n";
  }

  /// CalculiX's result of one tetrahedron about the other one, with its displacements.
  static std::string frd() {
    constexpr const char* nodes =
        " -1         1-1.00000E+00-1.00000E+00-1.00000E+00\n"
        " -1         2 4.00000E+01 0.00000E+00 0.00000E+00\n"
        " -1         3 0.00000E+00 4.00000E+01 0.00000E+00\n"
        " -1         4 0.00000E+00 0.00000E+00 4.00000E+01\n"
        " -3\n";
    return std::string("    1C\n    2C                             4\n") + nodes +
           "    3C                             1\n -1         1    3    0    1\n"
           " -2         1         2         3         4\n -3\n"
           "    1PSTEP                         1           1           1\n"
           "  100CL  101 1.000000000           4                     0    1           1\n"
           " -4  DISP        4    1\n -5  D1          1    2    1    0\n" +
           nodes + " 9999\n";
  }

  const Options& options_;
  fs::path folder_;
};

/// The command line that has a reader read a mutant.
std::vector<std::string> command_of(const Options& options, const Reader& reader, const fs::path& mutant,
                                    const fs::path& folder) {
  std::vector<std::string> arguments{options.program.string()};
  if (reader.command.empty()) arguments.insert(arguments.end(), {"info", "--json", mutant.string()});
  for (std::string word : reader.command) {
    for (const auto& [name, path] :
         {std::pair{"MUTANT", mutant.string()}, std::pair{"OUT", (folder / "out").string()}})
      if (const std::size_t at = word.find(name); at != std::string::npos)
        word.replace(at, std::string(name).size(), path);
    arguments.push_back(word);
  }
  arguments.insert(arguments.end(), reader.arguments.begin(), reader.arguments.end());
  return arguments;
}

struct Tally {
  std::uint64_t read = 0, refused = 0, faults = 0;
  std::size_t most_mib = 0;
  double slowest_s = 0.0;
};

/// One mutant through the program.
void judge(const Options& options, const Reader& reader, std::uint64_t seed, const fs::path& folder,
           Tally& tally, std::mutex& mutex) {
  const auto mutation = static_cast<Mutation>(seed % mutation_count);
  std::string mutant = mutated(reader.sound, mutation, seed / mutation_count);
  // Of a kind that is packed or sealed, every other round of kinds; unpacked it would not be of the kind.
  if (reader.finish && ((seed / mutation_count) % 2 == 0)) mutant = reader.finish(mutant);
  const fs::path place = folder / "mutant";
  fs::create_directories(place);
  for (const fs::path& other : reader.beside)
    if (!fs::exists(place / other.filename())) fs::copy_file(other, place / other.filename());
  write_bytes(place / reader.file, mutant);
  const bool by_folder = reader.name == "dicom_series" || reader.name == "png_stack";
  const std::vector<std::string> arguments =
      command_of(options, reader, by_folder ? place : place / reader.file, folder);
  const auto begin = std::chrono::steady_clock::now();
  const Outcome outcome = run(options, arguments, folder);
  const std::chrono::duration<double> passed = std::chrono::steady_clock::now() - begin;
  const std::string fault = fault_of(outcome, options);
  const std::lock_guard lock(mutex);
  tally.most_mib = std::max(tally.most_mib, outcome.resident_mib);
  tally.slowest_s = std::max(tally.slowest_s, passed.count());
  if (fault.empty()) {
    ++(outcome.status != 2 ? tally.read : tally.refused);
    return;
  }
  ++tally.faults;
  std::printf("FAULT %s, seed %llu (%s): %s\n  mutate_readers --reader %s --seed %llu --count 1\n",
              reader.name.c_str(), static_cast<unsigned long long>(seed), name_of(mutation), fault.c_str(),
              reader.name.c_str(), static_cast<unsigned long long>(seed));
  if (!options.keep.empty()) {
    fs::create_directories(options.keep);
    write_bytes(options.keep / (reader.name + "_" + std::to_string(seed) + "_" + reader.file), mutant);
  }
}

Tally judge_all(const Options& options, const Reader& reader, const fs::path& scratch) {
  Tally tally;
  std::mutex mutex;
  std::atomic<std::uint64_t> next = 0;
  std::vector<std::thread> workers;
  for (unsigned worker = 0; worker < options.workers; ++worker)
    workers.emplace_back([&, folder = scratch / (reader.name + std::to_string(worker))] {
      fs::create_directories(folder);
      for (std::uint64_t i = next++; i < options.count; i = next++)
        judge(options, reader, options.first_seed + i, folder, tally, mutex);
      fs::remove_all(folder);
    });
  for (std::thread& worker : workers) worker.join();
  std::printf("%-18s %6llu read %6llu refused %4llu faults   at most %4zu MiB, %5.2f s\n",
              reader.name.c_str(), static_cast<unsigned long long>(tally.read),
              static_cast<unsigned long long>(tally.refused), static_cast<unsigned long long>(tally.faults),
              tally.most_mib, tally.slowest_s);
  std::fflush(stdout);
  return tally;
}

/// The sound files are read: a harness that only ever sees refusals tests nothing.
void need_sound(const Options& options, const Reader& reader, const fs::path& scratch) {
  const fs::path folder = scratch / "sound";
  fs::create_directories(folder);
  for (const fs::path& other : reader.beside) fs::copy_file(other, folder / other.filename());
  write_bytes(folder / reader.file, reader.name == "nifti_gz" ? packed(reader.sound) : reader.sound);
  const Outcome outcome = run(options, command_of(options, reader, folder / reader.file, scratch), scratch);
  fs::remove_all(folder);
  if (const std::string fault = fault_of(outcome, options); !fault.empty() || outcome.status != 0)
    throw std::runtime_error(reader.name + ": the sound file is not read: " + fault + outcome.errors);
}

int judge_readers(const Options& options) {
  const ScratchFolder scratch;
  fs::create_directories(scratch / "sound_files");
  std::uint64_t faults = 0;
  std::size_t judged = 0;
  for (const Reader& reader : Kinds(options, scratch / "sound_files").readers()) {
    const bool wanted = options.readers.empty() || std::find(options.readers.begin(), options.readers.end(),
                                                             reader.name) != options.readers.end();
    if (!wanted) continue;
    need_sound(options, reader, scratch.path());
    const Tally tally = judge_all(options, reader, scratch.path());
    faults += tally.faults;
    ++judged;
  }
  if (judged == 0) throw std::runtime_error("no reader of that name");
  return faults == 0 ? 0 : 1;
}

}  // namespace

int main(int count, char** arguments) {
  try {
    Options options;
    CLI::App app("Damages sound files for every reader and has octotomy info read each in a limited process.",
                 "mutate_readers");
    app.add_option("--count", options.count, "Mutants a reader")->capture_default_str();
    app.add_option("--seed", options.first_seed, "Number of the first mutant")->capture_default_str();
    app.add_option("--reader", options.readers, "Only these, for example nrrd; default: all");
    app.add_option("--program", options.program, "The octotomy to run")->capture_default_str();
    app.add_option("--keep", options.keep, "A folder for mutants that show a fault");
    app.add_option("--seconds", options.seconds, "Time limit of one process")->capture_default_str();
    app.add_option("--workers", options.workers, "Processes at a time")->capture_default_str();
    app.footer("Example:\n  build/release/mutate_readers --count 2000 --keep faults");
    CLI11_PARSE(app, count, arguments);
    return judge_readers(options);
  } catch (const std::exception& error) {
    std::fprintf(stderr, "mutate_readers: %s\n", error.what());
    return 2;
  }
}
