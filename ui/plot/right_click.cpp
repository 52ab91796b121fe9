#include "ui/plot/right_click.hpp"

#include <fmt/format.h>

#include <memory>

#include "core/error.hpp"
#include "core/evaluation/tables.hpp"
#include "core/out_folder.hpp"
#include "ui/plot/plot_file.hpp"

namespace stillpoint {
namespace {

constexpr float kInPlace = 16.0F;  // px², as far as a hand trembles

void write_table(const Table& table, const std::string& path) {
  if (!path.ends_with(".csv")) throw InputError(fmt::format("{}: a table is written as .csv", path));
  write_text_file(path, to_csv(table));
}

}  // namespace

SaveOffer offer_of(const std::string& name, const Plot& plot) { return offer_of(name, plot, PlotView{}); }

SaveOffer offer_of(const std::string& name, const Plot& plot, const PlotView& view) {
  const auto figure = std::make_shared<const PlotFigure>(plot, view);
  return {"this plot",
          {name + ".svg", kPlotEndings, [figure](const std::string& path) { write_plot(*figure, path); }},
          [figure] { return plot_values(*figure); }};
}

SaveOffer offer_of(const std::string& name, Table table) {
  const auto kept = std::make_shared<const Table>(std::move(table));
  return {"this table",
          {name + ".csv", ".csv", [kept](const std::string& path) { write_table(*kept, path); }},
          [kept] { return to_csv(*kept); }};
}

void offer_by_right_click(const UiFrame& frame, const char* id, bool hovered,
                          const std::function<std::vector<SaveOffer>()>& make) {
  if (frame.all_offers != nullptr)
    for (SaveOffer& offer : make()) frame.all_offers->push_back(std::move(offer.file));
  if (frame.offer == nullptr) return;
  ImGui::PushID(id);
  if (hovered && ImGui::IsMouseReleased(ImGuiMouseButton_Right) &&
      ImGui::GetIO().MouseDragMaxDistanceSqr[ImGuiMouseButton_Right] < kInPlace)
    ImGui::OpenPopup("##save menu");
  if (ImGui::BeginPopup("##save menu")) {
    for (const SaveOffer& offer : make()) {
      if (ImGui::MenuItem(fmt::format("Save {}…", offer.what).c_str())) *frame.offer = offer.file;
      const bool one_of_many = offer.what != "this plot" && offer.what != "this table";
      const std::string copy = one_of_many ? fmt::format("Copy {}", offer.what) : "Copy its values";
      if (offer.values && ImGui::MenuItem(copy.c_str())) ImGui::SetClipboardText(offer.values().c_str());
    }
    ImGui::EndPopup();
  }
  ImGui::PopID();
}

void offer_table(const UiFrame& frame, const char* name, ImVec2 low, const std::function<Table()>& make) {
  const ImVec2 high{ImGui::GetWindowPos().x + ImGui::GetWindowContentRegionMax().x,
                    ImGui::GetCursorScreenPos().y};
  const bool hovered =
      ImGui::IsWindowHovered(ImGuiHoveredFlags_ChildWindows) && ImGui::IsMouseHoveringRect(low, high);
  offer_by_right_click(frame, name, hovered, [&] { return std::vector{offer_of(name, make())}; });
}

}  // namespace stillpoint
