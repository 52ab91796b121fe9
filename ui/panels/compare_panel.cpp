#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "core/evaluation/tables.hpp"
#include "core/evaluation/trajectory_metrics.hpp"
#include "core/inspect/frame_view.hpp"
#include "core/inspect/run_view.hpp"
#include "core/run/frame_figures.hpp"
#include "ui/panels/all_panels.hpp"
#include "ui/panels/frame_pictures.hpp"
#include "ui/panels/panel_choices.hpp"
#include "ui/panels/run_difference.hpp"
#include "ui/panels/run_look.hpp"
#include "ui/panels/run_series.hpp"
#include "ui/plot/right_click.hpp"
#include "ui/session/shown_runs.hpp"
#include "ui/theme/fonts.hpp"
#include "ui/theme/icons.hpp"

namespace stillpoint {
namespace {

/// An RMSE as it is read out; an error of which there is no sample is not said to be 0.
std::string error_text(const ErrorStatistics& statistics) {
  return statistics.count == 0 ? "–" : fmt::format("{:.1f} mm", 1000.0 * statistics.rmse);
}

cv::Mat or_nothing(const cv::Mat& mask, const cv::Size& size) {
  return mask.empty() ? cv::Mat(cv::Mat::zeros(size, CV_8UC1)) : mask;
}

/// The run beside its ghosts: figures of all, and for the frame shown what each took out.
class ComparePanel final : public NamedPanel {
 public:
  explicit ComparePanel(Shared shared) : NamedPanel("compare", "Compare runs", std::move(shared)) {}

  [[nodiscard]] PanelSize least() const override { return {440.0F, 320.0F}; }

  [[nodiscard]] bool shows_image_alone() const override { return false; }
  [[nodiscard]] bool keeps_up() const override { return true; }
  [[nodiscard]] bool lists_runs() const override { return true; }

  void draw(UiFrame& frame, const SessionView& session, PanelActions& actions) override {
    const auto& ghosts = session.debug.ghosts;
    if (ghosts.empty() && shows_preview(session)) {
      draw_preview(frame, session, actions);
      return;
    }
    if (ghosts.empty()) {
      // What is left out of plots is taken back in here.
      if (frame.runs != nullptr && session.baseline) draw_table(frame, session, actions);
      draw_absent(
          frame,
          "No second run yet. In the parameters panel, change something or choose a method to compare "
          "with: it then runs beside this one.");
      return;
    }
    chosen_ = std::min(chosen_, ghosts.size() - 1);
    draw_picture_choice(frame, session);
    draw_table(frame, session, actions);
    const GhostView& ghost = ghosts[chosen_];
    const auto here = record_of(session, session.current->index),
               there = record_of(*ghost.run, session.current->index);
    if (!here || !there) {
      draw_absent(frame, fmt::format("Frame {} has not been processed in {} yet.", session.current->index,
                                     here ? "\"" + ghost.name + "\"" : "this run"));
      return;
    }
    difference_ = difference_of(session.run->measured(), *here, ghost.run->measured(), *there);
    draw_frame_shown(frame, session, ghost, actions);
  }

 private:
  /// While no second run stands beside it, the frame shown beside its preview.
  void draw_preview(const UiFrame& frame, const SessionView& session, PanelActions& actions) {
    const GhostView preview{.name = "preview",
                            .config = session.debug.previewed.value_or(session.config),
                            .from = session.current->index,
                            .busy = false,
                            .run = session.run,
                            .current = session.debug.preview,
                            .diverged = {}};
    difference_ = {};
    if (session.current->record != nullptr && preview.current->record != nullptr) {
      const FrameRecords run(std::vector{*session.current->record}),
          previewed(std::vector{*preview.current->record});
      difference_ = difference_of({run}, 0, {previewed}, 0);
    }
    draw_frame_shown(frame, session, preview, actions);
  }

