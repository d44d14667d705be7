// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <nlohmann/json.hpp>
#include <string>

#include "planner/result/report/report.h"

namespace octotomy::planner {

/// {"name", "number", "issuer", "birth_date", "sex", "study_date"} of a scan in readable form: names as "Doe,
/// Jane", dates as "1970-01-31"; null for each value that the scan does not state or that is not readable.
/// Null if it states neither name nor number nor birth date.
nlohmann::ordered_json patient_json(const voxel::Identity& identity);

/// "Doe, Jane, number 17, born 1970-01-31, female, study of 2020-02-01": as far as stated. Empty if
/// patient_json() is null.
std::string patient_text(const voxel::Identity& identity);

/// The patients of all scans that were read, for the head of a report: one line for each different patient,
/// with the scans' names if there are several. A line of its own if no scan states its patient.
std::vector<std::string> patient_lines(const Evaluation& evaluation);

/// Removes the patients from a result: their identities, and their names, numbers and birth dates quoted in
/// audits or findings ('17'). The detail of a line that compares the identities of files is removed
/// completely, because it quotes files that the result does not store. File names are unchanged.
void leave_out_patients(Result& result);

/// A plan's text without its name, the paths of its scans and its signatures; removed attributes are added to
/// `changes`. The names of its steps stay.
std::string plan_without_names(const std::string& text, std::vector<std::string>& changes);

/// Like leave_out_patients(), and removes everything else of an evaluated result that may name a person: the
/// paths of its scans, in the plan's text too, the plan's name, its readers' signatures, and the details of
/// the scans' audits, which quote files. Returns one line for each removed item. The names of the plan's
/// steps stay.
std::vector<std::string> leave_out_names(Result& result);
/// Whether leave_out_names() was applied.
bool names_nobody(const Result& result);

}  // namespace octotomy::planner
