// SPDX-License-Identifier: AGPL-3.0-or-later
#include "planner/operation/motion/scan_fit.h"

#include <algorithm>
#include <array>
#include <cstdio>
#include <memory>

#include "planner/operation/measure/result_json.h"
#include "planner/operation/table/number_format.h"
#include "voxel/align/register_scans.h"
#include "voxel/scan/image_file.h"
#include "voxel/space/unfinished_folder.h"
#include "voxel/view/reformat.h"

namespace octotomy::planner {
namespace {

namespace fs = std::filesystem;

/// Edge in mm of a pixel in the difference pictures. Three planes of a head side by side then fit the width
/// of a screen.
constexpr double watched_pixel_mm = 1.0;

/// Draws a picture of the difference of two scans for each step of the search.
class Watched {
 public:
  Watched(const voxel::Scene& moving, const voxel::Scene& fixed, const fs::path& folder)
      : folder_(folder), work_(fs::absolute(folder).parent_path(), ".octotomy-watch-"), moving_(moving) {
    const voxel::Lattice& lattice = fixed.lattice;
    const glm::dvec3 middle_mm = lattice.lps_mm(0.5 * glm::dvec3(lattice.dims - 1));
    for (const char* name : {"inferior", "anterior", "left"}) {
      const voxel::View view = voxel::parse_view(name);
      sheets_.push_back(voxel::plane_sheet(lattice, view, glm::dot(middle_mm, view.look), watched_pixel_mm));
      still_.push_back(voxel::sample(fixed, sheets_.back(), voxel::Interpolation::Linear));
    }
    still_tones_ = tones_of(still_);
    for (const voxel::Sheet& sheet : sheets_) {
      size_px_.x += sheet.size_px().x;
      size_px_.y = std::max(size_px_.y, sheet.size_px().y);
    }
  }

  void draw(const voxel::ScanFitStep& step) {
    moving_.lattice.lps_from_voxel = step.fixed_from_moving * still_frame_;
    std::vector<voxel::SheetSamples> moved;
    for (const voxel::Sheet& sheet : sheets_)
      moved.push_back(voxel::sample(moving_, sheet, voxel::Interpolation::Linear));
    if (steps_.empty()) moved_tones_ = tones_of(moved);
    std::vector<std::uint8_t> rgb(
        3 * static_cast<std::size_t>(size_px_.x) * static_cast<std::size_t>(size_px_.y), 0);
    int left = 0;
    for (std::size_t s = 0; s < sheets_.size(); ++s) {
      const glm::ivec2 size = sheets_[s].size_px();
      for (int y = 0; y < size.y; ++y)
        for (int x = 0; x < size.x; ++x) {
          const auto from =
              static_cast<std::size_t>(y) * static_cast<std::size_t>(size.x) + static_cast<std::size_t>(x);
          const auto to = 3 * (static_cast<std::size_t>(y) * static_cast<std::size_t>(size_px_.x) +
                               static_cast<std::size_t>(left + x));
          rgb[to] = rgb[to + 2] = tone(moved[s], from, moved_tones_);
          rgb[to + 1] = tone(still_[s], from, still_tones_);
        }
      left += size.x;
    }
    char name[32];
    std::snprintf(name, sizeof name, "step_%04zu.png", steps_.size() + 1);
    voxel::write_image(work_.path() / name, size_px_, rgb);
    steps_.push_back({{"picture", name}, {"resolution_mm", step.resolution_mm}, {"likeness", step.likeness}});
  }

  /// Renames the folder to its final name. Returns the list of steps.
  Json finish() {
    const fs::path from = work_.keep();
    fs::permissions(from, fs::perms::owner_all | fs::perms::group_read | fs::perms::group_exec |
                              fs::perms::others_read | fs::perms::others_exec);
    fs::rename(from, folder_);
    return steps_;
  }

 private:
  /// The sample values that are drawn black and white: the 1st and 99th percentiles of the visible samples.
  static voxel::Range tones_of(const std::vector<voxel::SheetSamples>& seen) {
    std::vector<float> values;
    for (const voxel::SheetSamples& samples : seen)
      for (std::size_t i = 0; i < samples.inside.size(); ++i)
        if (samples.inside[i] != 0) values.push_back(samples.image.values[i]);
    if (values.empty()) return {0.0, 1.0};
    std::sort(values.begin(), values.end());
    const double low = values[values.size() / 100], high = values[values.size() - 1 - values.size() / 100];
    return {low, std::max(high, low + 1.0)};
  }

