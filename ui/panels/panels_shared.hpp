#pragma once

#include <Eigen/Core>
#include <list>
#include <memory>
#include <optional>

#include "core/inspect/feature_selection.hpp"
#include "core/motion/stage_log.hpp"
#include "ui/view/image_view.hpp"

namespace stillpoint {

struct FrameView;
struct PairGeometry;
struct RunView;
struct SessionView;

/// What the mouse was on last in any image of a frame.
struct ImageCursor {
  FrameSpace space = FrameSpace::kTarget;           ///< of the image it was on
  Eigen::Vector2d pixel = Eigen::Vector2d::Zero();  ///< px there, the middle of pixel (i, j) is (i, j)
  std::optional<Eigen::Vector2d> target;            ///< px: the same scene point in frame t, where known
  bool operator==(const ImageCursor&) const = default;
};

/// What the panels of one set share.
struct PanelsShared {
  LinkedViews views;                        ///< zoom and pan by name; all images of frames use "frame"
  std::optional<Eigen::Vector2i> pixel;     ///< of frame t: the scene point the mouse was on last
  std::optional<ImageCursor> cursor;        ///< the same, where it was
  std::optional<FeatureSelection> feature;  ///< the feature chosen
  std::optional<Stage> stage;               ///< the stage chosen: its place
  std::optional<Stage> stage_of_strips;     ///< the one that the first of several runs shows: its place

  /// The geometry of the pair shown, worked out once a frame.
  const PairGeometry& geometry(const SessionView& session);

 private:
  struct KeptGeometry {
    std::shared_ptr<const PairGeometry> geometry;
    std::weak_ptr<const FrameView> current;
    std::weak_ptr<const RunView> run;
  };
  std::list<KeptGeometry> geometries_;  // the newest first
};

}  // namespace stillpoint
