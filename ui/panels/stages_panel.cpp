#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "core/evaluation/tables.hpp"
#include "core/inspect/frame_stages.hpp"
#include "core/inspect/frame_view.hpp"
#include "core/inspect/stage_change.hpp"
#include "ui/panels/all_panels.hpp"
#include "ui/panels/panel_command.hpp"
#include "ui/panels/panels_shared.hpp"
#include "ui/panels/stage_drawing.hpp"
#include "ui/plot/right_click.hpp"
#include "ui/shell/input.hpp"
#include "ui/theme/fonts.hpp"
#include "ui/theme/icons.hpp"
#include "ui/view/picture_strips.hpp"

namespace stillpoint {
namespace {

constexpr float kListWidth = 206.0F, kListFrom = 620.0F;  // design px
constexpr std::array<const char*, 3> kAgainst{"Stage before", "Round before", "Frame before"};

std::string time_text(const Stage& stage) {
  return stage.timed && stage.ms > 0.0 ? fmt::format("{:.2f} ms", stage.ms) : std::string("–");
}

/// A frame's way through its method, one stage at a time: what it takes, makes, takes in time and changes.
class StagesPanel final : public FramePanel {
 public:
  explicit StagesPanel(Shared shared) : FramePanel("stages", "Stages", std::move(shared)) {}

  [[nodiscard]] std::vector<PanelCommand> commands() override {
    const auto step = [this](int by) {
      return [this, by](const SessionView& session, PanelActions& actions) { step_by(session, actions, by); };
    };
    return {{.name = "stage_next",
             .title = "Next stage of the frame",
             .group = "Playback",
             .icon = icons::kChevronDown,
             .keys = {{Key::kDown, {}}},
             .repeats = true,
             .shows = true,
             .run = step(1)},
            {.name = "stage_previous",
             .title = "Previous stage of the frame",
             .group = "Playback",
             .icon = icons::kChevronUp,
             .keys = {{Key::kUp, {}}},
             .repeats = true,
             .shows = true,
             .run = step(-1)}};
  }

  [[nodiscard]] PanelSize least() const override { return {420.0F, 280.0F}; }

  [[nodiscard]] std::unique_ptr<Panel> another() const override {
    return std::make_unique<StagesPanel>(shared_);
  }

  void draw(UiFrame& frame, const SessionView& session, PanelActions& actions) override {
    actions.compare_frames = true;
    list(session);
    const FrameView& view = *session.current;
    if (stages_.empty()) {
      draw_absent(frame, !view.frame.readable() || view.record != nullptr
                             ? missing_motion(session)
                             : fmt::format("Frame {} has not been processed yet.", view.index));
      return;
    }
    if (frame.strips != nullptr && frame.strips->pictures_alone()) {
      draw_pictures_alone(frame, {session, actions});
      return;
    }
    const std::size_t current = current_index();
    shared_->stage_of_strips = stages_[current];
    shared_->stage_of_strips->sides.clear();
    draw_controls(frame, session, actions, current);
    const bool wide = ImGui::GetContentRegionAvail().x > kListFrom * frame.scale;
    if (wide) {
      ImGui::BeginChild("list", {kListWidth * frame.scale, 0.0F});
      draw_list(frame, current);
      ImGui::EndChild();
      ImGui::SameLine();
    }
    // No window of its own: pictures of other runs are laid over these.
    ImGui::BeginGroup();
    draw_stage(frame, {session, actions}, stages_[current_index()], !wide);
    ImGui::EndGroup();
  }

 private:
  /// Of another run, in the places of the first one's pictures.
  void draw_pictures_alone(const UiFrame& frame, const FramePlace& place) {
    Controls(frame).choice("against", {kAgainst.begin(), kAgainst.end()}, against_);
    if (!shared_->stage_of_strips) return;
    const Stage& wanted = *shared_->stage_of_strips;
    alone_ = find_stage(stages_, wanted);
    const Stage& stage = stages_[*alone_];
    if (!wanted.same_place(stage)) {
      draw_absent(frame, fmt::format("Method {} has no stage \"{}\".", maker_of(place.session), wanted.name));
      return;
    }
    if (stage.sides.size() > 1) {
      std::vector<std::string> names;
      for (const StageSide& side : stage.sides) names.push_back(side.name);
      Controls(frame).choice("direction", names, direction_);
    }
    prepare(place.session, stage);
    const ImVec2 room = ImGui::GetContentRegionAvail();
    draw_pictures(frame, place, {room.x, room.y - ImGui::GetStyle().ItemSpacing.y});
  }