  /// What pictures of all panels show: kept with the sequence, not with this panel.
  static void draw_picture_choice(UiFrame& frame, const SessionView& session) {
    if (frame.runs == nullptr) return;
    PanelChoices* const choices = std::exchange(frame.choices, nullptr);
    int pictures = static_cast<int>(frame.runs->pictures);
    Controls controls(frame);
    if (controls.choice("pictures", {"This run", "Wipe", "Flip"}, pictures,
                        "What the pictures of all panels show: this run alone, the runs ticked below side by "
                        "side (W), or one after the other (F)"))
      frame.runs->pictures = static_cast<RunPictures>(pictures);
    if (const auto flipped = frame.runs->flipped(session))
      if (controls.button(fmt::format("Next after {} (F)", shortened(flipped->name, 18)).c_str()))
        frame.runs->flip(session, 1);
    frame.choices = choices;
  }

  /// Whether a run is among those that pictures show.
  static void draw_picture_tick(const UiFrame& frame, const SessionView& session, const ListedRun& run) {
    const std::vector<ListedRun> chosen = frame.runs->chosen_of(session);
    bool on =
        std::any_of(chosen.begin(), chosen.end(), [&](const ListedRun& one) { return one.name == run.name; });
    ImGui::PushStyleVar(ImGuiStyleVar_FramePadding, {2.0F * frame.scale, 2.0F * frame.scale});
    if (run.kind != ListedRun::Kind::own) {
      const bool hidden = frame.runs->hides(run.name);
      ImGui::PushStyleColor(ImGuiCol_Button, ImVec4{0, 0, 0, 0});
      ImGui::PushStyleColor(ImGuiCol_Text, to_vec4(hidden ? frame.theme.text_dim : frame.theme.text));
      if (ImGui::Button(hidden ? icons::kHide : icons::kShow, {1.5F * ImGui::GetFrameHeight(), 0.0F}))
        frame.runs->toggle_hidden(run.name);
      ImGui::PopStyleColor(2);
      if (ImGui::IsItemHovered())
        ImGui::SetTooltip(hidden ? "Left out of plots, tables and the trajectory; click to show it there"
                                 : "In plots, tables and the trajectory; click to leave it out");
    } else {
      ImGui::Dummy({1.5F * ImGui::GetFrameHeight(), 1.0F});
    }
    ImGui::SameLine();
    if (checkbox(frame, "##in pictures", on)) frame.runs->toggle(session, run.name);
    ImGui::PopStyleVar();
    if (ImGui::IsItemHovered())
      ImGui::SetTooltip("%s", run.no_pictures.empty() ? "Shown where pictures are wiped or flipped"
                                                      : run.no_pictures.c_str());
    ImGui::SameLine();
  }

  void draw_table(const UiFrame& frame, const SessionView& session, PanelActions& actions) {
    constexpr ImGuiTableFlags kFlags = ImGuiTableFlags_BordersInnerH | ImGuiTableFlags_SizingStretchProp;
    const ImVec2 low = ImGui::GetCursorScreenPos();
    if (!ImGui::BeginTable("runs", 6, kFlags)) return;
    // Eye and tick stand before the name.
    ImGui::TableSetupColumn("Run", ImGuiTableColumnFlags_WidthStretch, frame.runs != nullptr ? 3.8F : 2.2F);
    ImGui::TableSetupColumn("Frames", ImGuiTableColumnFlags_WidthStretch, 0.8F);
    const std::string rpe = "RPE " + session.run->evaluation.rpe_time.delta;
    ImGui::TableSetupColumn(rpe.c_str(), ImGuiTableColumnFlags_WidthStretch, 1.0F);
    ImGui::TableSetupColumn("ATE", ImGuiTableColumnFlags_WidthStretch, 1.0F);
    ImGui::TableSetupColumn("Parts at", ImGuiTableColumnFlags_WidthStretch, 0.9F);
    ImGui::TableSetupColumn("", ImGuiTableColumnFlags_WidthFixed, 26.0F * frame.scale);
    ImGui::TableHeadersRow();
    const std::vector<ListedRun> listed = listed_runs(session);
    run_row(frame, session, listed.front(), {role_colour(Role::kEstimate, frame.theme.name)},
            session.run->name + " (this run)", session.processed);
    ImGui::TableNextColumn();
    ImGui::TableNextColumn();
    // Without pictures to choose, the list is of what can be compared frame by frame.
    if (frame.runs != nullptr && session.baseline) {
      run_row(frame, session, listed[1],
              {role_colour(Role::kBaseline, frame.theme.name), SeriesStyle::kDashed, Sign::kDashed},
              baseline_name(session), static_cast<int>(session.baseline->records.size()));
      ImGui::TableNextColumn();
      ImGui::TableNextColumn();
    }
    for (std::size_t i = 0; i < session.debug.ghosts.size(); ++i) ghost_row(frame, session, i, actions);
    ImGui::EndTable();
    offer_table(frame, "runs", low, [&] { return runs_table(session); });
  }

