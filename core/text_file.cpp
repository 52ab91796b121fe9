#include "core/text_file.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cerrno>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <filesystem>
#include <fstream>

#include "core/error.hpp"

namespace stillpoint {
namespace {

constexpr std::string_view kBlanks = " \t\r\v\f";
constexpr std::string_view kSeparators = " \t,;";
constexpr std::string_view kSeparatorsBesideCommas = " \t;";

std::string_view without_comment(std::string_view text) {
  for (std::size_t at = text.find('#'); at != std::string_view::npos; at = text.find('#', at + 1))
    if (at == 0 || kBlanks.find(text[at - 1]) != std::string_view::npos) return text.substr(0, at);
  return text;
}

/// Without the quotes that spreadsheets put about cells.
std::string_view unquoted(std::string_view cell) {
  const bool quoted = cell.size() >= 2 && cell.front() == '"' && cell.back() == '"';
  return quoted ? cell.substr(1, cell.size() - 2) : cell;
}

std::vector<std::string_view> split(std::string_view text, std::string_view separators) {
  std::vector<std::string_view> columns;
  for (auto first = text.find_first_not_of(separators); first != std::string_view::npos;) {
    const auto end = std::min(text.find_first_of(separators, first), text.size());
    columns.push_back(unquoted(text.substr(first, end - first)));
    first = text.find_first_not_of(separators, end);
  }
  return columns;
}

/// Appends a code point in UTF-8.
void append_utf8(std::string& text, std::uint32_t code) {
  const auto put = [&text](std::uint32_t byte) { text += static_cast<char>(byte); };
  if (code < 0x80) return put(code);
  const int more = code < 0x800 ? 1 : code < 0x10000 ? 2 : 3;  // bytes after the first
  put((0xFF00U >> (more + 1) & 0xFFU) | code >> (6 * more));
  for (int i = more - 1; i >= 0; --i) put(0x80 | (code >> (6 * i) & 0x3F));
}

/// A text in UTF-16, as Windows' shells write it, in UTF-8. @param content without its byte order mark
std::string from_utf16(std::string_view content, bool big_endian) {
  const auto unit_at = [&](std::size_t at) {
    const auto byte = [&](std::size_t i) {
      return std::uint32_t{static_cast<unsigned char>(content[at + i])};
    };
    return big_endian ? byte(0) << 8 | byte(1) : byte(1) << 8 | byte(0);
  };
  std::string text;
  for (std::size_t at = 0; at + 1 < content.size(); at += 2) {
    std::uint32_t code = unit_at(at);
    const bool pair = code >= 0xD800 && code < 0xDC00 && at + 3 < content.size();
    if (pair) code = 0x10000 + ((code - 0xD800) << 10) + (unit_at(at += 2) - 0xDC00) % 0x400;
    append_utf8(text, code);
  }
  return text;
}

std::string_view trimmed(std::string_view text) {
  const auto first = text.find_first_not_of(kBlanks);
  if (first == std::string_view::npos) return {};
  return text.substr(first, text.find_last_not_of(kBlanks) - first + 1);
}

}  // namespace

std::string read_text(const std::string& path, std::size_t most) {
  std::error_code error;
  if (std::filesystem::is_directory(path, error))
    throw InputError(fmt::format("{}: a folder, where a text file was expected", path));
  errno = 0;
  std::ifstream file(path, std::ios::binary);
  if (!file)
    throw InputError(
        fmt::format("{}: cannot be read: {}", path, errno != 0 ? std::strerror(errno) : "unknown cause"));
  constexpr std::size_t kBlock = std::size_t{1} << 20;  // bytes
  std::string text;
  for (std::size_t size = 0; file; text.resize(size)) {
    if (size > most)
      throw InputError(fmt::format("{}: holds more than {} MB, expected a text file", path,
                                   most / (std::size_t{1} << 20)));
    text.resize(size + kBlock);
    file.read(text.data() + size, kBlock);
    size += static_cast<std::size_t>(file.gcount());
  }
  if (file.bad()) throw InputError(fmt::format("{}: cannot be read to its end", path));
  return text;
}

std::vector<TextLine> text_lines(std::string_view content, std::vector<TextLine>* comments) {
  std::vector<TextLine> lines;
  std::string converted;
  if (content.starts_with("\xEF\xBB\xBF")) {
    content.remove_prefix(3);
  } else if (content.starts_with("\xFF\xFE") || content.starts_with("\xFE\xFF")) {
    converted = from_utf16(content.substr(2), content.starts_with("\xFE"));
    content = converted;
  }
  // A single CR ends lines where nothing else does; beside LF it is a blank.
  const char line_end = content.find('\n') == std::string_view::npos ? '\r' : '\n';
  for (int number = 1; !content.empty(); ++number) {
    const std::size_t end = std::min(content.find(line_end), content.size());
    const std::string_view whole = trimmed(content.substr(0, end));
    const std::string_view text = trimmed(without_comment(whole));
    if (!text.empty())
      lines.push_back({number, std::string(text)});
    else if (comments != nullptr && !whole.empty())
      comments->push_back({number, std::string(trimmed(whole.substr(1)))});
    content.remove_prefix(std::min(end + 1, content.size()));
  }
  return lines;
}

std::vector<TextLine> read_text_lines(const std::string& path, std::vector<TextLine>* comments) {
  return text_lines(read_text(path), comments);
}

std::vector<std::string_view> split_columns(std::string_view text) { return split(text, kSeparators); }

std::vector<std::string_view> split_decimal_comma_columns(std::string_view text) {
  const auto is_digit = [&](std::size_t at) {
    return at < text.size() && text[at] >= '0' && text[at] <= '9';
  };
  bool any = false;
  for (std::size_t at = text.find(','); at != std::string_view::npos; at = text.find(',', at + 1)) {
    if (at == 0 || !is_digit(at - 1) || !is_digit(at + 1)) return {};
    any = true;
  }
  if (!any || text.find('.') != std::string_view::npos) return {};
  std::vector<std::string_view> columns = split(text, kSeparatorsBesideCommas);
  for (const std::string_view column : columns)
    if (column.find(',') != column.rfind(',')) return {};
  return columns;
}

std::optional<double> parse_number(std::string_view text) {
  if (text.starts_with('+') && !text.starts_with("+-")) text.remove_prefix(1);
  double value = 0.0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc() || end != text.data() + text.size()) return std::nullopt;
  return value;
}

std::optional<double> parse_comma_number(std::string_view text) {
  std::string point(text);
  std::replace(point.begin(), point.end(), ',', '.');
  return parse_number(point);
}

bool is_stamp(double number) {
  constexpr double kMost = 1e19;    // ns as well stay below it until the year 2286
  return std::abs(number) < kMost;  // and so no NaN
}

std::string lower_case(std::string text) {
  std::transform(text.begin(), text.end(), text.begin(),
                 [](char c) { return c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c; });
  return text;
}

std::string printable(std::string name) {
  std::replace_if(
      name.begin(), name.end(), [](unsigned char c) { return c < 32 || c == 127; }, '?');
  return name;
}

std::string in_quotes(std::string_view text) {
  constexpr std::size_t kMost = 60;  // bytes: enough to find the place again, and the sentence stays readable
  std::string result = "'";
  for (const char c : text.substr(0, kMost)) {
    const auto code = static_cast<unsigned char>(c);
    result += code < 32 || code == 127 ? '?' : c;
  }
  return result + (text.size() > kMost ? "…'" : "'");
}

}  // namespace stillpoint
