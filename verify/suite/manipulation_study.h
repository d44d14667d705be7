// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include "verify/suite/representation_study.h"

namespace octotomy::verify {

/// Recomputes tables 7.2, 7.4, 7.6 and 7.7 of the thesis for the thesis's sphere, with a box in place of the
/// hand-drawn volume of interest. The thesis prints seconds on two computers. The study counts nodes instead,
/// and tests whether combined operations make the same trees as single operations one after the other.
/// Deterministic. Cost: a second of processor time.
RepresentationStudy manipulation_study();

}  // namespace octotomy::verify
