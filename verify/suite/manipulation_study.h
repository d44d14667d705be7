// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include "verify/suite/representation_study.h"

namespace octotomy::verify {

/// Tables 7.2, 7.4, 7.6 and 7.7 of the thesis on its sphere and a box in place of its volume of interest, which was
/// drawn by hand. The thesis prints seconds of two computers; ours are counts of nodes, and whether operations in one
/// walk make the trees that operations one after the other make. Deterministic. Cost: a second of processor time.
RepresentationStudy manipulation_study();

}  // namespace octotomy::verify
