#include "core/run/condition_words.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <charconv>
#include <cmath>

#include "core/text_file.hpp"

namespace stillpoint::condition_words {
namespace {

constexpr std::size_t kMaxLength = 2000;  // letters of a condition

bool begins_name(char c) { return std::isalpha(static_cast<unsigned char>(c)) != 0 || c == '_'; }
bool in_name(char c) { return std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '_' || c == '.'; }

Token number_at(std::string_view text, std::size_t at) {
  Token token{Kind::number, {}, static_cast<int>(at), 0.0};
  const auto [end, error] = std::from_chars(text.data() + at, text.data() + text.size(), token.number);
  if (error != std::errc() || !std::isfinite(token.number)) fail(token.column, "a number that is too large");
  token.text = text.substr(at, static_cast<std::size_t>(end - (text.data() + at)));
  return token;
}

}  // namespace

void fail(int column, const std::string& why) {
  throw ConditionError(fmt::format("column {}: {}", column + 1, why), column);
}

std::vector<Token> tokens_of(std::string_view text) {
  if (text.size() > kMaxLength)
    fail(kMaxLength, fmt::format("a condition has at most {} letters", kMaxLength));
  std::vector<Token> tokens;
  for (std::size_t at = 0; at < text.size();) {
    const char c = text[at];
    if (std::isspace(static_cast<unsigned char>(c)) != 0) {
      ++at;
      continue;
    }
    Token token{Kind::symbol, text.substr(at, 1), static_cast<int>(at), 0.0};
    const bool point =
        c == '.' && at + 1 < text.size() && std::isdigit(static_cast<unsigned char>(text[at + 1])) != 0;
    if (std::isdigit(static_cast<unsigned char>(c)) != 0 || point) {
      token = number_at(text, at);
    } else if (begins_name(c)) {
      std::size_t end = at;
      while (end < text.size() && in_name(text[end])) ++end;
      token.kind = Kind::name;
      token.text = text.substr(at, end - at);
    } else {
      const std::string_view two = text.substr(at, 2);
      for (const std::string_view known : {"||", "&&", "<=", ">=", "==", "!="})
        if (two == known) token.text = two;
      if (token.text.size() == 1 && std::string_view("<>!+-*/(),%").find(c) == std::string_view::npos)
        fail(token.column, fmt::format("{} is not understood{}", in_quotes(token.text),
                                       c == '=' ? "; equal is written ==" : ""));
    }
    tokens.push_back(token);
    at += token.text.size();
  }
  tokens.push_back({Kind::end, {}, static_cast<int>(text.size()), 0.0});
  return tokens;
}

const std::vector<UnitName>& unit_names() {
  using enum FigureUnit;
  static const std::vector<UnitName> units = {
      {"m", metres, 1.0},  {"cm", metres, 0.01},      {"mm", metres, 0.001},       {"deg", degrees, 1.0},
      {"px", pixels, 1.0}, {"ms", milliseconds, 1.0}, {"s", milliseconds, 1000.0}, {"%", share, 0.01}};
  return units;
}

std::string_view nearest_name(std::string_view wrong, const std::vector<std::string_view>& names) {
  std::string_view best;
  std::size_t best_edits = std::max<std::size_t>(2, wrong.size() / 3) + 1;
  for (const std::string_view name : names) {
    std::vector<std::size_t> row(name.size() + 1);
    for (std::size_t i = 0; i < row.size(); ++i) row[i] = i;
    for (std::size_t i = 0; i < wrong.size(); ++i) {
      std::size_t corner = row[0];
      row[0] = i + 1;
      for (std::size_t j = 0; j < name.size(); ++j) {
        const std::size_t changed = corner + (wrong[i] != name[j] ? 1 : 0);
        corner = row[j + 1];
        row[j + 1] = std::min({changed, row[j] + 1, row[j + 1] + 1});
      }
    }
    if (row.back() < best_edits) {
      best_edits = row.back();
      best = name;
    }
  }
  return best;
}

}  // namespace stillpoint::condition_words
