#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "core/evaluation/tables.hpp"
#include "core/inspect/frame_view.hpp"
#include "core/inspect/point_readings.hpp"
#include "core/inspect/run_view.hpp"
#include "core/inspect/scene_point.hpp"
#include "core/odometry/frame_record.hpp"
#include "core/odometry/map_id.hpp"
#include "core/run/frame_figures.hpp"
#include "ui/panels/all_panels.hpp"
#include "ui/panels/frame_pictures.hpp"
#include "ui/panels/panel_command.hpp"
#include "ui/panels/panels_shared.hpp"
#include "ui/panels/run_series.hpp"
#include "ui/plot/right_click.hpp"
#include "ui/shell/input.hpp"
#include "ui/theme/fonts.hpp"
#include "ui/theme/icons.hpp"

namespace stillpoint {
namespace {

using Rows = std::vector<std::pair<std::string, std::string>>;

std::string position_text(const Pose& pose) {
  const Eigen::Vector3d t = pose.translation();
  // Adding 0 makes -0 of a coordinate that rounds to it 0.
  const auto rounded = [](double metres) { return std::round(1000.0 * metres) / 1000.0 + 0.0; };
  return fmt::format("{:.3f}, {:.3f}, {:.3f} m", rounded(t.x()), rounded(t.y()), rounded(t.z()));
}

/// "static_tracks" as a heading: "Static tracks".
std::string label_of(std::string name) {
  std::replace(name.begin(), name.end(), '_', ' ');
  if (!name.empty()) name[0] = static_cast<char>(std::toupper(static_cast<unsigned char>(name[0])));
  return name;
}

/// "freiburg1; rows over 25.0 ms, depth's over 33.0 ms, depth 28.0 ms before its stamp, …"
std::string camera_text(const Camera& camera) {
  std::string text = camera.name;
  if (camera.readout_s != 0) text += fmt::format("; rows over {:.1f} ms", 1e3 * camera.readout_s);
  if (camera.depth_readout_s) text += fmt::format(", depth's over {:.1f} ms", 1e3 * *camera.depth_readout_s);
  if (camera.depth_delay_s != 0)
    text += fmt::format(", depth {:.1f} ms {} its stamp", 1e3 * std::abs(camera.depth_delay_s),
                        camera.depth_delay_s < 0 ? "before" : "after");
  if (camera.stamp_delay_s != 0)
    text += fmt::format(", frame {:.1f} ms {} its image's stamp", 1e3 * std::abs(camera.stamp_delay_s),
                        camera.stamp_delay_s < 0 ? "before" : "after");
  return text;
}

Rows record_rows(const SessionView& session, const FrameRecord& r) {
  Rows rows{
      {"Frame", fmt::format("{} of {}", r.index, session.frame_count)},
      {"Time", fmt::format("{:.3f} s", r.timestamp - series_start(session))},
      {"Stamp", fmt::format("{:.4f} s", r.timestamp)},
      {"Camera", camera_text(session.camera)},
      {"Status", std::string(to_string(r.status))},
      {"Note", remarks_on(r).empty() ? "–" : remarks_on(r)},
      {"Position", position_text(r.world_from_camera)},
      {"Turned",
       fmt::format("{:.2f} °", rotation_angle(r.world_from_camera.linear()) * 180.0 / 3.14159265358979)},
      {"Pose", r.estimated ? "estimated" : "predicted"},
      {"Pose begun from", r.pose_start != PoseStart::none ? std::string(to_string(r.pose_start)) : "–"},
      {"Refers to keyframe", r.reference_keyframe == kNone ? "–" : fmt::format("{}", r.reference_keyframe)}};
  const auto row = record_of(session, r.index);
  if (!row) return rows;
  // Every figure of the one table that people are shown, as far as it is known here.
  const std::vector<double> values = figures_of_frame(session.run->measured(), *row);
  const auto& infos = frame_figure_infos();
  for (std::size_t i = 0; i < infos.size(); ++i) {
    const bool own = static_cast<int>(i) >= first_method_figure();
    if (std::isnan(values[i]) || (infos[i].title.empty() && !own)) continue;
    rows.emplace_back(infos[i].title.empty() ? label_of(infos[i].name) : infos[i].title,
                      shown_value(infos[i], values[i]));
  }
  return rows;
}

/// A point of the scene as every layer reads it, pins beside it, and the frame's record: every figure with
/// its unit.
class InspectorPanel final : public FramePanel {
 public:
  explicit InspectorPanel(Shared shared) : FramePanel("inspector", "Inspector", std::move(shared)) {}

