// SPDX-License-Identifier: AGPL-3.0-or-later
#include "voxel/scan/air_level.h"

#include <algorithm>
#include <array>
#include <cstdint>
#include <cstdio>
#include <functional>
#include <limits>
#include <span>
#include <string>
#include <tbb/blocked_range.h>
#include <tbb/parallel_reduce.h>

#include "voxel/space/printed.h"
#include "voxel/space/vector_clones.h"

namespace octotomy::voxel {

namespace {

struct Counts {
  std::uint64_t samples = 0;
  std::uint64_t air = 0;    ///< -1100..-900
  std::uint64_t above = 0;  ///< samples from -900 to -700, the band above air
  std::uint64_t soft = 0;   ///< -900..-20

  Counts operator+(const Counts& other) const {
    return {samples + other.samples, air + other.air, above + other.above, soft + other.soft};
  }
};

Counts counts_of(std::span<const float> samples) {
  Counts counts;
  counts.samples = samples.size();
  for (const float value : samples) {
    counts.air += value >= -1100 && value <= -900;
    counts.above += value > -900 && value <= -700;
    counts.soft += value > -900 && value < -20;
  }
  return counts;
}

/// Number of samples in which a 16-bit counter cannot overflow.
constexpr std::size_t short_run = 1 << 15;

/// Counts at most short_run samples. All counters have 16 bits, so that a vector has as many lanes as
/// possible.
OCTOTOMY_VECTOR_CLONES void count_run(const std::int16_t* __restrict samples, std::size_t count,
                                      std::uint16_t* __restrict found) {
  std::uint16_t air = 0, above = 0, soft = 0;
  for (std::size_t i = 0; i < count; ++i) {
    // In unsigned arithmetic a sample below a band wraps to a number above it.
    const auto from_air = static_cast<std::uint16_t>(samples[i] + 1100);
    const auto from_above = static_cast<std::uint16_t>(samples[i] + 899);
    air = static_cast<std::uint16_t>(air + (from_air <= 200));
    above = static_cast<std::uint16_t>(above + (from_above <= 199));
    soft = static_cast<std::uint16_t>(soft + (from_above <= 878));
  }
  found[0] = air;
  found[1] = above;
  found[2] = soft;
}

Counts counts_of(std::span<const std::int16_t> samples) {
  Counts counts;
  counts.samples = samples.size();
  for (std::size_t at = 0; at < samples.size(); at += short_run) {
    std::array<std::uint16_t, 3> found{};
    count_run(samples.data() + at, std::min(short_run, samples.size() - at), found.data());
    counts = counts + Counts{0, found[0], found[1], found[2]};
  }
  return counts;
}

Counts count(const Scene& scene) {
  return std::visit(
      [](const auto& samples) {
        return tbb::parallel_reduce(
            tbb::blocked_range<std::size_t>(0, samples.size(), std::size_t{1} << 16), Counts{},
            [&](const tbb::blocked_range<std::size_t>& part, const Counts& counts) {
              return counts + counts_of(std::span(samples).subspan(part.begin(), part.size()));
            },
            std::plus<>());
      },
      scene.samples);
}

bool is_seen(std::uint64_t some, const Counts& counts) {
  return some * 1000 >= counts.samples && some > 0;
}

std::string percent(std::uint64_t some, const Counts& counts) {
  char text[32];
  std::snprintf(text, sizeof text, "%.1f %%",
                100.0 * static_cast<double>(some) / static_cast<double>(counts.samples));
  return text;
}

std::string span(const Scene& scene) {
  const Range values = range(scene);
  char text[64];
  std::snprintf(text, sizeof text, "%g..%g", values.low, values.high);
  return text;
}

/// Air is -1000 HU. With noise of 30 to 50 HU almost no sample of air is below this limit.
constexpr double below_air = -1100.0;
constexpr double padding_gap = 100.0;
constexpr std::size_t least_padded = 64, samples_for_one_padded = 10000, padded_for_one_in_gap = 100;

}  // namespace

AirLevel air_level_of_ct(const Scene& scene) {
  const Counts counts = count(scene);
  if (is_seen(counts.air, counts))
    return {Meaning::Hounsfield,
            {"air_level", Verdict::Pass,
             percent(counts.air, counts) + " of the samples lie within 100 of -1000: Hounsfield units"}};
  if (is_seen(counts.soft, counts))
    return {Meaning::Hounsfield,
            {"air_level", Verdict::Warn,
             "no air near -1000 confirms Hounsfield units; values " + span(scene) +
                 " are read as the header declares them"}};
  return {Meaning::Raw,
          {"air_level", Verdict::Fail,
           "air is not near -1000, so values " + span(scene) +
               " are not Hounsfield units: windows in HU do not apply; if air is near 0, the rescale "
               "intercept (about -1024) is missing"}};
}

AirLevel air_level_of_unnamed(const Scene& scene) {
  const Counts counts = count(scene);
  if (is_seen(counts.air, counts) && counts.air >= 2 * counts.above)
    return {Meaning::Hounsfield,
            {"air_level", Verdict::Warn,
             "the file names no unit; " + percent(counts.air, counts) +
                 " of the samples peak within 100 of -1000, as air does: taken as Hounsfield units"}};
  return {Meaning::Raw,
          {"air_level", Verdict::Pass,
           "the file names no unit and no peak of air lies near -1000: values " + span(scene) +
               " are taken as raw"}};
}

std::optional<Finding> lost_sign_finding(const Scene& scene, bool is_ct) {
  const auto* samples = std::get_if<FloatSamples>(&scene.samples);
  if (samples == nullptr || samples->empty()) return std::nullopt;
  // The extended scale of a CT ends at 30710 HU.
  constexpr float beyond_ct = 40000.0F, half_of_16_bits = 32768.0F;
  std::size_t count = 0;
  float least = std::numeric_limits<float>::infinity(), most = -least, others = -least;
  for (const float sample : *samples) {
    if (sample <= beyond_ct) {
      others = std::max(others, sample);
      continue;
    }
    ++count;
    least = std::min(least, sample);
    most = std::max(most, sample);
  }
  if (count < std::max(least_padded, samples->size() / samples_for_one_padded) || count == samples->size() ||
      most - least > half_of_16_bits || least - others < half_of_16_bits || most > 65535.0F)
    return std::nullopt;
  const double low = static_cast<double>(least), high = static_cast<double>(most);
  return Finding{
      "sign", is_ct ? Verdict::Fail : Verdict::Warn,
      print("%zu samples from %.9g to %.9g lie far above all others (up to %.9g). As 16-bit numbers with a "
            "sign "
            "they would be %.9g to %.9g, which is air or padding. If so, every window without an upper bound "
            "contains them like bone: correct the type in the header to 16 bits with a sign",
            count, low, high, static_cast<double>(others), low - 65536.0, high - 65536.0)};
}

void take_unstated_padding(Scene& scene) {
  std::visit(
      [&](auto& samples) {
        using Sample = typename std::decay_t<decltype(samples)>::value_type;
        const auto is_padded = [&](Sample sample) {
          return scene.padding && static_cast<double>(sample) == *scene.padding;
        };
        Sample least = std::numeric_limits<Sample>::max();
        for (const Sample sample : samples)
          if (sample < least && !is_padded(sample)) least = sample;
        const auto value = static_cast<double>(least);
        if (!(value < below_air)) return;
        std::size_t padded = 0, in_gap = 0, measured = 0;
        for (const auto sample : samples) {
          const double above = static_cast<double>(sample) - value;
          padded += above == 0.0;
          in_gap += above > 0.0 && above < padding_gap;
          measured += above >= padding_gap;
        }
        if (padded < std::max(least_padded, samples.size() / samples_for_one_padded) ||
            in_gap * padded_for_one_in_gap > padded || measured == 0)
          return;
        if (scene.padding)
          std::replace(samples.begin(), samples.end(), least, static_cast<Sample>(*scene.padding));
        else
          scene.padding = value;
        scene.audit.push_back(
            {"padding", Verdict::Warn,
             print("%zu samples (%.3g %%) hold %.9g, below air and apart from all other values, and the file "
                   "does not name it as padding: they are taken as padding, not used by windows and "
                   "interpolation",
                   padded, 100.0 * static_cast<double>(padded) / static_cast<double>(samples.size()),
                   value)});
      },
      scene.samples);
}

}  // namespace octotomy::voxel
