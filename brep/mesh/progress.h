// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <functional>
#include <stop_token>

#include "brep/mesh/error.h"

namespace octotomy::brep {

/// Reports progress of long work and stops it. Only the working function's own thread calls it.
struct Progress {
  std::stop_token stop = {};
  std::function<void(double fraction)> report = {};  ///< is called with 0 to 1; may be empty

  /// Reports the fraction done. Throws Stopped if a stop is requested.
  void at(double fraction) const {
    if (stop.stop_requested()) throw Stopped("stopped before the work was done");
    if (report) report(fraction);
  }
};

}  // namespace octotomy::brep