  [[nodiscard]] bool keeps_up() const override { return false; }

  [[nodiscard]] std::vector<PanelCommand> commands() override {
    return {{.name = "pin",
             .title = "Pin the pixel under the mouse, or take its pin out",
             .group = "View",
             .icon = icons::kTarget,
             .keys = {{Key::kP, {}}},
             .enabled = [this](const SessionView&) { return shared_->pixel.has_value(); },
             .run = [this](const SessionView& session,
                           PanelActions& actions) { toggle_pin_at_cursor(session, *shared_, actions); }},
            {.name = "unpin_all",
             .title = "Take out all pins",
             .group = "View",
             .icon = icons::kClose,
             .enabled = [](const SessionView& session) { return !session.debug.pins.empty(); },
             .run = [](const SessionView&,
                       PanelActions& actions) { actions.requests.emplace_back(request::Pins{}); }}};
  }

  [[nodiscard]] PanelSize least() const override { return {260.0F, 180.0F}; }

  void draw(UiFrame& frame, const SessionView& session, PanelActions& actions) override {
    const ImVec2 room = ImGui::GetContentRegionAvail();
    if (room.x > 760.0F * frame.scale) {
      const float left = std::floor(0.5F * room.x);
      ImGui::BeginChild("points", {left, room.y});
      draw_points(frame, session, actions, true);
      ImGui::EndChild();
      ImGui::SameLine(0.0F, ImGui::GetStyle().ItemSpacing.x);
      ImGui::BeginChild("record");
      heading(frame, fmt::format("Record of frame {}", session.current->index));
      draw_record(frame, session, 2);
      ImGui::EndChild();
      return;
    }
    Controls(frame).choice("what", {"Points", "Record"}, what_);
    ImGui::BeginChild("shown");
    if (what_ == 0)
      draw_points(frame, session, actions, false);
    else
      draw_record(frame, session, room.x > 460.0F * frame.scale ? 2 : 1);
    ImGui::EndChild();
  }

 private:
  /// A column of the table.
  struct Column {
    std::string name;
    std::vector<ReadingGroup> groups;
    int pin = -1;  // index into the pins; below 0 is the cursor
  };

  [[nodiscard]] std::vector<Column> columns(const SessionView& session) {
    std::vector<Column> columns;
    const PairGeometry& pair = shared_->geometry(session);
    if (shared_->cursor && shared_->cursor->target)
      columns.push_back({"Mouse", read_point(*session.current, pair, shared_->pixel->cast<double>()), -1});
    const auto& pins = session.debug.pins;
    for (std::size_t i = 0; i < pins.size(); ++i)
      columns.push_back(
          {pins[i].name, read_point(*session.current, pair, {pins[i].x, pins[i].y}), static_cast<int>(i)});
    return columns;
  }

