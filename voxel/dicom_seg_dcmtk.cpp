// SPDX-License-Identifier: AGPL-3.0-or-later
//
// The one unit that includes DCMTK. A binary segmentation with one segment (DICOM PS3.3, A.51): patient and
// study of the source, one frame a plane, dimensions segment and position.
#include "voxel/dicom_seg_dcmtk.h"

#include <algorithm>
#include <dcmtk/config/osconfig.h>
#include <dcmtk/dcmdata/dctk.h>
#include <dcmtk/dcmfg/fgderimg.h>
#include <dcmtk/dcmfg/fgfracon.h>
#include <dcmtk/dcmfg/fgpixmsr.h>
#include <dcmtk/dcmfg/fgplanor.h>
#include <dcmtk/dcmfg/fgplanpo.h>
#include <dcmtk/dcmfg/fgseg.h>
#include <dcmtk/dcmiod/iodreferences.h>
#include <dcmtk/dcmseg/segdoc.h>
#include <dcmtk/dcmseg/segment.h>
#include <dcmtk/oflog/oflog.h>
#include <memory>
#include <set>
#include <stdexcept>

#include "voxel/dicom_values.h"

namespace {

using octotomy::voxel::dicom_decimal;
using octotomy::voxel::DicomSource;
using octotomy::voxel::SegmentFile;

// Dates of their own would break byte equality.
constexpr const char* no_date = "20000101";
constexpr const char* no_time = "000000";

void need(const OFCondition& condition, const char* what) {
  if (condition.bad()) throw std::runtime_error(std::string(what) + ": " + condition.text());
}

OFString text(const std::string& value) {
  return {value.c_str(), value.size()};
}

OFString decimal(double value) {
  return text(dicom_decimal(value));
}

/// What DCMTK, which checks for ASCII, takes in a text's place until put_texts() has the last word.
OFString ascii(std::string value) {
  for (char& symbol : value)
    if (static_cast<unsigned char>(symbol) > 127) symbol = '?';
  return text(value);
}

std::unique_ptr<DcmSegmentation> new_segmentation(const SegmentFile& file) {
  const IODGeneralEquipmentModule::EquipmentInfo equipment("Octotomy", "octotomy", "0", OCTOTOMY_VERSION);
  ContentIdentificationMacro* content = nullptr;
  need(ContentIdentificationMacro::create("1", "OCTOTOMY", ascii(file.label), "Octotomy^Planner", content),
       "content");
  const std::unique_ptr<ContentIdentificationMacro> owned(content);
  DcmSegmentation* segmentation = nullptr;
  need(DcmSegmentation::createBinarySegmentation(segmentation, static_cast<Uint16>(file.size_px.y),
                                                 static_cast<Uint16>(file.size_px.x), equipment, *content),
       "segmentation");
  return std::unique_ptr<DcmSegmentation>(segmentation);
}

void add_segment(DcmSegmentation& segmentation, const SegmentFile& file) {
  // What the object is nobody says: SNOMED's tissue holds for all.
  const CodeSequenceMacro tissue("85756007", "SCT", "Tissue");
  DcmSegment* segment = nullptr;
  need(DcmSegment::create(segment, ascii(file.label), tissue, tissue, DcmSegTypes::SAT_SEMIAUTOMATIC,
                          "Octotomy"),
       "segment");
  Uint16 number = 0;
  need(segmentation.addSegment(segment, number), "segment");
}

void add_shared_groups(DcmSegmentation& segmentation, const SegmentFile& file) {
  FGPixelMeasures measures;
  need(measures.setPixelSpacing(decimal(file.spacing_mm.y) + "\\" + decimal(file.spacing_mm.x)), "spacing");
  need(measures.setSliceThickness(decimal(file.step_mm)), "thickness");
  need(measures.setSpacingBetweenSlices(decimal(file.step_mm)), "spacing");
  need(segmentation.addForAllFrames(measures), "pixel measures");
  const std::unique_ptr<FGPlaneOrientationPatient> orientation(FGPlaneOrientationPatient::createMinimal(
      decimal(file.along_row.x), decimal(file.along_row.y), decimal(file.along_row.z),
      decimal(file.along_column.x), decimal(file.along_column.y), decimal(file.along_column.z)));
  if (!orientation) throw std::runtime_error("orientation");
  need(segmentation.addForAllFrames(*orientation), "orientation");
}

void add_dimensions(DcmSegmentation& segmentation, const SegmentFile& file) {
  IODMultiframeDimensionModule& dimensions = segmentation.getDimensions();
  const OFString uid = text(file.dimensions_uid);
  need(dimensions.addDimensionIndex(DCM_ReferencedSegmentNumber, uid, DCM_SegmentIdentificationSequence,
                                    "Segment"),
       "dimensions");
  need(dimensions.addDimensionIndex(DCM_ImagePositionPatient, uid, DCM_PlanePositionSequence, "Position"),
       "dimensions");
}

OFVector<ImageSOPInstanceReferenceMacro> references_of(const std::vector<DicomSource::Image>& images) {
  OFVector<ImageSOPInstanceReferenceMacro> references;
  for (const DicomSource::Image& image : images) {
    ImageSOPInstanceReferenceMacro reference;
    need(reference.setReferencedSOPClassUID(text(image.class_uid)), "reference");
    need(reference.setReferencedSOPInstanceUID(text(image.instance_uid)), "reference");
    references.push_back(reference);
  }
  return references;
}

void add_frame(DcmSegmentation& segmentation, const SegmentFile& file, std::size_t i,
               std::vector<Uint8>& pixels) {
  const SegmentFile::Frame& frame = file.frames[i];
  const std::unique_ptr<FGPlanePosPatient> position(FGPlanePosPatient::createMinimal(
      decimal(frame.first_mm.x), decimal(frame.first_mm.y), decimal(frame.first_mm.z)));
  if (!position) throw std::runtime_error("position");
  FGFrameContent content;
  need(content.setStackID("1"), "stack");
  need(content.setInStackPositionNumber(static_cast<Uint32>(i + 1)), "stack");
  need(content.setDimensionIndexValues(1, 0), "dimensions");
  need(content.setDimensionIndexValues(static_cast<Uint32>(i + 1), 1), "dimensions");
  OFVector<FGBase*> groups;
  groups.push_back(position.get());
  groups.push_back(&content);
  std::unique_ptr<FGDerivationImage> derivation;
  if (!frame.images.empty()) {
    derivation.reset(
        DcmSegmentation::createDerivationImageFG(references_of(frame.images), "Segmented from the source"));
    if (!derivation) throw std::runtime_error("references to the source");
    groups.push_back(derivation.get());
  }
  file.fill(i, pixels.data());
  need(segmentation.addFrame(pixels.data(), 1, groups), "frame");
}

/// Patient, study and frame of reference, and the images that are referred to.
void add_origin(DcmSegmentation& segmentation, const SegmentFile& file) {
  DcmDataset origin;
  for (const auto& [tag, value] : file.attributes)
    need(origin.putAndInsertString(DcmTag(static_cast<Uint16>(tag >> 16), static_cast<Uint16>(tag & 0xffffu),
                                          DcmVR(value.vr.c_str())),
                                   value.value.c_str()),
         "attributes of the source");
  need(segmentation.importFromSourceImage(origin), "attributes of the source");
  need(segmentation.getSOPCommon().setSOPInstanceUID(text(file.instance_uid)), "identifier");
  need(segmentation.getSeries().setSeriesInstanceUID(text(file.series_uid)), "identifier");
  need(segmentation.getSeries().setSeriesNumber("1"), "series");
  need(segmentation.getSeries().setSeriesDescription(ascii(file.series_description)), "series");
  if (file.source_series_uid.empty()) return;
  const auto study = file.attributes.find(0x0020000d);
  IODReferences references;
  std::set<std::string> known;
  for (const SegmentFile::Frame& frame : file.frames)
    for (const DicomSource::Image& image : frame.images)
      if (known.insert(image.instance_uid).second)
        references.add(new IODImageReference("", text(study->second.value), text(file.source_series_uid),
                                             text(image.instance_uid), text(image.class_uid)));
  if (segmentation.getCommonInstanceReference().addReferences(references) != references.size())
    throw std::runtime_error("references to the source");
}

bool is_ascii(const std::string& value) {
  return std::all_of(value.begin(), value.end(), [](unsigned char symbol) { return symbol < 128; });
}

/// Texts beyond ASCII make the whole file UTF-8, what came from the source included.
void put_texts(DcmDataset& dataset, const SegmentFile& file) {
  if (is_ascii(file.label) && is_ascii(file.series_description)) return;
  need(dataset.convertToUTF8(), "character set");
  need(dataset.putAndInsertString(DCM_SpecificCharacterSet, "ISO_IR 192"), "character set");
  need(dataset.putAndInsertString(DCM_ContentDescription, file.label.c_str()), "label");
  need(dataset.putAndInsertString(DCM_SeriesDescription, file.series_description.c_str()), "series");
  DcmItem* segment = nullptr;
  need(dataset.findAndGetSequenceItem(DCM_SegmentSequence, segment, 0), "label");
  need(segment->putAndInsertString(DCM_SegmentLabel, file.label.c_str()), "label");
}

void write(const SegmentFile& file, const char* path) {
  const std::unique_ptr<DcmSegmentation> segmentation = new_segmentation(file);
  add_segment(*segmentation, file);
  add_shared_groups(*segmentation, file);
  add_dimensions(*segmentation, file);
  std::vector<Uint8> pixels(static_cast<std::size_t>(file.size_px.x) *
                            static_cast<std::size_t>(file.size_px.y));
  for (std::size_t i = 0; i < file.frames.size(); ++i) add_frame(*segmentation, file, i, pixels);
  add_origin(*segmentation, file);
  // DCMTK compares every frame's groups with every other's, which takes minutes; they are ours and sound.
  segmentation->setCheckFGOnWrite(OFFalse);
  segmentation->setCheckDimensionsOnWrite(OFFalse);
  DcmFileFormat whole;
  DcmDataset& dataset = *whole.getDataset();
  need(segmentation->writeDataset(dataset), "segmentation");
  put_texts(dataset, file);
  for (const DcmTagKey& date : {DCM_InstanceCreationDate, DCM_ContentDate, DCM_SeriesDate})
    if (dataset.tagExists(date)) need(dataset.putAndInsertString(date, no_date), "dates");
  for (const DcmTagKey& time : {DCM_InstanceCreationTime, DCM_ContentTime, DCM_SeriesTime})
    if (dataset.tagExists(time)) need(dataset.putAndInsertString(time, no_time), "times");
  need(whole.saveFile(path, EXS_LittleEndianExplicit), "file");
}

}  // namespace

extern "C" bool octotomy_write_dicom_seg(const SegmentFile* file, const char* path, std::string* error) {
  OFLog::configure(OFLogger::OFF_LOG_LEVEL);
  try {
    write(*file, path);
    return true;
  } catch (const std::exception& failure) {
    *error = failure.what();
  }
  return false;
}
