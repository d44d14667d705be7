// SPDX-License-Identifier: AGPL-3.0-or-later
#include "planner/cli/verb/scan_in.h"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cstdio>

#include "planner/cli/verb/numbers.h"
#include "planner/operation/file/path_checks.h"
#include "planner/operation/table/same_patient.h"
#include "voxel/space/error.h"

namespace octotomy::planner::cli {
namespace {

glm::dvec3 spacing_of(const std::string& text) {
  const auto mm = parse_numbers<3>(text);
  if (!mm || !std::all_of(mm->begin(), mm->end(), [](double length) { return length > 0.0; }))
    throw CLI::ValidationError("--spacing",
                               "'" + text + "' is not a spacing: give X,Y,Z in mm, for example 0.5,0.5,1");
  return {(*mm)[0], (*mm)[1], (*mm)[2]};
}

std::vector<voxel::SliceRange> slices_of(const std::string& text) {
  try {
    return voxel::parse_slices(text);
  } catch (const voxel::InvalidInput& error) {
    throw CLI::ValidationError("--slices", error.what());
  }
}

/// Parses the text of an option. None if it is empty. Throws CLI::ValidationError if it is invalid.
template <typename Value>
std::optional<Value> parsed(const char* option, const std::string& text, Value (*parse)(const std::string&)) {
  if (text.empty()) return std::nullopt;
  try {
    return parse(text);
  } catch (const voxel::InvalidInput& error) {
    throw CLI::ValidationError(option, error.what());
  }
}

voxel::RawLayout layout_of(const ScanIn& in) {
  voxel::RawLayout layout;
  char rest = 0;
  if (std::sscanf(in.raw[0].c_str(), "%dx%dx%d%c", &layout.dims.x, &layout.dims.y, &layout.dims.z, &rest) !=
          3 ||
      layout.dims.x < 1 || layout.dims.y < 1 || layout.dims.z < 1)
    throw CLI::ValidationError("--raw",
                               "'" + in.raw[0] + "' are not dims: give XxYxZ, for example 512x512x300");
  const std::optional<voxel::SampleType> type = voxel::sample_type(in.raw[1]);
  if (!type)
    throw CLI::ValidationError("--raw", "'" + in.raw[1] +
                                            "' is not a type of samples: int8, uint8, int16, uint16, int32, "
                                            "uint32, int64, uint64, float or double");
  layout.type = *type;
  layout.big_endian = in.big_endian;
  layout.offset = in.offset;
  return layout;
}

}  // namespace

void add_scan_options(CLI::App& verb, ScanIn& in, const std::string& heading) {
  verb.add_option("--series", in.series,
                  "Series of a folder with several DICOM series: its number in octotomy info (2, or 2.1 for "
                  "one of several stacks), its UID, or a part of its description or kernel")
      ->group(heading);
  verb.add_flag("--join", in.join,
                "Join all DICOM series of the folder, of one patient and modality: for an export in which "
                "each image states another series, study or frame of reference. The audit then has a FAIL")
      ->group(heading);
  verb.add_option("--slices", in.slices,
                  "FROM:TO of the DICOM series' images to keep, 1 the lowest along their normal, for example "
                  "1:40 or 1:40,45:60")
      ->group(heading);
  verb.add_option(
          "--frame", in.frame,
          "RAS, LPS, LAS, ...: the patient's directions along the axes of a volume file's coordinates, "
          "overriding its own statement; also for images and raw files. Not for DICOM, which states its own")
      ->group(heading);
  verb.add_option("--unit", in.unit,
                  "mm, cm, m, um or inch: the unit of a volume file's lengths, overriding its own statement")
      ->group(heading);
  verb.add_option("--spacing", in.spacing, "X,Y,Z in mm, for raw files and for images that do not state it")
      ->group(heading);
  verb.add_option("--raw", in.raw, "XxYxZ TYPE: the file is raw samples, for example 512x512x300 int16")
      ->expected(2)
      ->group(heading);
  verb.add_flag("--big-endian", in.big_endian, "Raw samples have their high bytes first")->group(heading);
  verb.add_option("--offset", in.offset, "Bytes before the first raw sample")->group(heading);
}

void need_options_fit(const CLI::App& verb, const std::vector<std::string>& files) {
  if (files.empty()) return;
  const bool are_octrees = std::all_of(files.begin(), files.end(), is_octree);
  if (!std::all_of(files.begin(), files.end(),
                   [](const std::string& file) { return is_octree(file) || is_mesh(file); }))
    return;
  const auto refuse_given = [&](const char* name, const char* of) {
    const CLI::Option* option = verb.get_option_no_throw(name);
    if (option == nullptr || option->count() == 0) return;
    throw std::runtime_error(files.front() + ": is " + (is_octree(files.front()) ? "an octree" : "a mesh") +
                             ", and " + name + " applies to " + of + ": leave it out");
  };
  for (const char* name :
       {"--series", "--join", "--slices", "--spacing", "--raw", "--big-endian", "--offset"})
    refuse_given(name, "scans");
  if (!are_octrees) return;
  for (const char* name : {"--frame", "--unit"}) refuse_given(name, "scans and meshes");
}

CLI::Validator scan_path() {
  return {[](std::string& text) {
            const bool pattern =
                std::filesystem::path(text).filename().string().find_first_of("*?") != std::string::npos;
            return pattern || std::filesystem::exists(text) ? std::string() : "Path does not exist: " + text;
          },
          "SCAN"};
}

voxel::ReadOptions read_options(const Program& program, const ScanIn& in) {
  voxel::ReadOptions options;
  options.series = in.series;
  options.join = in.join;
  if (!in.slices.empty()) options.slices = slices_of(in.slices);
  if (!in.spacing.empty()) options.spacing_mm = spacing_of(in.spacing);
  options.frame = parsed("--frame", in.frame, voxel::parse_frame);
  options.unit = parsed("--unit", in.unit, voxel::parse_unit);
  if (!in.raw.empty()) options.raw = layout_of(in);
  if (in.raw.empty() && (in.big_endian || in.offset != 0))
    throw CLI::ValidationError("--offset", "--offset and --big-endian apply to raw files: also give --raw");
  options.progress.stop = program.stop.get_token();
  options.progress.report = program.progress("reading");
  return options;
}

bool is_dicom(const voxel::Scene& scene) {
  return is_of_series(scene.audit);
}

voxel::Scene read_scan(const Program& program, const std::filesystem::path& path, const ScanIn& in,
                       Timings& timings, const voxel::SlicesFinal& slices_final) {
  const Stopwatch watch(timings, "read");
  voxel::ReadOptions options = read_options(program, in);
  options.slices_final = slices_final;
  voxel::Scene scene = voxel::read_scene(path, options);
  program.note_scan(path, scene);
  return scene;
}

}  // namespace octotomy::planner::cli
