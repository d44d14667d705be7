// SPDX-License-Identifier: AGPL-3.0-or-later
#include "voxel/archive/write_dicom_document.h"

#include <set>
#include <stdexcept>

#include "voxel/dicom/character_set.h"
#include "voxel/scan/dicom_derived.h"
#include "voxel/space/error.h"
#include "voxel/space/staged_files.h"

namespace octotomy::voxel {
namespace {

namespace fs = std::filesystem;
using Items = std::vector<DicomAttributes>;

struct Storage {
  const char* class_uid;
  const char* media_type;
  const char* modality;
};

Storage storage_of(DocumentFormat format) {
  switch (format) {
    case DocumentFormat::Stl:
      return {"1.2.840.10008.5.1.4.1.1.104.3", "model/stl", "M3D"};
    case DocumentFormat::Obj:
      return {"1.2.840.10008.5.1.4.1.1.104.4", "model/obj", "M3D"};
    case DocumentFormat::Pdf:
      break;
  }
  return {"1.2.840.10008.5.1.4.1.1.104.1", "application/pdf", "DOC"};
}

bool is_surface(DocumentFormat format) {
  return format != DocumentFormat::Pdf;
}

/// The images of the source, one item for each file.
std::vector<DicomSource::Image> files_of(const DicomSource& source) {
  std::vector<DicomSource::Image> images;
  std::set<std::string> known;
  for (const DicomSource::Image& image : source.images)
    if (known.insert(image.instance_uid).second) images.push_back(image);
  return images;
}

void put_document(DicomAttributes& file, const std::string& bytes, DocumentFormat format,
                  const DicomDocumentOptions& options) {
  file.put(0x00080023, "DA", "20000101");
  file.put(0x00080033, "TM", "000000");
  file.put(0x0008002a, "DT", "");
  file.put(0x00200013, "IS", "1");
  file.put(0x00280301, "CS",
           is_surface(format) ? "NO" : "YES");  // whether the document shows the patient's name
  file.put(0x00420010, "ST", options.label);
  file.put_sequence(0x0040a043,
                    is_surface(format) ? Items{dicom_code("85040-4", "LN", "CAD 3D model")} : Items{});
  file.put(0x00420012, "LO", storage_of(format).media_type);
  file.put(0x00420011, "OB", bytes);
  file.put_longs(0x00420015, {static_cast<std::uint32_t>(bytes.size())});
  if (!options.source) return;
  Items instances;
  for (const DicomSource::Image& image : files_of(*options.source)) {
    instances.emplace_back();
    instances.back().put(0x00081150, "UI", image.class_uid);
    instances.back().put(0x00081155, "UI", image.instance_uid);
  }
  file.put_sequence(0x00420013, instances);
  if (is_surface(format)) put_referenced_series(file, options.source->series_uid, files_of(*options.source));
}

}  // namespace

void write_dicom_document(const std::string& bytes, DocumentFormat format, const fs::path& path,
                          const DicomDocumentOptions& options) {
  if (bytes.empty()) throw std::invalid_argument("an encapsulated document must not be empty");
  check_dicom_text(options.label, "label");
  check_dicom_text(options.series_description, "series_description");
  if (options.label.empty() || options.series_description.empty())
    throw InvalidInput("a document's label and series_description must not be empty");
  if (bytes.size() > 0xfffffffe)
    throw Error(ErrorCode::Geometry, "the document takes more than DICOM's 4 GB: decimate a surface first");
  const Storage storage = storage_of(format);
  DicomDigest digest;
  digest.add(bytes);
  digest.add(options.label);
  digest.add(options.series_description);
  if (options.source) digest.add(options.source->series_uid);
  DicomAttributes file;
  DicomOptions study{.series_description = options.series_description, .source = options.source};
  if (study.source) study.patient_name.clear();
  put_study(file, study, digest, !is_ascii(options.label) || !is_ascii(options.series_description));
  file.put(0x00080016, "UI", storage.class_uid);
  file.put(0x00080018, "UI", digest.uid(is_surface(format) ? "model" : "document"));
  file.put(0x00080060, "CS", storage.modality);
  file.put(0x00081090, "LO", "octotomy");
  file.put(0x00181000, "LO", "0");
  file.put(0x00181020, "LO", OCTOTOMY_VERSION);
  put_document(file, bytes, format, options);
  if (is_surface(format)) {
    file.put_sequence(0x004008ea, {dicom_code("mm", "UCUM", "mm")});
  } else {
    file.put(0x00080064, "CS", "WSD");  // made at a workstation
    file.remove(0x00200052);            // a PDF has no frame of reference
    file.remove(0x00201040);
  }
  StagedFiles staging(path.parent_path());
  write_dicom_file(staging.folder() / path.filename(), path, file);
  staging.commit();
}

}  // namespace octotomy::voxel
