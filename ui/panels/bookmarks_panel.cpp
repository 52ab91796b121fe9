#include <fmt/format.h>

#include <array>
#include <cstring>

#include "core/evaluation/tables.hpp"
#include "core/inspect/frame_view.hpp"
#include "core/inspect/run_view.hpp"
#include "ui/panels/all_panels.hpp"
#include "ui/panels/panel.hpp"
#include "ui/panels/panel_kit.hpp"
#include "ui/panels/panels_shared.hpp"
#include "ui/panels/run_series.hpp"
#include "ui/plot/right_click.hpp"
#include "ui/session/data_sources.hpp"
#include "ui/shell/ui_frame.hpp"
#include "ui/theme/icons.hpp"
#include "ui/theme/theme.hpp"

namespace stillpoint {
namespace {

using Field = std::array<char, 256>;

/// The frames to come back to, each with what is to be remembered of it.
class BookmarksPanel final : public NamedPanel {
 public:
  explicit BookmarksPanel(Shared shared) : NamedPanel("bookmarks", "Bookmarks", std::move(shared)) {}

  [[nodiscard]] PanelSize least() const override { return {290.0F, 160.0F}; }

  void draw(UiFrame& frame, const SessionView& session, PanelActions& actions) override {
    const auto& bookmarks = session.debug.bookmarks;
    const int here = session.current->index;
    Controls controls(frame);
    const bool marked = bookmark_at(session.debug, here) != nullptr;
    const std::string label = fmt::format("{}  Frame {}", icons::kPlus, here);
    ImGui::BeginDisabled(marked);
    if (controls.button(label.c_str(), marked ? "This frame has a bookmark" : "Bookmark this frame (B)")) {
      actions.requests.push_back(request::Bookmarks{with_bookmark(bookmarks, here)});
      focus_ = here;
    }
    ImGui::EndDisabled();
    const auto jump = [&](const char* icon, const char* tooltip, std::optional<int> to) {
      ImGui::BeginDisabled(!to);
      if (controls.button(icon, tooltip) && to) actions.go_to_frame = to;
      ImGui::EndDisabled();
    };
    const std::vector<int> frames = bookmarked_frames(session.debug);
    jump(icons::kChevronLeft, "Previous bookmark (,)", previous_in(frames, here));
    jump(icons::kChevronRight, "Next bookmark (.)", next_in(frames, here));
    if (bookmarks.empty()) {
      draw_absent(frame, "No bookmarks yet: B marks the frame shown, and a note says why.");
      return;
    }
    const ImVec2 low = ImGui::GetCursorScreenPos();
    ImGui::BeginChild("list");
    // In a narrow tile the note matters more than the time.
    has_times_ = ImGui::GetContentRegionAvail().x > kTimesFrom * frame.scale;
    if (ImGui::BeginTable("bookmarks", has_times_ ? 4 : 3, ImGuiTableFlags_BordersInnerH)) {
      ImGui::TableSetupColumn("frame", ImGuiTableColumnFlags_WidthFixed, 58.0F * frame.scale);
      if (has_times_) ImGui::TableSetupColumn("time", ImGuiTableColumnFlags_WidthFixed, 62.0F * frame.scale);
      ImGui::TableSetupColumn("note", ImGuiTableColumnFlags_WidthStretch);
      ImGui::TableSetupColumn("delete", ImGuiTableColumnFlags_WidthFixed, 26.0F * frame.scale);
      fields_.resize(bookmarks.size());
      const int editing = editing_;
      editing_ = -1;
      for (std::size_t i = 0; i < bookmarks.size(); ++i) draw_row(frame, session, i, editing, actions);
      ImGui::EndTable();
    }
    ImGui::EndChild();
    offer_table(frame, "bookmarks", low, [&] {
      Table table{{"frame", "note"}, {}};
      for (const Bookmark& one : bookmarks) table.rows.push_back({fmt::format("{}", one.frame), one.note});
      return table;
    });
  }

 private:
  void draw_row(const UiFrame& frame, const SessionView& session, std::size_t index, int editing,
                PanelActions& actions) {
    const Bookmark& bookmark = session.debug.bookmarks[index];
    ImGui::PushID(bookmark.frame);
    ImGui::TableNextRow();
    ImGui::TableNextColumn();
    const bool here = bookmark.frame == session.current->index;
    if (here) ImGui::PushStyleColor(ImGuiCol_Text, to_vec4(frame.theme.accent));
    if (ImGui::Button(fmt::format("{}", bookmark.frame).c_str(), {-1.0F, 0.0F}))
      actions.go_to_frame = bookmark.frame;
    if (here) ImGui::PopStyleColor();
    if (has_times_) {
      ImGui::TableNextColumn();
      ImGui::AlignTextToFramePadding();
      if (const auto at = record_of(session, bookmark.frame))
        ImGui::TextDisabled("%.2f s", session.run->records.outlines()[*at].timestamp - series_start(session));
    }
    ImGui::TableNextColumn();
    Field& field = fields_[index];
    if (editing != bookmark.frame) {
      std::strncpy(field.data(), bookmark.note.c_str(), field.size() - 1);
      field.back() = '\0';
    }
    if (focus_ == bookmark.frame) {
      ImGui::SetKeyboardFocusHere();
      focus_.reset();
    }
    ImGui::SetNextItemWidth(-1.0F);
    ImGui::InputTextWithHint("##note", "note", field.data(), field.size());
    if (ImGui::IsItemActive()) editing_ = bookmark.frame;
    if (ImGui::IsItemHovered() && ImGui::CalcTextSize(bookmark.note.c_str()).x > ImGui::GetItemRectSize().x)
      ImGui::SetTooltip("%s", bookmark.note.c_str());
    if (ImGui::IsItemDeactivatedAfterEdit()) {
      std::vector<Bookmark> all = session.debug.bookmarks;
      all[index].note = field.data();
      actions.requests.push_back(request::Bookmarks{std::move(all)});
    }
    ImGui::TableNextColumn();
    if (ImGui::Button(icons::kClose))
      actions.requests.push_back(
          request::Bookmarks{without_bookmark(session.debug.bookmarks, bookmark.frame)});
    if (ImGui::IsItemHovered()) ImGui::SetTooltip("Delete");
    ImGui::PopID();
  }

  static constexpr float kTimesFrom = 330.0F;  // design px

  bool has_times_ = true;
  std::vector<Field> fields_;
  int editing_ = -1;          // frame of the note being typed
  std::optional<int> focus_;  // frame whose note is to be typed next
};

}  // namespace

std::unique_ptr<Panel> make_bookmarks_panel(Shared shared) {
  return std::make_unique<BookmarksPanel>(std::move(shared));
}

}  // namespace stillpoint
