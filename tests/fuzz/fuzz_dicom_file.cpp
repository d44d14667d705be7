// SPDX-License-Identifier: AGPL-3.0-or-later
// Any bytes are a DICOM file's attributes or are refused with std::runtime_error; what is read lies within
// them. The first byte of an input says how the rest is given: whole, as the beginning of a longer file, or
// as inflated already.
#include <cstdint>
#include <cstdlib>
#include <stdexcept>
#include <string_view>

#include "voxel/dicom/dicom_file.h"

namespace {

using octotomy::voxel::DicomExtent;
using octotomy::voxel::DicomFile;
using octotomy::voxel::DicomTag;

void need(bool holds) {
  if (!holds) std::abort();
}

/// Reads everything that a slice's reader reads, in sequences as well.
void ask(const DicomFile& file, std::size_t file_bytes, int depth) {
  for (const DicomTag tag : {0x00080005u, 0x00080008u, 0x00080060u, 0x0008103eu, 0x00281054u})
    need(file.readable_text(tag).size() <= 3 * file_bytes);
  for (const DicomTag tag : {0x00200032u, 0x00200037u, 0x00280030u, 0x00281052u, 0x00281053u})
    if (const auto numbers = file.decimals(tag)) need(!numbers->empty());
  for (const DicomTag tag : {0x00280010u, 0x00280011u, 0x00280100u}) file.unsigned_short(tag);
  const auto within = [&](const DicomExtent& extent) {
    return extent.at <= file_bytes && extent.length <= file_bytes - extent.at;
  };
  if (file.raw_pixels()) need(within(*file.raw_pixels()));
  if (file.fragments())
    for (const DicomExtent& fragment : *file.fragments()) need(within(fragment));
  if (depth > 3) return;
  for (const DicomTag tag : {0x52009229u, 0x52009230u, 0x00209113u, 0x00209116u, 0x00289110u, 0x00289145u})
    for (const DicomFile& item : file.items(tag)) ask(item, file_bytes, depth + 1);
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  if (size < 1) return 0;
  const std::string_view bytes(reinterpret_cast<const char*>(data) + 1, size - 1);
  const std::size_t file_bytes = data[0] % 3 == 1 ? bytes.size() + 100'000 : bytes.size();
  try {
    DicomFile::begins(bytes);
    ask(DicomFile(bytes, file_bytes, data[0] % 3 == 2), file_bytes, 0);
  } catch (const std::runtime_error&) {
    return 0;
  } catch (const DicomFile::Deflated& from) {
    need(from.at <= bytes.size());
  } catch (const DicomFile::NeedsMore&) {
    need(file_bytes > bytes.size());
  }
  return 0;
}
