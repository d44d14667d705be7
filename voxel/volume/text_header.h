// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <cstddef>
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "voxel/volume/volume_header.h"

namespace octotomy::voxel {

/// The lines of a NRRD's or MetaImage's header.
struct TextHeader {
  /// Values of the fields by name, in lower case; NRRD's names without blanks.
  std::map<std::string, std::string> fields;
  std::map<std::string, std::string> keys;  ///< values of NRRD's key:=value pairs, by key in lower case
  std::vector<std::string> listed;          ///< the names of data files in the lines after LIST
  std::size_t end = 0;                      ///< offset of the samples that follow in the same file

  std::optional<std::string> field(const std::string& name) const;
  /// The numbers of a field, separated by blanks or commas; empty if the field is absent. Throws Error
  /// (Input) with `path` and the field if a word is not a number or there are not `count` numbers.
  std::vector<double> numbers(const std::filesystem::path& path, const std::string& name,
                              std::size_t count) const;
  /// numbers() for a field with one number.
  std::optional<double> number(const std::filesystem::path& path, const std::string& name) const;
};

/// Reads the header of a file. Throws Error (Input) with path and reason if the file is not a NRRD or
/// MetaImage, the header is longer than 4 MB, a line cannot be parsed, or a field occurs twice with different
/// values.
TextHeader read_text_header(const std::filesystem::path& path, VolumeFormat format);

/// The numbers in a text, separated by blanks or commas; none if a part is not a number. "nan" and "inf" are
/// numbers.
std::optional<std::vector<double>> numbers_in(const std::string& text);

/// The files that contain the samples: a single file, the files of a LIST, or the files of a pattern with
/// first number, last number and step ("slice%03d.raw 1 10 1"). Throws Error (Input) with the file that is
/// missing, or with the pattern if it does not have exactly one %d.
std::vector<std::filesystem::path> data_files(const std::filesystem::path& header,
                                              const std::string& statement,
                                              const std::vector<std::string>& listed);

}  // namespace octotomy::voxel
