// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <cstdint>
#include <glm/glm.hpp>
#include <string>

// Values as DICOM files hold them: what is written by the program's writers.

namespace octotomy::voxel {

/// A decimal string: the most digits that its 16 characters hold.
std::string dicom_decimal(double number);
std::string dicom_decimals(const glm::dvec3& p);

/// 128 bits that follow from what is put in, for unique identifiers that are the same for the same content:
/// two FNV-1a sums with different beginnings. Not for secrets.
class DicomDigest {
 public:
  void add(const void* bytes, std::size_t count);
  void add(const std::string& text) { add(text.data(), text.size() + 1); }

  /// An identifier of the form 2.25.<UUID as an integer>, a UUID of version 8 (RFC 9562).
  std::string uid() const;
  /// The same of what was put in and a text.
  std::string uid(const std::string& of) const;

 private:
  std::uint64_t high_ = 0xcbf29ce484222325;
  std::uint64_t low_ = 0x84222325cbf29ce4;
};

}  // namespace octotomy::voxel
