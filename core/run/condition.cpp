#include "core/run/condition.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <set>
#include <utility>

#include "core/median.hpp"
#include "core/run/condition_words.hpp"
#include "core/text_file.hpp"

namespace stillpoint {

/// Part of a condition, ready to be evaluated.
struct Condition::Node {
  FigureUnit unit = FigureUnit::plain;
  bool literal = false;  ///< a plain number, which takes the unit of what it stands beside
  int column = 0;
  std::function<double(const FrameFigures&, int row)> value;  ///< NaN where it is not known
};

namespace {

constexpr double kUnknownValue = std::numeric_limits<double>::quiet_NaN();

using Node = Condition::Node;
using NodePtr = std::shared_ptr<const Node>;
using enum FigureUnit;
using condition_words::fail, condition_words::Kind, condition_words::Token;

constexpr int kSpikeWindow = 60, kSpikeLeast = 8;  // frames: 2 s at 30 Hz; among fewer there is nothing usual
constexpr int kMaxDepth = 60;                      // of parentheses in each other

// ---- Units ----

std::string unit_text(const Node& node) {
  switch (node.unit) {
    case plain:
      return "a plain number";
    case truth:
      return "yes or no";
    case share:
      return "a share (%)";
    default:
      return "in " + std::string(to_string(node.unit));
  }
}

/// The unit of two values that are compared or added.
FigureUnit common_unit(const Node& a, const Node& b, const Token& between) {
  if (a.unit == b.unit) return a.unit;
  if (a.literal) return b.unit;
  if (b.literal) return a.unit;
  // A share is a plain number: half is 50 %.
  const auto unitless = [](const Node& node) { return node.unit == plain || node.unit == share; };
  if (unitless(a) && unitless(b)) return share;
  fail(between.column, fmt::format("left of {} stands a value that is {}, right of it one that is {}",
                                   in_quotes(between.text), unit_text(a), unit_text(b)));
}

// ---- Values ----

double spike(const Node& x, double sigmas, const FrameFigures& figures, int row) {
  const double now = x.value(figures, row);
  if (std::isnan(now)) return kUnknownValue;
  std::vector<double> before;
  for (int i = std::max(0, row - kSpikeWindow); i < row; ++i)
    if (const double value = x.value(figures, i); !std::isnan(value)) before.push_back(value);
  if (static_cast<int>(before.size()) < kSpikeLeast) return 0.0;
  const double middle = median_of(before);
  for (double& value : before) value = std::abs(value - middle);
  const double sigma = 1.4826 * median_of(before);  // of normally distributed values
  return std::abs(now - middle) > sigmas * sigma ? 1.0 : 0.0;
}

double compare(std::string_view symbol, double a, double b) {
  if (std::isnan(a) || std::isnan(b)) return kUnknownValue;
  const bool holds = symbol == "<"    ? a < b
                     : symbol == "<=" ? a <= b
                     : symbol == ">"  ? a > b
                     : symbol == ">=" ? a >= b
                     : symbol == "==" ? a == b
                                      : a != b;
  return holds ? 1.0 : 0.0;
}

bool is_true(double value) { return !std::isnan(value) && value != 0.0; }

// Three values, Kleene's logic: the opposite of what is not known is not known either, so that a condition
// over figures that nobody measured holds nowhere, however it is put.

double opposite(double a) { return std::isnan(a) ? kUnknownValue : a == 0.0 ? 1.0 : 0.0; }

double either_of(double a, double b) {
  if (is_true(a) || is_true(b)) return 1.0;
  return std::isnan(a) || std::isnan(b) ? kUnknownValue : 0.0;
}

double both_of(double a, double b) { return opposite(either_of(opposite(a), opposite(b))); }

// ---- Grammar ----

class Parser {
 public:
  explicit Parser(std::string_view text) : tokens_(condition_words::tokens_of(text)) {}

  NodePtr whole() {
    if (now().kind == Kind::end) fail(0, "there is no condition");
    NodePtr condition = either();
    if (now().kind != Kind::end) unexpected("&&, || or the end");
    return condition;
  }

  /// The figures named so far.
  [[nodiscard]] const std::set<int>& columns() const { return columns_; }

 private:
  [[nodiscard]] const Token& now() const { return tokens_[at_]; }
  bool is(std::string_view text) const { return now().kind != Kind::number && now().text == text; }
  bool take(std::string_view text) {
    if (now().kind == Kind::end || !is(text)) return false;
    ++at_;
    return true;
  }
  [[noreturn]] void unexpected(const std::string& wanted) const {
    fail(now().column, now().kind == Kind::end
                           ? fmt::format("it ends where {} is expected", wanted)
                           : fmt::format("{} stands where {} is expected", in_quotes(now().text), wanted));
  }
  void expect(std::string_view text, const std::string& meaning) {
    if (!take(text)) unexpected(meaning);
  }

