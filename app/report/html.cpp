#include "app/report/html.hpp"

#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "core/media/image_codec.hpp"

namespace stillpoint {
namespace {

constexpr int kJpegQuality = 88;  // of 100: text in pictures stays sharp

constexpr std::string_view kStyle = R"(
:root { color-scheme: light; }
* { box-sizing: border-box; }
body { margin: 0 auto; max-width: 1180px; padding: 28px 24px 60px; color: #1d2229; background: #fff;
       font: 15px/1.55 Inter, system-ui, "Segoe UI", "Helvetica Neue", Arial, sans-serif; }
h1 { font-size: 26px; line-height: 1.25; margin: 0 0 4px; }
h2 { font-size: 20px; margin: 40px 0 8px; padding-top: 14px; border-top: 1px solid #d9dde3; }
h3 { font-size: 16px; margin: 26px 0 6px; }
p { margin: 6px 0 10px; max-width: 86ch; }
.dim { color: #5b6572; }
nav { display: flex; flex-wrap: wrap; gap: 2px 16px; margin: 12px 0 0; overflow-wrap: anywhere; }
a { color: #00639c; }
.scroll { overflow-x: auto; margin: 10px 0 14px; }
table { border-collapse: collapse; font-size: 13.5px; line-height: 1.35; font-variant-numeric: tabular-nums; }
th, td { padding: 5px 10px; border-bottom: 1px solid #e4e7eb; text-align: left; vertical-align: top; }
th { background: #f4f6f8; font-weight: 600; vertical-align: bottom; }
td.number { text-align: right; white-space: nowrap; }
td.best { font-weight: 700; background: #eaf6f1; }
figure { margin: 10px 0; }
figure img { display: block; max-width: 100%; height: auto; border: 1px solid #d9dde3; border-radius: 4px; }
figcaption { color: #5b6572; font-size: 13px; margin-top: 4px; }
.grid { display: grid; grid-template-columns: repeat(auto-fit, minmax(380px, 1fr)); gap: 12px 16px; }
.grid figure { margin: 0; }
.bar { display: flex; height: 16px; min-width: 60px; border-radius: 3px; overflow: hidden; background: #eef0f3; }
.bar span { display: block; height: 100%; }
.key { display: inline-block; width: 11px; height: 11px; border-radius: 2px; margin: 0 5px 0 12px; }
.warning { background: #fff6e0; border-left: 4px solid #e69f00; padding: 6px 12px; }
details { margin: 8px 0; }
summary { cursor: pointer; }
pre { background: #f4f6f8; padding: 12px; border-radius: 4px; overflow-x: auto; font-size: 12.5px; line-height: 1.45; }
code { font-family: "JetBrains Mono", ui-monospace, Menlo, Consolas, monospace; font-size: 0.92em; }
@media print { body { max-width: none; padding: 0; } h2 { break-after: avoid; } figure { break-inside: avoid; } }
)";

}  // namespace

std::string escaped(std::string_view text) {
  std::string safe;
  safe.reserve(text.size());
  for (const char letter : text) {
    switch (letter) {
      case '&':
        safe += "&amp;";
        break;
      case '<':
        safe += "&lt;";
        break;
      case '>':
        safe += "&gt;";
        break;
      case '"':
        safe += "&quot;";
        break;
      case '\'':
        safe += "&#39;";
        break;
      default:
        safe += letter;
    }
  }
  return safe;
}

std::string base64(const std::vector<unsigned char>& bytes) {
  constexpr std::string_view kLetters = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string text;
  text.reserve((bytes.size() + 2) / 3 * 4);
  for (std::size_t at = 0; at < bytes.size(); at += 3) {
    const std::size_t there = std::min<std::size_t>(3, bytes.size() - at);
    unsigned value = 0;
    for (std::size_t i = 0; i < 3; ++i) value = value << 8U | (i < there ? bytes[at + i] : 0U);
    for (std::size_t i = 0; i < 4; ++i) text += i <= there ? kLetters[value >> (18U - 6U * i) & 63U] : '=';
  }
  return text;
}

std::string figure_html(const cv::Mat& picture, std::string_view caption, Packing packing) {
  const bool exact = packing == Packing::kExact;
  const std::vector<unsigned char> file = exact ? encode_png(picture, 8) : encode_jpeg(picture, kJpegQuality);
  return fmt::format(
      "<figure><img src=\"data:image/{};base64,{}\" width=\"{}\" height=\"{}\" alt=\"{}\">"
      "<figcaption>{}</figcaption></figure>\n",
      exact ? "png" : "jpeg", base64(file), picture.cols, picture.rows, escaped(caption), escaped(caption));
}

std::string figure_html_of_png(std::string_view png, std::string_view caption) {
  // The header's width and height, most significant byte first.
  const auto number_at = [&png](std::size_t at) {
    unsigned value = 0;
    for (std::size_t i = at; i < at + 4 && i < png.size(); ++i)
      value = value << 8U | static_cast<unsigned char>(png[i]);
    return value;
  };
  constexpr std::size_t kWidthAt = 16, kHeightAt = 20;  // bytes into a PNG: where IHDR has its sides
  return fmt::format(
      "<figure><img src=\"data:image/png;base64,{}\" width=\"{}\" height=\"{}\" alt=\"{}\">"
      "<figcaption>{}</figcaption></figure>\n",
      base64({png.begin(), png.end()}), number_at(kWidthAt), number_at(kHeightAt), escaped(caption),
      escaped(caption));
}

std::string table_html(const std::vector<std::string>& header,
                       const std::vector<std::vector<HtmlCell>>& rows) {
  std::string html = "<div class=\"scroll\"><table><thead><tr>";
  for (const std::string& name : header) html += fmt::format("<th>{}</th>", escaped(name));
  html += "</tr></thead><tbody>\n";
  for (const auto& row : rows) {
    html += "<tr>";
    for (const HtmlCell& cell : row) {
      const std::string text =
          cell.link.empty() ? escaped(cell.text)
                            : fmt::format("<a href=\"#{}\">{}</a>", escaped(cell.link), escaped(cell.text));
      html += fmt::format("<td class=\"{}{}\">{}{}</td>", cell.number ? "number" : "text",
                          cell.best ? " best" : "", text, cell.best ? " ✓" : "");
    }
    html += "</tr>\n";
  }
  return html + "</tbody></table></div>\n";
}

std::string script_json(const nlohmann::ordered_json& json) {
  using Errors = nlohmann::ordered_json::error_handler_t;
  const std::string text = json.dump(-1, ' ', true, Errors::replace);
  std::string safe;
  safe.reserve(text.size());
  // `<` is part of texts alone in JSON, and begins whatever a browser might take for markup.
  for (const char letter : text) {
    if (letter == '<')
      safe += "\\u003c";
    else
      safe += letter;
  }
  return safe;
}

std::string page_html(std::string_view title, std::string_view body, std::string_view style) {
  return fmt::format(
      "<!DOCTYPE html>\n<html lang=\"en\"><head><meta charset=\"utf-8\">\n"
      "<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n"
      "<title>{}</title><style>{}{}</style></head>\n<body>\n{}</body></html>\n",
      escaped(title), kStyle, style, body);
}

}  // namespace stillpoint
