// SPDX-License-Identifier: AGPL-3.0-or-later
#include "voxel/scan/stack_audit.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <limits>
#include <map>
#include <optional>

#include "voxel/space/printed.h"

namespace octotomy::voxel {

namespace {

class StackAudit {
 public:
  StackAudit(const DicomStack& stack, std::vector<Finding>& audit) : stack_(stack), audit_(audit) {}

  void run() {
    audit_traits();
    audit_compression();
    audit_photometric();
    audit_pixel_format();
    audit_thickness();
    audit_spacing_tag();
    audit_instance_order();
    audit_acr_nema();
    audit_numbers();
    audit_real_world();
    audit_aspect();
    audit_frames();
    audit_coding();
    audit_patient_orientation();
  }

 private:
  /// For each value the names of the slices that have it.
  using Values = std::map<std::string, std::vector<std::string>>;

  void find(const char* check, Verdict verdict, std::string detail, std::vector<std::string> files = {}) {
    audit_.push_back({check, verdict, std::move(detail), std::move(files)});
  }

  template <typename Value>
  Values values_of(const Value& value) const {
    Values values;
    for (const DicomSlice& slice : stack_.slices) values[value(slice)].push_back(slice.name);
    return values;
  }

  static Values::const_iterator commonest_of(const Values& values) {
    return std::max_element(values.begin(), values.end(),
                            [](const auto& a, const auto& b) { return a.second.size() < b.second.size(); });
  }

  /// The names of the slices whose value is not the commonest one.
  static std::vector<std::string> fewer_of(const Values& values) {
    std::vector<std::string> names;
    for (auto value = values.begin(); value != values.end(); ++value)
      if (value != commonest_of(values))
        names.insert(names.end(), value->second.begin(), value->second.end());
    return names;
  }

  /// "38 slices of 'H30s', 2 of 'H60s' (a.dcm, b.dcm)".
  static std::string mixture_of(const Values& values) {
    const auto shown = [](const std::string& value) { return value.empty() ? "none" : "'" + value + "'"; };
    const auto commonest = commonest_of(values);
    std::string text = slices(commonest->second.size()) + " of " + shown(commonest->first);
    std::size_t told = 0;
    for (auto value = values.begin(); value != values.end(); ++value)
      if (value != commonest && ++told <= 4)
        text.append(", ")
            .append(std::to_string(value->second.size()))
            .append(" of ")
            .append(shown(value->first))
            .append(" (")
            .append(listed(value->second))
            .append(")");
    return told > 4 ? text + " and " + std::to_string(told - 4) + " more values" : text;
  }

  /// Whether dates of the form YYYYMMDD lie more than a day apart; a scan may run over midnight.
  static bool are_days_apart(const Values& values) {
    std::optional<std::chrono::sys_days> first, last;
    for (const auto& [date, names] : values) {
      int year = 0;
      unsigned month = 0, day = 0;
      if (std::sscanf(date.c_str(), "%4d%2u%2u", &year, &month, &day) != 3) continue;
      const std::chrono::year_month_day read{std::chrono::year{year}, std::chrono::month{month},
                                             std::chrono::day{day}};
      if (!read.ok()) continue;
      const std::chrono::sys_days at = read;
      first = first ? std::min(*first, at) : at;
      last = last ? std::max(*last, at) : at;
    }
    return first && *last - *first > std::chrono::days{1};
  }

  void audit_traits() {
    std::string same;
    for (std::size_t trait = 0; trait < dicom_traits.size(); ++trait) {
      const DicomTrait& kind = dicom_traits[trait];
      if (kind.role != TraitRole::Stack && kind.role != TraitRole::Uniformity) continue;
      const bool is_type = kind.check == std::string("image_type");
      const Values values = values_of([&](const DicomSlice& slice) {
        const std::string& value = slice.traits[trait];
        // The first two values of ImageType state whether the image was measured; later values often count
        // reconstruction orders.
        return is_type ? value.substr(0, value.find('\\', value.find('\\') + 1)) : value;
      });
      if (values.size() == 1) {
        if (kind.role == TraitRole::Stack && !is_type && !values.begin()->first.empty())
          same += (same.empty() ? "" : ", ") + std::string(kind.words) + " " + values.begin()->first;
        continue;
      }
      // Axial scanners count one acquisition per rotation, and times increase from slice to slice, so nearly
      // each slice has its own value.
      const bool counts_on = 4 * values.size() > stack_.slices.size() && values.size() > 2 &&
                             (kind.check == std::string("acquisition") || kind.check == std::string("phase"));
      if (counts_on) continue;
      if (kind.check == std::string("acquisition_date") && !are_days_apart(values)) continue;
      // Audits may be given to others, so names and birth dates are not shown.
      const bool is_of_person =
          std::string(kind.check).starts_with("patient_") && kind.check != std::string("patient_position");
      find(kind.check, Verdict::Warn,
           (is_of_person ? slices(fewer_of(values).size()) + " with another " + kind.words + " (" +
                               listed(fewer_of(values)) + ")"
                         : mixture_of(values)) +
               ": " + kind.effect,
           fewer_of(values));
    }
    find("uniform", Verdict::Pass, same.empty() ? "no attribute to compare" : "all slices: " + same);
  }

