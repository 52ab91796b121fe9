#include "ui/view/image_view.hpp"

#include <algorithm>

namespace stillpoint {
namespace {

constexpr double kLeastZoom = 0.25;   // of the size that just fits: smaller, nothing is made out
constexpr double kMostScale = 256.0;  // panel px an image px

Eigen::Vector2d with_area(const Eigen::Vector2d& size) { return size.cwiseMax(1.0); }

void keep_in_image(ImageView& view) { view.centre = view.centre.cwiseMax(0.0).cwiseMin(1.0); }

double clamp_zoom(double zoom, double fitting) {
  return std::clamp(zoom, kLeastZoom, std::max(kLeastZoom, kMostScale / fitting));
}

}  // namespace

double fit_scale(const Eigen::Vector2d& image_size, const Eigen::Vector2d& panel_size) {
  return with_area(panel_size).cwiseQuotient(with_area(image_size)).minCoeff();
}

ImageMap::ImageMap(const ImageView& view, const Eigen::Vector2d& image_size,
                   const Eigen::Vector2d& panel_size)
    : image_size_(with_area(image_size)), scale_(view.zoom * fit_scale(image_size, panel_size)) {
  origin_ = 0.5 * with_area(panel_size) - scale_ * view.centre.cwiseProduct(image_size_);
}

Eigen::Vector2d ImageMap::to_panel(const RasterPoint& image) const { return origin_ + scale_ * image.px(); }

RasterPoint ImageMap::to_image(const Eigen::Vector2d& panel) const {
  return RasterPoint((panel - origin_) / scale_);
}

std::optional<Eigen::Vector2i> ImageMap::pixel_at(const Eigen::Vector2d& panel) const {
  const Eigen::Vector2d point = to_image(panel).px();
  if ((point.array() < 0.0).any() || (point.array() >= image_size_.array()).any()) return std::nullopt;
  return pixel_covering(RasterPoint(point));
}

void zoom_about(ImageView& view, const Eigen::Vector2d& image_size, const Eigen::Vector2d& panel_size,
                const Eigen::Vector2d& cursor, double factor) {
  const RasterPoint fixed = ImageMap(view, image_size, panel_size).to_image(cursor);
  const double fitting = fit_scale(image_size, panel_size);
  view.zoom = clamp_zoom(view.zoom * factor, fitting);
  const Eigen::Vector2d from_cursor = 0.5 * with_area(panel_size) - cursor;
  view.centre = (fixed.px() + from_cursor / (view.zoom * fitting)).cwiseQuotient(with_area(image_size));
  keep_in_image(view);
}

void pan_by(ImageView& view, const Eigen::Vector2d& image_size, const Eigen::Vector2d& panel_size,
            const Eigen::Vector2d& delta) {
  const double scale = view.zoom * fit_scale(image_size, panel_size);
  view.centre -= delta.cwiseQuotient(scale * with_area(image_size));
  keep_in_image(view);
}

void set_scale(ImageView& view, const Eigen::Vector2d& image_size, const Eigen::Vector2d& panel_size,
               double scale) {
  const double fitting = fit_scale(image_size, panel_size);
  view.zoom = clamp_zoom(scale / fitting, fitting);
}

void reveal(ImageView& view, const Eigen::Vector2d& image_size, const Eigen::Vector2d& panel_size,
            const RasterPoint& image_point) {
  const Eigen::Vector2d place = ImageMap(view, image_size, panel_size).to_panel(image_point);
  const Eigen::Vector2d inside = place.cwiseMax(0.0).cwiseMin(with_area(panel_size));
  pan_by(view, image_size, panel_size, inside - place);
}

}  // namespace stillpoint