  /// @param wide the record has a place of its own; elsewhere it stands here until there is a point to read
  void draw_points(const UiFrame& frame, const SessionView& session, PanelActions& actions, bool wide) {
    if (!session.current->frame.readable()) {
      draw_absent(frame, missing_motion(session));
      return;
    }
    const std::vector<Column> shown = columns(session);
    if (shown.empty()) {
      ImGui::PushStyleColor(ImGuiCol_Text, to_vec4(frame.theme.text_dim));
      text_in_lines("Point at an image to read every layer there; P pins the pixel.");
      ImGui::PopStyleColor();
      if (!wide) draw_record(frame, session, 1);
      return;
    }
    ImGui::PushFont(frame.fonts.small);
    ImGui::PushStyleVar(ImGuiStyleVar_CellPadding, {4.0F * frame.scale, 1.5F * frame.scale});
    const auto count = static_cast<int>(std::min<std::size_t>(shown.size(), kMostColumns));
    float widest = 0.0F;
    for (const ReadingGroup& group : shown.front().groups)
      for (const Reading& reading : group.readings)
        widest = std::max(widest, ImGui::CalcTextSize(reading.name.c_str()).x);
    // Columns that have no room beside each other are scrolled to.
    const float room = ImGui::GetContentRegionAvail().x,
                needed =
                    std::min(widest, 0.45F * room) + static_cast<float>(count) * kLeastColumn * frame.scale;
    const ImVec2 low = ImGui::GetCursorScreenPos();
    const bool scrolls = needed > room;
    if (ImGui::BeginTable("points", 1 + count,
                          ImGuiTableFlags_BordersInnerH | ImGuiTableFlags_SizingStretchProp |
                              ImGuiTableFlags_ScrollY | (scrolls ? ImGuiTableFlags_ScrollX : 0),
                          {0.0F, 0.0F}, scrolls ? needed : 0.0F)) {
      ImGui::TableSetupScrollFreeze(scrolls ? 1 : 0, 1);
      ImGui::TableSetupColumn("", ImGuiTableColumnFlags_WidthFixed, std::min(widest, 0.45F * room));
      for (int i = 0; i < count; ++i) ImGui::TableSetupColumn("", ImGuiTableColumnFlags_WidthStretch);
      draw_column_names(shown, count, session, actions);
      for (std::size_t g = 0; g < shown.front().groups.size(); ++g) draw_group(frame, shown, count, g);
      ImGui::EndTable();
    }
    offer_table(frame, "points", low, [&] { return points_table(shown); });
    ImGui::PopStyleVar();
    ImGui::PopFont();
  }

  static Table points_table(const std::vector<Column>& shown) {
    Table table{{"layer", "reading"}, {}};
    for (const Column& column : shown)
      table.header.push_back(column.pin < 0 ? column.name : "Pin " + column.name);
    for (std::size_t g = 0; g < shown.front().groups.size(); ++g)
      for (std::size_t r = 0; r < shown.front().groups[g].readings.size(); ++r) {
        std::vector<std::string> row{shown.front().groups[g].title, shown.front().groups[g].readings[r].name};
        for (const Column& column : shown) row.push_back(column.groups[g].readings[r].value);
        table.rows.push_back(std::move(row));
      }
    return table;
  }

  static void draw_column_names(const std::vector<Column>& shown, int count, const SessionView& session,
                                PanelActions& actions) {
    ImGui::TableNextRow(ImGuiTableRowFlags_Headers);
    ImGui::TableNextColumn();
    for (int i = 0; i < count; ++i) {
      const Column& column = shown[static_cast<std::size_t>(i)];
      ImGui::TableNextColumn();
      ImGui::TextUnformatted(column.pin < 0 ? column.name.c_str() : ("Pin " + column.name).c_str());
      if (column.pin < 0) continue;
      ImGui::SameLine();
      ImGui::PushID(i);
      if (ImGui::SmallButton("x")) {
        auto pins = session.debug.pins;
        pins.erase(pins.begin() + column.pin);
        actions.requests.emplace_back(request::Pins{std::move(pins)});
      }
      if (ImGui::IsItemHovered()) ImGui::SetTooltip("Takes the pin out");
      ImGui::PopID();
    }
  }