  void audit_compression() {
    const Values values = values_of([](const DicomSlice& slice) { return slice.lossy; });
    if (values.size() == 1 && values.begin()->first.empty())
      return find("compression", Verdict::Pass, "lossless");
    std::vector<std::string> names;
    std::string how;
    for (const auto& [value, members] : values) {
      if (value.empty()) continue;
      how += (how.empty() ? "" : "; ") + value;
      names.insert(names.end(), members.begin(), members.end());
    }
    find("compression", Verdict::Warn,
         slices(names.size()) + " lost values by compression (" + how +
             "): the errors of surfaces and densities depend on this compression: " + listed(names),
         names);
  }

  void audit_photometric() {
    const Values values = values_of(
        [](const DicomSlice& slice) { return std::string(slice.inverted ? "MONOCHROME1" : "MONOCHROME2"); });
    if (values.size() == 1 && !stack_.first().inverted) return;
    if (values.size() == 1)
      return find("photometric", Verdict::Warn,
                  "MONOCHROME1: viewers show it inverted; values are read as stored");
    find(
        "photometric", Verdict::Fail,
        "bright and dark are exchanged between slices: " + mixture_of(values) + "; values are read as stored",
        fewer_of(values));
  }

  void audit_pixel_format() {
    const Values values = values_of([](const DicomSlice& slice) {
      return print("%u of %u bits, %s", slice.pixels.stored, slice.pixels.allocated,
                   slice.pixels.is_signed ? "signed" : "unsigned");
    });
    if (values.size() > 1)
      find("pixel_format", Verdict::Warn,
           "mixed: " + mixture_of(values) + "; each slice is decoded by its own header", fewer_of(values));
  }

  /// The commonest distance between neighbours, rounded to a hundredth of a millimetre.
  double usual_gap_mm() const {
    std::map<long, std::size_t> counts;
    for (std::size_t i = 1; i < stack_.slices.size(); ++i)
      ++counts[std::lround(100.0 *
                           (stack_.height_mm(stack_.slices[i]) - stack_.height_mm(stack_.slices[i - 1])))];
    return 0.01 * static_cast<double>(
                      std::max_element(counts.begin(), counts.end(), [](const auto& a, const auto& b) {
                        return a.second < b.second;
                      })->first);
  }

  void audit_thickness() {
    const Values values = values_of([](const DicomSlice& slice) {
      return slice.thickness_mm ? print("%.6g mm", *slice.thickness_mm) : std::string();
    });
    if (values.size() > 1) {
      find("slice_thickness", Verdict::Warn, "mixed: " + mixture_of(values), fewer_of(values));
      return;
    }
    const std::optional<double> thickness_mm = stack_.first().thickness_mm;
    if (stack_.slices.size() < 2 || !thickness_mm || *thickness_mm <= 0.0) return;
    double gap_mm = usual_gap_mm();
    // Headers state thickness and positions to two decimals or better.
    const double tolerance_mm = 0.02 + 0.01 * gap_mm;
    // If positions are rounded more coarsely, only the mean is exact.
    const double mean_mm =
        stack_.height_mm(stack_.slices.back()) / static_cast<double>(stack_.slices.size() - 1);
    if (std::abs(*thickness_mm - mean_mm) <= tolerance_mm) gap_mm = mean_mm;
    if (*thickness_mm < gap_mm - tolerance_mm)
      find("slice_thickness", Verdict::Warn,
           print("slices of %.4g mm lie %.4g mm apart: %.3g mm between them were not measured", *thickness_mm,
                 gap_mm, gap_mm - *thickness_mm));
    else if (*thickness_mm > gap_mm + tolerance_mm)
      find("slice_thickness", Verdict::Warn,
           print("slices of %.4g mm lie %.4g mm apart and overlap: details along the stack are no finer than "
                 "%.4g mm",
                 *thickness_mm, gap_mm, *thickness_mm));
    else
      find("slice_thickness", Verdict::Pass, print("%.4g mm, as the slices' distance", *thickness_mm));
  }

