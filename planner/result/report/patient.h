// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <nlohmann/json.hpp>
#include <string>

#include "planner/result/report/report.h"

namespace octotomy::planner {

/// {"name", "number", "issuer", "birth_date", "sex", "study_date"} of a scan for people: names as "Doe,
/// Jane", dates as "1970-01-31"; null for each that the scan does not state or states in no readable form.
/// Null where it states neither name nor number nor birth date.
nlohmann::ordered_json patient_json(const voxel::Identity& identity);

/// "Doe, Jane, number 17, born 1970-01-31, female, study of 2020-02-01": what is stated of it. Empty where
/// patient_json() is null.
std::string patient_text(const voxel::Identity& identity);

/// The patients of all scans that were read, for the head of a report: one line for each that differs, with
/// the scans' names where there are several. Says so where no scan states its patient.
std::vector<std::string> patient_lines(const Evaluation& evaluation);

/// Takes the patients out of a result: their identities, and their names, numbers and birth dates where an
/// audit or a finding quotes them ('17'). A line that compares the identities of files loses its whole detail,
/// because it quotes files that the result does not keep. File names stay as they are.
void leave_out_patients(Result& result);

}  // namespace octotomy::planner
