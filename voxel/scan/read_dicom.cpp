// SPDX-License-Identifier: AGPL-3.0-or-later
//
// Turns a stack of slices into a lattice:
//   1 lay a lattice through the slices (slice_plan.h)
//   2 decode the slices, rescaled
//   3 interpolate linearly if slices leave the lattice: gantry tilt, uneven or missing slices
//   4 decide from the air whether values are Hounsfield units
// Geometry comes from ImagePositionPatient and ImageOrientationPatient. The scanner's tags for tilt and spacing
// are only compared with them, because vendors disagree on the sign of the tilt and on the meaning of the
// spacing.
#include "voxel/scan/read_dicom.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <numeric>
#include <span>
#include <tbb/parallel_for.h>
#include <tuple>
#include <type_traits>

#include "voxel/dicom/dicom_pixels.h"
#include "voxel/scan/air_level.h"
#include "voxel/scan/dicom_series.h"
#include "voxel/scan/neighbour_audit.h"
#include "voxel/scan/slice_plan.h"
#include "voxel/scan/tilt_correction.h"
#include "voxel/space/file_text.h"
#include "voxel/space/memory_need.h"
#include "voxel/space/printed.h"

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
    Stack stack = stack_of_series(path_, options_, scene_.audit);
    options_.progress.at(0.1);
    const Plan plan = slice_plan(stack, path_, scene_.audit);
    scene_.holes = plan.holes;
    const bool is_padded = std::any_of(stack.slices.begin(), stack.slices.end(),
                                       [](const DicomSlice& slice) { return slice.padding.has_value(); });
    if (is_padded) scene_.padding = std::numeric_limits<std::int16_t>::min();
    if (!decode_as<std::int16_t>(stack)) {
      if (is_padded) scene_.padding = far_below(stack);
      decode_as<float>(stack);
    }
    options_.progress.at(0.8);
    if (!stack.first().assumed_modality.empty())
      find("modality_class", Verdict::Warn,
           "Modality is " + stack.first().assumed_modality +
               ", but the images are stored as CT images: CT is assumed");
    audit_rescale(stack);
    std::visit([&](auto& samples) { take_padding(stack, samples); }, scene_.samples);
    audit_contents(stack);
    if (!plan.is_copy()) {
      need_room(path_, std::uint64_t(plan.size_px.x) * std::uint64_t(plan.size_px.y) * plan.slice_count,
                std::holds_alternative<FloatSamples>(scene_.samples) ? sizeof(float) : sizeof(std::int16_t));
      scene_.samples = tilt_corrected_samples(plan, stack.first().size_px, scene_.samples, scene_.padding);
    }
    scene_.lattice = lattice_of(stack, plan);
    scene_.modality = stack.first().modality;
    scene_.identity = stack.first().identity;
    scene_.identity.series_uid = stack.first().series_uid;
    scene_.declared_unit = stack.first().lut ? stack.first().lut->type : stack.first().rescale_type;
    audit_steps();
    if (scene_.modality == "CT") {
      AirLevel air = air_level_of_ct(scene_);
      // Not Hounsfield units if the header declares another unit, or if it leaves the unit unspecified (US)
      // and the air does not confirm Hounsfield units.
      const std::string& unit = stack.first().rescale_type;
      const bool is_other = !unit.empty() && unit != "HU" && unit != "HU_MOD" && unit != "US";
      if (is_other ||
          (unit == "US" && air.meaning == Meaning::Hounsfield && air.finding.verdict != Verdict::Pass))
        air.meaning = Meaning::Raw;
      scene_.meaning = air.meaning;
      scene_.audit.push_back(air.finding);
      if (auto sign = lost_sign_finding(scene_, true)) scene_.audit.push_back(std::move(*sign));
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
    need_room(path_, area * stack.slices.size(), sizeof(Sample));
    Samples<Sample> samples(area * stack.slices.size());
    std::optional<Sample> mark;
    if (scene_.padding) mark = static_cast<Sample>(*scene_.padding);
    std::vector<DecodedSlice> decoded(stack.slices.size());
    for_each_index(stack.slices.size(), options_.progress, [&](std::size_t i) {
      decoded[i] =
          read_dicom_samples(stack.slices[i], std::span<Sample>(samples).subspan(i * area, area), mark);
    });
    const bool all_fit =
        std::all_of(decoded.begin(), decoded.end(), [](const DecodedSlice& slice) { return slice.fits; });
    if (!all_fit && std::is_same_v<Sample, std::int16_t>) return false;
    scene_.samples = std::move(samples);
    audit_stored_bits(stack, decoded);
    return true;
  }

  /// The padding's value for samples in single precision: minus sixteen times the largest value that any
  /// slice can contain.
  static double far_below(const Stack& stack) {
    double largest = 65535.0;
    for (const DicomSlice& slice : stack.slices)
      largest = std::max(largest, std::abs(slice.slope.value_or(1.0)) *
                                          std::ldexp(1.0, static_cast<int>(slice.pixels.stored)) +
                                      std::abs(slice.intercept.value_or(0.0)));
    const double least = -static_cast<double>(std::numeric_limits<float>::max());
    return static_cast<double>(static_cast<float>(std::max(-16.0 * largest, least)));
  }

  /// Reports pixels with bits outside BitsStored: an overlay if the header states one, else values that may
  /// have been cut off.
  void audit_stored_bits(const Stack& stack, const std::vector<DecodedSlice>& decoded) {
    std::vector<std::string> names;
    std::size_t count = 0;
    unsigned stored = 0;
    for (std::size_t i = 0; i < decoded.size(); ++i) {
      if (decoded[i].foreign_count == 0 || stack.slices[i].pixels.holds_overlay) continue;
      names.push_back(stack.slices[i].name);
      count += decoded[i].foreign_count;
      stored = stack.slices[i].pixels.stored;
    }
    if (!names.empty())
      find("stored_bits", Verdict::Fail,
           std::to_string(count) + " pixels of " + slices(names.size()) +
               print(" have bits beyond the %u that BitsStored counts. They were cut off: if they belong to "
                     "the values, these values are wrong; correct BitsStored and HighBit: ",
                     stored) +
               listed(names),
           names);
  }

  /// Whether slices have a Modality LUT, which is applied instead of slope and intercept.
  bool audit_lut(const Stack& stack) {
    std::vector<std::string> without;
    const ModalityLut* lut = nullptr;
    for (const DicomSlice& slice : stack.slices)
      if (!slice.lut)
        without.push_back(slice.name);
      else if (lut == nullptr)
        lut = slice.lut.get();
    if (lut == nullptr) return false;
    const std::string applied =
        print("a Modality LUT of %zu entries from stored %g on is applied", lut->values.size(), lut->first) +
        (lut->type.empty() ? "" : ", its unit declared '" + lut->type + "'") +
        (stack.first().slope ? "; RescaleSlope and RescaleIntercept are not" : "");
    if (without.empty())
      find("rescale", Verdict::Pass, applied);
    else
      find("rescale", Verdict::Warn,
           applied + " where it exists; " + slices(without.size()) + " have none: " + listed(without),
           without);
    return true;
  }

  void audit_rescale(const Stack& stack) {
    const DicomSlice& first = stack.first();
    const bool is_ct = first.modality == "CT";
    if (audit_lut(stack)) return;
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
    std::vector<std::string> half_differing;
    for (const std::string& name : half)
      if (std::find(differing.begin(), differing.end(), name) != differing.end())
        half_differing.push_back(name);
    const auto without = named_if([](const DicomSlice& slice) { return !slice.slope && !slice.intercept; });
    if (!without.empty() && without.size() < stack.slices.size())
      find("rescale", Verdict::Fail,
           "RescaleSlope and RescaleIntercept are absent in " + slices(without.size()) +
               ", whose values are not rescaled as those of the others are: " + listed(without),
           without);
    else if (!half_differing.empty())
      find("rescale", Verdict::Fail,
           "RescaleSlope or RescaleIntercept is absent in " + slices(half_differing.size()) +
               ", where 1 or 0 is assumed; the other slices state other values: " + listed(half_differing),
           half_differing);
    else if (!differing.empty())
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
           print("slope %g, intercept %g applied", first.slope.value_or(1.0), first.intercept.value_or(0.0)) +
               (is_ct || first.rescale_type.empty()
                    ? ""
                    : "; their unit is declared '" + first.rescale_type + "'"));
  }

  /// Unmarks blank slices at the stack's ends whose value is the lowest sample of the neighbouring slice:
  /// they show air beyond the head.
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

  /// Reports slices without any contrast, and slices that repeat the one below pixel by pixel.
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
    std::vector<std::string> names;
    for (const DicomSlice& slice : stack.slices) names.push_back(slice.name);
    audit_neighbours(scene_.samples, stack.first().size_px, names, range_of_slices().low, scene_.audit);
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

  /// Warns if the measured samples of a CT (int16) come in steps above 4 HU. The step is the greatest common
  /// divisor of all their differences. A large step means that samples were stored with fewer bits or
  /// processed with losses.
  void audit_steps() {
    const auto* samples = std::get_if<Int16Samples>(&scene_.samples);
    if (samples == nullptr || scene_.modality != "CT") return;
    const auto measured = std::find_if_not(samples->begin(), samples->end(),
                                           [&](std::int16_t sample) { return is_padding(sample); });
    if (measured == samples->end()) return;
    const std::int16_t origin = *measured;
    int step = 0;
    for (const std::int16_t sample : *samples)
      if ((step = std::gcd(step, is_padding(sample) ? 0 : sample - origin)) == 1) break;
    // CT scanners resolve about 1 HU; steps of 4 HU are below the noise of any head protocol.
    if (step > 4)
      find("sample_steps", Verdict::Warn,
           print("samples come in steps of %d: finer differences were lost before this file was written",
                 step));
  }

  bool is_padding(double sample) const { return scene_.padding && sample == *scene_.padding; }

  /// The range of the measured samples on the stack's slices.
  Range range_of_slices() const {
    Range found{std::numeric_limits<double>::infinity(), -std::numeric_limits<double>::infinity()};
    std::visit(
        [&](const auto& samples) {
          for (const auto sample : samples) {
            const auto value = static_cast<double>(sample);
            if (is_padding(value)) continue;
            found.low = std::min(found.low, value);
            found.high = std::max(found.high, value);
          }
        },
        scene_.samples);
    return found;
  }

  /// The range of a slice's padding after the slice's rescale.
  static Range read_as(const DicomPadding& padding, const DicomSlice& slice) {
    const double slope = slice.slope.value_or(1.0) == 0.0 ? 1.0 : slice.slope.value_or(1.0);
    const double a = slope * padding.low + slice.intercept.value_or(0.0),
                 b = slope * padding.high + slice.intercept.value_or(0.0);
    return {std::min(a, b), std::max(a, b)};
  }

  /// The range of the padding that headers state, after rescale, over all slices without a LUT.
  static std::optional<Range> padding_values(const Stack& stack) {
    std::optional<Range> values;
    for (const DicomSlice& slice : stack.slices) {
      if (!slice.padding) continue;
      if (slice.lut) return std::nullopt;
      const Range own = read_as(*slice.padding, slice);
      if (!values) values = own;
      values->low = std::min(values->low, own.low);
      values->high = std::max(values->high, own.high);
    }
    return values;
  }

  /// Whether the slices state different paddings.
  static bool is_padding_mixed(const Stack& stack) {
    const std::optional<DicomPadding> usual = usual_padding(stack);
    return usual && std::any_of(stack.slices.begin(), stack.slices.end(), [&](const DicomSlice& slice) {
             return slice.padding && (slice.padding->low != usual->low || slice.padding->high != usual->high);
           });
  }

  /// Whether most padded samples have measured samples on at least two sides. Real padding fills areas
  /// instead.
  template <typename Samples>
  bool is_scattered(const Samples& samples, const glm::ivec2& size_px) const {
    const std::size_t width = static_cast<std::size_t>(size_px.x),
                      area = width * static_cast<std::size_t>(size_px.y);
    std::size_t padded = 0, lonely = 0;
    for (std::size_t i = 0; i < samples.size(); ++i) {
      if (!is_padding(static_cast<double>(samples[i]))) continue;
      const std::size_t x = i % width, place = i % area;
      const auto is_measured = [&](bool is_inside, std::size_t at) {
        return is_inside && !is_padding(static_cast<double>(samples[at]));
      };
      const int measured = is_measured(x > 0, i - 1) + is_measured(x + 1 < width, i + 1) +
                           is_measured(place >= width, i - width) +
                           is_measured(place + width < area, i + width);
      ++padded;
      lonely += measured >= 2;
    }
    return 2 * lonely > padded;
  }

  /// The commonest stated padding; none if no slice states one.
  static std::optional<DicomPadding> usual_padding(const Stack& stack) {
    std::map<std::pair<double, double>, std::size_t> counts;
    for (const DicomSlice& slice : stack.slices)
      if (slice.padding) ++counts[{slice.padding->low, slice.padding->high}];
    const auto most = std::max_element(counts.begin(), counts.end(),
                                       [](const auto& a, const auto& b) { return a.second < b.second; });
    if (most == counts.end()) return std::nullopt;
    return DicomPadding{most->first.first, most->first.second};
  }

  /// Marks the samples of an image that lie within `values` and are connected to the image's rim by such
  /// samples. Returns their number.
  template <typename Sample>
  static std::size_t mark_from_rim(std::span<Sample> image, int width, const Range& values, Sample mark) {
    const auto columns = static_cast<std::size_t>(width), rows = image.size() / columns;
    std::vector<std::size_t> reached;
    std::size_t count = 0;
    const auto reach = [&](std::size_t at) {
      const auto value = static_cast<double>(image[at]);
      if (value < values.low || value > values.high || image[at] == mark) return;
      image[at] = mark;
      ++count;
      reached.push_back(at);
    };
    for (std::size_t x = 0; x < columns; ++x) {
      reach(x);
      reach((rows - 1) * columns + x);
    }
    for (std::size_t y = 0; y < rows; ++y) {
      reach(y * columns);
      reach(y * columns + columns - 1);
    }
    while (!reached.empty()) {
      const std::size_t at = reached.back(), x = at % columns, y = at / columns;
      reached.pop_back();
      if (x > 0) reach(at - 1);
      if (x + 1 < columns) reach(at + 1);
      if (y > 0) reach(at - columns);
      if (y + 1 < rows) reach(at + columns);
    }
    return count;
  }

  /// Handles slices without PixelPaddingValue in a series whose other slices state one. Samples with the
  /// others' usual padding value that are connected to the rim are assumed to be padding. Elsewhere the same
  /// value may be a measurement.
  template <typename Samples>
  void assume_padding(Stack& stack, Samples& samples) {
    using Sample = typename Samples::value_type;
    const std::optional<DicomPadding> usual = usual_padding(stack);
    if (!usual) return;
    const std::size_t area = samples.size() / stack.slices.size();
    std::vector<std::string> names;
    std::size_t count = 0, without = 0;
    for (std::size_t i = 0; i < stack.slices.size(); ++i) {
      DicomSlice& slice = stack.slices[i];
      if (slice.padding) continue;
      ++without;
      if (slice.lut) continue;
      const std::size_t marked =
          mark_from_rim(std::span<Sample>(samples).subspan(i * area, area), slice.size_px.x,
                        read_as(*usual, slice), static_cast<Sample>(*scene_.padding));
      if (marked == 0) continue;
      slice.padding = usual;
      count += marked;
      names.push_back(slice.name);
    }
    if (names.empty()) return;
    find("unstated_padding", Verdict::Warn,
         slices(without) +
             print(" state no PixelPaddingValue, as %zu of the series do (stored %g",
                   stack.slices.size() - without, usual->low) +
             (usual->high > usual->low ? print(" to %g", usual->high) : "") +
             print("): %zu samples of that value in ", count) + slices(names.size()) +
             ", all at the rims of their images, are assumed to be padding, too; if they are measurements, "
             "remove PixelPaddingValue from the other slices: " +
             listed(names),
         names);
  }

  void take_other_padding(const Stack& stack, std::string without) {
    if (stack.first().modality == "CT") take_unstated_padding(scene_);
    if (!scene_.padding) find("padding", Verdict::Pass, std::move(without));
  }

  /// Pixels beyond the scanner's field of view have a padding value, which is no measurement. All these
  /// pixels get one value below all measured samples: the header's padding if it is below them, else the
  /// value to which such pixels were decoded.
  template <typename Samples>
  void take_padding(Stack& stack, Samples& samples) {
    using Sample = typename Samples::value_type;
    if (!scene_.padding) return take_other_padding(stack, "the header names no padding value");
    assume_padding(stack, samples);
    const std::optional<Range> values = padding_values(stack);
    const std::string named = !values ? std::string("by a table")
                              : values->low == values->high
                                  ? print("value %g", values->low)
                                  : print("values %g to %g", values->low, values->high) +
                                        (is_padding_mixed(stack) ? ", each slice's own," : "");
    const auto mark = static_cast<Sample>(*scene_.padding);
    const auto count = std::count(samples.begin(), samples.end(), mark);
    if (count == 0) {
      scene_.padding.reset();
      return take_other_padding(stack, "no sample has the padding " + named);
    }
    const Range measured = range_of_slices();
    const double least_step = std::abs(stack.first().slope.value_or(1.0));
    if (values && values->low == values->high && values->low < measured.high + 1.5 * least_step &&
        values->low > measured.low - 1.5 * least_step && is_scattered(samples, stack.first().size_px)) {
      std::replace(samples.begin(), samples.end(), mark, static_cast<Sample>(values->low));
      scene_.padding.reset();
      return find(
          "padding", Verdict::Warn,
          print("%td samples have the padding value %g, but lie scattered among measured ones of like "
                "value: they are taken as measurements",
                count, values->low));
    }
    if (values && values->low < measured.low &&
        values->low >= static_cast<double>(std::numeric_limits<Sample>::lowest()) &&
        static_cast<double>(static_cast<Sample>(values->low)) == values->low) {
      scene_.padding = values->low;
      std::replace(samples.begin(), samples.end(), mark, static_cast<Sample>(values->low));
    }
    const double percent = 100.0 * static_cast<double>(count) / static_cast<double>(samples.size());
    find("padding", Verdict::Warn,
         print("%td samples (%.3g %%) hold the padding ", count, percent) + named +
             (values && *scene_.padding != values->low ? print(" and are read as %g", *scene_.padding) : "") +
             (values && values->high >= measured.low && values->low <= measured.high
                  ? print("; measured values from %g to %g lie around it", measured.low, measured.high)
                  : "") +
             ": no measurement, not used by windows and interpolation");
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
