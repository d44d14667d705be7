// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <functional>
#include <string>

#include "tests/voxel/scan/dicom_bytes.h"

namespace octotomy::tests {

/// An enhanced CT in one file, of which frame k is a ramp: sample = 100 k + 10 y + x, stored with an
/// intercept.
struct DicomFrames {
  int count = 5;
  int columns = 4, rows = 3;
  bool open = false;             ///< sequences without lengths
  bool reversed = false;         ///< the last frame lies lowest
  bool own_orientation = false;  ///< in every frame's groups instead of the shared ones
  std::string image_type = "ORIGINAL\\PRIMARY";
  std::function<int(int)> place_of = {};     ///< frame to place along z; without it each frame has its own
  std::function<std::string(int)> own = {};  ///< more attributes of a frame's groups

  std::string position(int k) const {
    return "-10\\-20\\" + std::to_string(30 + 2 * (place_of ? place_of(k) : reversed ? count - 1 - k : k));
  }
  std::string attributes() const {
    const bool o = open;
    const auto seq = [&](std::uint32_t at, const std::string& inner) {
      return DicomBytes::sequence(at, DicomBytes::item(inner, o), o);
    };
    const std::string orientation =
        seq(0x00209116, DicomBytes::element(0x00200037, "DS", "1\\0\\0\\0\\1\\0"));
    std::string shared = own_orientation ? "" : orientation;
    shared += seq(0x00289110, DicomBytes::element(0x00180050, "DS", "2") +
                                  DicomBytes::element(0x00280030, "DS", "0.5\\0.25"));
    shared += seq(0x00289145, DicomBytes::element(0x00281052, "DS", "-1000") +
                                  DicomBytes::element(0x00281053, "DS", "1") +
                                  DicomBytes::element(0x00281054, "LO", "HU"));
    std::string frames, pixels;
    for (int k = 0; k < count; ++k) {
      frames += DicomBytes::item(seq(0x00209113, DicomBytes::element(0x00200032, "DS", position(k))) +
                                     (own_orientation ? orientation : "") + (own ? own(k) : ""),
                                 o);
      for (int y = 0; y < rows; ++y)
        for (int x = 0; x < columns; ++x)
          pixels += DicomBytes::number(static_cast<std::uint32_t>(100 * k + 10 * y + x), 2);
    }
    return DicomBytes::element(0x00080008, "CS", image_type) +
           DicomBytes::element(0x00080018, "UI", "1.2.3.4") + DicomBytes::element(0x00080060, "CS", "CT") +
           DicomBytes::element(0x0020000e, "UI", "1.2.3") + DicomBytes::us(0x00280002, 1) +
           DicomBytes::element(0x00280004, "CS", "MONOCHROME2") +
           DicomBytes::element(0x00280008, "IS", std::to_string(count)) +
           DicomBytes::us(0x00280010, static_cast<std::uint16_t>(rows)) +
           DicomBytes::us(0x00280011, static_cast<std::uint16_t>(columns)) + DicomBytes::us(0x00280100, 16) +
           DicomBytes::us(0x00280101, 16) + DicomBytes::us(0x00280102, 15) + DicomBytes::us(0x00280103, 1) +
           DicomBytes::sequence(0x52009229, DicomBytes::item(shared, o), o) +
           DicomBytes::sequence(0x52009230, frames, o) + DicomBytes::element(0x7fe00010, "OW", pixels);
  }
};

}  // namespace octotomy::tests
