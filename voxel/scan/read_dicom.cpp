// SPDX-License-Identifier: AGPL-3.0-or-later
//
// A stack of slices to a lattice:
//   1  lay a lattice through the slices (slice_plan.h)
//   2  decode the slices, rescaled
//   3  interpolate linearly if slices leave the lattice: gantry tilt, uneven or missing slices
//   4  judge by the air if the values are Hounsfield
// Geometry comes from ImagePositionPatient and ImageOrientationPatient. The scanner's tags for tilt and
// spacing are only compared with them, because vendors disagree on the sign of the tilt and on the meaning of
// the spacing.
#include "voxel/scan/read_dicom.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>
#include <span>
#include <tbb/parallel_for.h>
#include <tuple>

#include "voxel/scan/air_level.h"
#include "voxel/scan/audit.h"
#include "voxel/scan/dicom_series.h"
#include "voxel/scan/slice_plan.h"
#include "voxel/scan/upright.h"
#include "voxel/space/file_text.h"
#include "voxel/space/memory_need.h"

namespace octotomy::voxel {

namespace {

namespace fs = std::filesystem;
using Stack = DicomStack;

using Plan = SlicePlan;

class SeriesReader {
 public:
  SeriesReader(fs::path path, const ReadOptions& options) : path_(std::move(path)), options_(options) {}

  Scene run() {
    options_.progress.at(0.0);
    const Stack stack = stack_of_series(path_, options_, scene_.audit);
    options_.progress.at(0.1);
    const Plan plan = slice_plan(stack, path_, scene_.audit);
    scene_.holes = plan.holes;
    if (!decode_as<std::int16_t>(stack)) decode_as<float>(stack);
    options_.progress.at(0.8);
    audit_rescale(stack);
    audit_padding(stack);
    audit_contents(stack);
    if (!plan.is_copy()) {
      std::vector<glm::dvec2> aside_px(stack.slices.size(), glm::dvec2(0.0));
      if (plan.leans)
        for (std::size_t i = 0; i < aside_px.size(); ++i) aside_px[i] = stack.aside_px(stack.slices[i]);
      need_memory(
          path_, std::uint64_t(plan.size_px.x) * std::uint64_t(plan.size_px.y) * plan.slice_count,
          std::holds_alternative<FloatSamples>(scene_.samples) ? sizeof(float) : sizeof(std::int16_t));
      scene_.samples = upright_samples(plan, stack.first().size_px, aside_px, scene_.samples);
    }
    scene_.lattice = lattice_of(stack, plan);
    scene_.modality = stack.first().modality;
    scene_.identity = stack.first().identity;
    audit_steps();
    if (scene_.modality == "CT") {
      AirLevel air = air_level_of_ct(scene_);
      // The header declares the unit as unspecified, and no air contradicts it: not Hounsfield.
      if (stack.first().rescale_type == "US" && air.meaning == Meaning::Hounsfield &&
          air.finding.verdict != Verdict::Pass)
        air.meaning = Meaning::Raw;
      scene_.meaning = air.meaning;
      scene_.audit.push_back(air.finding);
    }
    scene_.source = path_.string();
    if (!stack.first().series_description.empty()) scene_.source += ": " + stack.first().series_description;
    return std::move(scene_);
  }

 private:
  void find(const char* check, Verdict verdict, std::string detail, std::vector<std::string> files = {}) {
    scene_.audit.push_back({check, verdict, std::move(detail), std::move(files)});
  }

  template <typename Sample>
  bool decode_as(const Stack& stack) {
    const glm::ivec2 size_px = stack.first().size_px;
    const std::size_t area = static_cast<std::size_t>(size_px.x) * static_cast<std::size_t>(size_px.y);
    need_memory(path_, area * stack.slices.size(), sizeof(Sample));
    Samples<Sample> samples(area * stack.slices.size());
    std::vector<char> fits(stack.slices.size(), 0);
    for_each_index(stack.slices.size(), options_.progress, [&](std::size_t i) {
      fits[i] = read_dicom_samples(stack.slices[i], std::span<Sample>(samples).subspan(i * area, area));
    });
    const bool all_fit = std::all_of(fits.begin(), fits.end(), [](char fit) { return fit != 0; });
    if (all_fit) scene_.samples = std::move(samples);
    return all_fit;
  }

