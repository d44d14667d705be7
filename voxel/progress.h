// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <functional>
#include <stop_token>

#include "voxel/read_scene.h"

namespace octotomy::voxel {

/// How long work is watched and ended. Called from the working function's own thread only.
struct Progress {
  std::stop_token stop;
  std::function<void(double fraction)> report;  ///< may be empty

  /// Reports the fraction done; throws Stopped where the work is to end.
  void at(double fraction) const {
    if (stop.stop_requested()) throw Stopped("stopped before a scan was worked through");
    if (report) report(fraction);
  }
};

}  // namespace octotomy::voxel