  static void draw_group(const UiFrame& frame, const std::vector<Column>& shown, int count,
                         std::size_t group) {
    const ReadingGroup& first = shown.front().groups[group];
    ImGui::TableNextRow();
    ImGui::TableNextColumn();
    ImGui::TextColored(to_vec4(frame.theme.accent), "%s", first.title.c_str());
    for (std::size_t r = 0; r < first.readings.size(); ++r) {
      ImGui::TableNextRow();
      ImGui::TableNextColumn();
      ImGui::PushStyleColor(ImGuiCol_Text, to_vec4(frame.theme.text_dim));
      text_in_lines(first.readings[r].name);
      ImGui::PopStyleColor();
      for (int i = 0; i < count; ++i) {
        const auto& groups = shown[static_cast<std::size_t>(i)].groups;
        ImGui::TableNextColumn();
        const Reading& reading = groups[group].readings[r];
        const Rgb ink = reading.speaks ? role_colour(Role::kWarning, frame.theme.name) : frame.theme.text;
        ImGui::PushStyleColor(ImGuiCol_Text, to_vec4(ink));
        text_in_lines(reading.value);
        ImGui::PopStyleColor();
      }
    }
  }

  static void draw_record(const UiFrame& frame, const SessionView& session, int pairs) {
    const FrameView& view = *session.current;
    if (view.record != nullptr)
      table(frame, "record", record_rows(session, *view.record), pairs);
    else
      ImGui::TextDisabled("Frame %d has not been processed yet.", view.index);
  }

  static void heading(const UiFrame& frame, const std::string& text) {
    ImGui::PushFont(frame.fonts.strong);
    ImGui::TextUnformatted(text.c_str());
    ImGui::PopFont();
  }

  /// Names and values, in as many pairs of columns.
  static void table(const UiFrame& frame, const char* id, const Rows& rows, int pairs) {
    ImGui::PushFont(frame.fonts.small);
    ImGui::PushStyleVar(ImGuiStyleVar_CellPadding, {4.0F * frame.scale, 1.5F * frame.scale});
    const ImVec2 low = ImGui::GetCursorScreenPos();
    if (ImGui::BeginTable(id, 2 * pairs, ImGuiTableFlags_BordersInnerH | ImGuiTableFlags_SizingStretchProp)) {
      float widest = 0.0F;
      for (const auto& [name, value] : rows) widest = std::max(widest, ImGui::CalcTextSize(name.c_str()).x);
      for (int pair = 0; pair < pairs; ++pair) {
        ImGui::TableSetupColumn("", ImGuiTableColumnFlags_WidthFixed, widest);
        ImGui::TableSetupColumn("", ImGuiTableColumnFlags_WidthStretch);
      }
      const auto count = static_cast<int>(rows.size()), lines = (count + pairs - 1) / pairs;
      for (int line = 0; line < lines; ++line) {
        ImGui::TableNextRow();
        for (int pair = 0; pair < pairs; ++pair) {
          const int i = line + pair * lines;
          if (i >= count) continue;
          const auto& [name, value] = rows[static_cast<std::size_t>(i)];
          ImGui::TableNextColumn();
          ImGui::TextDisabled("%s", name.c_str());
          ImGui::TableNextColumn();
          text_in_lines(value);
        }
      }
      ImGui::EndTable();
    }
    offer_table(frame, id, low, [&] {
      Table table{{"figure", "value"}, {}};
      for (const auto& [name, value] : rows) table.rows.push_back({name, value});
      return table;
    });
    ImGui::PopStyleVar();
    ImGui::PopFont();
  }

  static constexpr std::size_t kMostColumns = 8;  // pins: more have no room
  static constexpr float kLeastColumn = 84.0F;    // design px, of the readings at one point

  int what_ = 0;
};

}  // namespace

std::unique_ptr<Panel> make_inspector_panel(Shared shared) {
  return std::make_unique<InspectorPanel>(std::move(shared));
}

}  // namespace stillpoint