  static Table runs_table(const SessionView& session) {
    Table table{{"run", "frames", "RPE " + session.run->evaluation.rpe_time.delta, "ATE", "parts at"}, {}};
    const auto add = [&](const std::string& name, int frames, const RunView& run, const std::string& parts) {
      table.rows.push_back({name, fmt::format("{}", frames),
                            error_text(run.evaluation.rpe_time.translation_m),
                            error_text(run.evaluation.ate.translation_m), parts});
    };
    add(session.run->name, session.processed, *session.run, "");
    for (const GhostView& ghost : session.debug.ghosts)
      add(ghost.name, static_cast<int>(ghost.run->records.size()), *ghost.run,
          ghost.diverged ? fmt::format("{}", *ghost.diverged) : std::string());
    return table;
  }

  static void run_row(const UiFrame& frame, const SessionView& session, const ListedRun& listed,
                      const RunLook& look, const std::string& name, int processed) {
    const RunView& run = *listed.run;
    ImGui::TableNextRow();
    ImGui::TableNextColumn();
    ImGui::PushID(listed.name.c_str());
    if (frame.runs != nullptr) draw_picture_tick(frame, session, listed);
    ImGui::PopID();
    ImGui::AlignTextToFramePadding();
    const ImVec2 at = ImGui::GetCursorScreenPos();
    draw_sign(frame, *ImGui::GetWindowDrawList(),
              {at.x + 8.0F * frame.scale, at.y + 0.5F * ImGui::GetFrameHeight()}, 4.0F * frame.scale,
              look.sign, to_u32(look.colour));
    ImGui::SetCursorPosX(ImGui::GetCursorPosX() + 20.0F * frame.scale);
    text_in_room(name, frame.theme.text);
    ImGui::TableNextColumn();
    ImGui::Text("%d", processed);
    ImGui::TableNextColumn();
    ImGui::TextUnformatted(error_text(run.evaluation.rpe_time.translation_m).c_str());
    ImGui::TableNextColumn();
    ImGui::TextUnformatted(error_text(run.evaluation.ate.translation_m).c_str());
  }

