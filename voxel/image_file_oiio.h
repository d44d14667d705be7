// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <cstdint>
#include <string>
#include <vector>

/// What octotomy_image_io.so offers under the name "octotomy_encode_image". Fills `encoded`, or `error` with
/// the reason and returns false. No exception crosses the library's boundary.
extern "C" bool octotomy_encode_image(const char* format, int width, int height, const std::uint8_t* rgb,
                                      std::vector<std::uint8_t>* encoded, std::string* error);
