#pragma once

#include <imgui.h>

#include <functional>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "ui/theme/palette.hpp"

namespace stillpoint {

class EventLog;
class Gl;
class PanelChoices;
class PictureStrips;
struct Fonts;
struct RunsShown;
struct Theme;
struct UiPace;

/// How the interface looks, in a window and in images alike.
struct Look {
  ThemeName theme = ThemeName::kDark;
  float scale = 1.0F;  ///< times the design size of text and spacing, 0.5 to 4
  bool operator==(const Look&) const = default;
};

/// Something shown that a person wants as a file.
struct FileOffer {
  std::string name;     ///< of the file, as it is proposed: "errors.svg"
  std::string endings;  ///< its file may have, for people: ".svg, .pdf or .csv"
  std::function<void(const std::string& path)> write;  ///< @throws InputError
};

/// What a frame function works with, and what it may ask of the shell in return.
struct UiFrame {
  const Gl& gl;
  const Fonts& fonts;
  const Theme& theme;
  ImVec2 size;                                ///< px, of the whole
  float scale = 1.0F;                         ///< px a design pixel: multiply lengths by it
  double time_s = 0.0;                        ///< of the interface's own clock; offscreen it ticks by frames
  bool controls = true;                       ///< false in pictures for print: panels leave out their buttons
  std::vector<std::string> dropped_files{};   ///< since the frame before
  bool close_requested = false;               ///< the person closes the window
  const UiPace* pace = nullptr;               ///< how fast the interface is; null where nobody measures
  const EventLog* log = nullptr;              ///< what was said; null where nothing is
  PanelChoices* choices = nullptr;            ///< of the panel being drawn; null where none are kept
  RunsShown* runs = nullptr;                  ///< which runs pictures show; null: the session's own
  PictureStrips* strips = nullptr;            ///< while pictures of several runs are drawn; null mostly
  std::optional<FileOffer>* offer = nullptr;  ///< where what is to be saved is put; null where nothing can be
  std::vector<FileOffer>* all_offers = nullptr;  ///< where all that could be is put; null where nobody asks
  bool busy = false;                             ///< work goes on beside the interface: its pace counts
  Look wanted_look{};                            ///< from the next frame on
  double redraw_after_s = std::numeric_limits<double>::infinity();  ///< draw again by then even without input
  bool quit = false;                                                ///< leave the shell's loop
  bool changed = true;  ///< the picture is another than that of the frame before; known once it is drawn
};

/// Draws one frame of the interface through ImGui, whose context is current.
using FrameFunction = std::function<void(UiFrame&)>;

}  // namespace stillpoint
