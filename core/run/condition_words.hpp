#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "core/run/condition.hpp"

// The words that a condition's text is made of, before their order is looked at (condition.cpp).
namespace stillpoint::condition_words {

enum class Kind : std::uint8_t { number, name, symbol, end };

struct Token {
  Kind kind = Kind::end;
  std::string_view text;  ///< into the condition's
  int column = 0;         ///< from 0
  double number = 0.0;    ///< of a number
};

/// @throws ConditionError that points at a column
[[noreturn]] void fail(int column, const std::string& why);

/// All words in order, and an end.
/// @throws ConditionError for a letter that means nothing and for a text that is too long
[[nodiscard]] std::vector<Token> tokens_of(std::string_view text);

struct UnitName {
  std::string_view name;
  FigureUnit unit;
  double factor;  ///< a number in it times this is what FrameFigures has
};

/// All units a number may carry.
[[nodiscard]] const std::vector<UnitName>& unit_names();

/// The known name most like a wrong one: by the edits between them; empty when none is near.
[[nodiscard]] std::string_view nearest_name(std::string_view wrong,
                                            const std::vector<std::string_view>& names);

}  // namespace stillpoint::condition_words