  void ghost_row(const UiFrame& frame, const SessionView& session, std::size_t index, PanelActions& actions) {
    const GhostView& ghost = session.debug.ghosts[index];
    ImGui::PushID(static_cast<int>(index));
    const std::vector<ListedRun> listed = listed_runs(session);
    const ListedRun& own = listed[listed.size() - session.debug.ghosts.size() + index];
    run_row(frame, session, own, ghost_look(session.debug.ghosts, index, frame.theme.name),
            ghost.name + (ghost.busy ? "  running…" : ""), static_cast<int>(ghost.run->records.size()));
    if (index == chosen_)
      ImGui::TableSetBgColor(ImGuiTableBgTarget_RowBg0, to_u32(frame.theme.accent, 0.18F));
    ImGui::TableNextColumn();
    if (ghost.diverged) {
      const std::string frame_text = fmt::format("{}", *ghost.diverged);
      if (ImGui::SmallButton(frame_text.c_str())) actions.go_to_frame = ghost.diverged;
      if (ImGui::IsItemHovered()) ImGui::SetTooltip("The first frame that differs; click to go there (D)");
    } else {
      // Two runs part nowhere when both have gone all the way.
      const bool goes_on = ghost.busy || session.run->records.size() < ghost.run->records.size();
      ImGui::TextDisabled(goes_on ? "…" : "nowhere");
    }
    ImGui::TableNextColumn();
    if (ImGui::SmallButton(icons::kClose)) {
      actions.requests.push_back(request::RemoveGhost{static_cast<int>(index)});
      if (frame.runs != nullptr) frame.runs->forget(own.name);
    }
    if (ImGui::IsItemHovered()) ImGui::SetTooltip("Remove this run");
    // A click anywhere else in the row chooses the run.
    const ImVec2 low{ImGui::GetWindowPos().x, ImGui::GetItemRectMin().y};
    const ImVec2 high{ImGui::GetItemRectMin().x - 60.0F * frame.scale, low.y + ImGui::GetFrameHeight()};
    if (ImGui::IsWindowHovered() && ImGui::IsMouseHoveringRect(low, high) && ImGui::IsMouseClicked(0))
      chosen_ = index;
    ImGui::PopID();
  }

  void draw_frame_shown(const UiFrame& frame, const SessionView& session, const GhostView& ghost,
                        PanelActions& actions) {
    const ImVec2 room = ImGui::GetContentRegionAvail();
    // Three columns that can be read, or none beside the picture.
    const float least = 250.0F * frame.scale;
    const bool beside = room.x > 1.5F * room.y && room.x > 1.8F * least;
    const float figures_width = beside ? std::clamp(0.42F * room.x, least, 330.0F * frame.scale) : room.x;
    const float row = frame.fonts.small->FontSize + 4.0F * frame.scale;
    const float figures_height = row * static_cast<float>(difference_.figures.size() + 2);
    const bool has_figures = beside || room.y > figures_height + 120.0F * frame.scale;
    const float gap = ImGui::GetStyle().ItemSpacing.x;
    const ImVec2 picture = beside ? ImVec2{room.x - figures_width - gap, room.y}
                                  : ImVec2{room.x, has_figures ? room.y - figures_height - gap : room.y};
    ImGui::BeginChild("masks", picture);
    draw_masks(frame, session, ghost, actions);
    ImGui::EndChild();
    if (!has_figures) return;
    if (beside) ImGui::SameLine(0.0F, gap);
    ImGui::BeginChild("figures", {0.0F, 0.0F});
    draw_figures(frame, session, ghost);
    ImGui::EndChild();
  }

