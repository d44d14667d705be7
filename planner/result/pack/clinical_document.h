// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "voxel/scan/dicom_source.h"

namespace octotomy::planner {

/// A document of HL7's Clinical Document Architecture.
struct ClinicalDocument {
  std::string text;        ///< XML
  std::string identifier;  ///< the UID in its <id>, computed from the content
};

/// A plan as a CDA document: a header that names the patient of `source`, and the plan's bytes in base64 with
/// their SHA-256, so that any reader of XML can unpack and check them. Without a source, or if its identity
/// was removed, the header states that the patient is masked. Times are "not applicable" (NA), so that equal
/// plans make equal documents. Source: HL7 CDA Release 2, nonXMLBody; LOINC 18776-5, plan of care note.
ClinicalDocument clinical_document(const std::string& plan, const std::string& title,
                                   const std::optional<voxel::DicomSource>& source);

/// The plan's bytes in such a document. Throws std::runtime_error, whose message has no path, if the document
/// contains no plan, or one whose SHA-256 differs from the stated one. Memory: a few times the document's
/// size.
std::string plan_in_document(std::string_view document);

}  // namespace octotomy::planner
