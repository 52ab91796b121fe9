#pragma once

#include <imgui.h>

#include <opencv2/core.hpp>
#include <optional>
#include <string>
#include <vector>

#include "core/geometry/pixel_conventions.hpp"
#include "ui/theme/palette.hpp"
#include "ui/view/image_view.hpp"

namespace stillpoint {

class Texture;
struct UiFrame;

/// An image laid over another.
struct ImageOverlay {
  const Texture* texture = nullptr;
  float opacity = 0.5F;
  Rgb colour{255, 255, 255};       ///< times its own; of a cover (OneChannel) all of it
  std::optional<cv::Rect> part{};  ///< of its pixels, those that are not all transparent; else any may be
};

/// What an image panel shows.
struct ImageContent {
  const Texture* texture = nullptr;      ///< null or empty: `absent` is written instead
  std::vector<ImageOverlay> overlays{};  ///< same extent as the image, drawn in order
  const cv::Mat* values =
      nullptr;  ///< whose numbers stand on the pixels when zoomed in; any depth, 1 or 3 channels
  std::string absent = "No image";    ///< says what is missing
  bool drawn_on = false;              ///< the left button draws: it neither pans nor fits the image
  float wipe = 1.0F;                  ///< share of the width, from the left, that `texture` covers …
  const Texture* wiped_to = nullptr;  ///< … over this one
};

/// Where things are in a drawn image panel, for drawing on it, and what the mouse points at.
struct ImageResponse {
  ImageMap map{{}, {1.0, 1.0}, {1.0, 1.0}};
  ImVec2 panel_min, panel_max;  ///< px, of the display
  bool hovered = false;
  std::optional<RasterPoint> image_point;  ///< under the mouse
  std::optional<Eigen::Vector2i> pixel;    ///< under the mouse
  bool clicked = false;                    ///< left, pressed and released in place
  bool right_clicked = false;              ///< the same of the right button
  ImVec2 clip_min,
      clip_max;             ///< px, of the display: what is seen of the panel, a strip where there are strips
  bool clips_anew = false;  ///< … which lies in what is clipped otherwise

  /// Where a point of the image is on the display.
  [[nodiscard]] ImVec2 to_screen(const RasterPoint& image) const;
};

/// Draws an image into the given size (0 takes what is left) at ImGui's cursor; wheel zooms about the cursor,
/// drag with any button pans, double click fits. Afterwards, draw on it between push_clip and pop_clip. Where
/// the frame has strips, it is drawn into the strip at hand.
ImageResponse draw_image(const UiFrame& frame, const char* id, const ImageContent& content, ImageView& view,
                         ImVec2 size = {0, 0});

/// Confines ImGui's current draw list to an image panel, and lifts that again.
void push_clip(const ImageResponse& response);
void pop_clip();

/// The numbers of a pixel as text, one a line and channel: "128", "12\n80\n255" (R, G, B), "0.52".
[[nodiscard]] std::string pixel_text(const cv::Mat& image, int x, int y);

}  // namespace stillpoint
