// SPDX-License-Identifier: AGPL-3.0-or-later
#include "voxel/view/transfer.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <stdexcept>
#include <string_view>
#include <utility>

#include "voxel/space/error.h"
#include "voxel/view/srgb.h"

namespace octotomy::voxel {
namespace {

const std::array<std::pair<std::string_view, TransferFunction>, 3>& presets() {
  constexpr glm::vec3 ivory{0.94f, 0.89f, 0.78f}, marrow{0.80f, 0.55f, 0.42f};
  constexpr glm::vec3 skin{0.87f, 0.64f, 0.52f}, flesh{0.70f, 0.32f, 0.26f}, blood{0.78f, 0.14f, 0.11f};
  static const std::array<std::pair<std::string_view, TransferFunction>, 3> all{{
      {"bone", {{{180.0, marrow, 0.0}, {320.0, ivory, 0.5}, {900.0, ivory, 2.5}}, 60.0}},
      {"skin",
       {{{-500.0, skin, 0.0},
         {-300.0, skin, 0.10},
         {-80.0, skin, 0.10},
         {0.0, flesh, 0.012},
         {150.0, flesh, 0.012},
         {300.0, ivory, 0.4},
         {900.0, ivory, 2.0}},
        60.0}},
      {"vessels",
       {{{120.0, blood, 0.0},
         {180.0, blood, 0.35},
         {320.0, blood, 0.6},
         {450.0, ivory, 0.25},
         {1200.0, ivory, 0.6}},
        40.0}},
  }};
  return all;
}

/// The transfer function at a sample, interpolated between its points.
TransferTable::Entry entry_at(const TransferFunction& transfer, double sample) {
  const auto entry_of = [](const TransferPoint& point) {
    return TransferTable::Entry{linear_from_srgb(point.colour), static_cast<float>(point.per_mm)};
  };
  const auto& points = transfer.points;
  const auto above = std::find_if(points.begin(), points.end(),
                                  [&](const TransferPoint& point) { return point.sample >= sample; });
  if (above == points.begin()) return entry_of(points.front());
  if (above == points.end()) return entry_of(points.back());
  const TransferPoint& below = *(above - 1);
  const auto t = static_cast<float>((sample - below.sample) / (above->sample - below.sample));
  const TransferTable::Entry a = entry_of(below), b = entry_of(*above);
  return {glm::mix(a.light, b.light, t), glm::mix(a.per_mm, b.per_mm, t)};
}

}  // namespace

void check(const TransferFunction& transfer) {
  const auto fail = [](const std::string& what) { throw InvalidInput("the transfer function " + what); };
  if (transfer.points.size() < 2) fail("has fewer than two points");
  if (!(std::isfinite(transfer.surface_per_mm) && transfer.surface_per_mm > 0.0))
    fail("has a surface_per_mm that is not positive and finite");
  bool visible = false;
  for (std::size_t i = 0; i < transfer.points.size(); ++i) {
    const TransferPoint& point = transfer.points[i];
    const std::string where = "'s point " + std::to_string(i + 1) + " ";
    if (!(std::abs(point.sample) <= TransferPoint::max_sample))
      fail(where + "has a sample that is not between -1e6 and 1e6");
    if (i > 0 && !(point.sample > transfer.points[i - 1].sample))
      fail(where + "is not at a larger sample than the one before");
    if (!(point.per_mm >= 0.0 && point.per_mm <= TransferPoint::max_per_mm))
      fail(where + "has a per_mm that is not between 0 and 1e6");
    for (int channel = 0; channel < 3; ++channel)
      if (!(point.colour[channel] >= 0.0f && point.colour[channel] <= 1.0f))
        fail(where + "has a colour that is not between black and white");
    visible = visible || point.per_mm > 0.0;
  }
  if (!visible) fail("makes nothing visible: set per_mm of at least one point above 0");
}

TransferFunction preset_transfer(const std::string& name) {
  std::string known;
  for (const auto& [each, transfer] : presets()) {
    if (name == each) return transfer;
    known.append(known.empty() ? "" : ", ").append(each);
  }
  throw InvalidInput("there is no transfer function '" + name + "': choose one of " + known +
                     ", or choose a JSON file");
}

std::vector<std::string> preset_transfers() {
  std::vector<std::string> names;
  for (const auto& [name, transfer] : presets()) names.emplace_back(name);
  return names;
}

double visible_from(const TransferFunction& transfer) {
  const auto first = std::find_if(transfer.points.begin(), transfer.points.end(),
                                  [](const TransferPoint& point) { return point.per_mm > 0.0; });
  return first == transfer.points.begin() ? first->sample : (first - 1)->sample;
}

TransferTable::TransferTable(const TransferFunction& transfer, const MinMax& samples) : first_(samples.low) {
  assert(transfer.points.size() >= 2 && samples.low <= samples.high);
  const int count = samples.high - samples.low + 1;
  entries_.reserve(static_cast<std::size_t>(count) + 1);
  // The table has one entry more than the range has samples, so that at() has an upper neighbour for the last
  // sample.
  for (int i = 0; i <= count; ++i) entries_.push_back(entry_at(transfer, first_ + i));
  visible_before_.assign(entries_.size(), 0);
  for (std::size_t i = 0; i + 1 < entries_.size(); ++i)
    visible_before_[i + 1] =
        visible_before_[i] + (entries_[i].per_mm > 0.0f || entries_[i + 1].per_mm > 0.0f ? 1 : 0);
}

TransferTable::Entry TransferTable::at(double sample) const {
  const double place = std::clamp(sample - first_, 0.0, static_cast<double>(entries_.size() - 2));
  const auto below = static_cast<std::size_t>(place);
  const auto t = static_cast<float>(place - static_cast<double>(below));
  const Entry& a = entries_[below];
  const Entry& b = entries_[below + 1];
  return {a.light + (b.light - a.light) * t, a.per_mm + (b.per_mm - a.per_mm) * t};
}

bool TransferTable::visible(const MinMax& range) const {
  assert(range.low >= first_ && range.low <= range.high);
  assert(static_cast<std::size_t>(range.high - first_) < entries_.size());
  const auto low = static_cast<std::size_t>(range.low - first_);
  const auto high = static_cast<std::size_t>(range.high - first_);
  if (low == high) return entries_[low].per_mm > 0.0f;
  return visible_before_[high] > visible_before_[low];
}

}  // namespace octotomy::voxel
