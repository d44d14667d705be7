// SPDX-License-Identifier: AGPL-3.0-or-later
#include "planner/cohort/group_page.h"

#include "planner/report/html.h"
#include "planner/table/number_format.h"

namespace octotomy::planner {
namespace {

std::string figure(const nlohmann::ordered_json& summary, const char* key) {
  return figure_cell(plain(summary[key].get<double>()));
}

std::string numbers_table(const GroupPage& page) {
  std::string rows =
      "<tr><th>Number</th><th>Unit</th><th>Subjects</th><th>Mean</th><th>SD</th><th>Least</th><th>Median</th>"
      "<th>Greatest</th><th>Outliers</th></tr>";
  for (const GroupColumn& column : page.columns) {
    const auto& told = column.summary;
    rows += "<tr>" + cell(escaped(column.name)) + cell(escaped(column.unit)) +
            figure_cell(std::to_string(told["subjects"].get<std::size_t>())) + figure(told, "mean") +
            figure(told, "sd") + figure(told, "least") + figure(told, "median") + figure(told, "greatest") +
            figure_cell(std::to_string(column.outliers.size())) + "</tr>";
  }
  return "<table>" + rows + "</table>";
}

std::string picture(const GroupPage::Shown& subject) {
  const std::string source = "../sub-" + subject.label;
  const std::string image = subject.has_picture
                                ? "<img loading='lazy' width='160' height='160' src='" + source +
                                      "/picture.png' alt='Subject " + escaped(subject.label) + "'>"
                                : "<span class='none'>no picture</span>";
  return "<figure id='" + escaped(subject.label) + "'>" + image + "<figcaption>" + escaped(subject.label) +
         (subject.reason.empty() ? "" : ": " + escaped(subject.reason)) + "</figcaption></figure>";
}

std::string outliers_of(const GroupPage& page) {
  std::string text;
  for (const GroupColumn& column : page.columns)
    for (const auto& [subject, value] : column.outliers) {
      const std::string& label = page.subjects[subject].label;
      text += "<li><a href='#" + escaped(label) + "'>" + escaped(label) + "</a>: " + escaped(column.name) +
              " " + plain(value) + " " + escaped(column.unit) + "</li>";
    }
  return text.empty()
             ? "<p>None: no number lies more than 3.5 robust standard deviations from its median.</p>"
             : "<ul>" + text + "</ul>";
}

}  // namespace

std::string group_page(const GroupPage& page) {
  std::size_t done = 0;
  std::string missing, pictures, plots;
  for (const GroupPage::Shown& subject : page.subjects) {
    if (subject.reason.empty())
      ++done;
    else
      missing += "<li>" + escaped(subject.label) + ": " + escaped(subject.reason) + "</li>";
    pictures += picture(subject);
  }
  for (const GroupColumn& column : page.columns)
    for (const auto& [kind, svg] : column.plots) plots += "<div class='plot'>" + svg + "</div>";
  std::string body =
      "<style>.plots,.subjects{display:flex;flex-wrap:wrap;gap:14px}.plot{flex:1 1 380px;max-width:520px}"
      "figure{margin:0;width:160px;overflow-wrap:anywhere}.none{display:inline-block;width:160px;height:"
      "160px;"
      "line-height:160px;text-align:center;outline:1px dashed}</style>";
  body += element("h1", "Cohort of " + std::to_string(page.subjects.size()) + " subjects");
  body += element("p", std::to_string(done) + " have an answer, " +
                           std::to_string(page.subjects.size() - done) + " have none.");
  if (!missing.empty()) body += element("h2", "Without an answer") + element("ul", missing);
  body += element("h2", "Numbers") + numbers_table(page);
  body += element("h2", "Outliers") + outliers_of(page);
  body += element("h2", "Plots") + "<div class='plots'>" + plots + "</div>";
  body += element("h2", "Subjects") + "<div class='subjects'>" + pictures + "</div>";
  return html_page("Cohort", body);
}

}  // namespace octotomy::planner
