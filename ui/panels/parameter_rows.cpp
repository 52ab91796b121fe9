#include "ui/panels/parameter_rows.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>

#include "core/motion/methods.hpp"

namespace stillpoint {
namespace {

bool holds(std::string_view text, std::string_view part) {
  const auto same = [](char a, char b) {
    return std::tolower(static_cast<unsigned char>(a)) == std::tolower(static_cast<unsigned char>(b));
  };
  return std::search(text.begin(), text.end(), part.begin(), part.end(), same) != text.end();
}

std::string as_words(std::string text) {
  std::replace(text.begin(), text.end(), '_', ' ');
  if (!text.empty()) text[0] = static_cast<char>(std::toupper(static_cast<unsigned char>(text[0])));
  return text;
}

}  // namespace

std::string section_of(const Parameter& parameter) {
  return parameter.key.substr(0, parameter.key.find('.'));
}

std::string label_of(const Parameter& parameter) {
  std::string label = as_words(parameter.key.substr(parameter.key.find('.') + 1));
  if (label.ends_with(" px")) label.resize(label.size() - 3);
  return label;
}

std::string heading_of(const std::string& section) { return as_words(section); }

std::string value_text(const Parameter& parameter) {
  if (const auto* flag = std::get_if<bool*>(&parameter.value)) return **flag ? "true" : "false";
  if (const auto* integer = std::get_if<int*>(&parameter.value)) return fmt::format("{}", **integer);
  if (const auto* text = std::get_if<std::string*>(&parameter.value)) return **text;
  return fmt::format("{}", *std::get<double*>(parameter.value));
}

bool is_switch(const Parameter& parameter) { return std::holds_alternative<bool*>(parameter.value); }

std::string range_text(const Parameter& parameter) {
  if (!parameter.choices.empty()) return fmt::format("one of {}", parameter.choices.size());
  if (is_switch(parameter)) return "off or on";
  if (std::holds_alternative<std::string*>(parameter.value)) return "a text";
  return fmt::format("{}{}{:g} to {:g}", parameter.unit, parameter.unit.empty() ? "" : ", ", parameter.min,
                     parameter.max);
}

bool matches(const Parameter& parameter, std::string_view words) {
  return words.empty() || holds(parameter.key, words) || holds(label_of(parameter), words) ||
         holds(parameter.help, words);
}

bool is_live(const Parameter& parameter) {
  const std::string section = section_of(parameter);
  return parameter.key == "run.method" ||
         std::any_of(methods().begin(), methods().end(),
                     [&](const MethodInfo& method) { return method.parameters.name() == section; });
}

std::vector<ParameterChange> changes(const Config& config, const Config& from) {
  Config now = config, before = from;
  const std::vector<Parameter> values = parameters(now), others = parameters(before);
  std::vector<ParameterChange> all;
  for (std::size_t i = 0; i < values.size(); ++i) {
    std::string value = value_text(values[i]), other = value_text(others[i]);
    if (value != other) all.push_back({values[i].key, std::move(value), std::move(other)});
  }
  return all;
}

std::string change_name(const Config& config, const Config& from) {
  const std::vector<ParameterChange> all = changes(config, from);
  if (all.empty()) return "the same again";
  std::string name = fmt::format("{} {}", all.front().key, all.front().value);
  if (all.size() > 1) name += fmt::format(", +{}", all.size() - 1);
  return name;
}

}  // namespace stillpoint
