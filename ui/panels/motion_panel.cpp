#include <fmt/format.h>

#include <algorithm>

#include "core/inspect/frame_view.hpp"
#include "core/odometry/frame_record.hpp"
#include "ui/panels/all_panels.hpp"
#include "ui/panels/stage_drawing.hpp"

namespace stillpoint {
namespace {

/// The method's way at a glance: what the stages that tell most of it made, side by side, or one of them
/// large.
class MotionPanel final : public FramePanel {
 public:
  explicit MotionPanel(Shared shared) : FramePanel("motion", "Motion stages", std::move(shared)) {}

  [[nodiscard]] PanelSize least() const override { return {320.0F, 190.0F}; }

  [[nodiscard]] std::unique_ptr<Panel> another() const override {
    return std::make_unique<MotionPanel>(shared_);
  }

  void draw(UiFrame& frame, const SessionView& session, PanelActions& actions) override {
    const StageLog& log = *session.current->motion;
    std::vector<const Stage*> stages = overview_of(log);
    // An engine of its own way stands behind the method: its stages follow.
    if (session.current->odometry)
      for (const Stage* stage : overview_of(*session.current->odometry)) stages.push_back(stage);
    if (stages.empty()) {
      draw_absent(frame, missing_motion(session));
      return;
    }
    draw_controls(frame, stages);
    Footer footer;
    const bool all = shown_ == 0;
    if (all) {
      for (const Stage* stage : stages) add_legend(frame, stage->sides.front().output, footer);
    } else {
      add_legend(frame, stages[static_cast<std::size_t>(shown_ - 1)]->sides.front().output, footer);
    }
    footer.caption = caption(session, log, all ? nullptr : stages[static_cast<std::size_t>(shown_ - 1)]);
    const ImVec2 start = ImGui::GetCursorScreenPos(), room = room_above(frame, footer);
    if (all) {
      const auto count = std::min(stages.size(), painters_.size());
      const Tiling tiling = tile(frame, room, static_cast<int>(count), session.current->frame.gray.size());
      for (std::size_t i = 0; i < count; ++i) {
        ImGui::SetCursorScreenPos(tiling.corner(start, static_cast<int>(i)));
        draw_stage(frame, {session, actions}, *stages[i], i, tiling.size);
      }
    } else {
      draw_stage(frame, {session, actions}, *stages[static_cast<std::size_t>(shown_ - 1)],
                 static_cast<std::size_t>(shown_ - 1), room);
    }
    ImGui::SetCursorScreenPos({start.x, start.y + room.y + ImGui::GetStyle().ItemSpacing.y});
    footer.draw(frame);
  }

 private:
  /// The stages that the method marks as telling most of it.
  [[nodiscard]] std::vector<const Stage*> overview_of(const StageLog& log) const {
    std::vector<const Stage*> stages;
    for (const Stage& stage : log.stages)
      if (stage.overview && !stage.sides.empty()) stages.push_back(&stage);
    return stages;
  }

  void draw_controls(const UiFrame& frame, const std::vector<const Stage*>& stages) {
    Controls controls(frame);
    std::vector<std::string> names{"All"};
    for (const Stage* stage : stages) names.push_back(stage->name);
    shown_ = std::clamp(shown_, 0, static_cast<int>(stages.size()));
    controls.choice("stage", names, shown_);
  }

  void draw_stage(const UiFrame& frame, const FramePlace& place, const Stage& stage, std::size_t slot,
                  ImVec2 size) {
    Layer layer = stage.sides.front().output;
    layer.name = stage.name;
    painters_[slot].draw(frame, stage.id.c_str(), layer, static_cast<int>(slot), *shared_, place, size);
  }

  static void add_legend(const UiFrame& frame, const Layer& layer, Footer& footer) {
    for (LegendEntry& entry : legend_of(frame, layer))
      if (std::none_of(footer.legend.begin(), footer.legend.end(),
                       [&](const LegendEntry& known) { return known.name == entry.name; }))
        footer.legend.push_back(std::move(entry));
  }

  [[nodiscard]] static std::string caption(const SessionView& session, const StageLog& log,
                                           const Stage* stage) {
    std::string text = frame_text(session, session.current->frame) + ", method " + log.method;
    if (stage == nullptr) {
      const FrameRecord* record = session.current->record;
      if (record != nullptr && record->mask_share == 0.0 && record->features_removed > 0)
        text += fmt::format(": {} of {} features dynamic", record->features_removed, record->features_found);
      else if (record != nullptr)
        text += fmt::format(": {:.1f} % of the pixels dynamic", 100.0 * record->mask_share);
      return text + (log.note.empty() ? "" : "; " + log.note) + ".";
    }
    for (const StageFigure& figure : stage->figures)
      text += fmt::format("; {} {}", figure.name, figure_text(figure));
    return text + "." + (stage->note.empty() ? "" : " " + stage->note);
  }

  int shown_ = 0;
  std::array<StagePainter, 12> painters_;
};

}  // namespace

std::unique_ptr<Panel> make_motion_panel(Shared shared) {
  return std::make_unique<MotionPanel>(std::move(shared));
}

}  // namespace stillpoint
