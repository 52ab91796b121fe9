#include "app/report/live_page.hpp"

#include <nlohmann/json.hpp>

#include "app/report/embedded_report.hpp"
#include "app/report/html.hpp"

namespace stillpoint {

std::string live_markup() { return std::string(embedded_report("live.html")); }

std::string live_scripts(const nlohmann::ordered_json& data) {
  std::string html =
      "<script type=\"application/json\" id=\"report-data\">" + script_json(data) + "</script>\n<script>\n";
  html += "(() => {\n\"use strict\";\n";
  // One scope; what a file uses stands in those before it.
  for (const char* file : {"cursor.js", "canvas.js", "poses.js", "orbit.js", "paths.js", "plots.js",
                           "pictures.js", "table.js", "start.js"})
    html += embedded_report(file);
  return html + "})();\n</script>\n";
}

std::string live_style() { return std::string(embedded_report("live.css")); }

}  // namespace stillpoint