  void audit_rescale(const Stack& stack) {
    const DicomSlice& first = stack.first();
    const bool is_ct = first.modality == "CT";
    const auto named_if = [&](const auto& holds) {
      std::vector<std::string> names;
      for (const DicomSlice& slice : stack.slices)
        if (holds(slice)) names.push_back(slice.name);
      return names;
    };
    const auto flat = named_if([](const DicomSlice& slice) { return slice.slope == 0.0; });
    if (!flat.empty())
      return find("rescale", Verdict::Fail,
                  "RescaleSlope is 0 in " + slices(flat.size()) +
                      ", which leaves one value: a slope of 1 is assumed: " + listed(flat),
                  flat);
    const auto falling = named_if([](const DicomSlice& slice) { return slice.slope.value_or(1.0) < 0.0; });
    if (!falling.empty())
      return find("rescale", Verdict::Fail,
                  "RescaleSlope is below 0 in " + slices(falling.size()) +
                      ": bright and dark are exchanged there: " + listed(falling),
                  falling);
    std::map<std::tuple<double, double, std::string>, std::vector<std::string>> kinds;
    for (const DicomSlice& slice : stack.slices)
      kinds[{slice.slope.value_or(1.0), slice.intercept.value_or(0.0), slice.rescale_type}].push_back(
          slice.name);
    const auto commonest = std::max_element(kinds.begin(), kinds.end(), [](const auto& a, const auto& b) {
      return a.second.size() < b.second.size();
    });
    std::vector<std::string> differing;
    for (const auto& [kind, names] : kinds)
      if (kind != commonest->first) differing.insert(differing.end(), names.begin(), names.end());
    const auto half = named_if(
        [&](const DicomSlice& slice) { return slice.slope.has_value() != slice.intercept.has_value(); });
    if (!differing.empty())
      find("rescale", Verdict::Warn,
           "slope, intercept or unit change between slices (" + std::to_string(differing.size()) +
               " differ from the others); each slice's own are applied: " + listed(differing),
           differing);
    else if (!first.slope && !first.intercept)
      find("rescale", is_ct ? Verdict::Warn : Verdict::Pass,
           is_ct ? "RescaleSlope and RescaleIntercept are absent; stored values are not rescaled"
                 : "none in the header; stored values are not rescaled");
    else if (is_ct && !first.rescale_type.empty() && first.rescale_type != "HU")
      find("rescale", Verdict::Warn,
           print("slope %g, intercept %g applied; their unit is declared '%s', not HU",
                 first.slope.value_or(1.0), first.intercept.value_or(0.0), first.rescale_type.c_str()));
    else if (is_ct && !half.empty())
      find("rescale", Verdict::Warn,
           "RescaleSlope or RescaleIntercept is absent; a slope of 1 or an intercept of 0 is assumed: " +
               listed(half),
           half);
    else
      find("rescale", Verdict::Pass,
           print("slope %g, intercept %g applied", first.slope.value_or(1.0), first.intercept.value_or(0.0)));
  }

  /// Takes the marks off blank slices at the stack's ends that hold the least sample of the slice beside
  /// them: air beyond the head.
  template <typename Samples>
  static void pass_over_air(const Samples& samples, std::size_t area, std::vector<char>& blank,
                            std::vector<char>& repeated) {
    const auto pass = [&](std::size_t first, std::size_t count, std::size_t beside) {
      const auto slice = samples.begin() + static_cast<std::ptrdiff_t>(beside * area);
      const auto least = *std::min_element(slice, slice + static_cast<std::ptrdiff_t>(area));
      for (std::size_t i = first; i < first + count; ++i)
        if (samples[i * area] == least) blank[i] = repeated[i] = 0;
    };
    const auto is_blank = [](char mark) { return mark != 0; };
    const auto low =
        static_cast<std::size_t>(std::find_if_not(blank.begin(), blank.end(), is_blank) - blank.begin());
    const auto high =
        static_cast<std::size_t>(std::find_if_not(blank.rbegin(), blank.rend(), is_blank) - blank.rbegin());
    if (low == blank.size()) return;
    pass(0, low, low);
    pass(blank.size() - high, high, blank.size() - high - 1);
  }