  static NodePtr node(FigureUnit unit, int column, std::function<double(const FrameFigures&, int)> value) {
    return std::make_shared<const Node>(Node{unit, false, column, std::move(value)});
  }

  NodePtr either() {
    NodePtr left = both();
    for (int column = now().column; take("||") || take("or"); column = now().column)
      left = node(truth, column, [a = left, b = both()](const FrameFigures& f, int row) {
        return either_of(a->value(f, row), b->value(f, row));
      });
    return left;
  }

  NodePtr both() {
    NodePtr left = negation();
    for (int column = now().column; take("&&") || take("and"); column = now().column)
      left = node(truth, column, [a = left, b = negation()](const FrameFigures& f, int row) {
        return both_of(a->value(f, row), b->value(f, row));
      });
    return left;
  }

  NodePtr negation() {
    const int column = now().column;
    if (!take("!") && !take("not")) return comparison();
    const Deeper deeper(*this);
    return node(truth, column,
                [a = negation()](const FrameFigures& f, int row) { return opposite(a->value(f, row)); });
  }

  NodePtr comparison() {
    NodePtr left = sum();
    for (const std::string_view symbol : {"<=", ">=", "==", "!=", "<", ">"}) {
      const Token between = now();
      if (!take(symbol)) continue;
      const NodePtr right = sum();
      (void)common_unit(*left, *right, between);
      left = node(truth, between.column, [symbol, a = left, b = right](const FrameFigures& f, int row) {
        return compare(symbol, a->value(f, row), b->value(f, row));
      });
      break;
    }
    for (const std::string_view symbol : {"<=", ">=", "==", "!=", "<", ">"})
      if (is(symbol)) fail(now().column, "one comparison at a time; join two with &&");
    return left;
  }

  NodePtr sum() {
    NodePtr left = product();
    for (Token between = now(); take("+") || take("-"); between = now()) {
      const NodePtr right = product();
      const double sign = between.text == "-" ? -1.0 : 1.0;
      left = node(common_unit(*left, *right, between), between.column,
                  [sign, a = left, b = right](const FrameFigures& f, int row) {
                    return a->value(f, row) + sign * b->value(f, row);
                  });
    }
    return left;
  }

  NodePtr product() {
    NodePtr left = factor();
    for (Token between = now(); take("*") || take("/"); between = now()) {
      const NodePtr right = factor();
      const bool divides = between.text == "/";
      // A unit stays one only beside a plain number, and goes when divided by itself.
      FigureUnit unit = plain;
      if (right->unit == plain) unit = left->unit;
      if (!divides && left->unit == plain) unit = right->unit;
      left = node(unit, between.column, [divides, a = left, b = right](const FrameFigures& f, int row) {
        const double x = a->value(f, row), y = b->value(f, row);
        if (!divides) return x * y;
        return y == 0.0 ? kUnknownValue : x / y;
      });
    }
    return left;
  }

  NodePtr factor() {
    const Deeper deeper(*this);
    const int column = now().column;
    if (take("-")) {
      const NodePtr x = factor();
      return std::make_shared<const Node>(Node{
          x->unit, x->literal, column, [x](const FrameFigures& f, int row) { return -x->value(f, row); }});
    }
    if (take("(")) {
      NodePtr inside = either();
      expect(")", ") for the ( before");
      return inside;
    }
    if (now().kind == Kind::number) return number();
    if (now().kind == Kind::name) return tokens_[at_ + 1].text == "(" ? function() : figure();
    unexpected("a name or a number");
  }

  NodePtr number() {
    const Token token = tokens_[at_++];
    Node literal{plain, true, token.column, {}};
    double value = token.number;
    for (const condition_words::UnitName& unit : condition_words::unit_names()) {
      if (!take(unit.name)) continue;
      value *= unit.factor;
      literal.unit = unit.unit;
      literal.literal = false;
      break;
    }
    if (literal.literal && now().kind == Kind::name && !is("and") && !is("or"))
      fail(now().column,
           fmt::format("{} is no unit; there are m, cm, mm, deg, px, ms, s and %", in_quotes(now().text)));
    literal.value = [value](const FrameFigures&, int) { return value; };
    return std::make_shared<const Node>(std::move(literal));
  }

  NodePtr figure() {
    const Token token = tokens_[at_++];
    const auto& infos = frame_figure_infos();
    if (const int column = frame_figure(token.text); column >= 0) {
      columns_.insert(column);
      return node(infos[static_cast<std::size_t>(column)].unit, token.column,
                  [column](const FrameFigures& f, int row) { return f.value(row, column); });
    }
    std::vector<std::string_view> names;
    for (const FigureInfo& info : infos) {
      names.push_back(info.name);
      if (!info.column.empty()) names.push_back(info.column);
    }
    unknown(token, "name", names);
  }

