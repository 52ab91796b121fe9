// The layout as a file holds it.
#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <set>

#include "core/error.hpp"
#include "core/json_text.hpp"
#include "ui/workbench/layout.hpp"

namespace stillpoint {
namespace {

using Json = nlohmann::ordered_json;

Json node_to_json(const LayoutNode& node) {
  Json json = Json::object();
  json["share"] = node.share;
  if (node.is_panel()) {
    json["panel"] = node.panel;
    if (node.front) json["front"] = true;
    for (const auto& [control, value] : node.choices) json["choices"][control] = value;
  } else {
    Json children = Json::array();
    for (const LayoutNode& child : node.children) children.push_back(node_to_json(child));
    json[node.division == LayoutNode::Division::kColumns ? "columns" : "rows"] = std::move(children);
  }
  return json;
}

/// Reads nodes, and knows what messages need.
class LayoutReader {
 public:
  LayoutReader(const std::string& file, const std::vector<std::string>& known) : file_(file), known_(known) {}

  LayoutNode read(const Json& json, int depth = 0) {
    constexpr int kDeepest = 32;  // divisions: no screen has room for as many
    if (depth > kDeepest) refuse(fmt::format("tiles are divided more than {} times over", kDeepest));
    if (!json.is_object()) refuse("a tile must be an object with \"panel\", \"columns\" or \"rows\"");
    const auto keys = std::count_if(kContents.begin(), kContents.end(),
                                    [&](const char* key) { return json.contains(key); });
    if (keys != 1) refuse("a tile must have one of \"panel\", \"columns\" and \"rows\"");
    LayoutNode node;
    if (json.contains("panel")) {
      node.panel = read_panel(json["panel"]);
      if (json.contains("front") && !json["front"].is_boolean()) refuse("\"front\" must be true or false");
      node.front = json.value("front", false);
      if (json.contains("choices")) read_choices(json["choices"], node);
    } else {
      const bool columns = json.contains("columns");
      node.division = columns ? LayoutNode::Division::kColumns : LayoutNode::Division::kRows;
      read_children(json[columns ? "columns" : "rows"], node, depth);
    }
    return node;
  }

 private:
  static constexpr std::array kContents = {"panel", "columns", "rows"};

  [[noreturn]] void refuse(const std::string& why) const {
    throw InputError(fmt::format("{}: is no layout: {}", file_, why));
  }

  std::string read_panel(const Json& json) {
    if (!json.is_string()) refuse("\"panel\" must be a panel's name");
    auto name = json.get<std::string>();
    if (std::find(known_.begin(), known_.end(), name) == known_.end())
      refuse(fmt::format("there is no panel '{}'; the panels are {}", name, fmt::join(known_, ", ")));
    if (!seen_.insert(name).second) refuse(fmt::format("panel '{}' is named twice", name));
    return name;
  }

  void read_choices(const Json& json, LayoutNode& node) {
    if (!json.is_object()) refuse("\"choices\" must be an object of controls and values");
    for (const auto& [control, value] : json.items()) {
      if (!value.is_string())
        refuse(fmt::format("the choice '{}' of panel '{}' must be a text", control, node.panel));
      node.choices[control] = value.get<std::string>();
    }
  }

  void read_children(const Json& json, LayoutNode& node, int depth) {
    if (!json.is_array() || json.empty()) refuse("\"columns\" and \"rows\" must list at least one tile");
    double sum = 0.0;
    for (const Json& child : json) {
      node.children.push_back(read(child, depth + 1));
      double& share = node.children.back().share;
      share = 1.0 / static_cast<double>(json.size());
      if (child.contains("share")) {
        if (!child["share"].is_number()) refuse("\"share\" must be a number");
        share = child["share"].get<double>();
      }
      if (!(share > 0.0 && share <= 1e6)) refuse("\"share\" must be greater than 0");
      sum += share;
    }
    for (LayoutNode& child : node.children) child.share /= sum;
  }

  const std::string& file_;
  const std::vector<std::string>& known_;
  std::set<std::string> seen_;
};

}  // namespace

std::string to_json(const LayoutNode& root) { return node_to_json(root).dump(1) + '\n'; }

LayoutNode parse_layout(const std::string& text, const std::string& name,
                        const std::vector<std::string>& known) {
  const Json json = parse_json<Json>(text, false);
  if (json.is_discarded()) throw InputError(fmt::format("{}: is no layout: not JSON", name));
  return LayoutReader(name, known).read(json);
}

}  // namespace stillpoint