  void list(const SessionView& session) {
    const bool same = !listed_.owner_before(session.current) && !session.current.owner_before(listed_);
    if (same && !stages_.empty()) return;
    stages_ = stages_of(*session.current);
    listed_ = session.current;
    shown_.reset();
  }

  [[nodiscard]] std::size_t current_index() const {
    if (alone_) return *alone_;
    return shared_->stage ? find_stage(stages_, *shared_->stage) : telling_stage(stages_);
  }

  void choose(std::size_t index) {
    shared_->stage = stages_[index];
    shared_->stage->sides.clear();  // its place is enough
    scroll_ = true;
  }

  /// Beyond a frame's last stage lies the next frame's first one.
  void step_by(const SessionView& session, PanelActions& actions, int by) {
    list(session);
    if (stages_.empty()) return;
    const int wanted = static_cast<int>(current_index()) + by, count = static_cast<int>(stages_.size());
    if (wanted >= 0 && wanted < count) {
      choose(static_cast<std::size_t>(wanted));
      return;
    }
    const int frame = session.current->index + by;
    if (frame < 0 || frame >= session.frame_count) return;
    actions.go_to_frame = frame;
    choose(by > 0 ? 0 : stages_.size() - 1);
  }

  void draw_controls(const UiFrame& frame, const SessionView& session, PanelActions& actions,
                     std::size_t current) {
    Controls controls(frame);
    if (controls.button(icons::kChevronUp, "The stage before (Up)")) step_by(session, actions, -1);
    if (controls.button(icons::kChevronDown, "The next stage (Down)")) step_by(session, actions, 1);
    const Stage& stage = stages_[current];
    if (stage.sides.size() > 1) {
      std::vector<std::string> names;
      for (const StageSide& side : stage.sides) names.push_back(side.name);
      controls.choice("direction", names, direction_);
    }
    controls.choice("against", {kAgainst.begin(), kAgainst.end()}, against_,
                    "What the stage is compared with to show what changed");
  }

  void draw_list(const UiFrame& frame, std::size_t current) {
    ImGui::PushFont(frame.fonts.small);
    double longest = 0.0;
    for (const Stage& stage : stages_) longest = std::max(longest, stage.timed ? stage.ms : 0.0);
    const float right = ImGui::GetWindowContentRegionMax().x;
    std::string group;
    for (std::size_t i = 0; i < stages_.size(); ++i) {
      const Stage& stage = stages_[i];
      if (stage.group != group) {
        group = stage.group;
        ImGui::TextDisabled("%s", group.c_str());
      }
      const ImVec2 low = ImGui::GetCursorScreenPos();
      ImGui::PushID(static_cast<int>(i));
      if (ImGui::Selectable("##stage", i == current)) choose(i);
      ImGui::PopID();
      if (i == current && std::exchange(scroll_, false)) ImGui::SetScrollHereY(0.5F);
      draw_row(frame, stage, low, right, longest, i == current);
    }
    ImGui::PopFont();
  }

  /// A stage's name, its time, and a bar as long as it took.
  static void draw_row(const UiFrame& frame, const Stage& stage, ImVec2 low, float right, double longest,
                       bool current) {
    ImDrawList& list = *ImGui::GetWindowDrawList();
    const float width = right - 4.0F * frame.scale, line = ImGui::GetTextLineHeight();
    const std::string time = time_text(stage);
    if (stage.timed && longest > 0.0) {
      const float bar = 52.0F * frame.scale * static_cast<float>(stage.ms / longest);
      list.AddRectFilled({low.x + width - bar, low.y + line - 2.0F * frame.scale},
                         {low.x + width, low.y + line}, to_u32(frame.theme.accent, 0.7F));
    }
    list.AddText({low.x + 8.0F * frame.scale, low.y},
                 to_u32(current              ? frame.theme.text
                        : stage.note.empty() ? mix(frame.theme.text, frame.theme.text_dim, 0.4F)
                                             : frame.theme.text_dim),
                 stage.name.c_str());
    list.AddText({low.x + width - ImGui::CalcTextSize(time.c_str()).x, low.y}, to_u32(frame.theme.text_dim),
                 time.c_str());
  }

