// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <nlohmann/json.hpp>
#include <string>

#include "planner/result/report/report.h"

namespace octotomy::planner {

/// A scan's facts about its patient: {"name", "number", "issuer", "birth_date", "sex", "study_date"}, in
/// readable form, with names such as "Doe, Jane" and dates such as "1970-01-31". A value that is not stated
/// or not readable is null. Null if the scan states neither name nor number nor birth date.
nlohmann::ordered_json patient_json(const voxel::Identity& identity);

/// patient_json() as a line, such as "Doe, Jane, number 17, born 1970-01-31, female, study of 2020-02-01".
/// Leaves out values that are not stated; empty if patient_json() is null.
std::string patient_text(const voxel::Identity& identity);

/// Lines on the patients of all scans, for the head of a report: one for each different patient, with the
/// scans' names if there are several scans. A single line states it if no scan names its patient.
std::vector<std::string> patient_lines(const Evaluation& evaluation);

/// Removes the patients from a result: their identities, and their names, numbers and birth dates where
/// audits or findings quote them. The detail of a finding that compares identities is removed completely,
/// because it quotes files that the result does not store. Names of files stay.
void leave_out_patients(Result& result);

/// The text of a plan without its name, the paths of its scans and its signatures. Adds a line for each
/// removed attribute to `changes`. The names of steps stay.
std::string plan_without_names(const std::string& text, std::vector<std::string>& changes);

/// Removes from an evaluated result everything that may name a person. In addition to leave_out_patients(),
/// these are the paths of scans, also in the plan's text, the plan's name, its signatures, and the details of
/// the scans' audits, which quote files. Returns a line for each thing that was removed. The names of steps
/// stay.
std::vector<std::string> leave_out_names(Result& result);
/// Whether leave_out_names() was applied.
bool names_nobody(const Result& result);

}  // namespace octotomy::planner
