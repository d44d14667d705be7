// SPDX-License-Identifier: AGPL-3.0-or-later
#include "voxel/scan/dicom_derived.h"

#include "voxel/dicom/character_set.h"
#include "voxel/space/error.h"

namespace octotomy::voxel {
namespace {

std::vector<DicomAttributes> references(const std::vector<DicomSource::Image>& images) {
  std::vector<DicomAttributes> items(images.size());
  for (std::size_t i = 0; i < images.size(); ++i) {
    items[i].put(0x00081150, "UI", images[i].class_uid);
    items[i].put(0x00081155, "UI", images[i].instance_uid);
  }
  return items;
}

}  // namespace

void put_study(DicomAttributes& attributes, const DicomOptions& options, const DicomDigest& digest,
               bool in_utf8) {
  const auto own = [&](const char* value) { return options.source ? "" : value; };
  attributes.put(character_set_tag, "CS", "ISO_IR 192");
  attributes.put(0x00080020, "DA", own("20000101"));  // a fixed date, so that equal content is written as
                                                      // equal bytes
  attributes.put(0x00080030, "TM", own("000000"));
  attributes.put(0x00080050, "SH", "");
  attributes.put(0x00080070, "LO", "Octotomy");
  attributes.put(0x00080090, "PN", "");
  attributes.put(0x0008103e, "LO", options.series_description);
  attributes.put(0x00100010, "PN", options.patient_name);
  attributes.put(0x00100020, "LO", own("OCTOTOMY"));
  attributes.put(0x00100030, "DA", "");
  attributes.put(0x00100040, "CS", "");
  attributes.put(0x0020000d, "UI", digest.uid("study"));
  attributes.put(0x0020000e, "UI", digest.uid("series"));
  attributes.put(0x00200010, "SH", own("1"));
  attributes.put(0x00200011, "IS", "1");
  attributes.put(0x00200052, "UI", digest.uid("frame"));
  attributes.put(0x00201040, "LO", "");
  if (!options.source) return;
  const auto found = options.source->attributes.find(character_set_tag);
  const std::string character_set = found == options.source->attributes.end() ? "" : found->second.value;
  for (const auto& [tag, text] : options.source->attributes) {
    const DicomTag group = tag >> 16;
    if (group == 0x0018 || tag == 0x00200060) continue;  // attribute of the acquisition, not of the study
    if (tag == character_set_tag && in_utf8) continue;
    const std::optional<std::string> value = in_utf8 ? utf8_of(character_set, text.value) : text.value;
    if (!value)
      throw Error(ErrorCode::Input, "the source's texts in the character set '" + character_set +
                                        "' cannot be converted to UTF-8: choose a label in ASCII");
    attributes.put(tag, text.vr.c_str(), *value);
  }
  if (!options.source->attributes.contains(identity_removed_tag)) return;
  DicomAttributes profile(attributes.coding());
  profile.put(0x00080100, "SH", "113100");
  profile.put(0x00080102, "SH", "DCM");
  profile.put(0x00080104, "LO", "Basic Application Confidentiality Profile");
  attributes.put_sequence(0x00120064, {profile});
}

void put_source_images(DicomAttributes& attributes, const std::vector<DicomSource::Image>& images) {
  std::vector<DicomAttributes> items = references(images);
  for (DicomAttributes& item : items)
    item.put_sequence(0x0040a170,
                      {dicom_code("121322", "DCM", "Source image for image processing operation")});
  attributes.put_sequence(0x00082112, items);
}

void put_referenced_series(DicomAttributes& attributes, const std::string& series_uid,
                           const std::vector<DicomSource::Image>& images) {
  DicomAttributes series;
  series.put(0x0020000e, "UI", series_uid);
  series.put_sequence(0x0008114a, references(images));
  attributes.put_sequence(0x00081115, {series});
}

}  // namespace octotomy::voxel
