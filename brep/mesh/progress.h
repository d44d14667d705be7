// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <functional>
#include <stop_token>

#include "brep/mesh/error.h"

namespace octotomy::brep {

/// Watches and stops long work. The working function's own thread calls it, no other.
struct Progress {
  std::stop_token stop = {};
  std::function<void(double fraction)> report = {};  ///< 0 to 1; may be empty

  /// Reports the fraction done. Throws Stopped if the stop token is set.
  void at(double fraction) const {
    if (stop.stop_requested()) throw Stopped("stopped before the work was done");
    if (report) report(fraction);
  }
};

}  // namespace octotomy::brep
