// SPDX-License-Identifier: AGPL-3.0-or-later
#include "voxel/dicom_values.h"

#include <cstdio>
#include <cstring>

namespace octotomy::voxel {

std::string dicom_decimal(double number) {
  char text[40];
  for (int digits = 17; digits > 0; --digits) {
    std::snprintf(text, sizeof text, "%.*g", digits, number);
    if (std::strlen(text) <= 16) break;
  }
  return text;
}

std::string dicom_decimals(const glm::dvec3& p) {
  return dicom_decimal(p.x) + "\\" + dicom_decimal(p.y) + "\\" + dicom_decimal(p.z);
}

void DicomDigest::add(const void* bytes, std::size_t count) {
  constexpr std::uint64_t prime = 0x100000001b3;
  const auto* byte = static_cast<const unsigned char*>(bytes);
  for (std::size_t i = 0; i < count; ++i) {
    high_ = (high_ ^ byte[i]) * prime;
    low_ = (low_ ^ byte[i]) * prime;
    low_ ^= low_ >> 29;  // sets the second sum apart from the first
  }
}

std::string DicomDigest::uid() const {
  __extension__ using Wide = unsigned __int128;
  const std::uint64_t high = (high_ & ~std::uint64_t{0xf000}) | 0x8000;
  const std::uint64_t low = (low_ & ~(std::uint64_t{3} << 62)) | (std::uint64_t{2} << 62);
  std::string digits;
  for (Wide rest = (Wide{high} << 64) | low; rest != 0; rest /= 10)
    digits.insert(digits.begin(), static_cast<char>('0' + static_cast<int>(rest % 10)));
  return "2.25." + digits;
}

std::string DicomDigest::uid(const std::string& of) const {
  DicomDigest with = *this;
  with.add(of);
  return with.uid();
}

}  // namespace octotomy::voxel