  void draw_masks(const UiFrame& frame, const SessionView& session, const GhostView& ghost,
                  PanelActions& actions) {
    const FrameView& view = *session.current;
    if (!view.frame.readable() || ghost.current == nullptr || ghost.current->index != view.index) {
      draw_absent(frame, view.frame.readable() ? "This run's images of the frame are not there yet."
                                               : "The frame cannot be shown: " + view.frame.problem);
      return;
    }
    for (const auto& [record, name] :
         {std::pair(view.record, session.run->name), std::pair(ghost.current->record, ghost.name)})
      if (record != nullptr && !record->measured.mask) {
        draw_absent(frame, fmt::format("{} left no mask of frame {} to compare.", name, view.index));
        return;
      }
    const ComparisonColours colours{
        .agreed = okabe_ito::kGreen,
        .missed = ghost_look(ghost.look.value_or(chosen_), frame.theme.name).colour,
        .wrong = okabe_ito::kSkyBlue};
    // The ghost's image is another object whenever its frame or its run changes.
    const Texture& compared = compared_.get(frame, ghost.current, static_cast<int>(chosen_), [&] {
      const cv::Size size = view.frame.gray.size();
      const cv::Mat run = or_nothing(view.mask, size), other = or_nothing(ghost.current->mask, size);
      overlap_ = overlap_of(run, other);
      return compared_masks(run, other, colours);
    });
    const auto share = [&](int pixels) {
      return 100.0 * pixels / static_cast<double>(std::max<std::size_t>(view.frame.gray.total(), 1));
    };
    Footer footer;
    footer.legend = {{fmt::format("both {:.1f} %", share(overlap_.both)), colours.agreed, Sign::kSquare},
                     {fmt::format("only {} {:.1f} %", session.run->name, share(overlap_.only_run)),
                      colours.wrong, Sign::kBackHatch},
                     {fmt::format("only {} {:.1f} %", ghost.name, share(overlap_.only_ghost)), colours.missed,
                      Sign::kHatch}};
    const auto iou = overlap_.iou();
    footer.caption =
        fmt::format("{}: what each run took out{}.", frame_text(session, view.frame),
                    iou ? fmt::format("; they share {:.0f} %", 100.0 * *iou) : "; neither took anything");
    ImageContent content;
    content.texture = &ground_.get(frame, session.current, 0, [&] { return picture_of(view.frame); });
    content.values = &view.frame.gray;
    content.overlays.push_back({&compared, 1.0F});
    draw_frame_image(frame, "compared", content, *shared_, room_above(frame, footer), {session, actions});
    footer.draw(frame);
  }

  void draw_figures(const UiFrame& frame, const SessionView& session, const GhostView& ghost) const {
    ImGui::PushFont(frame.fonts.small);
    ImGui::PushTextWrapPos(0.0F);
    ImGui::TextUnformatted(pose_text(difference_, ghost.outside ? ghost.name : session.outside,
                                     in_worlds_of_their_own(session, ghost))
                               .c_str());
    ImGui::PopTextWrapPos();
    ImGui::PushStyleVar(ImGuiStyleVar_CellPadding, {4.0F * frame.scale, 1.0F * frame.scale});
    const ImVec2 low = ImGui::GetCursorScreenPos();
    if (ImGui::BeginTable("figures", 3, ImGuiTableFlags_BordersInnerH | ImGuiTableFlags_SizingStretchProp)) {
      ImGui::TableSetupColumn("", ImGuiTableColumnFlags_WidthStretch, 1.2F);
      ImGui::TableSetupColumn(session.run->name.c_str(), ImGuiTableColumnFlags_WidthStretch, 1.0F);
      ImGui::TableSetupColumn(ghost.name.c_str(), ImGuiTableColumnFlags_WidthStretch, 1.0F);
      ImGui::TableHeadersRow();
      for (const FigurePair& pair : difference_.figures) {
        ImGui::TableNextRow();
        ImGui::TableNextColumn();
        ImGui::TextDisabled("%s", pair.name.c_str());
        ImGui::TableNextColumn();
        ImGui::TextUnformatted(pair.run.c_str());
        ImGui::TableNextColumn();
        if (pair.differs)
          ImGui::TextColored(to_vec4(frame.theme.accent), "%s  ≠", pair.ghost.c_str());
        else
          ImGui::TextUnformatted(pair.ghost.c_str());
      }
      ImGui::EndTable();
    }
    offer_table(frame, "compared_frame", low, [&] {
      Table table{{"figure", session.run->name, ghost.name}, {}};
      for (const FigurePair& pair : difference_.figures)
        table.rows.push_back({pair.name, pair.run, pair.ghost});
      return table;
    });
    ImGui::PopStyleVar();
    ImGui::PopFont();
  }

  std::size_t chosen_ = 0;
  FrameDifference difference_;
  MaskOverlap overlap_;
  FrameTexture ground_, compared_;
};

}  // namespace

std::unique_ptr<Panel> make_compare_panel(Shared shared) {
  return std::make_unique<ComparePanel>(std::move(shared));
}

}  // namespace stillpoint