  [[noreturn]] static void unknown(const Token& token, const char* what,
                                   const std::vector<std::string_view>& names) {
    const std::string_view near = condition_words::nearest_name(token.text, names);
    fail(token.column, fmt::format("there is no {} {}{}", what, in_quotes(token.text),
                                   near.empty() ? "" : fmt::format("; did you mean {}?", near)));
  }

  NodePtr function() {
    const Token name = tokens_[at_];
    static const std::vector<std::string_view> known = {"abs", "previous", "change", "spike"};
    if (std::find(known.begin(), known.end(), name.text) == known.end()) unknown(name, "function", known);
    at_ += 2;
    const bool is_spike_of = name.text == "spike";
    if (is_spike_of && std::exchange(in_spike_, true))
      fail(name.column, "a spike of a spike is not to be had");
    const NodePtr x = either();
    double sigmas = 0.0;
    if (is_spike_of) {
      in_spike_ = false;
      expect(",", "a comma, then how many standard deviations");
      if (now().kind != Kind::number) unexpected("a number of standard deviations");
      sigmas = tokens_[at_++].number;
    }
    expect(")", fmt::format(") after what {} is taken of", name.text));
    const int column = name.column;
    if (name.text == "abs")
      return node(x->unit, column,
                  [x](const FrameFigures& f, int row) { return std::abs(x->value(f, row)); });
    if (is_spike_of)
      return node(truth, column,
                  [x, sigmas](const FrameFigures& f, int row) { return spike(*x, sigmas, f, row); });
    const bool change = name.text == "change";
    return node(x->unit, column, [x, change](const FrameFigures& f, int row) {
      // Before the first frame nothing was measured, and nothing was so.
      if (row == 0) return !change && x->unit == truth ? 0.0 : kUnknownValue;
      const double before = x->value(f, row - 1);
      return change ? x->value(f, row) - before : before;
    });
  }

  /// Counts how deep parts stand in each other, so that a hostile text cannot exhaust the stack.
  class Deeper {
   public:
    explicit Deeper(Parser& parser) : parser_(parser) {
      if (++parser_.depth_ > kMaxDepth) fail(parser_.now().column, "it is nested too deeply");
    }
    ~Deeper() { --parser_.depth_; }
    Deeper(const Deeper&) = delete;
    Deeper& operator=(const Deeper&) = delete;

   private:
    Parser& parser_;
  };

  std::vector<Token> tokens_;
  std::size_t at_ = 0;
  int depth_ = 0;
  bool in_spike_ = false;
  std::set<int> columns_;
};

}  // namespace

Condition::Condition(std::string_view text) : text_(text) {
  Parser parser(text);
  root_ = parser.whole();
  columns_ = parser.columns();
}

bool Condition::holds(const FrameFigures& figures, int row) const {
  return is_true(root_->value(figures, row));
}

std::vector<int> Condition::frames(const FrameFigures& figures) const {
  std::vector<int> frames;
  for (int row = 0; row < figures.rows(); ++row)
    if (holds(figures, row)) frames.push_back(figures.frame(row));
  return frames;
}

std::vector<std::string_view> Condition::unknown_figures(const FrameFigures& figures) const {
  std::vector<std::string_view> unknown;
  for (const int column : columns_) {
    bool known = figures.rows() == 0;
    for (int row = 0; row < figures.rows() && !known; ++row) known = !std::isnan(figures.value(row, column));
    if (!known) unknown.push_back(frame_figure_infos()[static_cast<std::size_t>(column)].name);
  }
  return unknown;
}

std::string frames_text(const std::vector<int>& frames) {
  std::string text;
  for (std::size_t i = 0; i < frames.size(); ++i) {
    const std::size_t first = i;
    while (i + 1 < frames.size() && frames[i + 1] == frames[i] + 1) ++i;
    text += fmt::format("{}{}", text.empty() ? "" : ", ", frames[first]);
    if (i > first) text += fmt::format("-{}", frames[i]);
  }
  return text;
}

std::string condition_help() {
  std::string text =
      "A condition over what is known of each frame, such as `rpe > 5 cm || inliers < 30 && !lost`.\n"
      "  Operators   || && ! (or, and, not), < <= > >= == !=, + - * /, parentheses\n"
      "  Units       m cm mm deg px ms s %; a plain number takes the unit of what it is compared with\n"
      "  Functions   previous(x): of the frame before; change(x): x - previous(x); abs(x);\n"
      "              spike(x, 3): more than 3 standard deviations off the median of the 60 frames before\n"
      "  What is not known, such as errors without ground truth, holds nowhere, nor does its opposite.\n"
      "Names:\n";
  for (const FigureInfo& info : frame_figure_infos())
    text += fmt::format("  {:<18} {:<7} {}{}\n", info.name, to_string(info.unit), info.help,
                        info.column.empty() ? "" : fmt::format(" (in frames.csv: {})", info.column));
  return text;
}

}  // namespace stillpoint
