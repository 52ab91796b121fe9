#pragma once

#include <nlohmann/json_fwd.hpp>
#include <opencv2/core.hpp>
#include <string>
#include <string_view>
#include <vector>

namespace stillpoint {

// Pieces of a page that needs nothing but itself: no links, pictures within.

/// Text fit to stand in HTML, in an attribute too.
[[nodiscard]] std::string escaped(std::string_view text);

/// RFC 4648, with padding.
[[nodiscard]] std::string base64(const std::vector<unsigned char>& bytes);

enum class Packing {
  kExact,  ///< PNG: plots, text
  kSmall,  ///< JPEG: camera images
};

/// A figure with its picture in it. @param caption shown below, and read out for the picture
[[nodiscard]] std::string figure_html(const cv::Mat& picture, std::string_view caption,
                                      Packing packing = Packing::kExact);

/// The same with a picture that is packed already. @param png the file's bytes
[[nodiscard]] std::string figure_html_of_png(std::string_view png, std::string_view caption);

/// A cell of a table.
struct HtmlCell {
  std::string text;     ///< not escaped yet
  bool number = false;  ///< aligned right
  bool best = false;    ///< of its column: marked, and not by colour alone
  std::string link{};   ///< where in the page it leads to, an id; empty: nowhere
};

/// A table that scrolls sideways where it is too wide. @param header not escaped yet
[[nodiscard]] std::string table_html(const std::vector<std::string>& header,
                                     const std::vector<std::vector<HtmlCell>>& rows);

/// JSON fit to stand in a script element: no text in it, of whatever bytes, ends that.
[[nodiscard]] std::string script_json(const nlohmann::ordered_json& json);

/// The whole page about `body`. @param style after the page's own
[[nodiscard]] std::string page_html(std::string_view title, std::string_view body,
                                    std::string_view style = {});

}  // namespace stillpoint