  void audit_spacing_tag() {
    const std::optional<double> tag_mm = stack_.first().spacing_tag_mm;
    if (stack_.slices.size() < 2 || !tag_mm || *tag_mm == 0.0) return;
    const double gap_mm = usual_gap_mm(), mean_mm = stack_.height_mm(stack_.slices.back()) /
                                                    static_cast<double>(stack_.slices.size() - 1);
    const double cosine = std::cos(stack_.first().tilt_deg.value_or(0.0) * 3.14159265358979323846 / 180.0);
    const auto is_near = [&](double mm) { return std::abs(std::abs(*tag_mm) - mm) <= 0.02 + 0.01 * mm; };
    // If positions are rounded, only the mean is exact.
    if (!is_near(gap_mm) && !is_near(gap_mm / cosine) && !is_near(mean_mm))
      find("spacing_tag", Verdict::Warn,
           print("SpacingBetweenSlices is %.4g mm, but by their positions the slices lie %.4g mm apart: the "
                 "positions are used",
                 *tag_mm, gap_mm));
  }

  /// Reports image numbers that run opposite to the positions of most slices: positions may be exchanged.
  void audit_instance_order() {
    std::vector<std::string> up, down;
    for (std::size_t i = 1; i < stack_.slices.size(); ++i) {
      const int step = stack_.slices[i].instance_number - stack_.slices[i - 1].instance_number;
      if (step != 0) (step > 0 ? up : down).push_back(stack_.slices[i].name);
    }
    const std::vector<std::string>& fewer = up.size() < down.size() ? up : down;
    if (fewer.empty()) return;
    find("instance_order", Verdict::Warn,
         "the numbers of " + slices(fewer.size()) +
             " run against their positions, which are used: " + listed(fewer),
         fewer);
  }

  void audit_acr_nema() {
    if (stack_.first().position_of_acr_nema)
      find("acr_nema", Verdict::Warn,
           "positions and orientations are those of ACR-NEMA, (0020,0030) and (0020,0035), read as DICOM's: "
           "check that left and right are not exchanged");
  }

  /// The names of the slices whose header has the given text, such as "a.dcm, b.dcm", and the first text
  /// found.
  struct Noted {
    std::vector<std::string> names;
    std::string text;
  };
  Noted noted(std::string DicomSlice::*text) const {
    Noted found;
    for (const DicomSlice& slice : stack_.slices)
      if (!(slice.*text).empty()) {
        if (found.names.empty()) found.text = slice.*text;
        found.names.push_back(slice.name);
      }
    return found;
  }

  void audit_numbers() {
    if (const Noted commas = noted(&DicomSlice::decimal_commas); !commas.names.empty())
      find("decimal_commas", Verdict::Warn,
           commas.text + " hold commas, read as decimal points, in " + slices(commas.names.size()) + ": " +
               listed(commas.names),
           commas.names);
  }

  /// The unit of a slice's values; empty if none is stated.
  static std::string unit_of(const DicomSlice& slice) {
    const std::string& type = slice.lut ? slice.lut->type : slice.rescale_type;
    return type == "US" || type.empty() ? (slice.modality == "CT" ? "HU" : "") : type;
  }

  /// Whether a mapping produces the same numbers and the same unit as the rescale.
  static bool agrees_with(const RealWorldMapping& mapping, const DicomSlice& slice) {
    if (slice.lut || !mapping.slope || !mapping.intercept) return false;
    const double slope = slice.slope.value_or(1.0), intercept = slice.intercept.value_or(0.0);
    // In a decimal string of 16 characters, ten digits fit beside sign and exponent.
    const auto are_one = [](double a, double b) {
      return std::abs(a - b) <= 1e-9 * std::max({std::abs(a), std::abs(b), 1e-300});
    };
    const std::string ours = unit_of(slice), theirs = mapping.unit == "[hnsf'U]" ? "HU" : mapping.unit;
    return are_one(*mapping.slope, slope) && are_one(*mapping.intercept, intercept) &&
           (ours.empty() || theirs.empty() || ours == theirs);
  }

  /// "2 * stored - 1024 [hnsf'U]".
  static std::string line_of(double slope, double intercept, const std::string& unit) {
    return print("%g * stored %s %g ", slope, intercept < 0.0 ? "-" : "+", std::abs(intercept)) +
           (unit.empty() ? "without a unit" : unit);
  }