  void draw_stage(const UiFrame& frame, const FramePlace& place, const Stage& stage, bool narrow) {
    prepare(place.session, stage);
    draw_title(frame, stage, narrow);
    const ImVec2 room = ImGui::GetContentRegionAvail();
    const float line = ImGui::GetTextLineHeightWithSpacing();
    const float table = std::min(0.38F * room.y, line * static_cast<float>(stage.figures.size() + 1));
    Footer footer;
    footer.legend = legend_of(frame, side_.output);
    if (change_) {
      for (LegendEntry& entry : legend_of(frame, change_->layer))
        if (std::none_of(footer.legend.begin(), footer.legend.end(),
                         [&](const LegendEntry& e) { return e.name == entry.name; }))
          footer.legend.push_back(std::move(entry));
      footer.caption = fmt::format("Against {}: {}.", lower(change_->against), change_->text);
    } else {
      footer.caption = std::string("Nothing before it to compare with.");
    }
    const float below = footer.height(frame) + ImGui::GetStyle().ItemSpacing.y;
    draw_pictures(
        frame, place,
        {room.x, std::max(room.y - table - below - ImGui::GetStyle().ItemSpacing.y, 60.0F * frame.scale)});
    footer.draw(frame);
    ImGui::BeginChild("figures");
    draw_figures(frame, stage);
    ImGui::EndChild();
  }

  [[nodiscard]] static std::string lower(std::string text) {
    if (!text.empty()) text[0] = static_cast<char>(std::tolower(static_cast<unsigned char>(text[0])));
    return text;
  }

  void draw_title(const UiFrame& frame, const Stage& stage, bool narrow) const {
    ImGui::PushFont(frame.fonts.strong);
    ImGui::TextUnformatted(stage.name.c_str());
    ImGui::PopFont();
    ImGui::SameLine();
    const auto index = static_cast<int>(current_index());
    std::string where = fmt::format("{} of {}, {}", index + 1, stages_.size(), lower(stage.group));
    if (stage.timed && stage.ms > 0.0) where += fmt::format(", {:.2f} ms", stage.ms);
    ImGui::TextDisabled("%s", where.c_str());
    if (narrow && ImGui::GetContentRegionAvail().y < 260.0F * frame.scale) return;
    ImGui::PushFont(frame.fonts.small);
    ImGui::TextWrapped("%s%s%s", stage.what.c_str(), stage.note.empty() ? "" : " ", stage.note.c_str());
    ImGui::PopFont();
  }

  /// The output large; what it was made of and what changed smaller beside it.
  void draw_pictures(const UiFrame& frame, const FramePlace& place, ImVec2 room) {
    const ImVec2 start = ImGui::GetCursorScreenPos();
    const float gap = 4.0F * frame.scale;
    const bool beside = room.x > 0.9F * room.y;
    const int small = static_cast<int>(side_.inputs.size()) + (change_ ? 1 : 0);
    const float share = small == 0 ? 1.0F : 0.62F;
    const ImVec2 large = beside ? ImVec2{std::floor(share * (room.x - gap)), room.y}
                                : ImVec2{room.x, std::floor(share * (room.y - gap))};
    int slot = 0;
    const auto draw = [&](const Layer& picture, ImVec2 at, ImVec2 size) {
      ImGui::SetCursorScreenPos(at);
      painters_[static_cast<std::size_t>(slot)].draw(frame, fmt::format("picture {}", slot).c_str(), picture,
                                                     variant_, *shared_, place, size);
      ++slot;
    };
    draw(side_.output, start, large);
    const ImVec2 corner =
        beside ? ImVec2{start.x + large.x + gap, start.y} : ImVec2{start.x, start.y + large.y + gap};
    const ImVec2 rest =
        beside ? ImVec2{room.x - large.x - gap, room.y} : ImVec2{room.x, room.y - large.y - gap};
    const Tiling tiling = tile(frame, rest, std::max(small, 1), place.session.current->frame.gray.size());
    int place_in_tiling = 0;
    if (change_) {
      Layer picture = change_->layer;
      picture.name = fmt::format("Against {}", lower(change_->against));
      draw(picture, tiling.corner(corner, place_in_tiling++), tiling.size);
    }
    for (const Layer& picture : side_.inputs)
      if (slot < static_cast<int>(painters_.size()))
        draw(picture, tiling.corner(corner, place_in_tiling++), tiling.size);
    ImGui::SetCursorScreenPos({start.x, start.y + room.y + ImGui::GetStyle().ItemSpacing.y});
  }

