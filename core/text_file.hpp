#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace stillpoint {

/// A line that says something, and where it stands.
struct TextLine {
  int number = 0;    ///< from 1, as editors count
  std::string text;  ///< without comment, line end and surrounding blanks; never empty
};

/// The lines of a small text file. `#` at the start of a line or after a blank begins a comment; blank lines
/// are left out; LF, CRLF and CR line ends, a byte order mark, and UTF-16 with one are understood.
/// @param comments receives, where given, the lines that are nothing but a comment, without their `#`
/// @throws InputError when the file cannot be read.
[[nodiscard]] std::vector<TextLine> read_text_lines(const std::string& path,
                                                    std::vector<TextLine>* comments = nullptr);

/// The same of a text that is at hand already.
[[nodiscard]] std::vector<TextLine> text_lines(std::string_view text,
                                               std::vector<TextLine>* comments = nullptr);

/// A whole text file.
/// @param most bytes: devices have no end, and no list is as long as this
/// @throws InputError when it cannot be read, or holds more.
[[nodiscard]] std::string read_text(const std::string& path, std::size_t most = std::size_t{1} << 30);

/// The columns of a line, parted by blanks, tabs, commas or semicolons, without quotes about them.
[[nodiscard]] std::vector<std::string_view> split_columns(std::string_view text);

/// The columns of a line of numbers with decimal commas, parted by blanks, tabs or semicolons. Nothing when
/// a comma parts columns there, or none is in the line.
[[nodiscard]] std::vector<std::string_view> split_decimal_comma_columns(std::string_view text);

/// parse_number of a text with a comma for the decimal point.
[[nodiscard]] std::optional<double> parse_comma_number(std::string_view text);

/// The whole text as a number written in the C manner, whatever the locale is; nothing when it is not one.
/// May be NaN or infinite.
[[nodiscard]] std::optional<double> parse_number(std::string_view text);

/// Whether a number can be a stamp, in whatever unit: those of today have 19 digits in nanoseconds.
[[nodiscard]] bool is_stamp(double number);

/// With the letters A to Z made small.
[[nodiscard]] std::string lower_case(std::string text);

/// A foreign name without control characters, which become '?', so that a message that holds it stays one
/// line.
[[nodiscard]] std::string printable(std::string name);

/// A foreign text fit for an error message: in quotes, clipped, and without control characters.
[[nodiscard]] std::string in_quotes(std::string_view text);

}  // namespace stillpoint
