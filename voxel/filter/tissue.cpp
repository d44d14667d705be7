// SPDX-License-Identifier: AGPL-3.0-or-later
#include "voxel/filter/tissue.h"

#include <algorithm>
#include <array>
#include <cstdio>

namespace octotomy::voxel {
namespace {

constexpr std::array<Tissue, 8> known{{
    {"bone", 300.0, std::nullopt,
     "the lowest threshold of craniofacial planning: it keeps thin cortical bone and drops the rim of spongy "
     "bone; Materialise Mimics' predefined set begins at 226"},
    {"cortical_bone", 662.0, std::nullopt,
     "Materialise Mimics, predefined threshold sets: compact bone, adult (CT), from 662; without its upper "
     "bound of 1988, which the petrous bone exceeds"},
    {"trabecular_bone", 148.0, 661.0,
     "Materialise Mimics, predefined threshold sets: spongial bone, adult (CT)"},
    {"teeth", 1553.0, 2850.0, "Materialise Mimics, predefined threshold sets: enamel, adult (CT)"},
    {"soft_tissue", -29.0, 150.0, "Mitsiopoulos et al., Journal of Applied Physiology 85, 1998: muscle"},
    {"fat", -190.0, -30.0, "Kvist et al., International Journal of Obesity 12, 1988: adipose tissue"},
    {"skin", -300.0, std::nullopt,
     "everything inside the skin: above the half maximum between air and skin, about -500 HU; cushions may "
     "also reach this value"},
    {"air", std::nullopt, -500.0,
     "the half maximum between air and water, -1000 and 0 HU by definition (Hounsfield, British Journal of "
     "Radiology 46, 1973)"},
}};

}  // namespace

std::span<const Tissue> tissues() {
  return known;
}

std::optional<Tissue> tissue(std::string_view name) {
  const auto* const found =
      std::find_if(known.begin(), known.end(), [&](const Tissue& each) { return each.name == name; });
  if (found == known.end()) return std::nullopt;
  return *found;
}

std::string described(const Tissue& tissue) {
  char bounds[64];
  if (tissue.low && tissue.high)
    std::snprintf(bounds, sizeof bounds, " (%g to %g HU)", *tissue.low, *tissue.high);
  else
    std::snprintf(bounds, sizeof bounds, tissue.low ? " (from %g HU)" : " (to %g HU)",
                  tissue.low ? *tissue.low : *tissue.high);
  return std::string(tissue.name) + bounds;
}

}  // namespace octotomy::voxel
