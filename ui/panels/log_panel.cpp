#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "core/evaluation/tables.hpp"
#include "core/inspect/run_view.hpp"
#include "core/odometry/frame_record.hpp"
#include "ui/panels/all_panels.hpp"
#include "ui/panels/panel.hpp"
#include "ui/panels/panel_kit.hpp"
#include "ui/panels/panels_shared.hpp"
#include "ui/panels/run_series.hpp"
#include "ui/plot/right_click.hpp"
#include "ui/session/session_view.hpp"
#include "ui/shell/event_log.hpp"
#include "ui/shell/ui_frame.hpp"
#include "ui/theme/icons.hpp"
#include "ui/theme/text.hpp"
#include "ui/theme/theme.hpp"

namespace stillpoint {
namespace {

/// A line of the log.
struct Line {
  std::string when, text;
  int frame = -1;  ///< to go to; -1: none
  bool bad = false;
};

std::string clock_text(double seconds) {
  const auto whole = static_cast<int>(seconds);
  return fmt::format("{:02d}:{:02d}", whole / 60, whole % 60);
}

/// What is worth a line in a record; empty for a frame like any other.
std::string note_of(const FrameRecord& record) {
  if (const std::string remarks = remarks_on(record); !remarks.empty())
    return fmt::format("{}: {}", to_string(record.status), remarks);
  if (record.status == FrameStatus::tracked) return "";
  return std::string(to_string(record.status));
}

/// The run's events, frames one after another with the same note as one.
std::vector<Line> lines_of_run(const SessionView& session) {
  std::vector<Line> lines;
  std::string last;
  int first = 0, last_frame = -2;
  std::size_t row = 0;
  for (const FrameOutline& frame : session.run->records.outlines()) {
    // Of most frames there is nothing to say, and their records need not be asked.
    const bool usual = frame.status == FrameStatus::tracked && !frame.remarked;
    const std::string note = usual ? "" : note_of(session.run->records[row]);
    ++row;
    const bool goes_on = note == last && frame.index == last_frame + 1;
    last_frame = frame.index;
    if (note.empty()) {
      last.clear();
      continue;
    }
    if (goes_on) {
      lines.back().when = fmt::format("frames {} to {}", first, frame.index);
      continue;
    }
    last = note;
    first = frame.index;
    lines.push_back({fmt::format("frame {}", frame.index), note, frame.index, is_lost(frame.status)});
  }
  return lines;
}

/// What the interface said, and what the run met with: errors and notices with their time or frame.
class LogPanel final : public NamedPanel {
 public:
  explicit LogPanel(Shared shared) : NamedPanel("log", "Log", std::move(shared)) {}

  [[nodiscard]] PanelSize least() const override { return {340.0F, 150.0F}; }

  void draw(UiFrame& frame, const SessionView& session, PanelActions& actions) override {
    if (run_ != session.run.get() || records_ != session.run->records.size()) {
      run_ = session.run.get();
      records_ = session.run->records.size();
      of_run_ = lines_of_run(session);
    }
    Controls controls(frame);
    controls.toggle("Errors only", errors_only_, "Lost and unreadable frames, and what could not be done");
    const FrameOutlines& frames = session.run->records.outlines();
    const auto lost = std::count_if(frames.begin(), frames.end(),
                                    [](const FrameOutline& one) { return is_lost(one.status); });
    ImGui::SameLine();
    ImGui::AlignTextToFramePadding();
    ImGui::TextDisabled("%s", fmt::format("{} of {} frames without a pose", lost, records_).c_str());
    const ImVec2 low = ImGui::GetCursorScreenPos();
    ImGui::BeginChild("lines");
    draw_lines(frame, "Of this run", of_run_, session, actions);
    if (frame.log != nullptr)
      draw_lines(frame, "Of the interface, newest first", said(*frame.log), session, actions);
    ImGui::EndChild();
    offer_table(frame, "log", low, [&] {
      Table table{{"of", "when", "text"}, {}};
      for (const Line& line : of_run_) table.rows.push_back({"run", line.when, line.text});
      if (frame.log != nullptr)
        for (const Line& line : said(*frame.log)) table.rows.push_back({"interface", line.when, line.text});
      return table;
    });
  }

 private:
  static std::vector<Line> said(const EventLog& log) {
    std::vector<Line> lines;
    for (auto it = log.entries().rbegin(); it != log.entries().rend(); ++it) {
      std::string when = clock_text(it->time_s);
      if (it->frame >= 0) when += fmt::format(", frame {}", it->frame);
      lines.push_back({when, it->times > 1 ? fmt::format("{} ({} times)", it->text, it->times) : it->text,
                       it->frame, it->error});
    }
    return lines;
  }

  void draw_lines(const UiFrame& frame, const char* heading, const std::vector<Line>& lines,
                  const SessionView& session, PanelActions& actions) const {
    small_heading(frame, heading);
    const float column = std::min(130.0F * frame.scale, 0.35F * ImGui::GetContentRegionAvail().x);
    bool any = false;
    ImGui::PushID(heading);
    for (std::size_t i = 0; i < lines.size(); ++i) {
      const Line& line = lines[i];
      if (errors_only_ && !line.bad) continue;
      any = true;
      ImGui::PushID(static_cast<int>(i));
      draw_line(frame, line, column, session, actions);
      ImGui::PopID();
    }
    ImGui::PopID();
    if (!any) ImGui::TextDisabled("Nothing%s.", errors_only_ ? " went wrong" : " yet");
    ImGui::Dummy({1.0F, 4.0F * frame.scale});
  }

  static void draw_line(const UiFrame& frame, const Line& line, float column, const SessionView& session,
                        PanelActions& actions) {
    const ImVec2 at = ImGui::GetCursorScreenPos();
    const float left = 20.0F * frame.scale + column;
    const float wrap = std::max(ImGui::GetContentRegionAvail().x - left, 60.0F * frame.scale);
    const std::string text = in_lines(*ImGui::GetFont(), line.text, wrap);
    const float height = ImGui::CalcTextSize(text.c_str(), nullptr, false, wrap).y;
    const bool goes = line.frame >= 0 && line.frame < session.frame_count;
    const bool clicked =
        ImGui::Selectable("##line", false, goes ? 0 : ImGuiSelectableFlags_Disabled, {0.0F, height});
    if (goes && ImGui::IsItemHovered()) ImGui::SetTooltip("click to go to frame %d", line.frame);
    if (goes && clicked) actions.go_to_frame = line.frame;
    ImDrawList& list = *ImGui::GetWindowDrawList();
    const Theme& theme = frame.theme;
    const Rgb colour = line.bad ? role_colour(Role::kWarning, theme.name) : theme.text;
    list.AddText(ImGui::GetFont(), ImGui::GetFontSize(), at, to_u32(line.bad ? colour : theme.text_dim),
                 line.bad ? icons::kWarning : icons::kInfo);
    list.AddText({at.x + 20.0F * frame.scale, at.y}, to_u32(theme.text_dim),
                 cut_to(*ImGui::GetFont(), line.when, column - 6.0F * frame.scale).c_str());
    list.AddText(ImGui::GetFont(), ImGui::GetFontSize(), {at.x + left, at.y}, to_u32(colour), text.c_str(),
                 nullptr, wrap);
  }

  bool errors_only_ = false;
  std::vector<Line> of_run_;
  const void* run_ = nullptr;
  std::size_t records_ = 0;
};

}  // namespace

std::unique_ptr<Panel> make_log_panel(Shared shared) { return std::make_unique<LogPanel>(std::move(shared)); }

}  // namespace stillpoint
