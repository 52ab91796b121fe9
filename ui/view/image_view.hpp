#pragma once

#include <Eigen/Core>
#include <map>
#include <optional>
#include <string>

#include "core/geometry/pixel_conventions.hpp"

namespace stillpoint {

// Zoom and pan of an image, without GL or ImGui.
//
// Points of an image are raster coordinates (core/geometry/pixel_conventions.hpp). Panel coordinates: px from
// the panel's upper left corner.

/// What part of an image is seen: plain data. Relative to the image's size, so that views of images of
/// different size can be linked.
struct ImageView {
  Eigen::Vector2d centre{0.5, 0.5};  ///< the point in the panel's middle, as shares of width and height
  double zoom = 1.0;                 ///< times the size at which the whole image just fits
  bool operator==(const ImageView&) const = default;
};

/// An image in a panel under a view.
class ImageMap {
 public:
  /// Sizes in px; an image or panel without area is taken as 1 px.
  ImageMap(const ImageView& view, const Eigen::Vector2d& image_size, const Eigen::Vector2d& panel_size);

  [[nodiscard]] double scale() const { return scale_; }  ///< panel px an image px
  [[nodiscard]] Eigen::Vector2d to_panel(const RasterPoint& image) const;
  [[nodiscard]] RasterPoint to_image(const Eigen::Vector2d& panel) const;

  /// The pixel under a panel point, or nothing beside the image.
  [[nodiscard]] std::optional<Eigen::Vector2i> pixel_at(const Eigen::Vector2d& panel) const;

 private:
  Eigen::Vector2d image_size_, origin_;  ///< origin_: where the image's corner lies in the panel
  double scale_;
};

/// The scale at which the whole image just fits the panel.
[[nodiscard]] double fit_scale(const Eigen::Vector2d& image_size, const Eigen::Vector2d& panel_size);

/// Comes nearer by `factor` (> 1), the image point under `cursor` staying there. Zoom runs from a quarter of
/// the fitting size to 256 px a pixel.
void zoom_about(ImageView& view, const Eigen::Vector2d& image_size, const Eigen::Vector2d& panel_size,
                const Eigen::Vector2d& cursor, double factor);

/// Drags the image by `delta` panel px. The panel's middle never leaves the image.
void pan_by(ImageView& view, const Eigen::Vector2d& image_size, const Eigen::Vector2d& panel_size,
            const Eigen::Vector2d& delta);

/// Shows the image at `scale` panel px a pixel (1: as it is), about the panel's middle.
void set_scale(ImageView& view, const Eigen::Vector2d& image_size, const Eigen::Vector2d& panel_size,
               double scale);

/// Moves as little as brings an image point into view.
void reveal(ImageView& view, const Eigen::Vector2d& image_size, const Eigen::Vector2d& panel_size,
            const RasterPoint& image_point);

/// Views by name: panels that use one name zoom and pan together.
class LinkedViews {
 public:
  [[nodiscard]] ImageView& at(const std::string& key) { return views_[key]; }
  [[nodiscard]] const std::map<std::string, ImageView>& all() const { return views_; }

 private:
  std::map<std::string, ImageView> views_;
};

}  // namespace stillpoint
