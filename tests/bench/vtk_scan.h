// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <vtkImageImport.h>

#include "tests/bench/picture_plane.h"

namespace octotomy::bench {

/// Lets VTK read a scan's samples where they are; they must outlive the import.
inline void import_scan(const FlatScan& scan, vtkImageImport& import) {
  import.SetDataScalarTypeToShort();
  import.SetNumberOfScalarComponents(1);
  import.SetWholeExtent(0, scan.dims[0] - 1, 0, scan.dims[1] - 1, 0, scan.dims[2] - 1);
  import.SetDataExtentToWholeExtent();
  import.SetDataSpacing(scan.spacing_mm.data());
  import.SetDataOrigin(scan.first_mm.data());
  import.SetImportVoidPointer(const_cast<std::int16_t*>(scan.samples));
  import.Update();
}

}  // namespace octotomy::bench
