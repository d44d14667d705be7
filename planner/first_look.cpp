// SPDX-License-Identifier: AGPL-3.0-or-later
#include "planner/first_look.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <stdexcept>
#include <utility>

#include "planner/answer.h"
#include "planner/figures.h"
#include "voxel/read_scene.h"

namespace octotomy::planner {
namespace {

constexpr int bins = 256;
constexpr int picture_px = 400;

/// A scan as a plan names it.
Json scan_entry(const std::filesystem::path& scan, const voxel::ReadOptions& read) {
  Json entry{{"path", std::filesystem::absolute(scan).lexically_normal().string()}};
  if (!read.series.empty()) entry["series"] = read.series;
  if (read.spacing_mm) entry["spacing_mm"] = to_json(*read.spacing_mm);
  if (read.raw)
    entry["raw"] = {{"dims", {read.raw->dims.x, read.raw->dims.y, read.raw->dims.z}},
                    {"type", voxel::name_of(read.raw->type)},
                    {"big_endian", read.raw->big_endian},
                    {"offset", read.raw->offset}};
  return entry;
}

double sample_at(const voxel::Scene& scene, std::size_t i) {
  return std::visit([i](const auto& samples) { return static_cast<double>(samples[i]); }, scene.samples);
}

/// Every so many samples: a million tell a histogram of 256 bins to a tenth of a per cent.
std::vector<double> sorted_samples(const voxel::Scene& scene) {
  constexpr std::size_t enough = 1'000'000;
  const std::size_t count = scene.lattice.sample_count();
  const std::size_t stride = std::max<std::size_t>(1, count / enough);
  std::vector<double> samples;
  for (std::size_t i = 0; i < count; i += stride) samples.push_back(sample_at(scene, i));
  std::sort(samples.begin(), samples.end());
  return samples;
}

}  // namespace

Thresholds thresholds_of(const voxel::Scene& scene) {
  const std::vector<double> samples = sorted_samples(scene);
  const auto percentile = [&](double part) {
    return samples[static_cast<std::size_t>(part * static_cast<double>(samples.size() - 1))];
  };
  double low = percentile(0.001), high = percentile(0.999);
  if (!(low < high)) low = samples.front(), high = samples.back();
  if (!(low < high))
    throw std::runtime_error("all samples are " + grouped(low, 0) +
                             ": there is nothing to tell apart in this scan");

  // Sums over the bins before each: how many samples, and of what total.
  std::array<double, bins + 1> count{}, total{};
  for (const double sample : samples) {
    const double place = std::clamp((sample - low) / (high - low), 0.0, 1.0) * (bins - 1);
    const auto bin = static_cast<std::size_t>(std::lround(place));
    count[bin + 1] += 1.0;
    total[bin + 1] += static_cast<double>(bin);
  }
  for (std::size_t bin = 1; bin <= bins; ++bin) count[bin] += count[bin - 1], total[bin] += total[bin - 1];

  // Least variance within classes is largest variance between them: the sum of total^2 / count.
  const auto between = [&](std::size_t from, std::size_t to) {
    const double n = count[to] - count[from], sum = total[to] - total[from];
    return n > 0.0 ? sum * sum / n : 0.0;
  };
  double best = -1.0;
  std::pair<std::size_t, std::size_t> cut{1, 2};
  for (std::size_t first = 1; first < bins; ++first)
    for (std::size_t second = first + 1; second < bins; ++second) {
      const double variance = between(0, first) + between(first, second) + between(second, bins);
      if (variance > best) best = variance, cut = {first, second};
    }
  const auto value = [&](std::size_t bin) {
    return std::ceil(low + (static_cast<double>(bin) - 0.5) * (high - low) / (bins - 1));
  };
  return {value(cut.first), value(cut.second)};
}

Result first_look(const std::filesystem::path& scan, const LookOptions& options) {
  Result result;
  double bone_low = options.bone_low.value_or(300.0), skin_low = options.skin_low.value_or(-300.0);
  if (!options.bone_low || !options.skin_low) {
    const voxel::Scene scene = voxel::read_scene(scan, options.read);
    if (scene.meaning != voxel::Meaning::Hounsfield) {
      const Thresholds thresholds = thresholds_of(scene);
      bone_low = options.bone_low.value_or(thresholds.upper);
      skin_low = options.skin_low.value_or(thresholds.lower);
      result.findings.push_back(
          {"thresholds", voxel::Verdict::Warn,
           "the samples are not Hounsfield units, so bone was taken from " + grouped(bone_low, 0) +
               " and skin from " + grouped(skin_low, 0) +
               " (three classes of least variance, Otsu 1979): look at the pictures, and set --bone and "
               "--skin" +
               (scene.modality == "MR" ? "; in MR, bone is as dark as air and this is no bone" : "")});
    }
  }
  const std::string name =
      scan.filename().empty() ? scan.parent_path().filename().string() : scan.filename().string();
  Json plan{{"octotomy_plan", 1},
            {"name", "First look at " + (name.empty() ? scan.string() : name)},
            {"scans", {{"scan", scan_entry(scan, options.read)}}},
            {"steps", Json::array()}};
  plan["steps"].push_back({{"id", "bone"}, {"do", "window"}, {"scan", "scan"}, {"low", bone_low}});
  plan["steps"].push_back({{"id", "skin"}, {"do", "window"}, {"scan", "scan"}, {"low", skin_low}});
  plan["steps"].push_back({{"id", "bone_size"}, {"do", "measure"}, {"object", "bone"}});
  plan["steps"].push_back({{"id", "skin_size"}, {"do", "measure"}, {"object", "skin"}});
  result.plan = parse_plan(plan.dump(2), std::filesystem::current_path());
  result.evaluation = evaluate(result.plan, options.evaluation);

  {
    const Stopwatch watch(result.evaluation.timings, "components");
    result.parts.push_back(parts_of(result.evaluation.object("bone")));
  }
  const Stopwatch watch(result.evaluation.timings, "render");
  const voxel::Drawn bone = drawn(result.evaluation.object("bone"), {0.91f, 0.87f, 0.79f});
  const voxel::Drawn skin = drawn(result.evaluation.object("skin"), {0.88f, 0.72f, 0.63f});
  for (const voxel::Drawn& object : {bone, skin}) {
    result.pictures.push_back({object.name, object.name == "bone" ? "Bone" : "Skin", {object}, {}});
    draw(result.pictures.back(), all_views(), {skin}, picture_px);
  }
  return result;
}

}  // namespace octotomy::planner
