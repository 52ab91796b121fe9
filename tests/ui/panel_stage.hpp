#pragma once

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <utility>

#include "ui/panels/panel.hpp"
#include "ui/shell/offscreen.hpp"

namespace stillpoint::testing {

/// One panel offscreen, filling the image, as `snapshot` draws it.
class PanelStage {
 public:
  PanelStage(const std::string& name, const Look& look, int width = 520, int height = 420)
      : offscreen_({.width = width, .height = height, .look = look}), panels_(make_panels()) {
    for (const auto& panel : panels_)
      if (panel->name() == name) panel_ = panel.get();
  }
  ~PanelStage() { EXPECT_THAT(offscreen_.take_gl_errors(), ::testing::IsEmpty()) << panel_->name(); }

  cv::Mat render(const SessionView& session) {
    return offscreen_.render([&](UiFrame& frame) { draw(frame, session); });
  }
  /// What the panel asks for when it is clicked at a place of the image, as shares of its size.
  PanelActions click(const SessionView& session, double x, double y) {
    return drag(session, {x, y}, {x, y}, {});
  }
  /// … when the mouse is pressed at one place and let go at another; keys held meanwhile.
  PanelActions drag(const SessionView& session, std::pair<double, double> from, std::pair<double, double> to,
                    const Modifiers& held) {
    const cv::Mat image = render(session);
    const auto moved = [&](std::pair<double, double> place) {
      return MouseMoved{static_cast<float>(place.first * image.cols),
                        static_cast<float>(place.second * image.rows)};
    };
    play(session, {moved(from)});
    actions_ = {};
    return play(session, {MouseButton{0, true, held}, moved(to), MouseButton{0, false, held}});
  }
  /// What the panel asks for while it is given these, and the frames they take to arrive.
  PanelActions play(const SessionView& session, const std::vector<InputEvent>& events) {
    for (const InputEvent& event : events) {
      offscreen_.send(event);
      offscreen_.draw([&](UiFrame& frame) { draw(frame, session); });
    }
    offscreen_.draw([&](UiFrame& frame) { draw(frame, session); });
    return std::exchange(actions_, {});
  }
  void send(const InputEvent& event) { offscreen_.send(event); }
  void resize(int width, int height) { offscreen_.resize(width, height); }

 private:
  void draw(UiFrame& frame, const SessionView& session) {
    ImGui::SetNextWindowPos({0, 0});
    ImGui::SetNextWindowSize(frame.size);
    ImGui::Begin("stage", nullptr, ImGuiWindowFlags_NoDecoration | ImGuiWindowFlags_NoMove);
    panel_->draw(frame, session, actions_);
    ImGui::End();
  }

  Offscreen offscreen_;
  std::vector<std::unique_ptr<Panel>> panels_;
  Panel* panel_ = nullptr;
  PanelActions actions_;
};

}  // namespace stillpoint::testing