  /// Compares Real World Value Mappings with the rescale. Only the rescale is applied.
  void audit_real_world() {
    std::vector<std::string> differing;
    std::size_t with = 0;
    const DicomSlice* first = nullptr;
    for (const DicomSlice& slice : stack_.slices) {
      if (slice.real_world.empty()) continue;
      ++with;
      if (std::any_of(slice.real_world.begin(), slice.real_world.end(),
                      [&](const RealWorldMapping& mapping) { return agrees_with(mapping, slice); }))
        continue;
      if (first == nullptr) first = &slice;
      differing.push_back(slice.name);
    }
    if (with == 0) return;
    if (first == nullptr)
      return find(
          "real_world_values", Verdict::Pass,
          "the Real World Value Mapping of " + slices(with) + " produces the same values as the rescale");
    const RealWorldMapping& mapping = first->real_world.front();
    const double slope = first->slope.value_or(1.0), intercept = first->intercept.value_or(0.0);
    const std::string unit = unit_of(*first);
    std::string used = first->lut ? "those of the Modality LUT"
                       : first->slope || first->intercept
                           ? "those of the rescale, " + line_of(slope, intercept, unit)
                           : "the stored ones, as the header states no rescale";
    std::string other = "a table of values" + (mapping.unit.empty() ? "" : " in " + mapping.unit);
    if (mapping.slope && mapping.intercept) {
      other = line_of(*mapping.slope, *mapping.intercept, mapping.unit);
      double stored = std::min(1000.0, std::ldexp(1.0, static_cast<int>(first->pixels.stored) - 1) - 1.0);
      if (mapping.first && mapping.last && *mapping.first <= *mapping.last)
        stored = std::clamp(stored, *mapping.first, *mapping.last);
      const auto named = [](double value, const std::string& of) {
        return print("%.6g", value) + (of.empty() ? "" : " " + of);
      };
      if (!first->lut)
        other += print("; a stored %g is ", stored) + named(slope * stored + intercept, unit) +
                 " by the rescale and " + named(*mapping.slope * stored + *mapping.intercept, mapping.unit) +
                 " by the mapping";
    }
    find("real_world_values", Verdict::Warn,
         "values are " + used + ". The Real World Value Mapping of " + slices(differing.size()) +
             " is not applied. It would produce " + other +
             (mapping.slope && mapping.intercept ? ". If the mapping's values are wanted, write its slope "
                                                   "and intercept into RescaleSlope and "
                                                   "RescaleIntercept: "
                                                 : ": ") +
             listed(differing),
         differing);
  }

  void audit_aspect() {
    std::vector<std::string> names;
    std::string told;
    for (const DicomSlice& slice : stack_.slices) {
      const double spacing_ratio = slice.spacing_mm.y / slice.spacing_mm.x;
      // The tolerance between both attributes, which are stated with few digits. An error of a hundredth
      // distorts a head by two millimetres.
      if (!slice.aspect_ratio || std::abs(*slice.aspect_ratio / spacing_ratio - 1.0) < 0.01) continue;
      if (names.empty())
        told = print("PixelAspectRatio makes pixels %.4g times as high as wide, PixelSpacing %.4g times",
                     *slice.aspect_ratio, spacing_ratio);
      names.push_back(slice.name);
    }
    if (!names.empty())
      find("pixel_aspect", Verdict::Warn,
           told + ": PixelSpacing is used; compare the head's width with its length: " + listed(names),
           names);
  }

  void audit_frames() {
    if (const Noted placed = noted(&DicomSlice::assumed_place); !placed.names.empty())
      find("frame_positions", Verdict::Warn,
           slices(placed.names.size()) + " have no position of their own and are placed by " + placed.text +
               ": check that head and feet are not exchanged");
    if (const Noted excess = noted(&DicomSlice::excess_pixels); !excess.names.empty())
      find("pixel_data", excess.text.find("images") != std::string::npos ? Verdict::Fail : Verdict::Warn,
           "the file holds " + excess.text + "; the rest is not read: " + listed(excess.names), excess.names);
  }

  void audit_coding() {
    if (const Noted doubts = noted(&DicomSlice::doubts); !doubts.names.empty())
      find("image_kind", Verdict::Warn,
           doubts.text + ", in " + slices(doubts.names.size()) + ": " + listed(doubts.names), doubts.names);
    if (const Noted coding = noted(&DicomSlice::assumed_coding); !coding.names.empty())
      find("coding", Verdict::Warn,
           slices(coding.names.size()) + " are read with " + coding.text + ": " + listed(coding.names),
           coding.names);
  }

