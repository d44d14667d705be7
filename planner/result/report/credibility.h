// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <nlohmann/json.hpp>
#include <string>

namespace octotomy::planner {

/// Which of a run's own checks support which of its numbers, in the terms of ASME V&V 40-2018. Made of what
/// result_json() holds and of nothing else: a check that the run did not do is a gap, and what only people
/// can state (the question, the model's influence, the decision's consequence) is null. Keys:
///   context_of_use, question_of_interest, model_risk: what the run did, and nulls to be stated;
///   credibility_factors: each of the standard's thirteen, with the evidence of this run or why there is
///   none; numbers: each measured number with `supported_by`, `contradicted_by` and `gaps`; unsupported: the
///   count of numbers that nothing supports, or that something contradicts.
nlohmann::ordered_json credibility_json(const nlohmann::ordered_json& result);

/// The same as a page of HTML.
std::string credibility_html(const nlohmann::ordered_json& credibility);

}  // namespace octotomy::planner
