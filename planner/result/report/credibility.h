// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <nlohmann/json.hpp>
#include <string>

namespace octotomy::planner {

/// Lists which checks of a run support which of its numbers, in the terms of ASME V&V 40-2018. Uses only
/// result_json(). A check that the run has not made is a gap. Facts that only the user can state (the
/// question, the model's influence, the decision's consequence) are null. Keys of the result:
/// - context_of_use, question_of_interest, model_risk: a description of the run, and nulls for the user to
///   fill in.
/// - credibility_factors: the standard's thirteen factors, each with the run's evidence or the reason why
///   there is none.
/// - numbers: each measured number with `supported_by`, `contradicted_by` and `gaps`.
/// - unsupported: the count of numbers without support or with a contradiction.
nlohmann::ordered_json credibility_json(const nlohmann::ordered_json& result);

/// The credibility report as an HTML page.
std::string credibility_html(const nlohmann::ordered_json& credibility);

}  // namespace octotomy::planner
