// SPDX-License-Identifier: AGPL-3.0-or-later
#include "voxel/archive/write_plan_objects.h"

#include <algorithm>
#include <set>

#include "voxel/dicom/character_set.h"
#include "voxel/scan/dicom_derived.h"
#include "voxel/space/error.h"
#include "voxel/space/staged_files.h"

namespace octotomy::voxel {
namespace {

namespace fs = std::filesystem;
using Items = std::vector<DicomAttributes>;

/// The attributes that all objects of a plan share. The frame of reference is left out, because documents and
/// pictures have none.
DicomAttributes object_of(const PlanObjects& plan, const std::optional<DicomSource>& source,
                          const DicomDigest& digest, const char* series, const char* description) {
  DicomOptions study{.series_description = description, .source = source};
  if (source) study.patient_name.clear();
  DicomAttributes file;
  put_study(file, study, digest, !is_ascii(plan.title));
  file.remove(0x00200052);
  file.remove(0x00201040);
  file.put(0x0020000e, "UI", digest.uid(series));
  file.put(0x00080023, "DA", "20000101");  // fixed, so that equal plans are written as equal bytes
  file.put(0x00080033, "TM", "000000");
  file.put(0x00080064, "CS", "WSD");  // made at a workstation
  file.put(0x00181020, "LO", OCTOTOMY_VERSION);
  return file;
}

/// The images of the source, one for each file.
std::vector<DicomSource::Image> source_files(const DicomSource& source) {
  std::vector<DicomSource::Image> images;
  std::set<std::string> known;
  for (const DicomSource::Image& image : source.images)
    if (known.insert(image.instance_uid).second) images.push_back(image);
  return images;
}

DicomAttributes plan_object(const PlanObjects& plan, const std::optional<DicomSource>& source,
                            const DicomDigest& digest) {
  DicomAttributes file = object_of(plan, source, digest, "plan series", "Octotomy, plan");
  file.put(0x00080016, "UI", "1.2.840.10008.5.1.4.1.1.104.2");
  file.put(0x00080018, "UI", digest.uid("plan"));
  file.put(0x00080060, "CS", "DOC");
  file.put(0x0008002a, "DT", "");
  file.put(0x00081090, "LO", "octotomy");
  file.put(0x00181000, "LO", "0");
  file.put(0x00200013, "IS", "1");
  file.put(0x00280301, "CS", "YES");  // the document may state the patient's name, as this file does
  file.put(0x00420010, "ST", plan.title);
  file.put_sequence(0x0040a043, {dicom_code("18776-5", "LN", "Plan of care note")});
  file.put(0x0040e001, "ST", plan.identifier);
  file.put(0x00420012, "LO", "text/XML");
  file.put(0x00420011, "OB", plan.document);
  file.put_longs(0x00420015, {static_cast<std::uint32_t>(plan.document.size())});
  if (!source) return file;
  Items instances;
  for (const DicomSource::Image& image : source_files(*source)) {
    instances.emplace_back();
    instances.back().put(0x00081150, "UI", image.class_uid);
    instances.back().put(0x00081155, "UI", image.instance_uid);
  }
  file.put_sequence(0x00420013, instances);
  return file;
}

DicomAttributes picture_object(const PlanObjects& plan, std::size_t index,
                               const std::optional<DicomSource>& source, const DicomDigest& digest) {
  const PlanPicture& picture = plan.pictures[index];
  const std::string number = std::to_string(index + 1);
  DicomAttributes file = object_of(plan, source, digest, "picture series", "Octotomy, pictures");
  file.put(0x00080008, "CS", "DERIVED\\SECONDARY");
  file.put(0x00080016, "UI", "1.2.840.10008.5.1.4.1.1.7");
  file.put(0x00080018, "UI", digest.uid("picture " + number));
  file.put(0x00080060, "CS", "OT");
  file.put(0x00082111, "ST", "View of a plan: " + picture.label);
  file.put(0x00200011, "IS", "2");
  file.put(0x00200013, "IS", number);
  file.put(0x00200020, "CS", "");
  file.put(0x00200060, "CS", "");
  file.put(0x00204000, "LT", picture.label);
  file.put_short(0x00280002, 3);
  file.put(0x00280004, "CS", "RGB");
  file.put_short(0x00280006, 0);
  file.put_short(0x00280010, static_cast<std::uint16_t>(picture.pixels.size_px.y));
  file.put_short(0x00280011, static_cast<std::uint16_t>(picture.pixels.size_px.x));
  file.put_short(0x00280100, 8);
  file.put_short(0x00280101, 8);
  file.put_short(0x00280102, 7);
  file.put_short(0x00280103, 0);
  file.put(0x00280301, "CS", "NO");
  file.put(0x00282110, "CS", "00");
  file.put(0x7fe00010, "OB", std::string(picture.pixels.rgb.begin(), picture.pixels.rgb.end()));
  if (source) put_source_images(file, source_files(*source));
  return file;
}

}  // namespace

std::vector<fs::path> write_plan_objects(const PlanObjects& plan, const fs::path& folder,
                                         const std::optional<DicomSource>& source) {
  check_dicom_text(plan.title, "title");
  if (plan.title.empty() || plan.document.empty())
    throw InvalidInput("a plan's title and document must not be empty");
  DicomDigest digest;
  digest.add(plan.title);
  digest.add(plan.document);
  if (source) digest.add(source->series_uid);
  for (const PlanPicture& picture : plan.pictures) {
    check_dicom_text(picture.label, "a picture's label");
    digest.add(picture.label);
    digest.add(picture.pixels.rgb.data(), picture.pixels.rgb.size());
  }
  StagedFiles staging(folder);
  std::vector<fs::path> names{"plan.dcm"};
  write_dicom_file(staging.folder() / names.front(), folder / names.front(),
                   plan_object(plan, source, digest));
  for (std::size_t i = 0; i < plan.pictures.size(); ++i) {
    const std::string number = std::to_string(i + 1);
    const std::string name =
        "picture_" + std::string(3 - std::min<std::size_t>(3, number.size()), '0') + number + ".dcm";
    names.emplace_back(name);
    write_dicom_file(staging.folder() / name, folder / name, picture_object(plan, i, source, digest));
  }
  staging.commit();
  return names;
}

}  // namespace octotomy::voxel
