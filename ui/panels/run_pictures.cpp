#include "ui/panels/run_pictures.hpp"

#include <algorithm>

#include "core/check/findings.hpp"
#include "core/inspect/frame_view.hpp"
#include "core/inspect/run_view.hpp"
#include "core/run/removal_errors.hpp"
#include "core/run/saved_map.hpp"
#include "core/run/sweep.hpp"
#include "ui/panels/panel_choices.hpp"
#include "ui/panels/run_look.hpp"
#include "ui/view/picture_strips.hpp"

namespace stillpoint {
namespace {

std::vector<PictureStrip> strips_of(const std::vector<ListedRun>& runs, ThemeName theme) {
  std::vector<PictureStrip> strips;
  for (const ListedRun& run : runs) strips.push_back({run.name, run_colour(run, theme), run.no_pictures});
  return strips;
}

/// Whether its pictures can be set against those of other runs.
bool has_pictures(Panel& panel) {
  if (panel.others.empty())
    if (auto one = panel.another()) panel.others.push_back(std::move(one));
  return !panel.others.empty();
}

void draw_run(UiFrame& frame, const SessionView& session, const ListedRun& run, Panel& panel,
              PanelActions& actions) {
  if (run.kind == ListedRun::Kind::own)
    panel.draw(frame, session, actions);
  else
    panel.draw(frame, as_run(session, run), actions);
}

/// The strips after the first: another panel each, which draws nothing but pictures into the first one's
/// places, with the choices that its controls show.
void draw_beside(UiFrame& frame, const SessionView& session, const ListedRun& run, Panel& panel,
                 std::size_t index, PanelActions& actions) {
  while (panel.others.size() <= index) panel.others.push_back(panel.another());
  PanelChoices mirror = frame.choices == nullptr ? PanelChoices() : frame.choices->mirrored();
  PanelChoices* const choices = std::exchange(frame.choices, &mirror);
  const bool controls = std::exchange(frame.controls, false);
  ImGui::PushID(static_cast<int>(index));
  const ImVec2 nowhere = ImGui::GetCursorScreenPos();
  ImGui::PushClipRect(nowhere, nowhere, false);
  draw_run(frame, session, run, *panel.others[index], actions);
  ImGui::PopClipRect();
  ImGui::PopID();
  frame.controls = controls;
  frame.choices = choices;
}

void draw_wiped(UiFrame& frame, const SessionView& session, Panel& panel, const std::vector<ListedRun>& runs,
                PanelActions& actions) {
  frame.runs->fit_dividers(runs.size());
  PictureStrips strips(strips_of(runs, frame.theme.name), frame.runs->dividers);
  frame.strips = &strips;
  const ImVec2 start = ImGui::GetCursorScreenPos(), room = ImGui::GetContentRegionAvail();
  std::size_t drawn = 0;
  for (std::size_t i = 0; i < runs.size(); ++i) {
    if (!runs[i].no_pictures.empty()) continue;
    // A feature that is clicked is looked up among those of the session's own run.
    strips.begin(i, runs[i].kind == ListedRun::Kind::own);
    ImGui::SetCursorScreenPos(start);
    if (drawn == 0)
      draw_run(frame, session, runs[i], panel, actions);
    else
      draw_beside(frame, session, runs[i], panel, drawn - 1, actions);
    ++drawn;
  }
  frame.strips = nullptr;
  strips.finish(frame, start, {start.x + room.x, start.y + room.y});
  ImGui::SetCursorScreenPos(start);
  ImGui::Dummy(room);
}

/// One run in place, its name on every picture.
void draw_flipped(UiFrame& frame, const SessionView& session, Panel& panel, const ListedRun& run,
                  PanelActions& actions) {
  std::vector<float> none;
  PictureStrips strips(strips_of({run}, frame.theme.name), none);
  const ImVec2 start = ImGui::GetCursorScreenPos(), room = ImGui::GetContentRegionAvail();
  if (has_pictures(panel) || !run.no_pictures.empty()) frame.strips = &strips;
  strips.begin(0, true);
  if (run.no_pictures.empty()) draw_run(frame, session, run, panel, actions);
  if (std::exchange(frame.strips, nullptr) == nullptr) return;
  strips.finish(frame, start, {start.x + room.x, start.y + room.y});
  ImGui::SetCursorScreenPos(start);
  ImGui::Dummy(room);
}

}  // namespace

Rgb run_colour(const ListedRun& run, ThemeName theme) {
  switch (run.kind) {
    case ListedRun::Kind::own:
      return role_colour(Role::kEstimate, theme);
    case ListedRun::Kind::baseline:
      return role_colour(Role::kBaseline, theme);
    case ListedRun::Kind::ghost:
      break;
  }
  return ghost_look(run.look, theme).colour;
}

bool is_by_runs(const UiFrame& frame, const SessionView& session, const Panel& panel) {
  // What is worked out anew while a slider moves is the session's own run's alone.
  return frame.runs != nullptr && frame.runs->pictures != RunPictures::alone && panel.shows_a_run() &&
         !session.current->image_alone && session.current != session.debug.preview;
}

void draw_by_runs(UiFrame& frame, const SessionView& session, Panel& panel, PanelActions& actions) {
  if (!is_by_runs(frame, session, panel)) return panel.draw(frame, session, actions);
  if (const auto flipped = frame.runs->flipped(session))
    return draw_flipped(frame, session, panel, *flipped, actions);
  const std::vector<ListedRun> runs = frame.runs->chosen_of(session);
  // A single run is what is seen, whichever it is.
  if (frame.runs->pictures == RunPictures::wiped && runs.size() == 1 && runs[0].kind != ListedRun::Kind::own)
    return draw_flipped(frame, session, panel, runs[0], actions);
  if (frame.runs->pictures != RunPictures::wiped || runs.size() < 2 || !has_pictures(panel))
    return panel.draw(frame, session, actions);
  draw_wiped(frame, session, panel, runs, actions);
}

}  // namespace stillpoint