  /// Slices without any contrast, and slices that repeat the one below pixel by pixel.
  void audit_contents(const Stack& stack) {
    const std::size_t area =
        static_cast<std::size_t>(stack.first().size_px.x) * static_cast<std::size_t>(stack.first().size_px.y);
    std::vector<char> blank(stack.slices.size(), 0), repeated(stack.slices.size(), 0);
    std::visit(
        [&](const auto& samples) {
          tbb::parallel_for(std::size_t{0}, stack.slices.size(), [&](std::size_t i) {
            const auto slice = samples.begin() + static_cast<std::ptrdiff_t>(i * area);
            const auto end = slice + static_cast<std::ptrdiff_t>(area);
            blank[i] = std::all_of(slice, end, [&](auto sample) { return sample == *slice; });
            repeated[i] = i > 0 && std::equal(slice, end, slice - static_cast<std::ptrdiff_t>(area));
          });
          pass_over_air(samples, area, blank, repeated);
        },
        scene_.samples);
    std::vector<std::string> blanks, repeats;
    for (std::size_t i = 0; i < stack.slices.size(); ++i) {
      if (blank[i] != 0) blanks.push_back(stack.slices[i].name);
      if (blank[i] == 0 && repeated[i] != 0) repeats.push_back(stack.slices[i].name);
    }
    if (!blanks.empty() && blanks.size() < stack.slices.size())
      find("blank_slices", Verdict::Warn, slices(blanks.size()) + " hold one value only: " + listed(blanks),
           blanks);
    if (!repeats.empty())
      find("repeated_slices", Verdict::Warn,
           slices(repeats.size()) +
               " repeat the pixels of the slice below at another place: " + listed(repeats),
           repeats);
  }

  /// The greatest common divisor of all differences of samples. Coarser steps than a unit come from 8-bit
  /// storage or from lossy processing.
  void audit_steps() {
    const auto* samples = std::get_if<Int16Samples>(&scene_.samples);
    if (samples == nullptr || scene_.modality != "CT") return;
    int step = 0;
    for (const std::int16_t sample : *samples)
      if ((step = std::gcd(step, sample - samples->front())) == 1) break;
    // Scanners measure to about a unit; four units are below the noise of any head protocol.
    if (step > 4)
      find("sample_steps", Verdict::Warn,
           print("samples come in steps of %d: finer differences were lost before this file was written",
                 step));
  }

  /// Pixels beyond the scanner's field of view hold a padding value, which is no measurement.
  void audit_padding(const Stack& stack) {
    const std::optional<double> padding = stack.first().padding;
    if (!padding) return find("padding", Verdict::Pass, "the header names no padding value");
    const auto count = std::visit(
        [&](const auto& samples) {
          return std::count_if(samples.begin(), samples.end(),
                               [&](auto sample) { return static_cast<double>(sample) == *padding; });
        },
        scene_.samples);
    if (count == 0)
      find("padding", Verdict::Pass, print("no sample has the padding value %g", *padding));
    else
      find("padding", Verdict::Warn,
           print("%td samples have the padding value %g, which is no measurement; they are kept: choose "
                 "windows without that value",
                 count, *padding));
  }

  fs::path path_;
  const ReadOptions& options_;
  Scene scene_;
};

}  // namespace

Scene read_dicom(const fs::path& path, const ReadOptions& options) {
  return SeriesReader(path, options).run();
}

}  // namespace octotomy::voxel
