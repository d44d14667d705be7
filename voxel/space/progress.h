// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <functional>
#include <stop_token>

#include "voxel/space/error.h"

namespace octotomy::voxel {

/// Progress reports of long work, and requests to stop it. Only the thread of the working function calls
/// `report`.
struct Progress {
  std::stop_token stop;
  std::function<void(double fraction)> report;  ///< receives the fraction done, 0 to 1; may be empty

  /// Reports the fraction done. Throws Stopped if the stop token is set.
  void at(double fraction) const {
    if (stop.stop_requested()) throw Stopped("stopped before the work was done");
    if (report) report(fraction);
  }
};

}  // namespace octotomy::voxel
