// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <filesystem>

namespace octotomy::bench {

/// Reads a DICOM folder by ITK's series reader, files sorted by GDCM. Returns a sample, so that none is
/// optimised away.
int read_series_by_itk(const std::filesystem::path& folder);

}  // namespace octotomy::bench