  static std::uint8_t tone(const voxel::SheetSamples& samples, std::size_t pixel, const voxel::Range& tones) {
    if (samples.inside[pixel] == 0) return 0;
    const double share = (samples.image.values[pixel] - tones.low) / (tones.high - tones.low);
    return static_cast<std::uint8_t>(255.0 * std::clamp(share, 0.0, 1.0) + 0.5);
  }

  fs::path folder_;
  voxel::UnfinishedFolder work_;
  voxel::Scene moving_;  ///< its frame follows the motion of each step
  const glm::dmat4 still_frame_ = moving_.lattice.lps_from_voxel;
  std::vector<voxel::Sheet> sheets_;
  std::vector<voxel::SheetSamples> still_;
  voxel::Range still_tones_, moved_tones_;
  glm::ivec2 size_px_{0};
  Json steps_ = Json::array();
};

const char* word_of(voxel::Verdict verdict) {
  return verdict == voxel::Verdict::Fail ? "FAIL" : verdict == voxel::Verdict::Warn ? "WARN" : "PASS";
}

}  // namespace

FittedScans fit_scans(const voxel::Scene& moving, const voxel::Scene& fixed, const ScanFitAsked& asked,
                      const voxel::Progress& progress, Timings& timings) {
  const Stopwatch watch(timings, "register");
  voxel::ScanFitOptions options;
  options.by =
      asked.is_correlation ? voxel::ScanLikeness::Correlation : voxel::ScanLikeness::MutualInformation;
  options.least_overlap = asked.least_overlap;
  options.finest_mm = asked.finest_mm;
  options.progress = progress;
  std::unique_ptr<Watched> watched;
  if (!asked.watch.empty()) {
    if (fs::exists(asked.watch))
      throw std::runtime_error("--watch: " + asked.watch.string() +
                               " exists already: choose the name of a new folder");
    watched = std::make_unique<Watched>(moving, fixed, asked.watch);
    options.watch = [&](const voxel::ScanFitStep& step) { watched->draw(step); };
  }
  const voxel::ScanFit fit = voxel::register_scans(moving, fixed, options);
  FittedScans fitted;
  fitted.fixed_from_moving = fit.fixed_from_moving;
  fitted.verdict = word_of(fit.verdict);
  fitted.findings = fit.findings;
  const std::string measure = asked.is_correlation ? "correlation" : "mutual information";
  fitted.summary = fitted.verdict + ", " + measure + " " + three_figures(fit.likeness) + ", " +
                   three_figures(100.0 * fit.overlap) + " % overlap, " + std::to_string(fit.agreeing) +
                   " of " + std::to_string(fit.refined) + " searches agree";
  fitted.details = {
      {"verdict", fitted.verdict},
      {"scans",
       {{"by", asked.is_correlation ? "correlation" : "mutual_information"},
        {"likeness", fit.likeness},
        {"overlap", fit.overlap},
        {"starts", fit.starts},
        {"refined", fit.refined},
        {"agreeing", fit.agreeing},
        {"rival_likeness", fit.rival ? Json(*fit.rival) : Json(nullptr)},
        {"likeness_there", fit.likeness_there},
        {"rival_resolution_mm", fit.rival_mm},
        {"least_drop", fit.least_drop},
        {"drop_at_mm", fit.probe_mm},
        {"motions", fit.motions},
        {"definition", asked.is_correlation
                           ? "likeness is the correlation of the samples, -1 to 1; rival_likeness that of "
                             "the best other motion; "
                             "least_drop the smallest loss of likeness at a motion of drop_at_mm"
                           : "likeness is twice the mutual information over the sum of the entropies, 0 to "
                             "1; rival_likeness that "
                             "of the best other motion; least_drop the smallest loss of likeness at a motion "
                             "of drop_at_mm"}}}};
  if (watched) {
    const Json steps = watched->finish();
    fitted.details["watch"] = {
        {"folder", asked.watch.string()}, {"pictures", steps.size()}, {"steps", steps}};
  }
  return fitted;
}

}  // namespace octotomy::planner
