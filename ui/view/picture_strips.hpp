#pragma once

#include <imgui.h>

#include <string>
#include <vector>

#include "ui/theme/theme.hpp"

namespace stillpoint {

struct UiFrame;

/// What stands in one strip.
struct PictureStrip {
  std::string name;    ///< written into it
  Rgb colour;          ///< … in this colour
  std::string absent;  ///< a sentence where it has no picture
};

/// Pictures of several makers in one place, each in an upright strip of it. Whoever draws them does so once
/// for each strip, in turn: the first pass that has pictures gives them their places, and draw_image() lays
/// those of later passes, which have the same ids, over them.
class PictureStrips {
 public:
  /// @param dividers ascending shares of a picture's width, one fewer than strips; dragging changes them
  PictureStrips(std::vector<PictureStrip> strips, std::vector<float>& dividers);

  /// Where a picture stands.
  struct Place {
    std::string id;
    ImVec2 low, high;                 ///< px, of the panel it fills
    float from = 0.0F, to = 0.0F;     ///< px, the columns in which the picture itself is seen …
    float top = 0.0F, bottom = 0.0F;  ///< … and the rows
    bool hovered = false, clicked = false, right_clicked = false;  ///< the whole of it
    std::vector<bool> drawn;                                       ///< by strip
  };

  /// Begins the pass of a strip. @param takes_clicks what is clicked in it is its own
  void begin(std::size_t strip, bool takes_clicks);
  /// The place of this pass's picture; null where a new one is to be made, if any is (makes_places()).
  [[nodiscard]] Place* find(const char* id);
  [[nodiscard]] bool makes_places() const { return makes_places_; }
  Place& add(const char* id, ImVec2 low, ImVec2 high);
  /// Whether this is a pass that draws pictures and nothing else.
  [[nodiscard]] bool pictures_alone() const { return passes_ > 1; }
  /// Whether a picture is of several, and not one in the place of another.
  [[nodiscard]] bool several() const { return strips_.size() > 1; }
  [[nodiscard]] bool takes_clicks() const { return takes_clicks_; }
  /// Marks a picture as drawn in the strip at hand.
  void note_drawn(Place& place) { place.drawn[strip_] = true; }
  /// What the strip at hand has instead of pictures.
  void say_absent(const std::string& sentence);

  /// The strip at hand of a place, px: its edges from left to right.
  struct Edges {
    float from = 0.0F, to = 0.0F;
  };
  [[nodiscard]] Edges edges(const Place& place) const { return edges(place, strip_); }
  /// Lets the mouse drag the divider it is on. @returns whether the mouse is the dividers'
  bool drag(const UiFrame& frame, Place& place);

  /// Names, dividers, and what is missing: after the last pass. Without any picture the sentences stand side
  /// by side in the rectangle given, px.
  void finish(const UiFrame& frame, ImVec2 low, ImVec2 high);

 private:
  [[nodiscard]] Edges edges(const Place& place, std::size_t strip) const;
  void draw_strip(const UiFrame& frame, const Place& place, std::size_t strip) const;

  std::vector<PictureStrip> strips_;
  std::vector<float>& dividers_;
  std::vector<Place> places_;
  std::size_t strip_ = 0;
  int passes_ = 0;
  float absent_from_ = -1e6F;  // px, of the display: above it stand controls
  bool makes_places_ = true, takes_clicks_ = true;
};

}  // namespace stillpoint