  static void draw_figures(const UiFrame& frame, const Stage& stage) {
    if (stage.figures.empty()) return;
    ImGui::PushFont(frame.fonts.small);
    ImGui::PushStyleVar(ImGuiStyleVar_CellPadding, {4.0F * frame.scale, 1.0F * frame.scale});
    const bool rounds = std::any_of(stage.figures.begin(), stage.figures.end(),
                                    [](const StageFigure& f) { return f.round_before.has_value(); });
    const bool frames = std::any_of(stage.figures.begin(), stage.figures.end(),
                                    [](const StageFigure& f) { return f.frame_before.has_value(); });
    const ImVec2 low = ImGui::GetCursorScreenPos();
    if (ImGui::BeginTable("figures", 2 + (rounds ? 1 : 0) + (frames ? 1 : 0),
                          ImGuiTableFlags_BordersInnerH | ImGuiTableFlags_SizingStretchSame)) {
      // By fixed weights: ImGui's own, of what columns hold, leave one that comes later no room.
      const auto column = [](const char* name, float weight) {
        ImGui::TableSetupColumn(name, ImGuiTableColumnFlags_WidthStretch, weight);
      };
      column("Figure", 1.3F);
      column("Now", 1.0F);
      if (rounds) column("Since last round", 1.0F);
      if (frames) column("Since last frame", 1.0F);
      ImGui::TableHeadersRow();
      for (const StageFigure& figure : stage.figures) {
        ImGui::TableNextColumn();
        ImGui::TextDisabled("%s", figure.name.c_str());
        ImGui::TableNextColumn();
        ImGui::TextUnformatted(figure_text(figure).c_str());
        const auto change = [&](const std::optional<double>& before) {
          ImGui::TableNextColumn();
          if (before) ImGui::TextUnformatted(change_text(figure, *before).c_str());
        };
        if (rounds) change(figure.round_before);
        if (frames) change(figure.frame_before);
      }
      ImGui::EndTable();
    }
    offer_table(frame, "stage_figures", low, [&] {
      Table table{{"stage", "figure", "now", "since last round", "since last frame"}, {}};
      for (const StageFigure& figure : stage.figures)
        table.rows.push_back(
            {stage.name, figure.name, figure_text(figure),
             figure.round_before ? change_text(figure, *figure.round_before) : std::string(),
             figure.frame_before ? change_text(figure, *figure.frame_before) : std::string()});
      return table;
    });
    ImGui::PopStyleVar();
    ImGui::PopFont();
  }

  /// Works the pictures out when the frame, the stage or what is asked of it changes.
  void prepare(const SessionView& session, const Stage& stage) {
    const std::size_t direction =
        stage.sides.size() > 1 ? std::min(static_cast<std::size_t>(direction_), stage.sides.size() - 1) : 0;
    if (shown_ && shown_->same_place(stage) && made_direction_ == direction && made_against_ == against_)
      return;
    side_ = stage.sides.empty() ? StageSide{} : stage.sides[direction];
    // What is asked for first, then whatever else there is.
    change_.reset();
    for (const ChangeAgainst against : {static_cast<ChangeAgainst>(against_), ChangeAgainst::kFrameBefore,
                                        ChangeAgainst::kRoundBefore, ChangeAgainst::kStageBefore})
      if (!change_)
        change_ =
            stage_change(*session.current, session.camera, stages_, current_index(), direction, against);
    shown_ = stage;
    shown_->sides.clear();
    made_direction_ = direction;
    made_against_ = against_;
    ++variant_;
  }

  std::vector<Stage> stages_;
  std::optional<std::size_t> alone_;  // of these, the one that strips show; nothing in a panel of its own
  std::weak_ptr<const FrameView> listed_;
  int direction_ = 0, against_ = static_cast<int>(ChangeAgainst::kStageBefore);
  bool scroll_ = true;
  StageSide side_;
  std::optional<StageChange> change_;
  std::optional<Stage> shown_;  // its place
  std::size_t made_direction_ = 0;
  int made_against_ = 0, variant_ = 0;
  std::array<StagePainter, 8> painters_;
};

}  // namespace

std::unique_ptr<Panel> make_stages_panel(Shared shared) {
  return std::make_unique<StagesPanel>(std::move(shared));
}

}  // namespace stillpoint
