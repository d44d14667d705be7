// SPDX-License-Identifier: AGPL-3.0-or-later
#include "planner/result/pack/numpy_array.h"

#include <bit>
#include <stdexcept>

namespace octotomy::planner {
namespace {

static_assert(std::endian::native == std::endian::little);

/// The header is padded so that the values begin at a multiple of this number of bytes.
constexpr std::size_t alignment = 64;

template <typename Value>
std::string bytes_of(const std::vector<Value>& values, std::size_t columns, const std::string& type) {
  if (columns == 0 || values.size() % columns != 0)
    throw std::invalid_argument("numpy_array: the values do not fill whole rows");
  std::string text = "{'descr': '" + type + "', 'fortran_order': False, 'shape': (" +
                     std::to_string(values.size() / columns) + ", " + std::to_string(columns) + "), }";
  const std::string magic("\x93NUMPY\x01\x00", 8);
  const std::size_t unpadded = magic.size() + 2 + text.size() + 1;
  text.append((alignment - unpadded % alignment) % alignment, ' ');
  text += '\n';
  std::string bytes = magic;
  bytes += static_cast<char>(text.size() & 0xff);
  bytes += static_cast<char>(text.size() >> 8);
  bytes += text;
  bytes.append(reinterpret_cast<const char*>(values.data()), values.size() * sizeof(Value));
  return bytes;
}

}  // namespace

std::string numpy_array(const std::vector<double>& values, std::size_t columns) {
  return bytes_of(values, columns, "<f8");
}

std::string numpy_array(const std::vector<std::int32_t>& values, std::size_t columns) {
  return bytes_of(values, columns, "<i4");
}

}  // namespace octotomy::planner