  /// Compares PatientOrientation, the patient's directions along rows and columns, with
  /// ImageOrientationPatient.
  void audit_patient_orientation() {
    std::vector<std::string> names;
    std::string stated;
    for (const DicomSlice& slice : stack_.slices) {
      const std::string& text = slice.patient_orientation;
      const std::size_t bar = text.find('\\');
      if (bar == std::string::npos || (agrees(text, slice.along_row) &&
                                       agrees(std::string_view(text).substr(bar + 1), slice.along_column)))
        continue;
      if (names.empty()) stated = text;
      names.push_back(slice.name);
    }
    if (!names.empty())
      find("patient_orientation", Verdict::Warn,
           "PatientOrientation '" + stated + "' contradicts ImageOrientationPatient, which is used, in " +
               slices(names.size()) + ": check that left and right are not exchanged: " + listed(names),
           names);
  }

  /// Whether a direction agrees with the first letter of its stated name: L, R, P, A, H or F. Other letters
  /// are used for animals and agree with any direction.
  static bool agrees(std::string_view letters, const glm::dvec3& along) {
    constexpr std::string_view known = "LRPAHF";
    const std::size_t at = letters.empty() ? std::string_view::npos : known.find(letters.front());
    if (at == std::string_view::npos) return true;
    const double towards = along[static_cast<int>(at / 2)] * (at % 2 == 0 ? 1.0 : -1.0);
    // The first letter states the axis with the largest component.
    return towards >= 0.5;
  }

  const DicomStack& stack_;
  std::vector<Finding>& audit_;
};

}  // namespace

void audit_stack(const DicomStack& stack, std::vector<Finding>& audit) {
  StackAudit(stack, audit).run();
}

void audit_join(const DicomStack& stack, std::vector<Finding>& audit) {
  std::map<std::string, std::size_t> series;
  for (const DicomSlice& slice : stack.slices) ++series[slice.series_uid];
  std::string of = std::to_string(series.size()) + " series";
  for (std::size_t trait = 0; trait < dicom_traits.size(); ++trait) {
    if (dicom_traits[trait].role != TraitRole::Origin) continue;
    std::map<std::string, std::size_t> values;
    for (const DicomSlice& slice : stack.slices) ++values[slice.traits[trait]];
    if (values.size() > 1)
      of += ", " + std::to_string(values.size()) + " values of " + dicom_traits[trait].words;
  }
  std::string apart = "one place";
  if (stack.slices.size() > 1) {
    double least_mm = std::numeric_limits<double>::infinity(), most_mm = 0.0;
    for (std::size_t i = 1; i < stack.slices.size(); ++i) {
      const double gap_mm = stack.height_mm(stack.slices[i]) - stack.height_mm(stack.slices[i - 1]);
      least_mm = std::min(least_mm, gap_mm);
      most_mm = std::max(most_mm, gap_mm);
    }
    apart = print("%.4g to %.4g mm apart", least_mm, most_mm);
  }
  audit.push_back({"join", Verdict::Fail,
                   "joined as requested: " + slices(stack.slices.size()) + " of " + of + ", " + apart +
                       ". Their headers do not state that their positions have a common origin: check the "
                       "pictures for steps between slices"});
}

void audit_counts(const DicomStack& stack, std::vector<Finding>& audit) {
  int stated = 0;
  for (const DicomSlice& slice : stack.slices) stated = std::max(stated, slice.stated_images.value_or(0));
  if (stated > static_cast<int>(stack.slices.size()))
    audit.push_back(
        {"image_count", Verdict::Warn,
         print(
             "the header states %d images in the acquisition, and %zu are in the stack: check that all were "
             "exported",
             stated, stack.slices.size())});
  struct Parts {
    std::vector<int> numbers;
    int total = 0;
  };
  std::map<std::string, Parts> concatenations;
  for (const DicomSlice& slice : stack.slices) {
    const Concatenation& part = slice.concatenation;
    if (part.uid.empty() && part.total < 2) continue;
    Parts& parts = concatenations[part.uid];
    parts.total = std::max({parts.total, part.total, part.number});
    if (std::find(parts.numbers.begin(), parts.numbers.end(), part.number) == parts.numbers.end())
      parts.numbers.push_back(part.number);
  }
  for (const auto& [uid, parts] : concatenations) {
    std::string missing;
    for (int number = 1; number <= std::min(parts.total, 9999); ++number)
      if (std::find(parts.numbers.begin(), parts.numbers.end(), number) == parts.numbers.end())
        missing += (missing.empty() ? "" : ", ") + std::to_string(number);
    if (!missing.empty())
      audit.push_back({"concatenation", Verdict::Fail,
                       print("the image is stored in %d files (InConcatenationTotalNumber), of which %zu "
                             "are here; missing: ",
                             parts.total, parts.numbers.size()) +
                           missing.substr(0, 200) + "; export it again"});
  }
}

}  // namespace octotomy::voxel
